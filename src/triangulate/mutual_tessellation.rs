//! Mutual tessellation: the samples become vertices of the input mesh, whose own vertices are then removed.
//!
//! Every step preserves the link condition, so the result has the topology of the input, whatever the samples are. It is
//! used for patches whose stars remain inconsistent because they are thinner or more strongly curved than the samples
//! resolve. A vertex that cannot be removed without turning a triangle against the surface remains as an additional sample.
//!
//! Based on: G. Turk, Re-tiling polygonal surfaces, 1992, DOI 10.1145/142920.134008. Departures: vertices are removed by
//! edge collapses, and Delaunay flips follow each collapse around it.
//!
//! Cost: linear in the triangles of the patch, with a large constant: some microseconds per vertex.

use crate::geom::triangle::barycentric;
use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::{OnCurve, next};
use crate::mesh::submesh::Fans;
use crate::mesh::topology::NONE;
use crate::surface::domain::{Domain, Sample};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

/// A sample to insert: on a triangle, or on one of its sides if that is on the boundary.
#[derive(Debug, Clone, Copy)]
pub struct Insertion {
    /// The sample.
    pub sample: Sample,
    /// For a sample on the boundary, the side `3 t + k` and the position along it.
    pub on_side: Option<(u32, f64)>,
    /// Whether it is the end of a spike, which is kept even where it is turned against the surface.
    pub is_spike: bool,
}

/// A part of the domain with new vertices.
#[derive(Debug, Clone)]
pub struct Tessellation {
    /// Its vertices are the insertions and those vertices of the domain that could not be removed.
    pub mesh: Manifold,
    /// The vertices along which the part was cut out of the domain, which are unchanged.
    pub border: VertexSet,
    /// The index of the insertion at each vertex, or [`NONE`].
    pub insertion: Vec<u32>,
}

/// Minimum cosine between a triangle and the surface in each round of removals: a vertex that is stuck at first may become
/// removable once its surroundings are coarser.
const ROUNDS: [f64; 6] = [0.7, 0.7, 0.5, 0.3, 0.1, -1.0];

/// Tessellates the part of the domain with the triangles `part`, sorted, over `insertions` on them.
///
/// Insertions that coincide with another one are left out.
pub fn mutual_tessellation(domain: &Domain, part: &[u32], insertions: &[Insertion]) -> Tessellation {
    let (mut mesh, border) = insert(domain, part, insertions);
    let inserted = insertions.len() as u32;
    for (v, _) in (0u32..).zip(insertions).filter(|(_, insertion)| insertion.is_spike) {
        mesh.connectivity.put_on_curve(v, OnCurve::Corner);
    }
    mesh.make_delaunay();
    for least_facing in ROUNDS {
        for v in inserted..mesh.connectivity.vertex_bound() {
            if mesh.connectivity.has_vertex(v) && !border.contains(v) {
                merge_away(&mut mesh, v, |facing| facing >= least_facing);
            }
        }
    }
    mesh.make_delaunay();
    for v in 0..mesh.connectivity.vertex_bound() {
        if mesh.connectivity.has_vertex(v) && !border.contains(v) {
            straighten(&mut mesh, v);
        }
    }
    let (triangles, old) = mesh.connectivity.compact();
    let left = Manifold::new(old.iter().map(|&v| *mesh.sample(v)).collect(), &triangles);
    let insertion = old.iter().map(|&v| if v < inserted { v } else { NONE }).collect();
    Tessellation { mesh: left, border: border.renumbered(&old), insertion }
}

/// Merges `v` into the neighbour that leaves the best triangles, among those that leave no triangle whose cosine to the
/// surface fails `passes`.
pub(super) fn merge_away(mesh: &mut Manifold, v: u32, passes: impl Fn(f64) -> bool) {
    let c = &mesh.connectivity;
    let mut best = None;
    let mut best_shape = f64::NEG_INFINITY;
    for h in c.outgoing(v) {
        let (facing, shape) = mesh.after_collapse(h);
        if passes(facing) && shape > best_shape && c.can_collapse(h) {
            (best, best_shape) = (Some(h), shape);
        }
    }
    if let Some(h) = best {
        mesh.collapse(h);
    }
}

/// If a triangle at `v` is turned against the surface, merges `v` into the neighbour that leaves the least turned triangles.
/// This leaves out a fold smaller than the samples resolve, including samples on it.
fn straighten(mesh: &mut Manifold, v: u32) {
    let c = &mesh.connectivity;
    if c.is_boundary(v) || c.outgoing(v).all(|h| FacingGuard::SOUND.passes(mesh.agreement(c.triangle(h)))) {
        return;
    }
    let merges = c.outgoing(v).filter(|&h| c.can_collapse(h)).map(|h| (mesh.after_collapse(h).0, h));
    if let Some((_, h)) = merges.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) {
        mesh.collapse(h);
    }
}

/// A point of a triangle in affine coordinates, in which points on its sides lie on them exactly.
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

/// Returns the mesh of the part with the insertions as its first vertices, and the vertices along which it was cut out.
fn insert(domain: &Domain, part: &[u32], insertions: &[Insertion]) -> (Manifold, VertexSet) {
    let mut by_triangle: Vec<(u32, u32)> =
        insertions.iter().enumerate().map(|(i, p)| (p.sample.triangle, i as u32)).collect();
    by_triangle.sort_unstable();
    let Fans { of_corner, first_corner, interface } = Fans::new(part, &domain.twin);
    let first = insertions.len() as u32;
    let mut triangles = Vec::with_capacity(part.len() + 2 * insertions.len());
    let mut own = by_triangle.chunk_by(|a, b| a.0 == b.0).peekable();
    for (&t, of_corner) in part.iter().zip(of_corner.chunks_exact(3)) {
        let ends = [0, 1, 2].map(|k| first + of_corner[k]);
        match own.next_if(|own| own[0].0 == t) {
            Some(own) => split(domain, t, ends, own.iter().map(|p| (p.1, &insertions[p.1 as usize])), &mut triangles),
            None => triangles.push(ends),
        }
    }
    let vertices = first_corner.into_iter().map(|corner| {
        let mut weights = [0.0; 3];
        weights[corner as usize % 3] = 1.0;
        domain.sample(part[corner as usize / 3], weights)
    });
    let samples = insertions.iter().map(|p| p.sample).chain(vertices).collect();
    let border = interface.iter().flat_map(|&side| [side, next(side)]).map(|c| first + of_corner[c as usize]);
    (Manifold::new(samples, &triangles), border.collect())
}

/// Appends the Delaunay triangles of the points on triangle `t`, whose corners have the indices `ends`.
fn split<'a>(
    domain: &Domain,
    t: u32,
    ends: [u32; 3],
    own: impl ExactSizeIterator<Item = (u32, &'a Insertion)>,
    triangles: &mut Vec<[u32; 3]>,
) {
    let mut own = own.peekable();
    if own.len() == 1
        && let Some((v, Insertion { on_side: None, .. })) = own.peek()
    {
        triangles.extend([0, 1, 2].map(|k| [*v, ends[k], ends[(k + 1) % 3]]));
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
            // Places are finite and between 0 and 1, so spade refuses none.
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

/// Returns a point along side `k`.
fn on_side(k: u32, along: f64) -> Point2<f64> {
    let along = along.clamp(1e-9, 1.0 - 1e-9);
    match k {
        0 => Point2::new(along, 0.0),
        1 => Point2::new(1.0 - along, along),
        _ => Point2::new(0.0, 1.0 - along),
    }
}

/// Returns a point kept away from the sides by a margin.
fn inside(domain: &Domain, t: u32, sample: &Sample) -> Point2<f64> {
    const MARGIN: f64 = 1e-6;
    let w = barycentric(sample.position, domain.mesh.corners(t as usize));
    let w = w.map(|w| w.max(MARGIN));
    let sum: f64 = w.iter().sum();
    Point2::new(w[1] / sum, w[2] / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::sphere;

    #[test]
    fn the_end_of_a_spike_stays_where_it_is_turned_against_the_surface() {
        let domain = Domain::new(sphere().try_into().unwrap());
        let part: Vec<u32> = (0..domain.mesh.triangles.len() as u32).collect();
        let on_surface: Vec<Sample> = part.iter().step_by(31).map(|&t| domain.sample(t, [1.0 / 3.0; 3])).collect();
        let stays = |is_spike: bool| {
            let turned = |&sample: &Sample| match sample.position.distance(on_surface[70].position) < 0.5 {
                true => Sample { normal: -sample.normal, ..sample },
                false => sample,
            };
            let insertion = |sample: &Sample| Insertion { sample: turned(sample), on_side: None, is_spike: false };
            let mut insertions: Vec<Insertion> = on_surface.iter().map(insertion).collect();
            insertions[70].is_spike = is_spike;
            mutual_tessellation(&domain, &part, &insertions).insertion.contains(&70)
        };
        assert!(stays(true) && !stays(false));
    }
}
