//! Symmetric matrices stored as six numbers: summing many outer products takes two thirds of the work of full matrices.

use glam::{DMat3, DVec3, Vec3Swizzles};
use std::ops::{AddAssign, Mul};

/// A symmetric 3 × 3 matrix.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Symmetric {
    /// Elements xx, yy and zz.
    pub diagonal: DVec3,
    /// Elements xy, yz and zx.
    mixed: DVec3,
}

impl Symmetric {
    /// The outer product of `a` with itself.
    #[inline]
    pub fn outer(a: DVec3) -> Symmetric {
        Symmetric { diagonal: a * a, mixed: a * a.yzx() }
    }

    /// Returns the full matrix.
    pub fn matrix(&self) -> DMat3 {
        let (d, m) = (self.diagonal, self.mixed);
        DMat3::from_cols(DVec3::new(d.x, m.x, m.z), DVec3::new(m.x, d.y, m.y), DVec3::new(m.z, m.y, d.z))
    }
}

impl Mul<f64> for Symmetric {
    type Output = Symmetric;

    #[inline]
    fn mul(self, factor: f64) -> Symmetric {
        Symmetric { diagonal: self.diagonal * factor, mixed: self.mixed * factor }
    }
}

impl AddAssign for Symmetric {
    #[inline]
    fn add_assign(&mut self, other: Symmetric) {
        self.diagonal += other.diagonal;
        self.mixed += other.mixed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_outer_products_are_those_of_full_matrices() {
        let (a, b) = (DVec3::new(1.0, -2.0, 3.0), DVec3::new(0.5, 4.0, -1.0));
        let mut sum = Symmetric::outer(a) * 2.0;
        sum += Symmetric::outer(b);
        let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        assert_eq!(sum.matrix(), outer(a) * 2.0 + outer(b));
    }
}
