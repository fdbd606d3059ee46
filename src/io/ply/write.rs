//! Writing PLY.

use crate::surface::mesh::Mesh;
use std::io::{self, Write};

/// Writes binary little-endian PLY with double coordinates, so that reading gives the same mesh.
///
/// # Errors
/// What `out` fails with.
pub(crate) fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    // Most readers know signed indices only, so unsigned ones are for what needs them.
    let index = if mesh.positions.len() > i32::MAX as usize { "uint" } else { "int" };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\nelement face {}\nproperty list uchar {index} vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    for p in &mesh.positions {
        out.write_all(p.to_array().map(f64::to_le_bytes).as_flattened())?;
    }
    for t in &mesh.triangles {
        out.write_all(&[3])?;
        out.write_all(t.map(u32::to_le_bytes).as_flattened())?;
    }
    Ok(())
}
