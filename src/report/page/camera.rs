//! Where meshes are looked at from at first.

use crate::base::math;
use glam::{DMat3, DVec3};

/// How far the eye goes around and above, in degrees.
const AROUND: f64 = 30.0;
const ABOVE: f64 = 25.0;

/// The rows of the first rotation of something that large: right, up and towards the eye. It is seen along its shortest
/// axis, from a little aside and above, with y up, or z where y is the shortest.
pub(super) fn first_rotation(size: DVec3) -> [[f64; 3]; 3] {
    let towards = if size.z <= size.x.min(size.y) {
        DVec3::Z
    } else if size.y <= size.x {
        -DVec3::Y
    } else {
        DVec3::X
    };
    let up = if towards == -DVec3::Y { DVec3::Z } else { DVec3::Y };
    let right = up.cross(towards);
    let [(sin_a, cos_a), (sin_b, cos_b)] = [AROUND, ABOVE].map(|angle: f64| math::sin_cos(angle.to_radians()));
    let aside = cos_a * towards + sin_a * right;
    let eye = cos_b * aside + sin_b * up;
    let right = cos_a * right - sin_a * towards;
    [right, eye.cross(right), eye].map(|v| v.to_array())
}

/// The same as a matrix that takes places to what the eye sees: right, up, near.
pub(super) fn first_view(size: DVec3) -> DMat3 {
    DMat3::from_cols_array_2d(&first_rotation(size)).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_view_is_a_rotation_that_looks_along_the_shortest_axis() {
        for (size, axis) in [
            (DVec3::new(3.0, 2.0, 1.0), DVec3::Z),
            (DVec3::new(3.0, 1.0, 2.0), -DVec3::Y),
            (DVec3::new(1.0, 2.0, 3.0), DVec3::X),
        ] {
            let view = first_view(size);
            assert!((view.determinant() - 1.0).abs() < 1e-12);
            assert!((view * view.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-12));
            assert!((view * axis).z > 0.7);
        }
    }
}
