//! Figures per triangle and per side of a mesh, for pictures and histograms; those per vertex are
//! [`valences`](crate::quality::shape::valences) and [`vertex_distances`](crate::quality::distance::vertex_distances).

use crate::base::parallel;
use crate::geom::triangle::{angles, quality, side_lengths};
use crate::mesh::triangle_mesh::Mesh;
use crate::quality::shape::extreme_angles;

/// Smallest angle of each triangle, in degrees; 0 if it has no area.
pub fn smallest_angles(mesh: &Mesh) -> Vec<f64> {
    parallel::map(0..mesh.triangles.len(), |t| extreme_angles(mesh.corners(t)).0)
}

/// Q of each triangle, in 0..=1.
pub fn qualities(mesh: &Mesh) -> Vec<f64> {
    parallel::map(0..mesh.triangles.len(), |t| quality(mesh.corners(t)))
}

/// The three angles of each triangle, in degrees.
pub fn all_angles(mesh: &Mesh) -> Vec<[f64; 3]> {
    parallel::map(0..mesh.triangles.len(), |t| angles(mesh.corners(t)))
}

/// Ratio of the length of each side to its target length, which is the mean of `wanted` at its ends. An edge of two
/// triangles counts twice; sides with an end without a target length are left out.
pub fn lengths_over(mesh: &Mesh, wanted: impl Fn(u32) -> Option<f64>) -> Vec<f64> {
    let mut ratios = Vec::with_capacity(3 * mesh.triangles.len());
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let at = corners.map(&wanted);
        // The length of a side is stored at the opposite corner.
        for (k, length) in side_lengths(mesh.corners(t)).into_iter().enumerate() {
            if let (Some(a), Some(b)) = (at[(k + 1) % 3], at[(k + 2) % 3]) {
                ratios.push(2.0 * length / (a + b));
            }
        }
    }
    ratios
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A right triangle with sides 3, 4 and 5, and one without area.
    fn mesh() -> Mesh {
        let positions = vec![DVec3::ZERO, 3.0 * DVec3::X, 4.0 * DVec3::Y, 6.0 * DVec3::X];
        Mesh { positions, triangles: vec![[0, 1, 2], [0, 1, 3]] }
    }

    #[test]
    fn each_triangle_has_its_figures() {
        let sharpest = 0.75f64.atan().to_degrees();
        let [first, flat] = smallest_angles(&mesh())[..] else { panic!("two triangles") };
        assert!((first - sharpest).abs() < 1e-12 && flat == 0.0);
        let angles = all_angles(&mesh());
        assert!((angles[0][0] - 90.0).abs() < 1e-12 && (angles[0][2] - sharpest).abs() < 1e-12);
        assert_eq!(angles[1], [0.0, 180.0, 0.0]);
        assert_eq!((qualities(&mesh())[1], qualities(&mesh())[0] > 0.6), (0.0, true));
    }

    #[test]
    fn lengths_are_over_the_mean_of_what_is_wanted_at_both_ends() {
        // 5 between the vertices 1 and 2, 4 between 2 and 0, 3 between 0 and 1.
        let wanted = |v: u32| [Some(1.0), Some(3.0), Some(7.0), None][v as usize];
        assert_eq!(lengths_over(&mesh(), wanted), [1.0, 1.0, 1.5, 1.5]);
    }
}
