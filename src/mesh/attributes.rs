//! The data of a mesh or a cloud besides its shape, as plain data: numbers at vertices, texture coordinates at corners,
//! materials of triangles.
//!
//! Two names have a special meaning: [`COLOR`] and [`NORMAL`]. Other attributes keep the names from their file.

use crate::base::error::{Error, Fault, Result};
use crate::mesh::materials::Materials;
use crate::mesh::parts::Parts;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// The name of the attribute with three or four components: red, green, blue and optionally opacity, in a range up to
/// [`Scalar::full`].
pub const COLOR: &str = "color";

/// The name of the attribute with three components that is the surface normal, of any length.
pub const NORMAL: &str = "normal";

/// The term for texture coordinates in messages.
pub const TEXTURE: &str = "texture coordinates";

/// The term for materials in messages.
pub const MATERIALS: &str = "materials";

/// The term for the names of parts in messages.
pub const PARTS: &str = "names of objects";

/// The type of a number in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Number of bytes of a value.
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    /// Returns whether the type holds integers only.
    pub fn is_integer(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// The value of a full colour component: the largest integer of the type, or 1.
    pub fn full(self) -> f64 {
        match self {
            Scalar::I8 => i8::MAX.into(),
            Scalar::U8 => u8::MAX.into(),
            Scalar::I16 => i16::MAX.into(),
            Scalar::U16 => u16::MAX.into(),
            Scalar::I32 => i32::MAX.into(),
            Scalar::U32 => u32::MAX.into(),
            Scalar::F32 | Scalar::F64 => 1.0,
        }
    }

    /// Returns the little-endian bytes of `value` in this type; integers are rounded and clamped to the range.
    pub fn bytes(self, value: f64) -> ([u8; 8], usize) {
        let mut bytes = [0; 8];
        let rounded = value.round();
        match self {
            Scalar::I8 => bytes[..1].copy_from_slice(&(rounded as i8).to_le_bytes()),
            Scalar::U8 => bytes[..1].copy_from_slice(&(rounded as u8).to_le_bytes()),
            Scalar::I16 => bytes[..2].copy_from_slice(&(rounded as i16).to_le_bytes()),
            Scalar::U16 => bytes[..2].copy_from_slice(&(rounded as u16).to_le_bytes()),
            Scalar::I32 => bytes[..4].copy_from_slice(&(rounded as i32).to_le_bytes()),
            Scalar::U32 => bytes[..4].copy_from_slice(&(rounded as u32).to_le_bytes()),
            Scalar::F32 => bytes[..4].copy_from_slice(&(value as f32).to_le_bytes()),
            Scalar::F64 => bytes.copy_from_slice(&value.to_le_bytes()),
        }
        (bytes, self.size())
    }
}

/// Numbers at all vertices, the same count at each.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    /// Its name: [`COLOR`], [`NORMAL`], or the name in its file.
    pub name: String,
    /// Number of values per vertex, at least one.
    pub components: usize,
    /// All values, vertex by vertex.
    pub values: Vec<f64>,
    /// The type of the values in the file, which is also used for writing.
    pub scalar: Scalar,
}

impl Attribute {
    /// Returns whether this is the colour.
    pub fn is_color(&self) -> bool {
        self.name == COLOR && matches!(self.components, 3 | 4)
    }

    /// Returns whether this is the normal.
    pub fn is_normal(&self) -> bool {
        self.name == NORMAL && self.components == 3
    }

    /// Returns whether the values are labels, which cannot be averaged: integers that are neither colours nor normals.
    pub fn is_label(&self) -> bool {
        self.scalar.is_integer() && !self.is_color() && !self.is_normal()
    }

    /// The values of vertex `v`.
    #[inline]
    pub fn of(&self, v: usize) -> &[f64] {
        &self.values[v * self.components..(v + 1) * self.components]
    }

    /// The red, green and blue components of vertex `v`, each from 0 to 1.
    pub fn color(&self, v: usize) -> [f64; 3] {
        let full = self.scalar.full();
        [0, 1, 2].map(|k| self.of(v)[k] / full)
    }

    /// The name of each component, as in PLY.
    pub fn component_names(&self) -> Vec<String> {
        let known: &[&str] = match self.name.as_str() {
            COLOR if self.is_color() => &["red", "green", "blue", "alpha"],
            NORMAL if self.is_normal() => &["nx", "ny", "nz"],
            name if self.components == 1 => return vec![name.into()],
            name => return (0..self.components).map(|k| format!("{name}_{k}")).collect(),
        };
        known[..self.components].iter().map(ToString::to_string).collect()
    }
}

/// All attributes of a mesh or a cloud.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// The vertex attributes.
    pub vertex: Vec<Attribute>,
    /// The texture coordinates of the corners of each triangle, with the origin at the lower left of the image; NaN at
    /// corners that have none. Empty if there are none at all.
    pub texture: Vec<[DVec2; 3]>,
    /// The materials, if any.
    pub materials: Option<Materials>,
    /// The named parts, if any.
    pub parts: Option<Parts>,
}

/// An attribute that could not be carried over, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lost {
    /// Its name.
    pub name: String,
    /// The reason.
    pub cause: String,
}

impl Attributes {
    /// Returns whether there are no attributes.
    pub fn is_empty(&self) -> bool {
        self.vertex.is_empty() && self.texture.is_empty() && self.materials.is_none() && self.parts.is_none()
    }

    /// The vertex attribute of this name.
    pub fn get(&self, name: &str) -> Option<&Attribute> {
        self.vertex.iter().find(|a| a.name == name)
    }

    /// The names of all attributes.
    pub fn names(&self) -> Vec<String> {
        let texture = (!self.texture.is_empty()).then(|| TEXTURE.into());
        let materials = self.materials.is_some().then(|| MATERIALS.into());
        let parts = self.parts.is_some().then(|| PARTS.into());
        self.vertex.iter().map(|a| a.name.clone()).chain(texture).chain(materials).chain(parts).collect()
    }

    /// Removes the attribute that [`Self::names`] lists under this name.
    pub fn remove(&mut self, name: &str) {
        self.vertex.retain(|a| a.name != name);
        if name == TEXTURE {
            self.texture.clear();
        }
        if name == MATERIALS {
            self.materials = None;
        }
        if name == PARTS {
            self.parts = None;
        }
    }

    /// The colours, if any.
    pub fn color(&self) -> Option<&Attribute> {
        self.get(COLOR).filter(|a| a.is_color())
    }

    /// Returns the attributes of the vertices `numbers`, in that order, without those of corners and triangles.
    #[must_use]
    pub fn of_vertices(&self, numbers: &[u32]) -> Attributes {
        let pick = |a: &Attribute| {
            let value = |&v: &u32| &a.values[a.components * v as usize..a.components * (v as usize + 1)];
            Attribute { values: numbers.iter().flat_map(value).copied().collect(), ..a.clone() }
        };
        Attributes { vertex: self.vertex.iter().map(pick).collect(), ..Attributes::default() }
    }

    /// Returns the attributes of the part of the mesh that consists of these `vertices` and `triangles`, in that order.
    #[must_use]
    pub fn of_part(&self, vertices: &[u32], triangles: &[u32]) -> Attributes {
        let numbers = |all: &[u32]| triangles.iter().map(|&t| all[t as usize]).collect();
        Attributes {
            texture: if self.texture.is_empty() {
                Vec::new()
            } else {
                triangles.iter().map(|&t| self.texture[t as usize]).collect()
            },
            materials: self.materials.as_ref().map(|m| Materials { of_triangle: numbers(&m.of_triangle), ..m.clone() }),
            parts: self.parts.as_ref().map(|p| Parts { list: p.list.clone(), of_triangle: numbers(&p.of_triangle) }),
            ..self.of_vertices(vertices)
        }
    }

    /// The normals, if any.
    pub fn normal(&self) -> Option<&Attribute> {
        self.get(NORMAL).filter(|a| a.is_normal())
    }

    /// The normals as vectors; empty if there are none.
    pub fn normals(&self) -> Vec<DVec3> {
        let vectors = self.normal().map(|a| a.values.chunks_exact(3).map(DVec3::from_slice).collect());
        vectors.unwrap_or_default()
    }

    /// Returns the values of the property `name`, one number per vertex: an attribute with one component, or one component
    /// of an attribute, such as `red` or `nz`.
    ///
    /// # Errors
    /// [`Error::Mesh`] with the existing names, if there is no such property.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        let mut known = Vec::new();
        for attribute in &self.vertex {
            for (k, component) in attribute.component_names().into_iter().enumerate() {
                if component == name {
                    return Ok(attribute.values.iter().skip(k).step_by(attribute.components).copied().collect());
                }
                known.push(component);
            }
        }
        let remedy = match &known[..] {
            [] => "there are none: pass the numbers separately, or use a format that stores them, such as PLY or glTF"
                .into(),
            _ => format!("use one of {}", known.join(", ")),
        };
        let cause = format!("the vertices have no property '{}'", name.escape_debug());
        Err(Error::Mesh { fault: Fault::NoAttribute, cause, remedy })
    }
}

/// Vertices together with texture coordinates: a vertex on a UV seam is split into several wedges.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Wedges {
    /// The vertex of each wedge.
    pub vertices: Vec<u32>,
    /// The texture coordinates of each wedge.
    pub coordinates: Vec<DVec2>,
    /// The wedge at each corner of each triangle.
    pub corners: Vec<[u32; 3]>,
}

impl Wedges {
    /// Returns the wedges of `triangles`, in the order of their first use; wedges of the same vertex differ in their
    /// coordinates.
    pub fn new(triangles: &[[u32; 3]], texture: &[[DVec2; 3]]) -> Wedges {
        let mut wedges = Wedges { corners: Vec::with_capacity(triangles.len()), ..Wedges::default() };
        let mut number = HashMap::new();
        for (triangle, coordinates) in triangles.iter().zip(texture) {
            let wedge = |k: usize| {
                let (v, at) = (triangle[k], coordinates[k]);
                *number.entry((v, at.to_array().map(f64::to_bits))).or_insert_with(|| {
                    wedges.vertices.push(v);
                    wedges.coordinates.push(at);
                    wedges.vertices.len() as u32 - 1
                })
            };
            wedges.corners.push([0, 1, 2].map(wedge));
        }
        wedges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attribute(name: &str, components: usize, values: &[f64], scalar: Scalar) -> Attribute {
        Attribute { name: name.into(), components, values: values.to_vec(), scalar }
    }

    #[test]
    fn numbers_go_by_the_names_of_components() {
        let color = attribute(COLOR, 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], Scalar::U8);
        let wide = attribute("flow", 2, &[7.0, 8.0, 9.0, 10.0], Scalar::F32);
        let one = attribute("size", 1, &[0.5, 0.25], Scalar::F64);
        let attributes = Attributes { vertex: vec![color, wide, one], ..Attributes::default() };
        for (name, numbers) in [("green", [2.0, 5.0]), ("flow_1", [8.0, 10.0]), ("size", [0.5, 0.25])] {
            assert_eq!(attributes.numbers(name).unwrap(), numbers);
        }
        let message = attributes.numbers("width").unwrap_err().to_string();
        assert_eq!(message, "the vertices have no property 'width'; use one of red, green, blue, flow_0, flow_1, size");
        assert!(Attributes::default().numbers("h").unwrap_err().to_string().contains("there are none"));
    }

    #[test]
    fn stored_numbers_are_rounded_and_kept_in_range() {
        assert_eq!(Scalar::U8.bytes(254.6), ([255, 0, 0, 0, 0, 0, 0, 0], 1));
        assert_eq!(Scalar::U8.bytes(-3.0).0[0], 0);
        assert_eq!(Scalar::I16.bytes(-1e9).0[..2], i16::MIN.to_le_bytes());
        assert_eq!(Scalar::F64.bytes(0.1).0, 0.1f64.to_le_bytes());
    }

    #[test]
    fn a_vertex_on_a_seam_is_several_wedges() {
        let [o, x, y, z] = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        let wedges = Wedges::new(&[[0, 1, 2], [2, 1, 3]], &[[o, x, y], [y, o, z]]);
        assert_eq!(wedges.vertices, [0, 1, 2, 1, 3]);
        assert_eq!(wedges.coordinates, [o, x, y, o, z]);
        assert_eq!(wedges.corners, [[0, 1, 2], [2, 3, 4]]);
    }
}
