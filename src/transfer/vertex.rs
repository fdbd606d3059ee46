//! Attributes of one mesh carried over to another one of the same surface.
//!
//! Each vertex of the output takes the attributes of the point of the input that is closest to it among those where the
//! surface faces the same way: numbers are interpolated in the triangle there; labels, which have no mean, are those of
//! the nearest corner. A triangle takes the material of the input triangle below its centre. Texture coordinates belong to
//! corners; `texture.rs` carries them. Normals are computed anew, if the input had any.
//!
//! Cost: a hierarchy over the input and a search for each vertex, and, for texture coordinates and materials, for each
//! triangle of the output; in parallel, with the same result for any number of threads.
//!
//! Limits: where the input's triangles are turned over, the other side of a wall thinner than an edge of the output may
//! be taken for this one.

use crate::geom::triangle::longest_side;
use crate::mesh::attributes::{Attribute, Attributes, Lost, Materials};
use crate::mesh::normals::vertex_normals;
use crate::mesh::submesh::Kept;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::spatial::foot::Foot;
use crate::transfer::texture::Atlas;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The attributes of an output: those it got and those it lost.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Carried {
    /// The attributes of the output.
    pub attributes: Attributes,
    /// Those of the input that the output does not have.
    pub lost: Vec<Lost>,
    /// What else a user should know, a sentence each.
    pub notes: Vec<String>,
}

/// The input with its search structure.
struct Surface<'a> {
    mesh: &'a Mesh,
    bvh: Bvh,
}

/// Carries the `attributes` of `input`, which may be any mesh whose indices are in range, over to `output`, which lies near
/// it. Attributes without a value for each vertex or triangle of `input` are lost.
pub fn carry(input: &Mesh, attributes: &Attributes, output: &Mesh) -> Carried {
    let mut carried = Carried::default();
    if attributes.is_empty() {
        return carried;
    }
    if input.triangles.is_empty() {
        let lost = |name| Lost { name, cause: "the input has no triangles to find it on".into() };
        carried.lost = attributes.names().into_iter().map(lost).collect();
        return carried;
    }
    let surface = Surface { mesh: input, bvh: Bvh::new(input) };
    let normals = vertex_normals(output);
    let feet = surface.feet_of_vertices(output, &normals);
    for attribute in &attributes.vertex {
        match of_vertices(attribute, input, &feet, &normals) {
            Ok(values) => {
                let Attribute { name, components, scalar, .. } = attribute;
                let (name, components, scalar) = (name.clone(), *components, *scalar);
                carried.attributes.vertex.push(Attribute { name, components, values, scalar });
            }
            Err(cause) => carried.lost.push(Lost { name: attribute.name.clone(), cause }),
        }
    }
    if !attributes.texture.is_empty() || attributes.materials.is_some() {
        let centres = surface.feet_of_centres(output);
        carried.attributes.materials = attributes.materials.as_ref().map(|m| of_triangles(m, &centres));
        carried.add_texture(&surface, attributes, output, &feet, &centres);
    }
    carried
}

impl Carried {
    /// Copies the `attributes` of the vertices and triangles of `output` that were kept from `input`, for the attributes
    /// that the output has.
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
        if self.attributes.texture.is_empty() {
            return;
        }
        for (new, old) in triangles() {
            // The corners may begin elsewhere, or go the other way.
            let own = input.corners(old);
            let same = |p: DVec3| own.iter().position(|&q| q == p).map_or(DVec2::NAN, |k| attributes.texture[old][k]);
            self.attributes.texture[new] = output.corners(new).map(same);
        }
    }

    fn add_texture(&mut self, surface: &Surface, of: &Attributes, output: &Mesh, feet: &[Foot], centres: &[Foot]) {
        if of.texture.is_empty() {
            return;
        }
        let (texture, distorted) = Atlas::new(surface.mesh, &of.texture).carry(output, feet, centres);
        self.attributes.texture = texture;
        if distorted > 0 {
            let total = output.triangles.len();
            self.notes.push(format!(
                "{distorted} of {total} triangles, all at seams, have distorted texture coordinates: more points make it less"
            ));
        }
    }
}

/// The values of an attribute at the vertices of the output, or why it has none.
fn of_vertices(
    attribute: &Attribute,
    input: &Mesh,
    feet: &[Foot],
    normals: &[DVec3],
) -> std::result::Result<Vec<f64>, String> {
    let Attribute { components, values, scalar, .. } = attribute;
    if attribute.is_normal() {
        return Ok(normals.iter().flat_map(|n| n.to_array()).collect());
    }
    if values.len() != components * input.positions.len() {
        return Err("it is not that of all vertices".into());
    }
    if let Some(at) = values.iter().position(|x| !x.is_finite()) {
        return Err(format!("vertex {} has {}, which is not a number to interpolate", at / components, values[at]));
    }
    let at = |&Foot { triangle, weights, .. }: &Foot| {
        let corners = input.triangles[triangle as usize].map(|v| attribute.of(v as usize));
        let mean = move |k: usize| (0..3).map(|i| weights[i] * corners[i][k]).sum::<f64>();
        let nearest = (1..3).fold(0, |best, i| if weights[i] > weights[best] { i } else { best });
        (0..*components).map(move |k| match () {
            () if attribute.is_label() => corners[nearest][k],
            () if scalar.is_integer() => mean(k).round(),
            () => mean(k),
        })
    };
    Ok(feet.par_iter().flat_map_iter(at).collect())
}

/// The materials of triangles whose centroids have these feet.
fn of_triangles(materials: &Materials, centres: &[Foot]) -> Materials {
    let of_triangle = |foot: &Foot| materials.of_triangle.get(foot.triangle as usize).copied().unwrap_or(NONE);
    let Materials { libraries, names, .. } = materials;
    let of_triangle = centres.iter().map(of_triangle).collect();
    Materials { libraries: libraries.clone(), names: names.clone(), of_triangle }
}

impl Surface<'_> {
    fn feet_of_vertices(&self, output: &Mesh, normals: &[DVec3]) -> Vec<Foot> {
        let mut reach = vec![0.0f64; output.positions.len()];
        for (t, corners) in output.triangles.iter().enumerate() {
            let longest = longest_side(output.corners(t));
            corners.iter().for_each(|&v| reach[v as usize] = reach[v as usize].max(longest));
        }
        let foot = |v: usize| self.foot(output.positions[v], normals[v], reach[v]);
        (0..output.positions.len()).into_par_iter().map(foot).collect()
    }

    fn feet_of_centres(&self, output: &Mesh) -> Vec<Foot> {
        let foot = |t: usize| {
            let corners = output.corners(t);
            self.foot(corners.into_iter().sum::<DVec3>() / 3.0, output.area_vector(t), longest_side(corners))
        };
        (0..output.triangles.len()).into_par_iter().map(foot).collect()
    }

    /// The point closest to `p` among those where the surface faces the way of `normal`; among all points if none of those
    /// lies within `reach` more than the distance to the closest one.
    fn foot(&self, p: DVec3, normal: DVec3, reach: f64) -> Foot {
        let agrees = |t: u32| self.mesh.area_vector(t as usize).dot(normal) > 0.0;
        // Nothing is closest to a point that is not finite, or so far that squares are not.
        let Some(nearest) = self.bvh.closest(self.mesh, p) else {
            let point = self.mesh.corners(0)[0];
            return Foot { triangle: 0, weights: [1.0, 0.0, 0.0], point, distance_squared: f64::INFINITY };
        };
        let hit = if agrees(nearest.triangle) {
            nearest
        } else {
            let bound = nearest.distance_squared.sqrt() + reach;
            self.bvh.closest_where(self.mesh, p, bound * bound, agrees).unwrap_or(nearest)
        };
        Foot::of_hit(self.mesh, hit)
    }
}
