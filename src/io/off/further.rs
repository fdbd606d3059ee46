//! Values after the position of each vertex, and the attributes that they form.

use crate::io::columns::{Columns, color, cut, normal};
use crate::mesh::attributes::Attributes;
use glam::DVec2;

/// The attributes whose values follow the position of each vertex.
#[derive(Clone, Copy, Default)]
pub(super) struct Further {
    pub normals: bool,
    pub colors: bool,
    pub texture: bool,
}

impl Further {
    pub fn of_prefix(prefix: &[u8]) -> Further {
        let has = |word: &[u8]| prefix.windows(word.len()).any(|w| w == word);
        Further { normals: has(b"N"), colors: has(b"C"), texture: has(b"ST") }
    }

    /// Returns the number of values per vertex after its position in a binary file.
    pub fn width(self) -> usize {
        3 * usize::from(self.normals) + 4 * usize::from(self.colors) + 2 * usize::from(self.texture)
    }

    pub fn is_nothing(self) -> bool {
        !(self.normals || self.colors || self.texture)
    }

    /// Converts the numbers of vertices to attributes. Adds a note if they are not what the keyword announces.
    pub fn attributes(self, columns: Columns, triangles: &[[u32; 3]], notes: &mut Vec<String>) -> Attributes {
        let (values, width) = columns.into_table();
        self.attributes_of(values, width, triangles, notes)
    }

    /// Converts `values`, `width` per vertex, to attributes.
    pub fn attributes_of(
        self,
        values: Vec<f64>,
        width: usize,
        triangles: &[[u32; 3]],
        notes: &mut Vec<String>,
    ) -> Attributes {
        let normals = if self.normals { 3 } else { 0 };
        let texture = if self.texture { 2 } else { 0 };
        let colors = width.saturating_sub(normals + texture);
        let as_announced = if self.colors { matches!(colors, 3 | 4) } else { width == normals + texture };
        let mut attributes = Attributes::default();
        if self.is_nothing() || values.is_empty() || !as_announced {
            if !self.is_nothing() && !triangles.is_empty() {
                notes.push(
                    "normals, colours and texture coordinates are left out: they do not match the keyword".into(),
                );
            }
            return attributes;
        }
        if self.normals {
            attributes.vertex.push(normal(cut(&values, width, 0, 3)));
        }
        if self.colors {
            attributes.vertex.extend(color(cut(&values, width, normals, normals + colors), colors));
        }
        if self.texture {
            let row = |v: u32| &values[v as usize * width + width - 2..][..2];
            attributes.texture = triangles.iter().map(|t| t.map(|v| DVec2::from_slice(row(v)))).collect();
        }
        attributes
    }
}
