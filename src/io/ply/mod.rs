//! PLY: ASCII, and binary in both byte orders.
//!
//! A file has a header, and a table for each element that the header declares. Read are the numbers of `vertex`, the
//! polygons of `face` (`vertex_indices` or `vertex_index`) with the texture coordinates of their corners (`texcoord`), and
//! the strips of `tristrips`, in any order and of any type. All other elements, lists, and properties of faces are left out.
//! A count in the header is compared with the number of remaining bytes before memory is reserved for it.
//!
//! `vertices` defines which properties of vertices are the position, the normal, the colour and texture coordinates; each
//! other one is an attribute by itself.
//!
//! A strip is a sequence of vertices; every three successive ones form a triangle, with the orientation alternating. -1
//! starts a new strip. Triangles with a repeated vertex only join strips and are left out.
//!
//! Limits: 64-bit integers, which some programs write, are not part of the format and are refused.

mod elements;
mod faces;
mod header;
#[cfg(feature = "fs")]
mod rows;
mod source;
mod vertices;
mod write;

#[cfg(feature = "fs")]
pub(crate) use rows::{surface, table};
pub(crate) use write::write;

use crate::base::error::{Error, Place};
use crate::io::bytes::{EXPORT_AGAIN, malformed};
use crate::io::content::{Parsed, Read};
use crate::io::text::small_faces;
use crate::mesh::attributes::Attributes;
use crate::mesh::triangle_mesh::Mesh;
use elements::skip_element;
use faces::Faces;
use glam::DVec2;
pub(super) use header::has_signature;
use header::{Element, Encoding, Header};
use source::{Binary, Source, Text};
use vertices::Vertices;

/// Reads the mesh in a PLY file. A file without faces gives vertices only.
///
/// # Errors
/// `Error::Format` with the line or byte that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let header = header::parse(bytes)?;
    match header.encoding {
        Encoding::Text => read(Text::new(&bytes[header.body..], header.line), &header),
        Encoding::Little => read(Binary::<false>::new(bytes, header.body), &header),
        Encoding::Big => read(Binary::<true>::new(bytes, header.body), &header),
    }
}

fn no_vertices(header: &Header) -> Error {
    malformed(Place::Line(header.line - 1), "no element 'vertex' in the header", EXPORT_AGAIN)
}

/// Reads all elements. Faces that come before the vertices are skipped first and read at the end.
fn read<S: Source>(mut source: S, header: &Header) -> Parsed {
    let Some(vertex) = header.elements.iter().position(|e| e.name == "vertex") else {
        return Err(no_vertices(header));
    };
    let is_surface = |e: &Element| matches!(e.name.as_str(), "face" | "tristrips");
    let with_faces = header.elements.iter().any(|e| is_surface(e) && e.count > 0);
    let mut vertices = Vertices::default();
    let mut faces = Faces::default();
    let mut notes = header.notes.clone();
    let mut early = Vec::new();
    for (i, element) in header.elements.iter().enumerate() {
        let surface = is_surface(element);
        if i == vertex {
            vertices = Vertices::read(&mut source, element, with_faces, &mut notes)?;
        } else if surface && i > vertex {
            faces.read(&mut source, element, &vertices.positions, &mut notes)?;
        } else {
            if surface {
                early.push((source.clone(), element));
            } else if element.count > 0 {
                notes.push(format!("{} elements '{}' are left out", element.count, element.name));
            }
            skip_element(&mut source, element)?;
        }
    }
    for (mut source, element) in early {
        faces.read(&mut source, element, &vertices.positions, &mut notes)?;
    }
    small_faces(&mut notes, faces.small);
    if source.has_more() {
        notes.push("everything after the last element is left out".into());
    }
    Ok(joined(vertices, faces, notes))
}

/// Combines vertices and faces. Texture coordinates of corners take precedence over those of vertices.
fn joined(vertices: Vertices, faces: Faces, notes: Vec<String>) -> Read {
    let Vertices { positions, attributes, texture: of_vertices } = vertices;
    let Faces { triangles, mut texture, .. } = faces;
    if !texture.is_empty() {
        texture.resize(triangles.len(), [DVec2::NAN; 3]);
    } else if !of_vertices.is_empty() {
        texture = triangles.iter().map(|t| t.map(|v| of_vertices[v as usize])).collect();
    }
    let attributes = Attributes { vertex: attributes, texture, ..Attributes::default() };
    Read { mesh: Mesh { positions, triangles }, attributes, notes }
}

#[cfg(test)]
mod tests;
