//! Detects rods: bodies that are thinner than edges are long in two directions. Samples at the target distance are too few
//! to go around them.

use crate::surface::domain::Domain;
use glam::DVec3;

/// Returns the width of the body at `p`, in units of `length`, if it is a rod along the unit vector `axis`: narrower than
/// `length` in both directions. `normal` is the surface normal at `p`.
pub(in crate::pipeline) fn width_along(
    domain: &Domain,
    p: DVec3,
    normal: DVec3,
    axis: DVec3,
    length: f64,
) -> Option<f64> {
    let thickness = domain.thickness_at(p, normal, length)?;
    let middle = p - 0.5 * thickness * normal;
    let across = normal.cross(axis).normalize_or_zero();
    let width = domain.thickness_at(middle, across, length)? + domain.thickness_at(middle, -across, length)?;
    (width < length).then_some(thickness.max(width) / length)
}

/// Returns the same for a rod along any axis: of two perpendicular axes, one is within 45 degrees of it.
pub(in crate::pipeline) fn width_at(domain: &Domain, p: DVec3, normal: DVec3, length: f64) -> Option<f64> {
    let axis = normal.any_orthonormal_vector();
    let widths = [axis, normal.cross(axis)].map(|axis| width_along(domain, p, normal, axis, length));
    widths.into_iter().flatten().reduce(f64::min)
}
