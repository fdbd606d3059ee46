//! The small angles of a result, except those that the surface forces where two feature curves meet or a spike ends; and its
//! slivers, triangles with an angle too small to compute with.

use crate::base::math;
use crate::geom::triangle::{angles, smallest_sine_cosine};
use crate::manifold::Manifold;
use crate::mesh::half_edge::{Connectivity, prev};

/// Angle in degrees below which a triangle is a sliver.
pub const SLIVER: f64 = 1.0;

/// Angle in degrees below which a triangle has no area, even if the angle is forced.
const NO_AREA: f64 = 0.01;

/// A triangle with a small angle.
#[derive(Debug, Clone, Copy)]
pub struct SmallAngle {
    /// The number of the triangle.
    pub triangle: u32,
    /// Its smallest angle in degrees.
    pub smallest: f64,
    /// Its smallest unforced angle; infinite if all are forced, but 0 if the triangle has no area.
    pub unforced: f64,
}

/// Returns the triangles of `mesh` whose smallest angle, forced or not, is below `degrees`.
pub fn small_angles(mesh: &Manifold, degrees: f64) -> impl Iterator<Item = SmallAngle> {
    let (sin, cos) = math::sin_cos(degrees.to_radians());
    let is_small = move |t: u32| {
        let (sine, cosine) = smallest_sine_cosine(mesh.corners(t));
        sine * cos <= cosine * sin
    };
    mesh.triangles().filter(move |&t| is_small(t)).map(|t| SmallAngle::of(mesh, t))
}

/// Returns the triangles of `mesh`, as positions among its triangles, that have no area or an unforced angle below
/// [`SLIVER`].
pub fn slivers(mesh: &Manifold) -> Vec<u32> {
    let numbers = with_angles_below(mesh, SLIVER);
    let places = (0..).zip(mesh.triangles()).filter(|(_, t)| numbers.binary_search(t).is_ok());
    places.map(|(place, _)| place).collect()
}

/// Returns the numbers of the triangles of `mesh` that have no area or an unforced angle below `degrees`, in increasing
/// order.
pub fn with_angles_below(mesh: &Manifold, degrees: f64) -> Vec<u32> {
    small_angles(mesh, degrees).filter(|small| small.unforced < degrees).map(|small| small.triangle).collect()
}

/// Returns the smallest unforced angle in degrees; `None` if all are forced.
pub fn smallest_unforced_angle(mesh: &Manifold) -> Option<f64> {
    let smallest = mesh.triangles().map(|t| SmallAngle::of(mesh, t).unforced).fold(f64::INFINITY, f64::min);
    smallest.is_finite().then_some(smallest)
}

impl SmallAngle {
    /// Returns the angles of the triangle with number `t`.
    fn of(mesh: &Manifold, t: u32) -> SmallAngle {
        let c = &mesh.connectivity;
        let is_forced = |h: u32| c.is_curve_edge(h) && c.is_curve_edge(prev(h)) || ends_spike(c, c.origin(h));
        let least = |angles: &mut dyn Iterator<Item = f64>| angles.fold(f64::INFINITY, f64::min);
        let angles = angles(mesh.corners(t));
        let smallest = least(&mut angles.into_iter());
        let mut unforced = (3 * t..).zip(angles).filter(|(h, _)| !is_forced(*h)).map(|(_, angle)| angle);
        let unforced = if smallest < NO_AREA { 0.0 } else { least(&mut unforced) };
        SmallAngle { triangle: t, smallest, unforced }
    }
}

/// Returns whether a spike ends in `v` with the fewest triangles around it that enclose anything: more would be narrower.
fn ends_spike(c: &Connectivity, v: u32) -> bool {
    c.is_corner(v) && c.valence(v) == 3 && !c.outgoing(v).any(|h| c.is_curve_edge(h) || !c.has_twin(h))
}
