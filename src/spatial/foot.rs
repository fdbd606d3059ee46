//! The foot of a point on a mesh: the closest point on one of its triangles.

use crate::geom::triangle::{barycentric, closest_weights};
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Hit;
use glam::DVec3;

/// The point of a triangle closest to another point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// The triangle of the mesh on which the foot lies.
    pub triangle: u32,
    /// Barycentric coordinates of the foot on its triangle, non-negative, with sum 1.
    pub weights: [f64; 3],
    /// The foot itself.
    pub point: DVec3,
    /// Its squared distance to the query point.
    pub distance_squared: f64,
}

impl Foot {
    /// Returns the foot of `p` on triangle `t`. If the foot is on a side or at a corner, the weights of the other corners
    /// are exactly zero. `None` if the triangle is too thin for a reliable answer.
    #[inline]
    pub fn on_triangle(mesh: &Mesh, p: DVec3, t: u32) -> Option<Foot> {
        let corners = mesh.corners(t as usize);
        let weights = closest_weights(p, corners)?;
        let point = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
        Some(Foot { triangle: t, weights, point, distance_squared: p.distance_squared(point) })
    }

    /// Converts a hit found by a search in `mesh`.
    pub fn of_hit(mesh: &Mesh, hit: Hit) -> Foot {
        let Hit { triangle, point, distance_squared } = hit;
        let weights = barycentric(point, mesh.corners(triangle as usize)).map(|w| w.clamp(0.0, 1.0));
        let sum: f64 = weights.iter().sum();
        Foot { triangle, weights: weights.map(|w| w / sum), point, distance_squared }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::bvh::Bvh;
    use crate::testing::cube;

    #[test]
    fn a_search_and_a_single_triangle_have_the_same_foot() {
        let mesh = cube();
        for p in [DVec3::new(0.3, 0.6, 2.0), DVec3::new(-1.0, -1.0, -1.0), DVec3::new(0.9, 0.2, 0.5)] {
            let searched = Foot::of_hit(&mesh, Bvh::new(&mesh).closest(&mesh, p).unwrap());
            let alone = Foot::on_triangle(&mesh, p, searched.triangle).unwrap();
            assert!(searched.point.distance(alone.point) < 1e-15, "{searched:?} {alone:?}");
            assert!((0..3).all(|k| (searched.weights[k] - alone.weights[k]).abs() < 1e-15));
        }
    }
}
