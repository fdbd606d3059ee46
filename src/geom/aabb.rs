//! Axis-aligned bounding boxes.

use glam::DVec3;
use std::fmt;

/// An axis-aligned box. The default box contains only the origin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub lo: DVec3,
    /// Largest coordinates.
    pub hi: DVec3,
}

impl From<[[f64; 3]; 2]> for Aabb {
    /// The box with these lowest and highest x, y and z.
    fn from([lo, hi]: [[f64; 3]; 2]) -> Aabb {
        Aabb { lo: lo.into(), hi: hi.into() }
    }
}

impl fmt::Display for Aabb {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Aabb { lo, hi } = self;
        write!(f, "{},{},{},{},{},{}", lo.x, lo.y, lo.z, hi.x, hi.y, hi.z)
    }
}

impl Aabb {
    /// The neutral element of [`Self::join`], which contains nothing.
    pub(crate) const EMPTY: Aabb = Aabb { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    /// The bounding box of some points; `None` if there are no points.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Option<Aabb> {
        points.into_iter().map(Aabb::at).reduce(|all, point| all.join(&point))
    }

    /// The bounding box of a triangle.
    #[inline]
    pub fn of_triangle([a, b, c]: [DVec3; 3]) -> Aabb {
        Aabb { lo: a.min(b).min(c), hi: a.max(b).max(c) }
    }

    /// The box of a single point.
    #[inline]
    pub fn at(p: DVec3) -> Aabb {
        Aabb { lo: p, hi: p }
    }

    /// The smallest box around both boxes.
    #[inline]
    #[must_use]
    pub fn join(&self, other: &Aabb) -> Aabb {
        Aabb { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The side lengths.
    #[inline]
    pub fn size(&self) -> DVec3 {
        self.hi - self.lo
    }

    /// The length of the diagonal.
    #[inline]
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// Returns whether a point is inside the box or on its faces.
    #[inline]
    pub fn contains(&self, p: DVec3) -> bool {
        self.lo.cmple(p).all() && p.cmple(self.hi).all()
    }

    /// The squared distance of the box to `p`; zero if `p` is inside. Even rounded, it never exceeds that of any point of
    /// the box.
    #[inline]
    pub fn distance_squared(&self, p: DVec3) -> f64 {
        (self.lo - p).max(p - self.hi).max(DVec3::ZERO).length_squared()
    }

    /// Returns whether a ray meets the box within the distance `longest`. `inverse` has the reciprocals of the components of
    /// the ray's unit direction.
    #[inline]
    pub fn meets_ray(&self, origin: DVec3, inverse: DVec3, longest: f64) -> bool {
        let (a, b) = ((self.lo - origin) * inverse, (self.hi - origin) * inverse);
        // For a ray along an upper side, NaN occurs here and does not limit the ray; a ray along a lower side is missed.
        let (enters, leaves) = (a.min(b), a.max(b));
        let last = |leaves: f64, so_far: f64| if leaves < so_far { leaves } else { so_far };
        let first = |enters: f64, so_far: f64| if enters > so_far { enters } else { so_far };
        let enters = enters.to_array().into_iter().fold(0.0, |so_far, x| first(x, so_far));
        let leaves = leaves.to_array().into_iter().fold(longest, |so_far, x| last(x, so_far));
        enters <= leaves
    }

    /// Returns whether two boxes have a point in common; touching counts.
    #[inline]
    pub fn meets(&self, other: &Aabb) -> bool {
        self.lo.cmple(other.hi).all() && other.lo.cmple(self.hi).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_of_points_has_their_extent() {
        let corners = [DVec3::new(1.0, 0.0, 3.0), DVec3::new(-1.0, 2.0, 5.0), DVec3::new(0.0, 1.0, 4.0)];
        let found = Aabb::of(corners).unwrap();
        assert_eq!((found.lo, found.hi), (DVec3::new(-1.0, 0.0, 3.0), DVec3::new(1.0, 2.0, 5.0)));
        assert_eq!((found.size(), found.diagonal()), (DVec3::splat(2.0), 12f64.sqrt()));
        assert_eq!((found, found), (Aabb::of_triangle(corners), found.join(&Aabb::EMPTY)));
        assert_eq!((found, found.to_string()), ([[-1.0, 0.0, 3.0], [1.0, 2.0, 5.0]].into(), "-1,0,3,1,2,5".into()));
        assert_eq!(Aabb::of([]), None);
    }

    #[test]
    fn distances_and_contacts_with_points_and_rays() {
        let unit = Aabb { lo: DVec3::ZERO, hi: DVec3::ONE };
        assert_eq!(unit.distance_squared(DVec3::new(2.0, 0.5, -1.0)), 2.0);
        assert_eq!(unit.distance_squared(DVec3::splat(0.5)), 0.0);
        assert!(unit.meets(&Aabb::at(DVec3::X)) && !unit.meets(&Aabb::at(1.1 * DVec3::X)));
        let from = DVec3::new(0.5, 0.5, -1.0);
        assert!(unit.meets_ray(from, DVec3::Z.recip(), 1.5) && !unit.meets_ray(from, DVec3::Z.recip(), 0.5));
        assert!(!unit.meets_ray(from, DVec3::NEG_Z.recip(), 9.0));
    }
}
