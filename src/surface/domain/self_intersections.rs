//! Where the surface intersects itself, searched only around the places that are asked for.

use crate::geom::aabb::Aabb;
use crate::geom::triangle::{closest_point, longest_side};
use crate::mesh::topology::NONE;
use crate::surface::domain::Domain;
use glam::DVec3;

impl Domain {
    /// Returns the triangles that pass through others, pair by pair or along an edge, in increasing order.
    pub fn self_intersections(&self) -> Vec<u32> {
        self.passing.all(&self.mesh, &self.bvh, |side| self.other_side(side))
    }

    /// Returns whether one of [`Self::self_intersections`] is at most the longest side of `triangle` away from its centre.
    /// Near them, any mesh of the surface intersects itself, too.
    pub fn intersects_itself_near(&self, triangle: [DVec3; 3]) -> bool {
        let (middle, length) = (triangle.iter().sum::<DVec3>() / 3.0, longest_side(triangle));
        let is_near =
            |t: u32| closest_point(middle, self.mesh.corners(t as usize)).distance_squared(middle) <= length * length;
        let wanted = Aabb { lo: middle - length, hi: middle + length };
        self.passing.any_near(&wanted, &self.mesh, &self.bvh, |side| self.other_side(side), is_near)
    }

    /// Returns the opposite side of `side`, also across a sharp edge.
    fn other_side(&self, side: u32) -> u32 {
        match self.twin[side as usize] {
            NONE => self.across.get(side),
            twin => twin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{grid, joined};
    use glam::dvec3;

    #[test]
    fn a_surface_intersects_itself_only_near_where_its_sheets_meet() {
        // A level sheet, and one that passes through it at x = 0.52.
        let sheet = |slope: f64| grid(20, 20, |x, y| dvec3(x, y, slope * (x - 0.52)));
        let domain = Domain::new(joined([sheet(0.0), sheet(1.0)]).try_into().unwrap());
        let crossing = domain.self_intersections();
        assert_eq!(crossing.len(), 80);
        let triangle_at = |x: f64| [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]].map(|[u, v]| dvec3(x + u, 0.5 + v, 0.0));
        let is_near = |x: f64| domain.intersects_itself_near(triangle_at(x));
        assert_eq!([0.1, 0.25, 0.4, 0.5, 0.7, 0.9].map(is_near), [false, false, true, true, false, false]);
    }
}
