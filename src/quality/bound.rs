//! Bounds of the Hausdorff distance between two meshes: samples alone only give a lower bound.
//!
//! The distance to one triangle f is convex, so its maximum over another triangle T is at a corner; and the distance at two
//! points differs by at most the distance between them. With m the centroid of T, f the triangle of the other mesh that is
//! closest to m, and d the distance to that mesh,
//!
//! ```text
//! d(m)  ≤  max d on T  ≤  min( max over the corners of the distance to f,  d(m) + distance of the farthest corner to m )
//! ```
//!
//! T is split in four until both bounds are close, or the upper one is below a distance known to occur elsewhere, or below
//! what is of interest.
//!
//! Based on: M. Tang, M. Lee, Y. J. Kim, Interactive Hausdorff distance computation for general polygonal models, 2009, DOI
//! 10.1145/1531326.1531380. Departure: no pairs of boxes are culled; triangles are as small as the distance matters.
//!
//! Cost: two hierarchies, and some twenty closest-point queries per triangle. Limits: the upper bound holds up to the
//! rounding of the closest points; where triangles are more than a hundred times as long as the distance, it may be several
//! times as large as the distance.

use crate::base::parallel;
use crate::geom::triangle::closest_point;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use glam::DVec3;

/// Maximum ratio of the upper bound to the distance known to occur.
const CLOSE: f64 = 1.05;

/// Maximum number of times that a triangle is split in four.
const DEEPEST: u32 = 7;

/// Bounds of a Hausdorff distance, in the units of the meshes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Distance at `place`.
    pub lower: f64,
    /// Upper bound of the distance of any point of either mesh from the other one.
    pub upper: f64,
    /// Point of one of the meshes that is about as far from the other one as any.
    pub place: DVec3,
}

/// Bounds the two-sided Hausdorff distance between two meshes. An upper bound of `enough`, in their units, need not be
/// improved. `None` if one of the meshes has no triangles.
pub fn hausdorff_bounds(a: &Mesh, b: &Mesh, enough: f64) -> Option<Bounds> {
    if a.triangles.is_empty() || b.triangles.is_empty() {
        return None;
    }
    let (of_a, of_b) = rayon::join(|| Bvh::new(a), || Bvh::new(b));
    let (a, b) = (Side { mesh: a, bvh: &of_a }, Side { mesh: b, bvh: &of_b });
    let known = a.farthest_centroid(&b).max(b.farthest_centroid(&a)).max(enough / CLOSE);
    Some(a.bounds(&b, known).join(b.bounds(&a, known)))
}

impl Bounds {
    /// Returns the bounds of the union of two point sets.
    fn join(self, other: Bounds) -> Bounds {
        let (lower, place) =
            if other.lower > self.lower { (other.lower, other.place) } else { (self.lower, self.place) };
        Bounds { lower, upper: self.upper.max(other.upper), place }
    }
}

/// One of the meshes.
#[derive(Clone, Copy)]
struct Side<'a> {
    mesh: &'a Mesh,
    bvh: &'a Bvh,
}

impl Side<'_> {
    /// Applies `of` to each triangle.
    fn of_triangles<T: Send>(&self, of: impl Fn([DVec3; 3]) -> T + Sync) -> Vec<T> {
        parallel::map(0..self.mesh.triangles.len(), |t| of(self.mesh.corners(t)))
    }

    /// Returns the largest distance of a triangle's centroid to the other mesh.
    fn farthest_centroid(&self, other: &Side) -> f64 {
        self.of_triangles(|t| other.bounds_on(t).lower).into_iter().fold(0.0, f64::max)
    }

    /// Bounds the largest distance to the other mesh, where distances below `known` do not matter.
    fn bounds(&self, other: &Side, known: f64) -> Bounds {
        let none = Bounds { lower: f64::NEG_INFINITY, upper: 0.0, place: DVec3::ZERO };
        let all = self.of_triangles(|t| other.split_bounds(t, known, DEEPEST));
        all.into_iter().fold(none, Bounds::join)
    }

    /// Bounds the distance to this mesh on a triangle, which is split where the bounds are not close.
    fn split_bounds(&self, triangle: [DVec3; 3], known: f64, depth: u32) -> Bounds {
        let whole = self.bounds_on(triangle);
        if depth == 0 || whole.upper <= CLOSE * known.max(whole.lower) {
            return whole;
        }
        let [a, b, c] = triangle;
        let [ab, bc, ca] = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0];
        let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
        let none = Bounds { upper: 0.0, ..whole };
        let parts = quarters.into_iter().map(|t| self.split_bounds(t, known.max(whole.lower), depth - 1));
        let parts = parts.fold(none, Bounds::join);
        Bounds { upper: parts.upper.min(whole.upper), ..parts }
    }

    /// Bounds the distance to this mesh on a triangle.
    fn bounds_on(&self, triangle: [DVec3; 3]) -> Bounds {
        let middle = triangle.iter().sum::<DVec3>() / 3.0;
        let Some(hit) = self.bvh.closest(self.mesh, middle) else {
            return Bounds { lower: f64::INFINITY, upper: f64::INFINITY, place: middle };
        };
        let nearest = self.mesh.corners(hit.triangle as usize);
        let farthest = |distance: &dyn Fn(DVec3) -> f64| triangle.iter().map(|&c| distance(c)).fold(0.0, f64::max);
        let lower = hit.distance_squared.sqrt();
        let upper = farthest(&|c| c.distance(closest_point(c, nearest))).min(lower + farthest(&|c| c.distance(middle)));
        Bounds { lower, upper, place: middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::distance::distance;
    use crate::testing::sheet;

    #[test]
    fn the_truth_is_between_the_bounds_and_they_are_close() {
        // A single vertex protrudes, and no sample hits it.
        for height in [0.01, 0.03, 0.1] {
            let mut spike = sheet(20, |_, _| 0.0);
            spike.positions[21 * 10 + 10].z = height;
            for (a, b) in [(&spike, &sheet(10, |_, _| 0.0)), (&sheet(7, |_, _| 0.0), &spike)] {
                let found = hausdorff_bounds(a, b, 0.0).unwrap();
                assert!(found.lower <= height * (1.0 + 1e-9) && found.upper >= height * (1.0 - 1e-9), "{found:?}");
                assert!(found.upper <= 1.1 * height, "{height}: {found:?}");
                assert!(found.place.truncate().distance(glam::DVec2::splat(0.5)) < 0.02, "{found:?}");
            }
        }
    }

    #[test]
    fn never_below_what_samples_find() {
        let (a, b) = (sheet(9, |x, y| 0.1 * (7.0 * x + y).sin()), sheet(31, |x, y| 0.1 * (7.0 * x + y).sin()));
        let found = hausdorff_bounds(&a, &b, 0.0).unwrap();
        let sampled = distance(&a, &b, 20_000, 0).unwrap().hausdorff * b.diagonal() / 100.0;
        assert!(found.upper >= sampled && found.upper <= 1.1 * sampled, "{found:?} {sampled}");
        assert_eq!(hausdorff_bounds(&a, &Mesh::default(), 0.0), None);
        let same = hausdorff_bounds(&a, &a, 0.01).unwrap();
        assert!(same.upper <= 0.01 && same.lower < 1e-12, "{same:?}");
    }
}
