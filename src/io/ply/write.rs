//! Writing of PLY.

use crate::io::content::Content;
use crate::mesh::attributes::{Attribute, Scalar};
use std::io::{self, Write};

/// Writes binary little-endian PLY with double coordinates, so that reading it gives the same mesh. Attributes keep their
/// types; texture coordinates become a list per face, in single precision.
///
/// # Errors
/// Those of `out`.
pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let Content { positions, triangles, attributes } = content;
    write_header(content, out)?;
    for (v, p) in positions.iter().enumerate() {
        out.write_all(p.to_array().map(f64::to_le_bytes).as_flattened())?;
        for a in &attributes.vertex {
            for &value in a.of(v) {
                let (bytes, size) = a.scalar.bytes(value);
                out.write_all(&bytes[..size])?;
            }
        }
    }
    for (t, triangle) in triangles.iter().enumerate() {
        out.write_all(&[3])?;
        out.write_all(triangle.map(u32::to_le_bytes).as_flattened())?;
        if let Some(texture) = attributes.texture.get(t) {
            out.write_all(&[6])?;
            let numbers = texture.map(|at| at.as_vec2().to_array().map(f32::to_le_bytes));
            out.write_all(numbers.as_flattened().as_flattened())?;
        }
    }
    Ok(())
}

fn write_header(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let Content { positions, triangles, attributes } = content;
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\n",
        positions.len()
    )?;
    attributes.vertex.iter().try_for_each(|a| write_properties(a, out))?;
    if !triangles.is_empty() {
        // Most readers know only signed indices, so unsigned ones are used only if necessary.
        let index = if positions.len() > i32::MAX as usize { "uint" } else { "int" };
        write!(out, "element face {}\nproperty list uchar {index} vertex_indices\n", triangles.len())?;
    }
    if !attributes.texture.is_empty() {
        out.write_all(b"property list uchar float texcoord\n")?;
    }
    out.write_all(b"end_header\n")
}

fn write_properties(attribute: &Attribute, out: &mut dyn Write) -> io::Result<()> {
    let kind = match attribute.scalar {
        Scalar::I8 => "char",
        Scalar::U8 => "uchar",
        Scalar::I16 => "short",
        Scalar::U16 => "ushort",
        Scalar::I32 => "int",
        Scalar::U32 => "uint",
        Scalar::F32 => "float",
        Scalar::F64 => "double",
    };
    for name in attribute.component_names() {
        // Names in PLY files are single words.
        writeln!(out, "property {kind} {}", name.replace(char::is_whitespace, "_"))?;
    }
    Ok(())
}
