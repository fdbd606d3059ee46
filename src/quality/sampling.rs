//! Points spread evenly over a mesh by area.

use crate::base::rng::{Random, unit};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// Samples `count` points of the surface, uniformly by area: point k has a random position in the k-th of `count` equal
/// shares of the area, in the order of the triangles.
///
/// Compared with `count` independent points, one point per share lowers the variance of sums over the points and visits the
/// mesh in its own order. If the mesh has no area, every triangle has the same share. Empty if there are no triangles.
pub fn by_area(mesh: &Mesh, count: usize, rng: &mut Random) -> Vec<DVec3> {
    if mesh.triangles.is_empty() {
        return Vec::new();
    }
    let mut shares: Vec<f64> = (0..mesh.triangles.len()).map(|t| mesh.triangle_area(t)).collect();
    if shares.iter().sum::<f64>() <= 0.0 {
        shares.fill(1.0);
    }
    let total: f64 = shares.iter().sum();
    let (mut t, mut before) = (0, 0.0);
    (0..count)
        .map(|k| {
            let target = total * (k as f64 + unit(rng)) / count as f64;
            while before + shares[t] <= target && t + 1 < shares.len() {
                before += shares[t];
                t += 1;
            }
            in_triangle(mesh.corners(t), rng)
        })
        .collect()
}

/// Samples a point uniformly in a triangle: the square root maps equal shares of the unit interval to equal areas.
fn in_triangle([a, b, c]: [DVec3; 3], rng: &mut Random) -> DVec3 {
    let away = unit(rng).sqrt();
    let across = unit(rng);
    (1.0 - away) * a + away * (1.0 - across) * b + away * across * c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};

    /// A unit square of one large triangle and two small ones, and a triangle without area.
    fn square() -> Mesh {
        let points = [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0.5, 0.5]];
        Mesh {
            positions: points.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 4], [0, 4, 3], [4, 2, 3]],
        }
    }

    #[test]
    fn moments_of_a_square_are_those_of_the_uniform_density() {
        let points = by_area(&square(), 20_000, &mut stream(1, Stage::Distance));
        let mean = |f: fn(DVec3) -> f64| points.iter().map(|&p| f(p)).sum::<f64>() / points.len() as f64;
        assert!((mean(|p| p.x) - 0.5).abs() < 0.01 && (mean(|p| p.y) - 0.5).abs() < 0.01);
        assert!((mean(|p| p.x * p.x) - 1.0 / 3.0).abs() < 0.01 && (mean(|p| p.x * p.y) - 0.25).abs() < 0.01);
        assert!(points.iter().all(|p| p.min_element() >= 0.0 && p.max_element() <= 1.0));
    }

    #[test]
    fn without_area_there_are_points_still_and_without_triangles_none() {
        let line = Mesh { triangles: vec![[0, 2, 4], [1, 1, 1]], ..square() };
        let points = by_area(&line, 10, &mut stream(1, Stage::Distance));
        assert_eq!(points.iter().filter(|p| p.distance(DVec3::X) < 1e-12).count(), 5);
        assert!(by_area(&Mesh::default(), 10, &mut stream(1, Stage::Distance)).is_empty());
    }
}
