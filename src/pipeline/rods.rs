//! Rods: bodies that are thinner than edges are long, two ways. Samples at the wanted distance are too few to go around them.

use crate::surface::domain::Domain;
use glam::DVec3;

/// How wide the body is at `p`, in lengths of `length`, if it is a rod along the unit vector `axis`: narrower than that both ways.
/// `normal` is that of the surface at `p`.
pub(super) fn width_along(domain: &Domain, p: DVec3, normal: DVec3, axis: DVec3, length: f64) -> Option<f64> {
    let thickness = domain.thickness_at(p, normal, length)?;
    let middle = p - 0.5 * thickness * normal;
    let across = normal.cross(axis).normalize_or_zero();
    let width = domain.thickness_at(middle, across, length)? + domain.thickness_at(middle, -across, length)?;
    (width < length).then_some(thickness.max(width) / length)
}

/// The same of a rod along any axis: of two at right angles, one is within 45 degrees of it.
pub(super) fn width_at(domain: &Domain, p: DVec3, normal: DVec3, length: f64) -> Option<f64> {
    let axis = normal.any_orthonormal_vector();
    let widths = [axis, normal.cross(axis)].map(|axis| width_along(domain, p, normal, axis, length));
    widths.into_iter().flatten().reduce(f64::min)
}
