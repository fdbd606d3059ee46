//! Distance between the points of a cloud and the result made from it.
//!
//! The distance of a cloud to a mesh is that of each point to the closest point of the mesh. The initial mesh through the
//! points is not a valid reference: points that it left out are far from it, too.
//!
//! Cost: one hierarchy, and one closest-point query per point, in parallel.

use crate::base::parallel;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Distances of the points of a cloud, without outliers, to a result, in their units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Number of points at distinct places, without outliers.
    pub points: usize,
    /// Number of these that are farther away than `within`.
    pub missed: usize,
    /// Three times the mean spacing of the points or of the vertices of the result, whichever is larger.
    pub within: f64,
    /// Root mean square of the distances of the points to the result.
    pub rms: f64,
    /// Largest of these distances.
    pub largest: f64,
    /// Position of the farthest point: x, y and z.
    #[serde(default)]
    pub place: [f64; 3],
}

/// Points more than this many spacings away from a surface do not belong to it.
const FAR: f64 = 3.0;

/// Share of points that may be missed: tips and shreds of which a scan has only a few points.
pub(in crate::pipeline) const MOST_MISSED: f64 = 0.05;

impl Coverage {
    /// Measures how well `mesh`, which has triangles, covers `points`; `spacing` is the larger of their mean spacings.
    pub fn of(points: &[DVec3], mesh: &Mesh, spacing: f64) -> Coverage {
        let hierarchy = Bvh::new(mesh);
        let squared = |p: &DVec3| hierarchy.closest(mesh, *p).map_or(f64::INFINITY, |hit| hit.distance_squared);
        let squared: Vec<f64> = parallel::map(points, squared);
        let within = FAR * spacing;
        let farthest = (0..points.len()).max_by(|&a, &b| squared[a].total_cmp(&squared[b]).then(b.cmp(&a)));
        Coverage {
            points: points.len(),
            missed: squared.iter().filter(|d| **d > within * within).count(),
            within,
            rms: (squared.iter().sum::<f64>() / points.len().max(1) as f64).sqrt(),
            largest: farthest.map_or(0.0, |p| squared[p].sqrt()),
            place: farthest.map_or([0.0; 3], |p| points[p].to_array()),
        }
    }

    /// Returns whether all points except a few are close to the result.
    pub fn is_enough(&self) -> bool {
        self.missed as f64 <= MOST_MISSED * self.points as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::cube;

    #[test]
    fn points_beside_a_cube_are_missed() {
        let points = [DVec3::ZERO, DVec3::new(0.5, 0.5, 1.1), DVec3::new(0.5, 0.5, 3.0), DVec3::X];
        let found = Coverage::of(&points, &cube(), 0.1);
        assert_eq!((found.points, found.missed), (4, 1));
        assert_eq!(found.place, [0.5, 0.5, 3.0]);
        assert!((found.largest - 2.0).abs() < 1e-12 && (found.rms - (4.01f64 / 4.0).sqrt()).abs() < 1e-12);
        assert!(!found.is_enough() && Coverage { missed: 0, ..found }.is_enough());
    }
}
