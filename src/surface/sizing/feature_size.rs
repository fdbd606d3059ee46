//! Edge lengths that follow the size of features between curves: the width of strips, chamfers and slots, the distance
//! between holes, the radius of their rims.
//!
//! The local feature size f at a point of a curve is the distance to the nearest other part of the boundary of its smooth
//! patch: on another loop, or on the same loop if the path along it is so much longer than the distance that the loop has
//! turned back. Where two curves meet at a corner, their distance falls to zero, which no refinement changes. So around one
//! corner only the narrowest wedges count. Along a curve without corners, a rim, f is the diameter. The target edge length
//! there is f / κ, but no less than a certain share of the length elsewhere, and grows from there with a bounded gradient.
//! The length elsewhere grows so that the number of vertices stays the same.
//!
//! Based on: J. Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, 1995,
//! DOI 10.1006/jagm.1995.1021 (local feature size). Departures: parts of the same curve also count; distances are measured in
//! space, not within the patch; wedges do not count.
//!
//! Cost: a search among the sides of curves for each vertex on them, and a few passes of Dijkstra's algorithm.
//!
//! Limits: strips narrower than `SHORTEST` of the length elsewhere keep triangles that are longer than they are wide.

use crate::base::parallel;
use crate::geom::triangle::closest_point_of_segment;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::spatial::groups::Groups;
use crate::surface::domain::Domain;
use crate::surface::sizing::room::{has_room, sizes_with_room};
use glam::DVec3;

/// κ: the number of edges across a narrow place, and per diameter around a rim (eight in all).
const ACROSS: f64 = 1.0;
const ACROSS_RIM: f64 = 2.6;

/// Minimum path length along a loop, relative to the distance, if the path passes no corner, one, or more.
const TURNED_BACK: [f64; 3] = [1.5, 6.0, 1.5];

/// Paths along a loop that are shorter than this share of it do not count.
const ROUNDING: f64 = 1e-9;

/// Returns `sizes`, relative to `spacing`, reduced where curves are close to each other and increased elsewhere so that the
/// number of vertices stays the same. `None` if there is no such place, or no room for one.
pub fn sizes_between_curves(domain: &Domain, sizes: &[f64], spacing: f64) -> Option<Vec<f64>> {
    sizes_with_room(domain, sizes, &wanted(domain, spacing), spacing)
}

/// Returns whether the vertices suffice for features between curves, down to a width of `narrowest` spacings.
pub fn has_room_between_curves(domain: &Domain, narrowest: f64, spacing: f64) -> bool {
    has_room(domain, &wanted(domain, spacing), narrowest / ACROSS, spacing)
}

/// Target edge length at each vertex for features between curves, relative to `spacing`.
fn wanted(domain: &Domain, spacing: f64) -> Vec<f64> {
    lengths(domain, ACROSS_RIM * spacing).into_iter().map(|l| l / spacing).collect()
}

/// Position of a side along the boundary of its patch.
#[derive(Clone, Copy)]
struct Along {
    /// The loop, and its total length.
    number: u32,
    total: f64,
    /// Arc length of the loop up to the side, number of corners up to and including its start, and their total number.
    arc: f64,
    corners: u32,
    all_corners: u32,
}

/// The sides of all curves as segments, each with its position on its loop.
pub(super) struct Sides {
    segments: Mesh,
    bvh: Bvh,
    patch: Vec<u32>,
    /// The sides of each patch.
    patches: Groups,
    along: Vec<Along>,
    /// Start vertex of each side.
    vertex: Vec<u32>,
    /// The curve of each side, and of the side before it on its loop.
    curves: Vec<[u32; 2]>,
}

impl Sides {
    pub fn new(domain: &Domain) -> Sides {
        let position = |v: u32| domain.mesh.positions[v as usize];
        let (mut positions, mut patch, mut along) = (Vec::new(), Vec::new(), Vec::new());
        let (mut vertex, mut curves) = (Vec::new(), Vec::new());
        for (number, sides) in (0..).zip(domain.boundary_loops()) {
            let first = along.len();
            let (mut arc, mut corners) = (0.0, 0);
            let mut before = sides.last().map_or(0, |&side| domain.curves.of_side(side));
            for side in sides {
                let [from, to] = domain.mesh.ends(side);
                corners += u32::from(domain.curves.is_corner(from));
                along.push(Along { number, total: 0.0, arc, corners, all_corners: 0 });
                patch.push(domain.patch_of(side / 3));
                vertex.push(from);
                let curve = domain.curves.of_side(side);
                curves.push([curve, std::mem::replace(&mut before, curve)]);
                positions.extend([position(from), position(to)]);
                arc += position(from).distance(position(to));
            }
            along[first..].iter_mut().for_each(|a| (a.total, a.all_corners) = (arc, corners));
        }
        let triangles = (0..along.len() as u32).map(|i| [2 * i, 2 * i + 1, 2 * i + 1]).collect();
        let segments = Mesh { positions, triangles };
        let bvh = Bvh::new(&segments);
        let patches = Groups::new((&segments, &bvh), domain.patch_count(), |side| patch[side as usize]);
        Sides { bvh, segments, patch, patches, along, vertex, curves }
    }

    pub fn count(&self) -> usize {
        self.along.len()
    }

    /// Returns the start vertex of side `i` in the domain.
    pub fn vertex(&self, i: usize) -> u32 {
        self.vertex[i]
    }

    /// Returns the distance from the start of side `i` to what faces it, either across a `rim` or not; infinite beyond
    /// `reach`.
    pub fn distance_at(&self, domain: &Domain, i: usize, reach: f64, rim: bool) -> f64 {
        let [here, ..] = self.segments.corners(i);
        let is_own = |j: u32| self.patch[j as usize] == self.patch[i];
        let faces = |j: u32| self.turned_back(domain, here, i, j as usize) == Some(rim);
        let all = (&self.segments, &self.bvh);
        let hit = self.patches.closest(all, (self.patch[i], is_own), here, reach * reach, faces);
        hit.map_or(f64::INFINITY, |hit| hit.distance_squared.sqrt())
    }

    /// Target edge length at the start of side `i`; infinite if nothing is within `reach`.
    fn length_at(&self, domain: &Domain, i: usize, reach: f64) -> f64 {
        let across = self.distance_at(domain, i, reach * ACROSS / ACROSS_RIM, false) / ACROSS;
        across.min(self.distance_at(domain, i, reach, true) / ACROSS_RIM)
    }

    /// Returns whether side `j` faces `here`, the start of side `i` of the same patch, and if so, whether across a rim.
    fn turned_back(&self, domain: &Domain, here: DVec3, i: usize, j: usize) -> Option<bool> {
        let (a, b) = (self.along[i], self.along[j]);
        if a.number != b.number {
            return Some(false);
        }
        let [p, q, _] = self.segments.corners(j);
        let there = closest_point_of_segment(here, p, q);
        let forwards = (b.arc + p.distance(there) - a.arc).rem_euclid(a.total);
        let between = if b.arc >= a.arc { b.corners - a.corners } else { a.all_corners - a.corners + b.corners };
        let own = u32::from(domain.curves.is_corner(self.vertex[i]));
        // If `here` is a corner itself, neither path counts it.
        let ways = [(forwards, between), (a.total - forwards, a.all_corners - own - between.min(a.all_corners - own))];
        let (way, corners) = if ways[0].0 <= ways[1].0 { ways[0] } else { ways[1] };
        // The two sides of a crease that ends within its patch are on one loop and at the same place.
        if corners > 0 && self.curves[i].contains(&self.curves[j][0]) {
            return None;
        }
        let least = TURNED_BACK[(corners as usize).min(2)];
        (way > least * here.distance(there) + ROUNDING * a.total).then_some(corners == 0)
    }
}

/// Target edge length at each vertex of the domain: f / κ on curves, infinite elsewhere and where f exceeds `reach`.
fn lengths(domain: &Domain, reach: f64) -> Vec<f64> {
    let sides = Sides::new(domain);
    let at = parallel::map(0..sides.along.len(), |i| sides.length_at(domain, i, reach));
    let mut lengths = vec![f64::INFINITY; domain.mesh.positions.len()];
    for (&v, length) in sides.vertex.iter().zip(at) {
        lengths[v as usize] = lengths[v as usize].min(length);
    }
    lengths
}
