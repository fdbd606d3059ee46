//! Eigenvectors of symmetric 3 × 3 matrices. The first eigenvector of a covariance matrix is the direction of least spread
//! of the points.
//!
//! Based on: C. G. J. Jacobi, Über ein leichtes Verfahren, die in der Theorie der Säculärstörungen vorkommenden Gleichungen
//! numerisch aufzulösen, 1846: successive rotations each zero one off-diagonal entry.
//!
//! Cost: about a dozen rotations. Accurate to rounding, even for coinciding eigenvalues.

use glam::{DMat3, DVec3};

/// Number of sweeps over the three off-diagonal entries. These converge quadratically: to rounding level after five sweeps.
const SWEEPS: usize = 8;

/// Returns the mean m of points p, and Σ (p - m)(p - m)ᵀ, which is their covariance matrix times their number.
pub fn scatter(points: impl Iterator<Item = DVec3> + Clone) -> (DVec3, DMat3) {
    let mean = points.clone().sum::<DVec3>() / points.clone().count() as f64;
    let outer = |d: DVec3| DMat3::from_cols(d.x * d, d.y * d, d.z * d);
    (mean, points.fold(DMat3::ZERO, |sum, p| sum + outer(p - mean)))
}

/// Returns the eigenvalues of a symmetric matrix in increasing order, and their unit eigenvectors.
pub fn eigen(matrix: DMat3) -> ([f64; 3], [DVec3; 3]) {
    let mut a = matrix.to_cols_array_2d();
    let mut vectors = DMat3::IDENTITY.to_cols_array_2d();
    let trace = a[0][0].abs() + a[1][1].abs() + a[2][2].abs();
    for _ in 0..SWEEPS {
        if a[0][1].abs() + a[0][2].abs() + a[1][2].abs() <= f64::EPSILON * f64::EPSILON * trace {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut vectors, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    (order.map(|i| a[i][i]), order.map(|i| DVec3::from_array(vectors[i])))
}

/// Rotates in the plane of axes `p` and `q` such that their common entry becomes zero. Vectors are rows.
fn rotate(a: &mut [[f64; 3]; 3], vectors: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
    let sine = tangent * cosine;
    let turn = |x: f64, y: f64| (cosine * x - sine * y, sine * x + cosine * y);
    for row in a.iter_mut() {
        (row[p], row[q]) = turn(row[p], row[q]);
    }
    for k in 0..3 {
        (a[p][k], a[q][k]) = turn(a[p][k], a[q][k]);
        (vectors[p][k], vectors[q][k]) = turn(vectors[p][k], vectors[q][k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use approx::assert_relative_eq;
    use glam::{DQuat, Vec3Swizzles};

    #[test]
    fn points_scatter_around_their_mean() {
        let points = [DVec3::X, DVec3::new(3.0, 1.0, 0.0), DVec3::new(2.0, -1.0, 0.0)];
        let (mean, matrix) = scatter(points.iter().copied());
        assert_eq!(mean, 2.0 * DVec3::X);
        assert_eq!(matrix, DMat3::from_cols(DVec3::new(2.0, 1.0, 0.0), DVec3::new(1.0, 2.0, 0.0), DVec3::ZERO));
    }

    #[test]
    fn vectors_are_scaled_by_their_values() {
        let mut rng = stream(3, Stage::Scan);
        for case in 0..200 {
            let turn = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, unit(&mut rng), unit(&mut rng), 9.0));
            // Every third matrix has two equal eigenvalues; every fifth is flat.
            let wanted = DVec3::new(if case % 5 == 0 { 0.0 } else { 1e-6 }, unit(&mut rng), 2.0);
            let wanted = if case % 3 == 0 { wanted.xyy() } else { wanted };
            let matrix = turn * DMat3::from_diagonal(wanted) * turn.transpose();
            let (values, vectors) = eigen(matrix);
            assert!(values[0] <= values[1] && values[1] <= values[2]);
            for (value, vector) in values.into_iter().zip(vectors) {
                assert_relative_eq!(vector.length(), 1.0, epsilon = 1e-12);
                assert!((matrix * vector).distance(value * vector) < 1e-12);
            }
        }
    }
}
