//! Quadrature rule for a triangle, exact up to degree four.
//!
//! Based on: D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, 1985,
//! DOI 10.1002/nme.1620210612.

use glam::DVec3;

/// Barycentric coordinates and weights of the points.
pub(super) const POINTS: [([f64; 3], f64); 6] = {
    const A: (f64, f64, f64) = (0.108_103_018_168_070, 0.445_948_490_915_965, 0.223_381_589_678_011);
    const B: (f64, f64, f64) = (0.816_847_572_980_459, 0.091_576_213_509_771, 0.109_951_743_655_322);
    [
        ([A.0, A.1, A.1], A.2),
        ([A.1, A.0, A.1], A.2),
        ([A.1, A.1, A.0], A.2),
        ([B.0, B.1, B.1], B.2),
        ([B.1, B.0, B.1], B.2),
        ([B.1, B.1, B.0], B.2),
    ]
};

/// Returns the point with barycentric coordinates `at` in the triangle with corners `x`.
#[inline]
pub(super) fn point(x: [DVec3; 3], at: [f64; 3]) -> DVec3 {
    at[0] * x[0] + at[1] * x[1] + at[2] * x[2]
}
