//! Coordinates in which the pipeline works.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// Coordinate system of the pipeline: centred at the origin and of size about one, so that neither the scale of the input
/// nor its distance from the origin matters.
pub(super) struct Unit {
    centre: DVec3,
    /// A power of two, so that scaling is exact.
    pub size: f64,
}

/// Number of steps per unit size to which the coordinates of results are rounded, a power of two: computations are off by
/// some hundredths of a step, single precision by thousands of steps.
const STEPS: f64 = (1u64 << 44) as f64;

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

    /// Returns the area that `mesh`, in this unit, could have merely by the rounding of its coordinates if all its corners
    /// were on one line.
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

    /// Transforms the mesh of a result back. Its coordinates are rounded, so that vertices in a plane perpendicular to an
    /// axis lie in it to the last bit: programs that search for intersecting faces report those that are almost coplanar.
    pub(super) fn outwards(&self, mut mesh: Mesh) -> Mesh {
        mesh.positions.iter_mut().for_each(|p| *p = self.outwards_point(*p).map(|x| self.rounded(x)));
        mesh
    }

    fn rounded(&self, x: f64) -> f64 {
        let step = self.size / STEPS;
        // Adding zero removes the sign of a negative zero.
        let rounded = (x / step).round() * step + 0.0;
        if rounded.is_finite() { rounded } else { x }
    }

    pub(super) fn outwards_point(&self, p: DVec3) -> DVec3 {
        p * self.size + self.centre
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn what_is_in_a_plane_across_an_axis_stays_in_it_to_the_last_bit() {
        for scale in [1e-9, 1.0, 1e9] {
            let unit = Unit::within(Aabb { lo: scale * DVec3::NEG_ONE, hi: scale * dvec3(5.3, 1.7, 9.1) });
            let in_plane = |i: i32| unit.inwards_point(scale * dvec3(4.8279, 0.01 * f64::from(i), 0.0));
            // Each point between two others, as vertices are between corners of the input.
            let positions = (0..100).map(|i| in_plane(i).lerp(in_plane(3 * i), 0.01 * f64::from(i))).collect();
            let made = unit.outwards(Mesh { positions, triangles: vec![] }).positions;
            assert!(made.iter().all(|p| p.x == made[0].x && p.z.to_bits() == 0));
            assert!((made[0].x - scale * 4.8279).abs() <= 1e-12 * scale);
        }
    }

    #[test]
    fn coordinates_in_single_precision_keep_their_bits_and_those_far_from_the_origin_do() {
        let points: Vec<DVec3> = (0..100).map(|i| DVec3::splat(f64::from(0.1 * i as f32))).collect();
        let unit = Unit::of_points(&points);
        let made = unit.outwards(unit.inwards(&Mesh { positions: points.clone(), triangles: vec![] }));
        assert_eq!(made.positions, points);
        let unit = Unit { centre: DVec3::ZERO, size: 1.0 };
        assert!([5.4e6 + 1.0 / 1024.0, 1e300, 0.0].into_iter().all(|x| unit.rounded(x) == x));
        let unit = Unit { centre: DVec3::ZERO, size: f64::MIN_POSITIVE };
        assert_eq!(unit.rounded(3.0 * f64::MIN_POSITIVE), 3.0 * f64::MIN_POSITIVE);
    }
}
