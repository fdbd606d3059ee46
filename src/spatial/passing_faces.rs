//! Faces of a mesh that pass through others.
//!
//! Besides those that do so pair by pair, these are faces that pass along an edge: two faces that share an edge are on
//! different sides of a third face in which the edge lies, or of two others that share an edge at the same place. Taken pair
//! by pair, they only touch.
//!
//! Cost: a search of the hierarchy for each face of the blocks that are asked for.

use crate::base::math;
use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::geom::intersection::cross_deeper_than;
use crate::mesh::half_edge::prev;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::spatial::self_intersections::depth_of_contact;
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// The faces of a mesh that pass through others. They are found block by block of the hierarchy over the mesh, when the block
/// is first asked for.
///
/// Each call takes the same mesh, the same hierarchy over it, and the same function, which gives the twin of each side, or
/// [`NONE`].
pub struct PassingFaces {
    /// [`depth_of_contact`]
    depth: f64,
    of_block: Vec<OnceLock<Vec<u32>>>,
}

impl PassingFaces {
    /// Those of `mesh`, of which none has been found yet.
    pub fn new(mesh: &Mesh, bvh: &Bvh) -> PassingFaces {
        PassingFaces { depth: depth_of_contact(mesh), of_block: vec![OnceLock::new(); bvh.blocks()] }
    }

    /// Returns all of them, in increasing order.
    pub fn all(&self, mesh: &Mesh, bvh: &Bvh, across: impl Fn(u32) -> u32 + Sync) -> Vec<u32> {
        let of_blocks = parallel::each(0..self.of_block.len(), |block| self.of_block(block, mesh, bvh, &across));
        let mut faces = of_blocks.concat();
        faces.sort_unstable();
        faces
    }

    /// Returns whether `accept` holds for one of those in the blocks that meet the box `wanted`.
    pub fn any_near(
        &self,
        wanted: &Aabb,
        mesh: &Mesh,
        bvh: &Bvh,
        across: impl Fn(u32) -> u32,
        accept: impl Fn(u32) -> bool,
    ) -> bool {
        bvh.any_block_in_box(wanted, |block| self.of_block(block, mesh, bvh, &across).iter().any(|&t| accept(t)))
    }

    fn of_block(&self, block: usize, mesh: &Mesh, bvh: &Bvh, across: &impl Fn(u32) -> u32) -> &[u32] {
        let passes = |&t: &u32| passes_through_others(t, mesh, bvh, across, self.depth);
        self.of_block[block].get_or_init(|| bvh.block(block).iter().copied().filter(passes).collect())
    }
}

fn passes_through_others(t: u32, mesh: &Mesh, bvh: &Bvh, across: impl Fn(u32) -> u32, depth: f64) -> bool {
    let own = Face::new(mesh.corners(t as usize));
    let around = Aabb::of_triangle(own.corners);
    let wanted = Aabb { lo: around.lo - depth, hi: around.hi + depth };
    // Of the two sides of an edge always the first, so that it makes no difference which of its faces is asked for.
    let edge = |side: u32| {
        let other = across(side);
        let (side, other) = (side.min(other), side.max(other));
        let tops = || [side, other].map(|side| mesh.positions[mesh.origin(prev(side)) as usize]);
        (other != NONE).then(|| Edge { ends: mesh.segment(side), tops: tops() })
    };
    let edges = [0, 1, 2].map(|k| edge(3 * t + k));
    let is_flat = edges.iter().flatten().all(|edge| edge.tops.iter().all(|&p| own.height(p).abs() <= depth));
    bvh.any_in_box(mesh, &wanted, |u| {
        if t == u {
            return false;
        }
        let other = Face::new(mesh.corners(u as usize));
        let (first, second) = if t < u { (&own, &other) } else { (&other, &own) };
        if cross_deeper_than(depth, first.corners, second.corners) {
            return true;
        }
        let is_near = other.corners.map(|p| own.height(p).abs() <= depth);
        // In a plane, faces only touch.
        if is_flat && is_near == [true; 3] {
            return false;
        }
        let lies_in_own = |k: usize| {
            let may_lie = is_near[k] && is_near[(k + 1) % 3];
            may_lie && edge(3 * u + k as u32).is_some_and(|edge| edge.lies_in(&own, depth))
        };
        let is_crossed = |mine: &Edge, k: usize| {
            let ends = [other.corners[k], other.corners[(k + 1) % 3]];
            let side = 3 * u + k as u32;
            // The edge itself, seen from the other face, does not alternate: its faces are the same.
            mine.lies_along(ends, depth) && edge(side).is_some_and(|edge| mine.alternates(&edge, depth))
        };
        (0..3).any(lies_in_own)
            || edges.iter().flatten().any(|edge| edge.lies_in(&other, depth) || (0..3).any(|k| is_crossed(edge, k)))
    })
}

/// A face and its unit normal.
struct Face {
    corners: [DVec3; 3],
    normal: DVec3,
}

impl Face {
    fn new(corners: [DVec3; 3]) -> Face {
        let [a, b, c] = corners;
        Face { corners, normal: (b - a).cross(c - a).normalize_or_zero() }
    }

    fn height(&self, p: DVec3) -> f64 {
        (p - self.corners[0]).dot(self.normal)
    }
}

/// Edge with the corners opposite it in both of its faces.
struct Edge {
    ends: [DVec3; 2],
    tops: [DVec3; 2],
}

impl Edge {
    /// Returns whether a part of the edge lies in `face`, and the two faces are on different sides of that, both deeper than
    /// `depth`.
    fn lies_in(&self, face: &Face, depth: f64) -> bool {
        if self.ends.iter().any(|&p| face.height(p).abs() > depth) {
            return false;
        }
        let [above, below] = self.tops.map(|p| face.height(p));
        if above.abs() <= depth || above * below > -depth * depth {
            return false;
        }
        // The range of the edge that is on the inner side of all sides of the face.
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for k in 0..3 {
            let [start, end] = [face.corners[k], face.corners[(k + 1) % 3]];
            let inwards = face.normal.cross(end - start).normalize_or_zero();
            let [a, b] = self.ends.map(|p| (p - start).dot(inwards) - depth);
            if a < 0.0 && b < 0.0 {
                return false;
            }
            let crossing = a / (a - b);
            if a < 0.0 {
                from = from.max(crossing);
            } else if b < 0.0 {
                to = to.min(crossing);
            }
        }
        (to - from) * self.ends[0].distance(self.ends[1]) > depth
    }

    /// Returns whether a part of the edge lies along one with these `ends`.
    fn lies_along(&self, ends: [DVec3; 2], depth: f64) -> bool {
        let [start, end] = self.ends;
        let along = end - start;
        let length_squared = along.length_squared();
        let is_off = |p: DVec3| (p - start).cross(along).length_squared() > depth * depth * length_squared;
        if ends.into_iter().any(is_off) {
            return false;
        }
        let length = length_squared.sqrt();
        let [a, b] = ends.map(|p| (p - start).dot(along) / length);
        a.max(b).min(length) - a.min(b).max(0.0) > depth
    }

    /// Returns whether the faces of the edge and of `other`, which lies along it, alternate around it, all farther apart than
    /// `depth`.
    fn alternates(&self, other: &Edge, depth: f64) -> bool {
        let [start, end] = self.ends;
        let along = (end - start).normalize_or_zero();
        let off_line = |p: DVec3| (p - start).reject_from_normalized(along);
        let ([first, second], tops) = (self.tops.map(off_line), other.tops.map(off_line));
        let distance = |p: DVec3, ray: DVec3| {
            let ray = ray.normalize_or_zero();
            p.distance(ray * p.dot(ray).max(0.0))
        };
        let are_apart = || tops.iter().all(|&p| distance(p, first) > depth && distance(p, second) > depth);
        let turn = |p: DVec3| {
            let turn = math::atan2(first.cross(p).dot(along), first.dot(p));
            if turn < 0.0 { turn + TAU } else { turn }
        };
        let is_between = |p: DVec3| turn(p) < turn(second);
        is_between(tops[0]) != is_between(tops[1]) && are_apart()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};
    use crate::mesh::topology::twins;
    use crate::spatial::self_intersections::{faces_of, self_intersecting_pairs, self_intersections};
    use crate::testing::random_point;
    use std::f64::consts::PI;

    fn all_passing(mesh: &Mesh) -> Vec<u32> {
        let (twin, bvh) = (twins(&mesh.triangles), Bvh::new(mesh));
        PassingFaces::new(mesh, &bvh).all(mesh, &bvh, |side| twin[side as usize])
    }

    #[test]
    fn a_fold_in_a_face_passes_through_it() {
        // A roof whose ridge lies in a large triangle, and a valley that only stands on it.
        let large = [[-9., -9., 0.], [9., -9., 0.], [0., 9., 0.]];
        let folded = |z: [f64; 2]| {
            let [a, b] = [[-1., 0., 0.], [1., 0., 0.]];
            let corners = [large[0], large[1], large[2], a, b, [0., 1., z[0]], [0., -1., z[1]]];
            let triangles = vec![[0, 1, 2], [3, 4, 5], [4, 3, 6]];
            Mesh { positions: corners.map(DVec3::from).to_vec(), triangles }
        };
        assert!(self_intersections(&folded([1.0, -1.0])).is_empty());
        assert_eq!(all_passing(&folded([1.0, -1.0])), [0, 1, 2]);
        assert!(all_passing(&folded([1.0, 1.0])).is_empty());
        assert!(all_passing(&folded([1.0, 1e-9])).is_empty());
        let mut beside = folded([1.0, -1.0]);
        beside.positions[3..].iter_mut().for_each(|p| *p += 20.0 * DVec3::X);
        assert!(all_passing(&beside).is_empty());
    }

    #[test]
    fn sheets_that_cross_along_edges_pass_through_each_other_and_those_that_touch_there_do_not() {
        // Two sheets of two triangles, each bent along the x axis or a part of it.
        let bent = |from: f64, to: f64, turns: [f64; 2]| {
            let top = |turn: f64| DVec3::new(0.5, turn.cos(), turn.sin());
            [DVec3::X * from, DVec3::X * to, top(turns[0]), top(turns[1])]
        };
        let passing = |one: [DVec3; 4], other: [DVec3; 4]| {
            let positions = one.into_iter().chain(other).collect();
            let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [1, 0, 3], [4, 5, 6], [5, 4, 7]] };
            all_passing(&mesh).len()
        };
        let level = bent(0.0, 1.0, [0.0, PI]);
        assert_eq!(passing(level, bent(0.0, 1.0, [0.5 * PI, 1.5 * PI])), 4);
        assert_eq!(passing(level, bent(0.5, 1.5, [0.2 * PI, 1.1 * PI])), 4);
        assert_eq!(passing(level, bent(0.0, 1.0, [0.3 * PI, 0.6 * PI])), 0);
        assert_eq!(passing(level, bent(1.0, 2.0, [0.5 * PI, 1.5 * PI])), 0);
    }

    #[test]
    fn of_triangles_without_neighbours_they_are_those_of_the_pairs_that_intersect() {
        let mut rng = stream(12, Stage::Distance);
        let corners = |_| [0; 3].map(|_| random_point(&mut rng));
        let mesh = Mesh::soup((0..400).map(corners).collect::<Vec<_>>());
        let bvh = Bvh::new(&mesh);
        assert!(bvh.blocks() > 1);
        let passing = PassingFaces::new(&mesh, &bvh).all(&mesh, &bvh, |_| NONE);
        assert_eq!(passing, faces_of(self_intersecting_pairs(&mesh, &bvh)));
    }
}
