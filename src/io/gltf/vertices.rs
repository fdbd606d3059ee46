//! Vertex attributes of all primitives, concatenated to one list per attribute.

use super::store::{Store, Vectors};
use crate::base::error::Error;
use crate::mesh::attributes::{Attribute, Attributes, COLOR, NORMAL};
use ::gltf::json::mesh::{Primitive, Semantic};
use ::gltf::json::validation::Checked;
use glam::{DMat3, DVec2, DVec3};
use std::collections::BTreeSet;

/// Name of texture coordinates until they are assigned to corners.
const TEXTURE: &str = "TEXCOORD_0";

/// Attributes of the vertices read so far.
#[derive(Default)]
pub(super) struct Columns {
    columns: Vec<Attribute>,
    /// Notes on attributes that are left out, with the reason.
    left_out: BTreeSet<String>,
}

/// Returns the accessors of a primitive's vertex attributes that are read, apart from positions. Primitives with the same
/// accessors share their vertices.
pub(super) fn accessors(primitive: &Primitive) -> Vec<usize> {
    named(primitive).map(|(_, accessor)| accessor).collect()
}

fn named(primitive: &Primitive) -> impl Iterator<Item = (String, usize)> {
    primitive.attributes.iter().filter_map(|(semantic, accessor)| {
        let name = match semantic {
            Checked::Valid(Semantic::Normals) => NORMAL.into(),
            Checked::Valid(Semantic::Colors(0)) => COLOR.into(),
            Checked::Valid(Semantic::TexCoords(0)) => TEXTURE.into(),
            Checked::Valid(Semantic::Extras(name)) => format!("_{name}"),
            _ => return None,
        };
        Some((name, accessor.value()))
    })
}

/// Returns notes on the attributes that are never read.
fn unread(primitive: &Primitive) -> impl Iterator<Item = String> {
    primitive.attributes.keys().filter_map(|semantic| match semantic {
        Checked::Valid(
            Semantic::Positions
            | Semantic::Normals
            | Semantic::Colors(0)
            | Semantic::TexCoords(0)
            | Semantic::Extras(_),
        ) => None,
        Checked::Valid(other) => Some(format!("attribute {} is left out", other.to_string())),
        Checked::Invalid => None,
    })
}

impl Columns {
    /// Adds the attributes of a primitive, whose vertices are those from `base` up to `base + count`. Normals are
    /// transformed by `turn`. Attributes that cannot be read are left out with a note.
    pub fn add(&mut self, store: &Store, primitive: &Primitive, base: usize, count: usize, turn: DMat3) {
        self.left_out.extend(unread(primitive));
        for (name, accessor) in named(primitive) {
            match store.vectors(accessor, name == COLOR) {
                Ok(vectors) if vectors.values.len() != count * vectors.components => {
                    let found = vectors.values.len() / vectors.components;
                    self.leave_out(&name, &format!("accessor {accessor} has {found} values for {count} vertices"));
                }
                Ok(vectors) => self.extend(name, vectors, base, turn),
                Err(Error::Format { place, cause, .. }) => {
                    self.leave_out(&name, format!("{place}: {cause}").trim_start_matches(", "));
                }
                Err(other) => self.leave_out(&name, &other.to_string()),
            }
        }
    }

    fn leave_out(&mut self, name: &str, cause: &str) {
        self.left_out.insert(format!("attribute {name} is left out: {cause}"));
    }

    fn extend(&mut self, name: String, vectors: Vectors, base: usize, turn: DMat3) {
        let Vectors { components, scalar, mut values } = vectors;
        match name.as_str() {
            NORMAL if components == 3 => {
                let turned = |n: &mut [f64]| (turn * DVec3::from_slice(n)).normalize_or_zero().write_to_slice(n);
                values.chunks_exact_mut(3).for_each(turned);
            }
            // Moves the origin from the upper left of the image to the lower left.
            TEXTURE => values.iter_mut().skip(1).step_by(2).for_each(|v| *v = 1.0 - *v),
            _ => {}
        }
        let known = self.columns.iter().position(|c| c.name == name).unwrap_or_else(|| {
            self.columns.push(Attribute { name, components, values: Vec::new(), scalar });
            self.columns.len() - 1
        });
        let column = &mut self.columns[known];
        if column.name == TEXTURE && components == column.components {
            // Vertices of primitives without texture coordinates, such as those of a plain material, get NaN.
            column.values.resize(base * components, f64::NAN);
            column.values.append(&mut values);
            return;
        }
        // An attribute that some vertices lack stays incomplete.
        if (column.components, column.scalar) == (components, scalar) && column.values.len() == base * components {
            column.values.append(&mut values);
        }
    }

    /// Returns the attributes that all of `count` vertices have, and notes on the others.
    pub fn finish(mut self, count: usize, triangles: &[[u32; 3]]) -> (Attributes, Vec<String>) {
        let mut attributes = Attributes::default();
        for mut column in std::mem::take(&mut self.columns) {
            let is_texture = column.name == TEXTURE;
            if is_texture {
                column.values.resize(count * column.components, f64::NAN);
            }
            if column.values.len() != count * column.components {
                self.leave_out(&column.name, "not all primitives have it with the same type");
            } else if is_texture && (column.components != 2 || triangles.is_empty()) {
                self.leave_out(TEXTURE, "it needs triangles, and two numbers for each vertex");
            } else if is_texture {
                let at = |v: u32| DVec2::from_slice(column.of(v as usize));
                attributes.texture = triangles.iter().map(|t| t.map(at)).collect();
            } else {
                attributes.vertex.push(column);
            }
        }
        (attributes, self.left_out.into_iter().collect())
    }
}
