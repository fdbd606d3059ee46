//! Removes flakes and fins: components of negligible area or width that cuts and exports leave behind. No mesh with the
//! target edges can follow them.
//!
//! A flake has less area than a triangle with an angle of [`SLIVER`] degrees that is as long as the flake or as the target
//! edges. A fin is narrow and attached along edges of wider components, from which repair separated it: the surface
//! continues without it.
//!
//! Cost: linear in the triangles, and nothing for a surface of one component; one sort of the vertices if a component is
//! narrow.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::manifold::small_angles::SLIVER;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::sides::lower_first;
use crate::mesh::submesh::Submesh;
use crate::mesh::topology::components;
use crate::mesh::weld::representatives;
use rustc_hash::FxHashSet;

/// Width below which a component is narrow, in spacings.
const NARROW: f64 = 0.2;

/// Minimum length of the edges that a narrow component shares with wider ones to count as a fin, as a share of its own
/// length.
const ALONG: f64 = 0.5;

/// Size of a component.
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

    /// Returns whether a triangle of the same length and area is narrow.
    fn is_narrow(&self, spacing: f64) -> bool {
        2.0 * self.area < NARROW * spacing * self.bounds.diagonal()
    }
}

/// Returns `surface` without its flakes and fins, for edges of length `spacing`; `None` if it has none or consists of
/// nothing else.
pub(in crate::pipeline) fn without_flakes(surface: &OrientedManifold, spacing: f64) -> Option<OrientedManifold> {
    let component = components(surface.positions.len(), &surface.triangles);
    let of = |corners: &[u32; 3]| component[corners[0] as usize] as usize;
    let areas = surface.component_areas(&component).into_iter();
    let mut sizes: Vec<Size> = areas.map(|area| Size { area, bounds: Aabb::EMPTY }).collect();
    for (t, corners) in surface.triangles.iter().enumerate() {
        let bounds = &mut sizes[of(corners)].bounds;
        *bounds = bounds.join(&Aabb::of_triangle(surface.corners(t)));
    }
    let is_narrow: Vec<bool> = sizes.iter().map(|size| size.is_narrow(spacing)).collect();
    let hanging = lengths_in_common(surface, &component, &is_narrow);
    let goes = |(size, along): (&Size, f64)| size.is_flake(spacing) || along > ALONG * size.bounds.diagonal();
    let goes: Vec<bool> = sizes.iter().zip(hanging).map(goes).collect();
    if !goes.contains(&true) || !goes.contains(&false) {
        return None;
    }
    let stays: Vec<bool> = surface.triangles.iter().map(|corners| !goes[of(corners)]).collect();
    let triangles: Vec<u32> = (0..).zip(&stays).filter(|(_, stays)| **stays).map(|(t, _)| t).collect();
    let part = Submesh::cut_out(surface, &stays);
    let provenance = surface.provenance().clone().select(&part.source, &triangles);
    Some(OrientedManifold::trusted(part.mesh, provenance))
}

/// Returns, for each narrow component, the length of its edges that wider components also have; zero for all others.
/// `component` holds the component number of each vertex.
fn lengths_in_common(surface: &OrientedManifold, component: &[u32], is_narrow: &[bool]) -> Vec<f64> {
    let mut lengths = vec![0.0; is_narrow.len()];
    if !is_narrow.contains(&true) || !is_narrow.contains(&false) {
        return lengths;
    }
    let place = representatives(&surface.positions);
    let of = |side: u32| component[surface.origin(side) as usize] as usize;
    let edge = |side: u32| lower_first(surface.ends(side).map(|v| place[v as usize]));
    let sides = |narrow: bool| (0..3 * surface.triangles.len() as u32).filter(move |&s| is_narrow[of(s)] == narrow);
    let of_narrow: FxHashSet<[u32; 2]> = sides(true).map(edge).collect();
    let common: FxHashSet<[u32; 2]> = sides(false).map(edge).filter(|edge| of_narrow.contains(edge)).collect();
    for side in sides(true).filter(|&side| common.contains(&edge(side))) {
        let [a, b] = surface.segment(side);
        lengths[of(side)] += a.distance(b);
    }
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing::{cube, joined};
    use glam::{DVec3, dvec3};

    const SPACING: f64 = 0.1;

    /// Returns a triangle of the given length and height.
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
        // As long as an edge or longer, and small in every direction.
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
    fn fins_go_where_the_surface_goes_on_without_them() {
        let at = |from: DVec3, height: f64| {
            let positions = vec![from, from + DVec3::X, from + dvec3(0.4, -height, 0.0)];
            Mesh { positions, triangles: vec![[0, 1, 2]] }
        };
        let [low, high] = [0.15, 0.5].map(|share| share * SPACING);
        // Along an edge of the cube, a narrow one and a wide one; and a narrow one elsewhere.
        let triangles = [at(DVec3::ZERO, low), at(DVec3::ZERO, high), at(-3.0 * DVec3::X, low)];
        // A ribbon attached by its end.
        let [a, b, c, d] = [[5.0, 0.0], [6.0, 0.0], [6.0, 1.0], [5.0, low]].map(|[x, y]| dvec3(x, y, 0.0));
        let sheet = Mesh { positions: vec![a, b, c, d], triangles: vec![[0, 1, 2], [0, 2, 3]] };
        let ribbon = Mesh { positions: vec![a, d, a - 3.0 * DVec3::X], triangles: vec![[0, 1, 2]] };
        let left = left(joined([cube()].into_iter().chain(triangles).chain([sheet, ribbon]))).unwrap();
        let sources: Vec<u32> = (0..left.triangles.len() as u32).map(|t| left.provenance().triangle(t)).collect();
        assert_eq!(sources, (0..12).chain(13..18).collect::<Vec<u32>>());
    }

    #[test]
    fn a_surface_that_is_nothing_else_stays() {
        assert!(left(joined([triangle(1.0, 1e-6), triangle(2.0, 1e-6)])).is_none());
    }
}
