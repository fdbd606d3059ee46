//! Components of the input that a result has hardly anything of, because they are smaller than its edges.
//!
//! A component keeps its topology, so a small one becomes a tetrahedron or an octahedron and loses its shape. Only its area
//! tells: an octahedron has half the area of the sphere around it, while a flat sheet of two triangles keeps all of its own.
//!
//! Cost: linear in the triangles of both meshes.

use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::Origins;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// A component has lost its shape if it has no more triangles than an octahedron, and less of its area than this share, which
/// is that of an icosahedron in a sphere.
const OCTAHEDRON: usize = 8;
const LEAST_AREA: f64 = 0.75;

/// What became of components that a result has no room for.
#[derive(Debug, Clone, PartialEq)]
pub struct LostComponents {
    /// Those that have no triangle in the result.
    pub gone: usize,
    /// Those that have a few triangles and not their shape.
    pub shrunk: usize,
    /// Triangles of the input in the largest of both.
    pub triangles: usize,
    /// Its share of the area of the input.
    pub share: f64,
    /// A point of it: x, y and z.
    pub place: [f64; 3],
}

/// The components of an input.
pub(super) struct Components {
    /// For each triangle of the input the number of its component; [`NONE`] for one that repair has removed.
    of_triangle: Vec<u32>,
    list: Vec<Component>,
}

/// A component of the input.
#[derive(Clone, Default)]
struct Component {
    triangles: usize,
    area: f64,
    place: DVec3,
}

/// What is left of a component in a result.
#[derive(Clone, Default)]
struct Left {
    triangles: usize,
    area: f64,
}

impl Component {
    fn is_lost(&self, left: &Left) -> bool {
        left.triangles <= OCTAHEDRON && left.triangles < self.triangles && left.area < LEAST_AREA * self.area
    }
}

impl Components {
    /// Those of `input`, which was made `repaired`, for whose vertices `number` has the number of the component.
    pub(super) fn new(input: &Mesh, repaired: &OrientedManifold, number: &[u32]) -> Components {
        let mut list = vec![Component::default(); number.iter().max().map_or(0, |&last| last as usize + 1)];
        let mut of_triangle = vec![NONE; input.triangles.len()];
        for (t, corners) in (0..).zip(&repaired.triangles) {
            let source = repaired.provenance().triangle(t) as usize;
            of_triangle[source] = number[corners[0] as usize];
            let component = &mut list[of_triangle[source] as usize];
            if component.triangles == 0 {
                component.place = input.centroid(source);
            }
            component.triangles += 1;
            component.area += 0.5 * input.area_vector(source).length();
        }
        Components { of_triangle, list }
    }

    /// Those that are lost in `result`, whose vertices and triangles have these origins; `None` if there are none.
    pub(super) fn lost(&self, result: &Mesh, origins: &Origins) -> Option<LostComponents> {
        let mut all_left = vec![Left::default(); self.list.len()];
        for (t, corners) in result.triangles.iter().enumerate() {
            let source = origins.vertices[corners[0] as usize].triangle as usize;
            if let Some(left) = all_left.get_mut(self.of_triangle[source] as usize) {
                left.triangles += 1;
                left.area += 0.5 * result.area_vector(t).length();
            }
        }
        let whole: f64 = self.list.iter().map(|c| c.area).sum();
        let lost = || self.list.iter().zip(&all_left).filter(|(component, left)| component.is_lost(left));
        let (largest, _) = lost().max_by(|a, b| a.0.area.total_cmp(&b.0.area))?;
        let gone = lost().filter(|(_, left)| left.triangles == 0).count();
        Some(LostComponents {
            gone,
            shrunk: lost().count() - gone,
            triangles: largest.triangles,
            share: largest.area / whole,
            place: largest.place.to_array(),
        })
    }
}
