//! The small angles of a result, but for those that the surface forces where two feature curves meet, or a spike ends;
//! and its slivers, triangles with an angle too small to compute with.

use crate::geom::triangle::angles;
use crate::manifold::Manifold;
use crate::mesh::half_edge::{Connectivity, prev};

/// Angle in degrees below which a triangle is a sliver.
pub const SLIVER: f64 = 1.0;

/// Angle in degrees below which a triangle has no area, whatever forces it.
const NO_AREA: f64 = 0.01;

/// The triangles of `mesh`, by their place among its triangles, without area or with an angle below [`SLIVER`] that is not
/// forced.
pub fn slivers(mesh: &Manifold) -> Vec<u32> {
    (0..).zip(mesh.triangles()).filter(|&(_, t)| unforced_angle(mesh, t) < SLIVER).map(|(place, _)| place).collect()
}

/// The numbers of the triangles of `mesh` without area or with an angle below that, in degrees, which is not forced.
pub fn with_angles_below(mesh: &Manifold, degrees: f64) -> Vec<u32> {
    mesh.triangles().filter(|&t| unforced_angle(mesh, t) < degrees).collect()
}

/// The smallest angle in degrees that is not forced; `None` if all are.
pub fn smallest_unforced_angle(mesh: &Manifold) -> Option<f64> {
    let smallest = mesh.triangles().map(|t| unforced_angle(mesh, t)).fold(f64::INFINITY, f64::min);
    smallest.is_finite().then_some(smallest)
}

/// That of the triangle with number `t`; infinite if all of its angles are forced, but 0 if it has no area.
fn unforced_angle(mesh: &Manifold, t: u32) -> f64 {
    let c = &mesh.connectivity;
    let is_forced = |h: u32| c.is_curve_edge(h) && c.is_curve_edge(prev(h)) || ends_spike(c, c.origin(h));
    let angles = angles(mesh.corners(t));
    if angles.iter().any(|&angle| angle < NO_AREA) {
        return 0.0;
    }
    let unforced = (3 * t..).zip(angles).filter(|(h, _)| !is_forced(*h));
    unforced.map(|(_, angle)| angle).fold(f64::INFINITY, f64::min)
}

/// Whether a spike ends in `v`, with the fewest triangles around it that enclose anything: more of them would be narrower.
fn ends_spike(c: &Connectivity, v: u32) -> bool {
    c.is_corner(v) && c.valence(v) == 3 && !c.outgoing(v).any(|h| c.is_curve_edge(h) || !c.has_twin(h))
}
