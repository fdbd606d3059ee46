//! Edge lengths that follow the size of what lies between feature curves: the width of strips, chamfers and slots, the
//! distance of holes, the radius of their rims.
//!
//! The local feature size f of a point on a curve is the distance to the nearest other part of the boundary of its smooth
//! patch: of another loop, or so much farther along the same loop than through space that the loop has turned back. Where
//! two curves meet at a corner the distance between them falls to zero, which no refinement changes, so around one corner
//! only the narrowest wedges count. Along a curve without corners, a rim, f is the diameter. The length that is wanted there
//! is f / κ, but no less than a share of the length elsewhere, and grows by a bounded gradient from there. The length
//! elsewhere grows such that the number of vertices stays what it was.
//!
//! Based on: J. Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, 1995,
//! DOI 10.1006/jagm.1995.1021 (local feature size). Departures: parts of one curve count, too; distances are in space, not
//! within the patch; wedges do not count.
//!
//! Cost: a search among the sides of curves for each vertex on them, and some passes of Dijkstra's algorithm.
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

/// κ, edges across what is narrow, and around a rim edges for each diameter of it: eight in all.
const ACROSS: f64 = 1.0;
const ACROSS_RIM: f64 = 2.6;

/// How much longer the way along a loop has to be than the distance, by the corners that it passes: none, one, more.
const TURNED_BACK: [f64; 3] = [1.5, 6.0, 1.5];

/// Ways along a loop shorter than this share of it do not count.
const ROUNDING: f64 = 1e-9;

/// `sizes`, relative to `spacing`, made smaller where curves are near each other, and as much larger elsewhere as keeps the
/// number of vertices. `None` if there is no such place, or no room for one.
pub fn sizes_between_curves(domain: &Domain, sizes: &[f64], spacing: f64) -> Option<Vec<f64>> {
    sizes_with_room(domain, sizes, &wanted(domain, spacing), spacing)
}

/// Whether the vertices suffice for what is between curves, down to a width of `narrowest` spacings.
pub fn has_room_between_curves(domain: &Domain, narrowest: f64, spacing: f64) -> bool {
    has_room(domain, &wanted(domain, spacing), narrowest / ACROSS, spacing)
}

/// The length that is wanted at each vertex for what is between curves, relative to `spacing`.
fn wanted(domain: &Domain, spacing: f64) -> Vec<f64> {
    lengths(domain, ACROSS_RIM * spacing).into_iter().map(|l| l / spacing).collect()
}

/// Where a side of the domain lies along the boundary of its patch.
#[derive(Clone, Copy)]
struct Along {
    /// The loop, and the length of all of it.
    number: u32,
    total: f64,
    /// The length of the loop up to the side, the number of corners up to its begin, that one included, and in all.
    arc: f64,
    corners: u32,
    all_corners: u32,
}

/// The sides of all curves as segments, each with its place on its loop.
pub(super) struct Sides {
    segments: Mesh,
    bvh: Bvh,
    patch: Vec<u32>,
    /// The sides of each patch.
    patches: Groups,
    along: Vec<Along>,
    /// The vertex that each side leaves.
    vertex: Vec<u32>,
    /// The curve of each side, and of the one before it on its loop.
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

    /// The vertex of the domain that side `i` leaves.
    pub fn vertex(&self, i: usize) -> u32 {
        self.vertex[i]
    }

    /// The distance from the start of side `i` to what faces it, as the far side of a rim or not; infinite beyond `reach`.
    pub fn distance_at(&self, domain: &Domain, i: usize, reach: f64, rim: bool) -> f64 {
        let [here, ..] = self.segments.corners(i);
        let is_own = |j: u32| self.patch[j as usize] == self.patch[i];
        let faces = |j: u32| self.turned_back(domain, here, i, j as usize) == Some(rim);
        let all = (&self.segments, &self.bvh);
        let hit = self.patches.closest(all, (self.patch[i], is_own), here, reach * reach, faces);
        hit.map_or(f64::INFINITY, |hit| hit.distance_squared.sqrt())
    }

    /// The length wanted at the start of side `i`; infinite if nothing is within `reach`.
    fn length_at(&self, domain: &Domain, i: usize, reach: f64) -> f64 {
        let across = self.distance_at(domain, i, reach * ACROSS / ACROSS_RIM, false) / ACROSS;
        across.min(self.distance_at(domain, i, reach, true) / ACROSS_RIM)
    }

    /// Whether side `j` faces `here`, the start of side `i` of the same patch, and if so whether as the far side of a rim.
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
        // If `here` is a corner itself, it counts on neither way.
        let ways = [(forwards, between), (a.total - forwards, a.all_corners - own - between.min(a.all_corners - own))];
        let (way, corners) = if ways[0].0 <= ways[1].0 { ways[0] } else { ways[1] };
        // Both sides of a crease that ends within its patch are on one loop, and at one place.
        if corners > 0 && self.curves[i].contains(&self.curves[j][0]) {
            return None;
        }
        let least = TURNED_BACK[(corners as usize).min(2)];
        (way > least * here.distance(there) + ROUNDING * a.total).then_some(corners == 0)
    }
}

/// The wanted length at each vertex of the domain: f / κ on curves, infinite elsewhere and where f exceeds `reach`.
fn lengths(domain: &Domain, reach: f64) -> Vec<f64> {
    let sides = Sides::new(domain);
    let at = parallel::map(0..sides.along.len(), |i| sides.length_at(domain, i, reach));
    let mut lengths = vec![f64::INFINITY; domain.mesh.positions.len()];
    for (&v, length) in sides.vertex.iter().zip(at) {
        lengths[v as usize] = lengths[v as usize].min(length);
    }
    lengths
}
