//! Flakes: components of next to no area, which cuts and exports leave behind. No triangles of a flake have angles to compute with,
//! so they are left out.
//!
//! A flake has less area than one triangle as long as it is, or as edges are to be, with an angle of [`SLIVER`] degrees.
//!
//! Cost: linear in the triangles, and nothing for a surface of one component.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::manifold::small_angles::SLIVER;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::submesh::Submesh;
use crate::mesh::topology::components;

/// A component's size.
#[derive(Clone)]
struct Size {
    area: f64,
    bounds: Aabb,
}

impl Size {
    fn is_flake(&self, spacing: f64) -> bool {
        let length = self.bounds.diagonal();
        let of_sliver = 0.5 * math::sin_cos(SLIVER.to_radians()).0 * length * length.min(spacing);
        self.area < of_sliver
    }
}

/// `surface` without its flakes, where edges are to be `spacing` long; `None` if it has none, or nothing else.
pub(super) fn without_flakes(surface: &OrientedManifold, spacing: f64) -> Option<OrientedManifold> {
    let component = components(surface.positions.len(), &surface.triangles);
    let of = |corners: &[u32; 3]| component[corners[0] as usize] as usize;
    let none = Size { area: 0.0, bounds: Aabb::EMPTY };
    let mut sizes = vec![none; component.iter().max().map_or(0, |&last| last as usize + 1)];
    for (t, corners) in surface.triangles.iter().enumerate() {
        let size = &mut sizes[of(corners)];
        size.area += 0.5 * surface.area_vector(t).length();
        size.bounds = size.bounds.join(&Aabb::of_triangle(surface.corners(t)));
    }
    let is_flake: Vec<bool> = sizes.iter().map(|size| size.is_flake(spacing)).collect();
    if !is_flake.contains(&true) || !is_flake.contains(&false) {
        return None;
    }
    let stays: Vec<bool> = surface.triangles.iter().map(|corners| !is_flake[of(corners)]).collect();
    let triangles: Vec<u32> = (0..).zip(&stays).filter(|(_, stays)| **stays).map(|(t, _)| t).collect();
    let part = Submesh::cut_out(surface, &stays);
    let provenance = surface.provenance().clone().select(&part.source, &triangles);
    Some(OrientedManifold::trusted(part.mesh, provenance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing::{cube, joined};
    use glam::{DVec3, dvec3};

    const SPACING: f64 = 0.1;

    /// A triangle that long and high.
    fn triangle(length: f64, height: f64) -> Mesh {
        let positions = vec![DVec3::ZERO, length * DVec3::X, dvec3(0.5 * length, height, 0.0)];
        Mesh { positions, triangles: vec![[0, 1, 2]] }
    }

    fn left(mesh: Mesh) -> Option<OrientedManifold> {
        without_flakes(&mesh.try_into().unwrap(), SPACING)
    }

    #[test]
    fn flakes_go_and_what_has_a_shape_stays() {
        let narrow = (0.5 * SPACING, 0.0005 * SPACING);
        // As long as an edge or longer, and small all over.
        let whole = [(3.0 * SPACING, 0.03 * SPACING), (1e-6, 1e-6)].map(|(length, height)| triangle(length, height));
        for (length, height) in [narrow, (8.0 * SPACING, 0.005 * SPACING), (1e-6, 1e-9)] {
            let [shape, small] = whole.clone();
            let left = left(joined([small, cube(), triangle(length, height), shape])).unwrap();
            assert_eq!(left.triangles.len(), 14, "{length} {height}");
            let sources: Vec<u32> = (0..14).map(|t| left.provenance().triangle(t)).collect();
            assert_eq!(sources, (0..13).chain([14]).collect::<Vec<u32>>());
        }
        assert!(left(joined(whole)).is_none());
    }

    #[test]
    fn a_surface_that_is_nothing_else_stays() {
        assert!(left(joined([triangle(1.0, 1e-6), triangle(2.0, 1e-6)])).is_none());
    }
}
