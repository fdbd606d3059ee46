//! Writing OBJ.

use crate::io::content::Content;
use crate::io::text::write_line;
use crate::mesh::attributes::{Materials, Wedges};
use std::io::{self, Write};

pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let Content { positions, triangles, attributes } = content;
    let (color, normal, materials) = (attributes.color(), attributes.normal(), attributes.materials.as_ref());
    for library in materials.iter().flat_map(|m| &m.libraries) {
        writeln!(out, "mtllib {library}")?;
    }
    for (v, p) in positions.iter().enumerate() {
        write_line(out, "v", p.to_array().into_iter().chain(color.into_iter().flat_map(|c| c.color(v))))?;
    }
    for n in normal.iter().flat_map(|n| n.values.chunks_exact(3)) {
        write_line(out, "vn", n.iter().copied())?;
    }
    let wedges = Wedges::new(triangles, &attributes.texture);
    for at in &wedges.coordinates {
        // Corners without coordinates are not written with them.
        write_line(out, "vt", if at.is_finite() { at.to_array() } else { [0.0; 2] })?;
    }
    for (t, triangle) in triangles.iter().enumerate() {
        write_material(materials, t, out)?;
        let wedge = wedges.corners.get(t).filter(|_| attributes.texture[t].iter().all(|at| at.is_finite()));
        write_face(triangle, wedge, normal.is_some(), out)?;
    }
    Ok(())
}

/// The material of triangle `t`, where it is not that of the one before.
fn write_material(materials: Option<&Materials>, t: usize, out: &mut dyn Write) -> io::Result<()> {
    let Some(Materials { names, of_triangle, .. }) = materials else { return Ok(()) };
    match names.get(of_triangle[t] as usize) {
        Some(name) if t == 0 || of_triangle[t - 1] != of_triangle[t] => writeln!(out, "usemtl {name}"),
        _ => Ok(()),
    }
}

/// A triangle with its texture coordinates, if it has some, and the normals of its vertices.
fn write_face(triangle: &[u32; 3], wedge: Option<&[u32; 3]>, normals: bool, out: &mut dyn Write) -> io::Result<()> {
    let [a, b, c] = triangle.map(|v| u64::from(v) + 1);
    match (wedge.map(|w| w.map(|w| u64::from(w) + 1)), normals) {
        (None, false) => writeln!(out, "f {a} {b} {c}"),
        (None, true) => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}"),
        (Some([i, j, k]), false) => writeln!(out, "f {a}/{i} {b}/{j} {c}/{k}"),
        (Some([i, j, k]), true) => writeln!(out, "f {a}/{i}/{a} {b}/{j}/{b} {c}/{k}/{c}"),
    }
}
