//! Finds bridges: triangles between vertices of the surface that span places where there is no surface.
//!
//! Around a rod that is thinner than the edges are long, and where samples miss a bend of a rod, triangles that fit together
//! may lie across the empty space beside it.
//!
//! Cost: a closest-point search for each long edge, of which there are few where samples follow the surface.

use crate::manifold::Manifold;
use crate::surface::domain::Domain;

/// Minimum distance of a bridge's edge from the surface, in mean edge lengths. In eighty real-world files, no point of a
/// result that follows the surface is farther than 0.7 from it.
const FAR: f64 = 1.0;

/// Returns the bridges of `mesh`, as positions among its triangles. `spacing` is the mean target edge length; sizes do not
/// count, since they change where results are mended.
pub fn bridges(domain: &Domain, mesh: &Manifold, spacing: f64) -> Vec<u32> {
    let c = &mesh.connectivity;
    let is_far = |h: &u32| {
        let [a, b] = [c.origin(*h), c.target(*h)].map(|v| mesh.position(v));
        let far = FAR * spacing;
        let steps = (a.distance(b) / far) as u32;
        // The ends are on the surface.
        (1..steps).any(|k| {
            let p = a.lerp(b, f64::from(k) / f64::from(steps));
            domain.project_anywhere(p).position.distance(p) > far
        })
    };
    let places = (0..).zip(mesh.triangles());
    places.filter(|(_, t)| (3 * t..3 * t + 3).any(|h| is_far(&h))).map(|(place, _)| place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing::grid;
    use glam::dvec3;
    use std::f64::consts::PI;

    /// Half of a tube of radius 1, made of `n` by `n` squares.
    fn half_tube(n: u32) -> Mesh {
        grid(n, n, |u, v| {
            let (y, x) = math::sin_cos(PI * u);
            dvec3(x, y, 4.0 * v)
        })
    }

    /// Number of bridges in a mesh of `n` by `n` squares over it.
    fn found(n: u32, spacing: f64) -> usize {
        let domain = Domain::new(half_tube(60).try_into().unwrap());
        let coarse = half_tube(n);
        let samples = coarse.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        bridges(&domain, &Manifold::new(samples, &coarse.triangles), spacing).len()
    }

    #[test]
    fn edges_that_follow_the_surface_are_none_however_long_they_are() {
        assert_eq!([found(12, 0.3), found(12, 0.03), found(3, 0.2)], [0; 3]);
    }

    #[test]
    fn triangles_across_empty_space_are_found() {
        // Straight across the tube, a radius from the surface.
        assert_eq!([found(1, 0.9), found(1, 0.2), found(1, 1.1)], [2, 2, 0]);
    }
}
