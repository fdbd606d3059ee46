//! The coordinates that the pipeline works in.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// The pipeline's own coordinates: around the origin and about one in size, so that neither the scale of the input nor
/// its distance from the origin matters.
pub(super) struct Unit {
    centre: DVec3,
    /// A power of two, so that scaling is exact.
    pub size: f64,
}

impl Unit {
    pub(super) fn of(mesh: &Mesh) -> Unit {
        Unit::within(mesh.bounds().unwrap_or_default())
    }

    pub(super) fn of_points(points: &[DVec3]) -> Unit {
        Unit::within(Aabb::of(points.iter().copied()).unwrap_or_default())
    }

    fn within(bounds: Aabb) -> Unit {
        let longest = bounds.size().max_element();
        let size = if longest > 0.0 { math::next_power_of_two(longest) } else { 1.0 };
        Unit { centre: bounds.lo + bounds.size() / 2.0, size }
    }

    /// The area that `mesh`, in this unit, could have if all its corners were on one line but for the rounding of their
    /// coordinates.
    pub(super) fn area_of_rounding(&self, mesh: &Mesh) -> f64 {
        let longest = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        let rounding = f64::EPSILON * (1.0 + self.centre.abs().max_element() / self.size);
        mesh.sum_over_triangles(|t| rounding * longest(t))
    }

    pub(super) fn inwards(&self, mesh: &Mesh) -> Mesh {
        let positions = mesh.positions.iter().map(|&p| self.inwards_point(p)).collect();
        Mesh { positions, triangles: mesh.triangles.clone() }
    }

    pub(super) fn move_inwards(&self, positions: &mut [DVec3]) {
        positions.iter_mut().for_each(|p| *p = self.inwards_point(*p));
    }

    pub(super) fn inwards_point(&self, p: DVec3) -> DVec3 {
        (p - self.centre) / self.size
    }

    pub(super) fn outwards(&self, mut mesh: Mesh) -> Mesh {
        mesh.positions.iter_mut().for_each(|p| *p = self.outwards_point(*p));
        mesh
    }

    pub(super) fn outwards_point(&self, p: DVec3) -> DVec3 {
        p * self.size + self.centre
    }
}
