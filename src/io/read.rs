//! Reading: converts the bytes of a file in any format to a mesh with checked indices and coordinates.

use crate::base::error::{Error, Place, Result};
use crate::io::content::{Read, Resolve};
use crate::io::format::Format;
use crate::io::{e57, gltf, gmsh, las, medit, obj, off, pcd, ply, stl, text, threemf, vtk, xyz};
use crate::mesh::attributes::{Attribute, Attributes};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::thin::Thinned;

/// A mesh or a cloud as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// All triangles of the file over all its vertices. A file without faces gives vertices without triangles.
    pub mesh: Mesh,
    /// Attributes of its vertices, corners and triangles.
    pub attributes: Attributes,
    /// Format that it was read as.
    pub format: Format,
    /// The kept part of a cloud with more points than were wanted; `None` if all were kept.
    pub thinned: Option<Thinned>,
    /// Notes for the user on what was left out, one sentence each.
    pub notes: Vec<String>,
}

/// Reads a mesh from the bytes of a file. Indices of the result are in range and coordinates finite. Vertices and triangles
/// are those of the file, in its order, with nothing merged or repaired. If every face has a repeated corner, the result has
/// points only: some programs put such faces into files of clouds.
///
/// # Errors
/// [`Error::Format`] with an empty file name and the place, for content that violates the format.
pub fn parse(bytes: &[u8], format: Format, resolve: Resolve) -> Result<Loaded> {
    if bytes.is_empty() {
        return Err(whole("the file is empty", "export it again"));
    }
    let read = match format {
        Format::Obj => obj::parse(bytes),
        Format::Ply => ply::parse(bytes),
        Format::Stl => stl::parse(bytes),
        Format::Off => off::parse(bytes),
        Format::Gltf | Format::Glb => gltf::parse(bytes, resolve),
        Format::Xyz => xyz::parse(bytes),
        Format::Las => las::parse(bytes),
        Format::ThreeMf => threemf::parse(bytes),
        Format::Vtk => vtk::parse_legacy(bytes),
        Format::Vtp => vtk::parse_xml(bytes),
        Format::Pcd => pcd::parse(bytes),
        Format::Gmsh => gmsh::parse(bytes),
        Format::Medit => medit::parse(bytes),
        Format::E57 => e57::parse(bytes),
    }?;
    checked(read, format)
}

/// Returns the content that was read, if it is valid.
pub(super) fn checked(read: Read, format: Format) -> Result<Loaded> {
    let Read { mesh, attributes, notes } = read;
    check(&mesh, format)?;
    check_attributes(&mesh, &attributes)?;
    let (mesh, attributes, notes) = without_empty_faces(mesh, attributes, notes);
    Ok(Loaded { mesh, attributes, format, thinned: None, notes })
}

/// Converts a mesh whose faces all have a repeated corner to points, with a note.
fn without_empty_faces(mesh: Mesh, attributes: Attributes, mut notes: Vec<String>) -> (Mesh, Attributes, Vec<String>) {
    let faces = mesh.triangles.len();
    let is_empty = |&[a, b, c]: &[u32; 3]| a == b || b == c || c == a;
    if faces == 0 || !mesh.triangles.iter().all(is_empty) {
        return (mesh, attributes, notes);
    }
    notes.push(format!("no face has an area ({faces} in all): the vertices are taken as a point cloud"));
    let attributes = Attributes { vertex: attributes.vertex, ..Attributes::default() };
    (Mesh { triangles: Vec::new(), ..mesh }, attributes, notes)
}

/// Checks the guarantees that all later stages rely on, independently of the readers.
fn check(mesh: &Mesh, format: Format) -> Result<()> {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    if vertices == 0 {
        return Err(whole(format!("it has no vertices when read as {format}"), "check what the file contains"));
    }
    // The three sides of each triangle are numbered in u32.
    if vertices >= u32::MAX as usize || triangles >= (u32::MAX / 3) as usize {
        let cause = format!("{vertices} vertices and {triangles} triangles are too many for 32-bit indices");
        return Err(whole(cause, "split the file"));
    }
    if let Some(v) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(part(format!("vertex {v}"), "a coordinate is not finite"));
    }
    let out_of_range = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= vertices);
    if let Some(t) = mesh.triangles.iter().position(out_of_range) {
        return Err(part(format!("triangle {t}"), &format!("an index is out of range: there are {vertices} vertices")));
    }
    Ok(())
}

/// Checks that there is a value for each vertex, corner and triangle.
fn check_attributes(mesh: &Mesh, attributes: &Attributes) -> Result<()> {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    let is_whole = |a: &Attribute| a.components > 0 && Some(a.values.len()) == a.components.checked_mul(vertices);
    if let Some(a) = attributes.vertex.iter().find(|a| !is_whole(a)) {
        return Err(part(
            format!("attribute {}", text::quote(a.name.as_bytes())),
            "it does not have one value for each vertex",
        ));
    }
    let materials = attributes.materials.iter().map(|m| (&m.of_triangle, m.list.len()));
    let parts = attributes.parts.iter().map(|p| (&p.of_triangle, p.list.len()));
    let is_known = |(numbers, count): (&Vec<u32>, usize)| {
        numbers.len() == triangles && numbers.iter().all(|&n| n == NONE || (n as usize) < count)
    };
    if !materials.chain(parts).all(is_known) || !attributes.texture.is_empty() && attributes.texture.len() != triangles
    {
        return Err(whole(
            "texture coordinates, materials or objects are not given for each triangle",
            "export the file again",
        ));
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
    use crate::io::content::NO_BUFFERS;
    use glam::DVec3;

    #[test]
    fn vertices_with_empty_faces_are_a_cloud() {
        let read = |faces: &str| {
            let text = format!("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n{faces}");
            parse(text.as_bytes(), Format::Off, NO_BUFFERS).unwrap()
        };
        let cloud = read("3 0 0 0\n3 1 2 1\n");
        assert_eq!((cloud.mesh.positions.len(), cloud.mesh.triangles.len()), (3, 0));
        assert_eq!(cloud.notes, ["no face has an area (2 in all): the vertices are taken as a point cloud"]);
        assert_eq!(read("3 0 0 0\n3 0 1 2\n").mesh.triangles.len(), 2);
    }

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
            check(&Mesh::default(), Format::Stl)
                .unwrap_err()
                .to_string()
                .contains("it has no vertices when read as STL")
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
