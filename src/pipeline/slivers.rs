//! Slivers of a result: triangles with an angle so small that whoever computes with them fails.

use crate::geom::triangle::angles;
use crate::manifold::Manifold;
use crate::mesh::half_edge::prev;

/// Angle in degrees below which a triangle is a sliver.
pub(super) const SLIVER: f64 = 1.0;

/// The triangles of `mesh`, by their place among its triangles, with an angle below [`SLIVER`] that no two feature curves
/// force by meeting there.
pub(super) fn slivers(mesh: &Manifold) -> Vec<u32> {
    let is_sliver = |t: u32| {
        let is_forced = |h: u32| mesh.connectivity.is_curve_edge(h) && mesh.connectivity.is_curve_edge(prev(h));
        (3 * t..).zip(angles(mesh.corners(t))).any(|(h, angle)| angle < SLIVER && !is_forced(h))
    };
    (0..).zip(mesh.triangles()).filter(|(_, t)| is_sliver(*t)).map(|(place, _)| place).collect()
}
