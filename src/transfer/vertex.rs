//! Transfers attributes from one mesh to another mesh of the same surface.
//!
//! Each output vertex takes the attributes at its origin, the point of the input on which it lies. Numbers are interpolated
//! in the triangle there; labels, which have no mean, are those of the nearest corner. A triangle takes the material of the
//! input below its centre. Texture coordinates belong to corners; `texture.rs` transfers them. Normals are not transferred
//! but recomputed, if the input has any.
//!
//! Cost: linear in the output; in parallel, with the same result for any number of threads.

use crate::base::parallel;
use crate::mesh::attributes::{Attribute, Attributes, Lost};
use crate::mesh::materials::Materials;
use crate::mesh::normals::vertex_normals;
use crate::mesh::parts::Parts;
use crate::mesh::provenance::{Origins, PointOnTriangle};
use crate::mesh::submesh::Kept;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::transfer::texture::Atlas;
use glam::DVec2;
use glam::DVec3;

/// Attributes that were transferred, and those that were lost.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Carried {
    /// Attributes of the output.
    pub attributes: Attributes,
    /// Attributes of the input that the output does not have.
    pub lost: Vec<Lost>,
    /// Other notes for the user, one sentence each.
    pub notes: Vec<String>,
}

/// Transfers the `attributes` of `input` to `output`, whose vertices and triangles have these `origins` on it. Vertex
/// attributes that do not cover all vertices of `input`, or are not finite, are lost.
pub fn carry(input: &Mesh, attributes: &Attributes, output: &Mesh, origins: &Origins) -> Carried {
    let mut carried = Carried::default();
    if attributes.is_empty() {
        return carried;
    }
    let normals = vertex_normals(output);
    attributes.vertex.iter().for_each(|attribute| carried.add(attribute, input, &origins.vertices, &normals));
    carried.attributes.materials = attributes.materials.as_ref().map(|m| materials(m, &origins.triangles));
    carried.attributes.parts = attributes.parts.as_ref().map(|p| parts(p, &origins.triangles));
    carried.add_texture(input, attributes, output, origins);
    carried
}

/// Transfers the `attributes` of the vertices of `input`, except its normals, to these `points` of it. Those that do not
/// cover all vertices, or are not finite, are lost.
pub fn carry_to_points(input: &Mesh, attributes: &Attributes, points: &[PointOnTriangle]) -> Carried {
    let mut carried = Carried::default();
    let others = attributes.vertex.iter().filter(|attribute| !attribute.is_normal());
    others.for_each(|attribute| carried.add(attribute, input, points, &[]));
    carried
}

/// Transfers the `attributes` of points to the vertices of `output`, one point per vertex. Attributes that are not finite
/// are lost.
pub fn carry_at_vertices(attributes: Attributes, output: &Mesh) -> Carried {
    let mut carried = Carried::default();
    for attribute in attributes.vertex {
        if attribute.is_normal() {
            let values = vertex_normals(output).iter().flat_map(|n| n.to_array()).collect();
            carried.attributes.vertex.push(Attribute { values, ..attribute });
        } else if let Some(cause) = flaw(&attribute, output.positions.len()) {
            carried.lost.push(Lost { name: attribute.name, cause });
        } else {
            carried.attributes.vertex.push(attribute);
        }
    }
    carried
}

/// Returns why an attribute of `vertices` vertices cannot be transferred, if it cannot.
fn flaw(Attribute { components, values, .. }: &Attribute, vertices: usize) -> Option<String> {
    if values.len() != components * vertices {
        return Some("it does not cover all vertices".into());
    }
    let at = values.iter().position(|x| !x.is_finite())?;
    Some(format!("vertex {} has {}, which cannot be interpolated", at / components, values[at]))
}

impl Carried {
    /// Removes some attributes, which are lost.
    pub fn leave_out(&mut self, lost: Vec<Lost>) {
        lost.iter().for_each(|lost| self.attributes.remove(&lost.name));
        self.lost.extend(lost);
    }

    /// Restores the original `attributes` of the vertices and triangles that `output` kept from `input`, as far as the
    /// output has such attributes.
    pub fn keep(&mut self, input: &Mesh, attributes: &Attributes, output: &Mesh, kept: &Kept) {
        let vertices = || (0..).zip(&kept.vertices).filter(|v| *v.1 != NONE).map(|(new, &old)| (new, old as usize));
        let triangles = || (0..).zip(&kept.triangles).filter(|t| *t.1 != NONE).map(|(new, &old)| (new, old as usize));
        for attribute in &mut self.attributes.vertex {
            let n = attribute.components;
            let Some(own) = attributes.get(&attribute.name).filter(|own| own.values.len() == n * input.positions.len())
            else {
                continue;
            };
            vertices().for_each(|(new, old): (usize, _)| attribute.values[new * n..][..n].copy_from_slice(own.of(old)));
        }
        if let (Some(materials), Some(own)) = (&mut self.attributes.materials, &attributes.materials) {
            triangles().for_each(|(new, old): (usize, _)| materials.of_triangle[new] = own.of_triangle[old]);
        }
        if let (Some(parts), Some(own)) = (&mut self.attributes.parts, &attributes.parts) {
            triangles().for_each(|(new, old): (usize, _)| parts.of_triangle[new] = own.of_triangle[old]);
        }
        if self.attributes.texture.is_empty() {
            return;
        }
        for (new, old) in triangles() {
            // The corners may start at another vertex, or run in the opposite direction.
            let own = input.corners(old);
            let same = |p: DVec3| own.iter().position(|&q| q == p).map_or(DVec2::NAN, |k| attributes.texture[old][k]);
            self.attributes.texture[new] = output.corners(new).map(same);
        }
    }

    /// Adds an attribute of `input` at vertices that have these `origins` on it, and these `normals`.
    fn add(&mut self, attribute: &Attribute, input: &Mesh, origins: &[PointOnTriangle], normals: &[DVec3]) {
        let Attribute { name, components, scalar, .. } = attribute;
        let name = name.clone();
        match of_vertices(attribute, input, origins, normals) {
            Ok(values) => {
                let added = Attribute { name, components: *components, values, scalar: *scalar };
                self.attributes.vertex.push(added);
            }
            Err(cause) => self.lost.push(Lost { name, cause }),
        }
    }

    fn add_texture(&mut self, input: &Mesh, of: &Attributes, output: &Mesh, origins: &Origins) {
        if of.texture.is_empty() {
            return;
        }
        let (texture, distorted) = Atlas::new(input, &of.texture).carry(output, origins);
        self.attributes.texture = texture;
        if distorted > 0 {
            let total = output.triangles.len();
            self.notes.push(format!(
                "{distorted} of {total} triangles, all at seams, have distorted texture coordinates: more points reduce that"
            ));
        }
    }
}

/// Returns the values of an attribute at the vertices of the output, or why it has none.
fn of_vertices(
    attribute: &Attribute,
    input: &Mesh,
    origins: &[PointOnTriangle],
    normals: &[DVec3],
) -> std::result::Result<Vec<f64>, String> {
    let Attribute { components, scalar, .. } = attribute;
    if attribute.is_normal() {
        return Ok(normals.iter().flat_map(|n| n.to_array()).collect());
    }
    if let Some(cause) = flaw(attribute, input.positions.len()) {
        return Err(cause);
    }
    let at = |&PointOnTriangle { triangle, weights }: &PointOnTriangle| {
        let corners = input.triangles[triangle as usize].map(|v| attribute.of(v as usize));
        let mean = move |k: usize| (0..3).map(|i| weights[i] * corners[i][k]).sum::<f64>();
        let nearest = (1..3).fold(0, |best, i| if weights[i] > weights[best] { i } else { best });
        (0..*components).map(move |k| match () {
            () if attribute.is_label() => corners[nearest][k],
            () if scalar.is_integer() => mean(k).round(),
            () => mean(k),
        })
    };
    Ok(parallel::collect(origins, |block| block.iter().flat_map(at)))
}

/// Returns the materials of triangles whose centres are these points of the input.
fn materials(of: &Materials, centres: &[PointOnTriangle]) -> Materials {
    let Materials { libraries, list, images, of_triangle } = of;
    let of_triangle = below(of_triangle, centres);
    Materials { libraries: libraries.clone(), list: list.clone(), images: images.clone(), of_triangle }
}

/// Returns the parts of triangles whose centres are these points of the input.
fn parts(of: &Parts, centres: &[PointOnTriangle]) -> Parts {
    Parts { list: of.list.clone(), of_triangle: below(&of.of_triangle, centres) }
}

/// Returns the entries of `of_triangle` for the triangles on which these points lie.
fn below(of_triangle: &[u32], centres: &[PointOnTriangle]) -> Vec<u32> {
    centres.iter().map(|centre| of_triangle.get(centre.triangle as usize).copied().unwrap_or(NONE)).collect()
}
