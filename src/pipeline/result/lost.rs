//! Components of the input that are nearly absent from a result because they are smaller than its edges.
//!
//! A component keeps its topology, so a small one becomes a tetrahedron or an octahedron and loses its shape. Only its area
//! reveals this: an octahedron has half the area of its circumscribed sphere, whereas a flat sheet of two triangles keeps
//! its full area.
//!
//! Cost: linear in the triangles of both meshes.

use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::Origins;
use crate::mesh::topology::{NONE, component_count};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// A component has lost its shape if it has no more triangles than an octahedron and less than this share of its area, which
/// is the share of an icosahedron in a sphere.
const OCTAHEDRON: usize = 8;
const LEAST_AREA: f64 = 0.75;

/// Components for which a result has no room.
#[derive(Debug, Clone, PartialEq)]
pub struct LostComponents {
    /// Number of components without a triangle in the result.
    pub gone: usize,
    /// Number of components that have a few triangles but lost their shape.
    pub shrunk: usize,
    /// Number of input triangles in the largest of all these.
    pub triangles: usize,
    /// Its share of the area of the input.
    pub share: f64,
    /// Position of a point of it: x, y and z.
    pub place: [f64; 3],
}

/// Components of an input.
pub(in crate::pipeline) struct Components {
    /// For each triangle of the input, the number of its component; [`NONE`] if repair removed the triangle.
    of_triangle: Vec<u32>,
    list: Vec<Component>,
}

/// Component of an input.
#[derive(Clone, Default)]
struct Component {
    triangles: usize,
    area: f64,
    place: DVec3,
}

/// Remainder of a component in a result.
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
    /// Collects the components of `input`, which became `repaired`; `number` holds the component of each vertex of the
    /// latter.
    pub(in crate::pipeline) fn new(input: &Mesh, repaired: &OrientedManifold, number: &[u32]) -> Components {
        let mut list = vec![Component::default(); component_count(number)];
        let mut of_triangle = vec![NONE; input.triangles.len()];
        for (t, corners) in (0..).zip(&repaired.triangles) {
            let source = repaired.provenance().triangle(t) as usize;
            of_triangle[source] = number[corners[0] as usize];
            let component = &mut list[of_triangle[source] as usize];
            if component.triangles == 0 {
                component.place = input.centroid(source);
            }
            component.triangles += 1;
            component.area += input.triangle_area(source);
        }
        Components { of_triangle, list }
    }

    /// Returns the components that are lost in `result`, whose vertices and triangles have these origins; `None` if there
    /// are none.
    pub(in crate::pipeline) fn lost(&self, result: &Mesh, origins: &Origins) -> Option<LostComponents> {
        let mut all_left = vec![Left::default(); self.list.len()];
        for (t, corners) in result.triangles.iter().enumerate() {
            let source = origins.vertices[corners[0] as usize].triangle as usize;
            if let Some(left) = all_left.get_mut(self.of_triangle[source] as usize) {
                left.triangles += 1;
                left.area += result.triangle_area(t);
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
