//! Mesh files as bytes: readers and writers of the common formats, one a file. Names of files are in `io::file` only.
//!
//! ```
//! use spectral_remesh::io::{self, Format};
//!
//! let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
//! let loaded = io::parse(text, Format::Obj, io::NO_BUFFERS)?;
//! assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
//!
//! let mut bytes = Vec::new();
//! io::write(&loaded.mesh, Format::Off, &mut bytes).expect("memory does not fail");
//! assert_eq!(Format::sniff(&bytes), Some(Format::Off));
//! # Ok::<(), spectral_remesh::Error>(())
//! ```

use crate::base::error::{Error, Place, Result};
use crate::mesh::attributes::{Attribute, Attributes, NORMAL, Scalar};
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

mod base64;
mod bytes;
mod columns;
mod faces;
#[cfg(feature = "fs")]
pub mod file;
mod format;
mod gltf;
mod las;
mod obj;
mod off;
mod ply;
mod stl;
mod text;
mod xyz;

pub use format::Format;

/// A mesh or a cloud as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// All triangles of the file over all its vertices. A file without faces gives vertices without triangles.
    pub mesh: Mesh,
    /// What its vertices, corners and triangles have beside their places.
    pub attributes: Attributes,
    /// The format that it was read as.
    pub format: Format,
    /// What a user should know of what was left out, a sentence each.
    pub notes: Vec<String>,
}

/// Fetches an external buffer of a glTF file by its relative address; a sentence says what went wrong.
pub type Resolve<'a> = &'a dyn Fn(&str) -> std::result::Result<Vec<u8>, String>;

/// For bytes without a place: glTF files with external buffers are refused.
pub const NO_BUFFERS: Resolve<'static> = &|_| Err("external buffers need the file's folder".into());

/// What a format's reader gives to [`parse`], or the error.
pub(crate) type Parsed = Result<Read>;

/// What a file is read as.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Read {
    pub mesh: Mesh,
    pub attributes: Attributes,
    pub notes: Vec<String>,
}

/// What a format's writer writes.
pub(crate) struct Content<'a> {
    pub positions: &'a [DVec3],
    pub triangles: &'a [[u32; 3]],
    pub attributes: &'a Attributes,
}

impl Loaded {
    /// The vertices as points, with their normals if the file has them.
    pub fn into_points(self) -> Points {
        Points { normals: self.attributes.normals(), positions: self.mesh.positions }
    }
}

/// Reads a mesh from the bytes of a file. Indices of the result are in range and coordinates finite; vertices and
/// triangles are those of the file, in its order, with nothing merged or repaired.
///
/// # Errors
/// [`Error::Format`] with an empty file name and the place, for content that is not what the format says.
pub fn parse(bytes: &[u8], format: Format, resolve: Resolve) -> Result<Loaded> {
    if bytes.is_empty() {
        return Err(whole("the file is empty", "export it again"));
    }
    let Read { mesh, attributes, notes } = match format {
        Format::Obj => obj::parse(bytes),
        Format::Ply => ply::parse(bytes),
        Format::Stl => stl::parse(bytes),
        Format::Off => off::parse(bytes),
        Format::Gltf | Format::Glb => gltf::parse(bytes, resolve),
        Format::Xyz => xyz::parse(bytes),
        Format::Las => las::parse(bytes),
    }?;
    check(&mesh, format)?;
    check_attributes(&mesh, &attributes)?;
    Ok(Loaded { mesh, attributes, format, notes })
}

/// Writes a mesh as the content of a file. `out` should be buffered.
///
/// OBJ and OFF keep every bit of the coordinates; STL and glTF have single precision.
///
/// # Errors
/// Those of `out`; `InvalidData` for a mesh that the format cannot hold.
pub fn write(mesh: &Mesh, format: Format, out: &mut dyn std::io::Write) -> std::io::Result<()> {
    write_with_attributes(mesh, &Attributes::default(), format, out)
}

/// Writes a mesh like [`write()`], and those of `attributes`, which have to be its own, that
/// [`Format::cannot_hold`] does not name.
///
/// # Errors
/// Those of [`write()`].
pub fn write_with_attributes(
    mesh: &Mesh,
    attributes: &Attributes,
    format: Format,
    out: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    write_content(&Content { positions: &mesh.positions, triangles: &mesh.triangles, attributes }, format, out)
}

/// Writes points with their normals, if they have some, and those of `attributes` of theirs that the format can hold.
///
/// # Errors
/// Those of [`write()`].
pub fn write_points(
    points: &Points,
    attributes: &Attributes,
    format: Format,
    out: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    let mut attributes = attributes.clone();
    if !points.normals.is_empty() {
        let values = points.normals.iter().flat_map(|n| n.to_array()).collect();
        attributes.vertex.retain(|a| !a.is_normal());
        attributes.vertex.insert(0, Attribute { name: NORMAL.into(), components: 3, values, scalar: Scalar::F64 });
    }
    write_content(&Content { positions: &points.positions, triangles: &[], attributes: &attributes }, format, out)
}

fn write_content(content: &Content, format: Format, out: &mut dyn std::io::Write) -> std::io::Result<()> {
    match format {
        Format::Obj => obj::write(content, out),
        Format::Ply => ply::write(content, out),
        Format::Stl => stl::write(content, out),
        Format::Off => off::write(content, out),
        Format::Gltf => gltf::write_gltf(content, out),
        Format::Glb => gltf::write_glb(content, out),
        Format::Xyz => xyz::write(content, out),
        Format::Las => Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, "LAS is read only")),
    }
}

/// What every stage after this one relies on, whatever the reader did.
fn check(mesh: &Mesh, format: Format) -> Result<()> {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    if vertices == 0 {
        return Err(whole(format!("there are no vertices in it, read as {format}"), "check what the file is"));
    }
    // Three sides a triangle are numbered in u32.
    if vertices >= u32::MAX as usize || triangles >= (u32::MAX / 3) as usize {
        let cause =
            format!("{vertices} vertices and {triangles} triangles are more than 32-bit numbers can tell apart");
        return Err(whole(cause, "split the file"));
    }
    if let Some(v) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(part(format!("vertex {v}"), "a coordinate is not finite"));
    }
    let out_of_range = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= vertices);
    if let Some(t) = mesh.triangles.iter().position(out_of_range) {
        return Err(part(
            format!("triangle {t}"),
            &format!("an index is not below the number of vertices, {vertices}"),
        ));
    }
    Ok(())
}

/// That there is a value for each vertex, corner and triangle.
fn check_attributes(mesh: &Mesh, attributes: &Attributes) -> Result<()> {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    let is_whole = |a: &Attribute| a.components > 0 && Some(a.values.len()) == a.components.checked_mul(vertices);
    if let Some(a) = attributes.vertex.iter().find(|a| !is_whole(a)) {
        return Err(part(
            format!("attribute {}", text::quote(a.name.as_bytes())),
            "its values are not those of all vertices",
        ));
    }
    let of_triangles = attributes.materials.as_ref().map_or(triangles, |m| m.of_triangle.len());
    if of_triangles != triangles || !attributes.texture.is_empty() && attributes.texture.len() != triangles {
        return Err(whole("texture coordinates or materials are not those of all triangles", "export the file again"));
    }
    Ok(())
}

fn whole(cause: impl Into<String>, remedy: &str) -> Error {
    Error::Format { file: String::new(), place: Place::Whole, cause: cause.into(), remedy: remedy.into() }
}

fn part(name: String, cause: &str) -> Error {
    let remedy = "export the file again".into();
    Error::Format { file: String::new(), place: Place::Part(name), cause: cause.into(), remedy }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn no_reader_is_trusted() {
        let good = Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] };
        assert_eq!(check(&good, Format::Obj), Ok(()));
        let mut bad = good.clone();
        bad.triangles.push([0, 1, 3]);
        assert!(check(&bad, Format::Obj).unwrap_err().to_string().contains("triangle 1"));
        let mut bad = good;
        bad.positions[2].z = f64::NAN;
        assert!(check(&bad, Format::Obj).unwrap_err().to_string().contains("vertex 2"));
        assert!(
            check(&Mesh::default(), Format::Stl).unwrap_err().to_string().contains("no vertices in it, read as STL")
        );
    }

    #[test]
    fn empty_and_foreign_content() {
        for format in Format::ALL {
            assert!(parse(b"", format, NO_BUFFERS).unwrap_err().to_string().contains("empty"));
            assert!(parse(b"hello\n", format, NO_BUFFERS).is_err());
        }
    }
}
