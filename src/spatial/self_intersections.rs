//! Self-intersections of a mesh.
//!
//! Two faces intersect if they pass through each other, or if they share a side and are folded over; see
//! [`crate::geom::intersection`]. Corners at the same position count as one corner, whatever their numbers, so UV seams do
//! not intersect. Surfaces that only touch, at corners, along edges or with whole faces, do not intersect either: anything
//! up to the depth `CONTACT` is contact.
//!
//! Cost: n log n to build the hierarchy, then near-linear for surfaces, whose boxes meet few others; in parallel.
//!
//! Limits: n faces at the same position (copies in a soup) form n² pairs; these are only stored if pairs are requested.

use crate::base::math;
use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::geom::intersection::cross_deeper_than;
use crate::geom::triangle::longest_side;
use crate::mesh::half_edge::prev;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Depth up to which faces count as touching, as a fraction of the diagonal of their mesh: coordinates in single precision
/// are off by up to a tenth of it.
const CONTACT: f64 = 1e-6;

/// The depth, for [`cross_deeper_than`], beyond which faces of `mesh` intersect.
pub fn depth_of_contact(mesh: &Mesh) -> f64 {
    CONTACT * mesh.diagonal()
}

/// Returns the pairs of intersecting faces of `mesh`, in increasing order, the lower index first. `bvh` is the hierarchy
/// over `mesh`.
pub fn self_intersecting_pairs(mesh: &Mesh, bvh: &Bvh) -> Vec<(u32, u32)> {
    let depth = depth_of_contact(mesh);
    bvh.pairs_that_meet(mesh, |t, u| cross_deeper_than(depth, mesh.corners(t as usize), mesh.corners(u as usize)))
}

/// Returns the self-intersecting faces of `mesh`, in increasing order.
pub fn self_intersections(mesh: &Mesh) -> Vec<u32> {
    let depth = depth_of_contact(mesh);
    let bvh = Bvh::new(mesh);
    bvh.triangles_that_meet(mesh, |t, u| cross_deeper_than(depth, mesh.corners(t as usize), mesh.corners(u as usize)))
}

/// The faces of a mesh that pass through others, pair by pair or along an edge: two faces that share an edge are on different
/// sides of a third face in which the edge lies, or of two others that share an edge at the same place. Taken pair by pair,
/// these faces only touch. They are found block by block of the hierarchy over the mesh, when the block is first asked for.
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

/// The self-intersecting triangles of a surface. Near them, any mesh of the surface intersects itself, too.
pub struct Inherited {
    mesh: Mesh,
    bvh: Bvh,
}

impl Inherited {
    /// The triangles with these corners.
    pub fn new(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Inherited {
        let mesh = Mesh::soup(triangles);
        Inherited { bvh: Bvh::new(&mesh), mesh }
    }

    /// Returns whether any of them is at most the longest side of `triangle` away from its centre.
    pub fn is_near(&self, triangle: [DVec3; 3]) -> bool {
        let (middle, length) = (triangle.iter().sum::<DVec3>() / 3.0, longest_side(triangle));
        let squared = length * length;
        !self.mesh.triangles.is_empty()
            && self.bvh.closest_or_near(&self.mesh, middle, squared, squared, |_| true).is_some()
    }
}

/// Returns the faces of these pairs, each once, in increasing order.
pub fn faces_of(pairs: Vec<(u32, u32)>) -> Vec<u32> {
    let mut faces: Vec<u32> = pairs.into_iter().flat_map(|(t, u)| [t, u]).collect();
    faces.sort_unstable();
    faces.dedup();
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::mesh::topology::twins;
    use std::f64::consts::PI;

    /// A band of `n` squares around the z axis, of radius 1 at the bottom and `top` at height 1.
    fn band(n: u32, top: f64) -> Mesh {
        let place = |i: u32, r: f64, z: f64| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
            DVec3::new(r * cos, r * sin, z)
        };
        let positions = (0..n).flat_map(|i| [place(i, 1.0, 0.0), place(i, top, 1.0)]).collect();
        let corner = |k: u32| k % (2 * n);
        let triangles = (0..2 * n).map(|k| [k, corner(k + 1), corner(k + 2)]).collect();
        Mesh { positions, triangles }
    }

    fn all_passing(mesh: &Mesh) -> Vec<u32> {
        let (twin, bvh) = (twins(&mesh.triangles), Bvh::new(mesh));
        PassingFaces::new(mesh, &bvh).all(mesh, &bvh, |side| twin[side as usize])
    }

    #[test]
    fn a_surface_does_not_cross_itself_and_a_tangled_one_does() {
        assert!(self_intersections(&band(100, 1.0)).is_empty());
        assert!(self_intersections(&band(100, 0.1)).is_empty());
        // Turned through its axis: each triangle crosses those on the other side.
        assert_eq!(self_intersections(&band(9, -1.0)).len(), 18);
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
    fn what_crosses_excuses_what_is_within_a_length_of_it() {
        let crossing = Inherited::new([[DVec3::ZERO, DVec3::X, DVec3::Y]]);
        let at = |z: f64| [[0.1, 0.1], [0.3, 0.1], [0.1, 0.3]].map(|[x, y]| DVec3::new(x, y, z));
        assert!(crossing.is_near(at(0.2)));
        assert!(!crossing.is_near(at(0.4)));
        assert!(!Inherited::new([]).is_near(at(0.0)));
    }

    #[test]
    fn corners_at_the_same_place_are_one() {
        let whole = band(20, 0.7);
        let positions: Vec<DVec3> = (0..whole.triangles.len()).flat_map(|t| whole.corners(t)).collect();
        let triangles = (0..whole.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        assert!(self_intersections(&Mesh { positions, triangles }).is_empty());
    }

    #[test]
    fn random_triangles_between_few_points_as_by_looking_at_all_pairs() {
        let mut rng = stream(11, Stage::Distance);
        // On a coarse grid of positions, so that triangles share corners, touch, are coplanar or have no area.
        for (count, places) in [(40, 4.0), (200, 30.0), (300, 1e9)] {
            let mut at = || ((unit(&mut rng) * places).floor() / places, unit(&mut rng));
            let mut mesh = Mesh::default();
            for t in 0..count {
                let corner = |_| DVec3::new(at().0, at().0, at().0);
                mesh.positions.extend([0; 3].map(corner));
                mesh.triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
            }
            let all = (0..count).flat_map(|t| (t + 1..count).map(move |u| (t, u)));
            let depth = depth_of_contact(&mesh);
            let meet = |t, u| cross_deeper_than(depth, mesh.corners(t as usize), mesh.corners(u as usize));
            let expected: Vec<(u32, u32)> = all.filter(|&(t, u)| meet(t, u)).collect();
            assert!(expected.len() > 10);
            let bvh = Bvh::new(&mesh);
            assert_eq!(self_intersecting_pairs(&mesh, &bvh), expected);
            let passing = PassingFaces::new(&mesh, &bvh);
            assert_eq!(passing.all(&mesh, &bvh, |_| NONE), faces_of(expected));
        }
    }

    #[test]
    fn no_faces_cross_no_faces() {
        assert!(self_intersections(&Mesh::default()).is_empty());
    }
}
