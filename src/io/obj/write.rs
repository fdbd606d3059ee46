//! Writing of OBJ. Triangles are grouped by part, and within a part by material.

use crate::io::content::Content;
use crate::io::text::write_line;
use crate::mesh::attributes::{Attributes, Wedges};
use crate::mesh::parts::Part;
use crate::mesh::topology::NONE;
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
        // Faces with corners that lack coordinates are written without them.
        write_line(out, "vt", if at.is_finite() { at.to_array() } else { [0.0; 2] })?;
    }
    let mut before = (NONE, NONE);
    for t in order(triangles.len(), attributes) {
        let here = labels(attributes, t);
        write_labels(attributes, before, here, out)?;
        before = here;
        let triangle = &triangles[t];
        let wedge = wedges.corners.get(t).filter(|_| attributes.texture[t].iter().all(|at| at.is_finite()));
        write_face(triangle, wedge, normal.is_some(), out)?;
    }
    Ok(())
}

/// Returns the triangles sorted by part and material, those with neither first.
fn order(triangles: usize, attributes: &Attributes) -> Vec<usize> {
    let mut order: Vec<usize> = (0..triangles).collect();
    if attributes.parts.is_some() || attributes.materials.is_some() {
        // `NONE` is the largest number, so it wraps around to zero.
        order.sort_by_key(|&t| {
            let (part, material) = labels(attributes, t);
            (part.wrapping_add(1), material.wrapping_add(1))
        });
    }
    order
}

/// Returns the indices of the part and of the material of triangle `t`.
fn labels(Attributes { parts, materials, .. }: &Attributes, t: usize) -> (u32, u32) {
    (parts.as_ref().map_or(NONE, |p| p.of_triangle[t]), materials.as_ref().map_or(NONE, |m| m.of_triangle[t]))
}

/// Writes the names of the part and the material `here` if they differ from those of the triangle `before`.
fn write_labels(attributes: &Attributes, before: (u32, u32), here: (u32, u32), out: &mut dyn Write) -> io::Result<()> {
    let part = |number: u32| attributes.parts.as_ref().and_then(|parts| parts.list.get(number as usize));
    if before.0 != here.0 {
        let nothing = Part::default();
        let (old, new) = (part(before.0).unwrap_or(&nothing), part(here.0).unwrap_or(&nothing));
        let is_other = old.object != new.object;
        if is_other {
            writeln!(out, "o {}", plain(&new.object))?;
        }
        // A new object begins without a group.
        if new.group != if is_other { "" } else { &old.group } {
            writeln!(out, "g {}", plain(&new.group))?;
        }
    }
    if before.1 != here.1 {
        let material = attributes.materials.as_ref().and_then(|materials| materials.list.get(here.1 as usize));
        writeln!(out, "usemtl {}", plain(material.map_or("", |material| &material.name)))?;
    }
    Ok(())
}

/// Returns a name in a form that fits on a line: single spaces between words, and no backslash at the end that would
/// continue the line.
pub(super) fn plain(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ").trim_end_matches('\\').replace(char::is_control, "_")
}

/// Writes a triangle with its texture coordinates, if it has some, and the normals of its vertices if `normals`.
fn write_face(triangle: &[u32; 3], wedge: Option<&[u32; 3]>, normals: bool, out: &mut dyn Write) -> io::Result<()> {
    let [a, b, c] = triangle.map(|v| u64::from(v) + 1);
    match (wedge.map(|w| w.map(|w| u64::from(w) + 1)), normals) {
        (None, false) => writeln!(out, "f {a} {b} {c}"),
        (None, true) => writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}"),
        (Some([i, j, k]), false) => writeln!(out, "f {a}/{i} {b}/{j} {c}/{k}"),
        (Some([i, j, k]), true) => writeln!(out, "f {a}/{i}/{a} {b}/{j}/{b} {c}/{k}/{c}"),
    }
}
