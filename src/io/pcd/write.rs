//! Writing of PCD: binary, single precision.

use crate::io::bytes::narrow;
use crate::io::content::Content;
use crate::mesh::attributes::{Attribute, Scalar};
use std::io::{self, Write};

/// Writes the points with all their attributes.
pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let attributes = &content.attributes.vertex;
    header(content.positions.len(), attributes, out)?;
    for (v, &p) in content.positions.iter().enumerate() {
        for x in narrow(p)? {
            out.write_all(&x.to_le_bytes())?;
        }
        for attribute in attributes {
            numbers(attribute, v, out)?;
        }
    }
    Ok(())
}

fn header(points: usize, attributes: &[Attribute], out: &mut dyn Write) -> io::Result<()> {
    let mut lists = ["FIELDS x y z", "SIZE 4 4 4", "TYPE F F F", "COUNT 1 1 1"].map(String::from);
    for field in attributes.iter().flat_map(fields) {
        lists.iter_mut().zip(&field).for_each(|(list, word)| *list = format!("{list} {word}"));
    }
    let lists = lists.join("\n");
    write!(
        out,
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n{lists}\nWIDTH {points}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA binary\n"
    )
}

/// Returns name, size, type and count of each field of an attribute.
fn fields(attribute: &Attribute) -> Vec<[String; 4]> {
    let field = |name: &str, size: usize, kind: &str, count: usize| {
        [name.into(), size.to_string(), kind.into(), count.to_string()]
    };
    if attribute.is_normal() {
        return ["normal_x", "normal_y", "normal_z"].map(|name| field(name, 4, "F", 1)).to_vec();
    }
    // The types by which the Point Cloud Library recognises these two.
    match attribute.components {
        3 if attribute.is_color() => return vec![field("rgb", 4, "F", 1)],
        4 if attribute.is_color() => return vec![field("rgba", 4, "U", 1)],
        _ => {}
    }
    let kind = match attribute.scalar {
        Scalar::I8 | Scalar::I16 | Scalar::I32 => "I",
        Scalar::U8 | Scalar::U16 | Scalar::U32 => "U",
        Scalar::F32 | Scalar::F64 => "F",
    };
    let name = attribute.name.replace(char::is_whitespace, "_");
    vec![field(&name, attribute.scalar.size(), kind, attribute.components)]
}

/// Writes the numbers of an attribute of vertex `v`.
fn numbers(attribute: &Attribute, v: usize, out: &mut dyn Write) -> io::Result<()> {
    if attribute.is_color() {
        let full = attribute.scalar.full();
        let byte = |k: usize| attribute.of(v).get(k).map_or(0, |x| Scalar::U8.bytes(x / full * 255.0).0[0]);
        return out.write_all(&[byte(2), byte(1), byte(0), byte(3)]);
    }
    let scalar = if attribute.is_normal() { Scalar::F32 } else { attribute.scalar };
    for &x in attribute.of(v) {
        let (bytes, size) = scalar.bytes(x);
        out.write_all(&bytes[..size])?;
    }
    Ok(())
}
