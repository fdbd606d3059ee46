//! Mutual tessellation: the samples become vertices of the input mesh, and the input's own vertices are taken away.
//!
//! Every step keeps the link condition, so the result has the topology of the input whatever the samples are. It serves
//! the pieces whose stars do not settle, because they are thinner or more bent than the samples resolve. A vertex that
//! cannot go without turning a triangle against the surface stays as a sample of its own.
//!
//! Based on: G. Turk, Re-tiling polygonal surfaces, 1992, DOI 10.1145/142920.134008. Departures: vertices go by edge
//! collapses, and every collapse is followed by Delaunay flips around it.
//!
//! Cost: linear in the triangles of the piece, with a large constant: some microseconds a vertex.

use crate::surface::connectivity::next;
use crate::surface::domain::{Domain, Sample};
use crate::surface::manifold::Manifold;
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::collections::HashMap;

/// A sample to insert: on a triangle, or on a side of it if that is on the boundary.
#[derive(Debug, Clone, Copy)]
pub struct Insertion {
    pub sample: Sample,
    /// The side `3 t + k` and how far along, for a sample on the boundary.
    pub on_side: Option<(u32, f64)>,
}

/// Least cosine between a triangle and the surface in each round of removals: what is stuck at first may come loose once
/// its surroundings are coarser.
const ROUNDS: [f64; 5] = [0.7, 0.7, 0.5, 0.3, 0.1];

/// The manifold over `insertions` on the piece of the domain made of the triangles `piece`.
///
/// Its vertices are the samples in their order, without those that coincide with another one, and then the vertices of
/// the domain that could not be removed.
pub fn mutual_tessellation(domain: &Domain, piece: &[u32], insertions: &[Insertion]) -> Manifold {
    let (samples, triangles, inserted) = insert(domain, piece, insertions);
    let mut mesh = Manifold::new(samples, &triangles);
    mesh.make_delaunay();
    for least_facing in ROUNDS {
        for v in inserted as u32..mesh.connectivity.vertex_bound() {
            if mesh.connectivity.has_vertex(v) {
                remove(&mut mesh, v, least_facing);
            }
        }
    }
    mesh.make_delaunay();
    let (triangles, old) = mesh.connectivity.compact();
    Manifold::new(old.iter().map(|&v| mesh.samples[v as usize]).collect(), &triangles)
}

/// Merges `v` into the neighbour that leaves the best triangles, if there is one that may be.
fn remove(mesh: &mut Manifold, v: u32, least_facing: f64) {
    let c = &mesh.connectivity;
    let candidates = c.outgoing(v).filter(|&h| c.can_collapse(h)).filter_map(|h| {
        let (facing, shape) = mesh.after_collapse(h);
        (facing >= least_facing).then_some((shape, h))
    });
    let Some((_, h)) = candidates.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) else { return };
    let into = c.target(h);
    mesh.connectivity.collapse(h);
    let around = mesh.connectivity.outgoing(into).flat_map(|h| [h, next(h)]).collect();
    mesh.flip_to_delaunay(around);
}

/// A point of a triangle in affine coordinates, so that points on its sides are on them exactly.
struct Site {
    place: Point2<f64>,
    vertex: u32,
    /// Bit k is set if the point lies on side k.
    sides: u8,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// The mesh of the piece with the insertions in it: vertices, triangles, and how many of the vertices, the first ones,
/// are insertions.
fn insert(domain: &Domain, piece: &[u32], insertions: &[Insertion]) -> (Vec<Sample>, Vec<[u32; 3]>, usize) {
    let mut by_triangle: Vec<(u32, u32)> =
        insertions.iter().enumerate().map(|(i, p)| (p.sample.triangle, i as u32)).collect();
    by_triangle.sort_unstable();
    let mut used = vec![false; insertions.len()];
    // Corners are numbered after the insertions, in the order in which triangles meet them.
    let mut corners: Vec<Sample> = Vec::new();
    let mut number: HashMap<u32, u32> = HashMap::new();
    let mut triangles = Vec::new();
    for &t in piece {
        let ends = [0, 1, 2].map(|k| {
            *number.entry(domain.mesh.triangles[t as usize][k]).or_insert_with(|| {
                let mut weights = [0.0; 3];
                weights[k] = 1.0;
                corners.push(domain.sample(t, weights));
                (insertions.len() + corners.len() - 1) as u32
            })
        });
        let begin = by_triangle.partition_point(|p| p.0 < t);
        let own = by_triangle[begin..].iter().take_while(|p| p.0 == t).map(|p| p.1);
        let first = triangles.len();
        split(domain, t, ends, own.map(|i| (i, &insertions[i as usize])), &mut triangles);
        for &v in triangles[first..].iter().flatten() {
            if let Some(u) = used.get_mut(v as usize) {
                *u = true;
            }
        }
    }
    close_ranks(insertions, &used, corners, triangles)
}

/// Drops the insertions that are not used, for lying where another one does.
fn close_ranks(
    insertions: &[Insertion],
    used: &[bool],
    corners: Vec<Sample>,
    mut triangles: Vec<[u32; 3]>,
) -> (Vec<Sample>, Vec<[u32; 3]>, usize) {
    let mut samples: Vec<Sample> = insertions.iter().zip(used).filter(|(_, u)| **u).map(|(p, _)| p.sample).collect();
    let inserted = samples.len();
    let mut number: Vec<u32> = Vec::with_capacity(used.len());
    let mut count = 0;
    for &u in used {
        number.push(count);
        count += u32::from(u);
    }
    for v in triangles.iter_mut().flatten() {
        *v = if (*v as usize) < used.len() { number[*v as usize] } else { *v - used.len() as u32 + count };
    }
    samples.extend(corners);
    (samples, triangles, inserted)
}

/// Adds the Delaunay triangles of the points of triangle `t`, whose corners have the numbers `ends`.
fn split<'a>(
    domain: &Domain,
    t: u32,
    ends: [u32; 3],
    own: impl Iterator<Item = (u32, &'a Insertion)>,
    triangles: &mut Vec<[u32; 3]>,
) {
    let mut own = own.peekable();
    if own.peek().is_none() {
        triangles.push(ends);
        return;
    }
    let mut plane = DelaunayTriangulation::<Site>::new();
    let places = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
    let corners = (0..3).map(|k| {
        let (x, y) = places[k];
        Site { place: Point2::new(x, y), vertex: ends[k], sides: 1 << k | 1 << ((k + 2) % 3) }
    });
    let points = own.map(|(i, p)| {
        let (place, sides) = match p.on_side {
            Some((side, along)) => (on_side(side % 3, along), 1 << (side % 3)),
            None => (inside(domain, t, &p.sample), 0),
        };
        Site { place, vertex: i, sides }
    });
    for site in corners.chain(points).collect::<Vec<_>>() {
        if plane.locate_vertex(site.place).is_none() {
            // Places are finite and between 0 and 1: nothing that spade refuses.
            let _ = plane.insert(site);
        }
    }
    for face in plane.inner_faces() {
        let [a, b, c] = face.vertices().map(|v| (v.data().vertex, v.data().sides));
        if a.1 & b.1 & c.1 == 0 {
            triangles.push([a.0, b.0, c.0]);
        }
    }
}

/// A point along side `k`.
fn on_side(k: u32, along: f64) -> Point2<f64> {
    let along = along.clamp(1e-9, 1.0 - 1e-9);
    match k {
        0 => Point2::new(along, 0.0),
        1 => Point2::new(1.0 - along, along),
        _ => Point2::new(0.0, 1.0 - along),
    }
}

/// A point kept off the sides by a margin.
fn inside(domain: &Domain, t: u32, sample: &Sample) -> Point2<f64> {
    const MARGIN: f64 = 1e-6;
    let w = crate::geom::triangle::barycentric(sample.position, domain.mesh.corners(t as usize));
    let w = w.map(|w| w.max(MARGIN));
    let sum: f64 = w.iter().sum();
    Point2::new(w[1] / sum, w[2] / sum)
}
