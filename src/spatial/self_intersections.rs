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

use crate::geom::intersection::cross_deeper_than;
use crate::geom::triangle::longest_side;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use glam::DVec3;

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

    #[test]
    fn a_surface_does_not_cross_itself_and_a_tangled_one_does() {
        assert!(self_intersections(&band(100, 1.0)).is_empty());
        assert!(self_intersections(&band(100, 0.1)).is_empty());
        // Turned through its axis: each triangle crosses those on the other side.
        assert_eq!(self_intersections(&band(9, -1.0)).len(), 18);
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
            assert_eq!(self_intersecting_pairs(&mesh, &Bvh::new(&mesh)), expected);
        }
    }

    #[test]
    fn no_faces_cross_no_faces() {
        assert!(self_intersections(&Mesh::default()).is_empty());
    }
}
