//! Writing: a mesh or points as the content of a file in any format.

use crate::io::content::Content;
use crate::io::format::Format;
use crate::io::{gltf, obj, off, pcd, ply, stl, threemf, vtk, xyz};
use crate::mesh::attributes::{Attribute, Attributes, NORMAL, Scalar};
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;

/// Writes a mesh as the content of a file. `out` should be buffered.
///
/// STL, glTF and PCD have single precision; the others keep every bit of the coordinates.
///
/// # Errors
/// Those of `out`; `InvalidData` for a mesh that the format cannot hold.
pub fn write(mesh: &Mesh, format: Format, out: &mut dyn std::io::Write) -> std::io::Result<()> {
    write_with_attributes(mesh, &Attributes::default(), format, out)
}

/// Writes a mesh like [`write()`], with those of its `attributes` that [`Format::cannot_hold`] does not name.
///
/// # Errors
/// Those of [`write()`].
pub fn write_with_attributes(
    mesh: &Mesh,
    attributes: &Attributes,
    format: Format,
    out: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    write_content(&content(mesh, attributes), format, out)
}

/// Writes points with their normals, if they have some, and those of their `attributes` that the format can hold.
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
    if !points.normals().is_empty() {
        let values = points.normals().iter().flat_map(|n| n.to_array()).collect();
        attributes.vertex.retain(|a| !a.is_normal());
        attributes.vertex.insert(0, Attribute { name: NORMAL.into(), components: 3, values, scalar: Scalar::F64 });
    }
    write_content(&Content { positions: points.positions(), triangles: &[], attributes: &attributes }, format, out)
}

/// Writes the levels of detail of a mesh, each with its attributes, from fine to coarse, as one file. Their materials must
/// be the same.
///
/// # Errors
/// Those of [`write()`]; `InvalidInput` for a format that does not [hold levels](Format::holds_levels).
pub fn write_levels(
    levels: &[(&Mesh, &Attributes)],
    format: Format,
    out: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    let levels: Vec<Content> = levels.iter().map(|(mesh, attributes)| content(mesh, attributes)).collect();
    match format {
        Format::Gltf => gltf::write_gltf(&levels, out),
        Format::Glb => gltf::write_glb(&levels, out),
        _ => Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, format!("{format} can hold only one mesh"))),
    }
}

fn content<'a>(mesh: &'a Mesh, attributes: &'a Attributes) -> Content<'a> {
    Content { positions: &mesh.positions, triangles: &mesh.triangles, attributes }
}

fn write_content(content: &Content, format: Format, out: &mut dyn std::io::Write) -> std::io::Result<()> {
    match format {
        Format::Obj => obj::write(content, out),
        Format::Ply => ply::write(content, out),
        Format::Stl => stl::write(content, out),
        Format::Off => off::write(content, out),
        Format::Gltf => gltf::write_gltf(std::slice::from_ref(content), out),
        Format::Glb => gltf::write_glb(std::slice::from_ref(content), out),
        Format::Xyz => xyz::write(content, out),
        Format::ThreeMf => threemf::write(content, out),
        Format::Vtp => vtk::write(content, out),
        Format::Pcd => pcd::write(content, out),
        Format::Las | Format::Vtk | Format::Gmsh | Format::Medit | Format::E57 => Err(std::io::Error::new(
            std::io::ErrorKind::InvalidInput,
            format!("{format} can only be read, not written"),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::content::NO_BUFFERS;
    use crate::io::read::parse;
    use glam::DVec3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_written_reads_as_the_same(points in prop::collection::vec(prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO), 3..20)) {
            let last = points.len() as u32 - 1;
            let m = Mesh { positions: points.into_iter().map(DVec3::from).collect(), triangles: vec![[0, 1, last], [last, 1, 0]] };
            for format in [Format::Off, Format::Obj] {
                let mut text = Vec::new();
                write(&m, format, &mut text).unwrap();
                let loaded = parse(&text, format, NO_BUFFERS).unwrap();
                prop_assert_eq!((loaded.mesh, loaded.attributes, loaded.notes), (m.clone(), Attributes::default(), Vec::new()));
            }
        }
    }
}
