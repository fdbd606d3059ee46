//! Writing of 3MF: one object, with a colour for each corner of its triangles if vertices have colours.

use super::{MODEL, RELATIONS};
use crate::io::content::Content;
use crate::io::text::write_number;
use crate::mesh::attributes::{Attribute, Scalar};
use std::collections::HashMap;
use std::io::{self, Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";

const TARGET: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" \
    xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
    xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n<resources>\n";

/// Writes triangles with the colours of their vertices.
pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    // In memory, because an archive stores the sizes of files before their content.
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default();
    for (name, text) in [("[Content_Types].xml", TYPES), (RELATIONS, TARGET)] {
        archive.start_file(name, options)?;
        archive.write_all(text.as_bytes())?;
    }
    archive.start_file(MODEL, options.large_file(content.positions.len() > 1 << 24))?;
    let mut buffered = io::BufWriter::new(archive);
    model(content, &mut buffered)?;
    let archive = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
    out.write_all(archive.finish()?.get_ref())
}

fn model(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let colors = content.attributes.color().map(Colors::new);
    out.write_all(HEAD.as_bytes())?;
    if let Some(colors) = &colors {
        out.write_all(b"<m:colorgroup id=\"1\">\n")?;
        for [r, g, b, a] in &colors.list {
            writeln!(out, "<m:color color=\"#{r:02X}{g:02X}{b:02X}{a:02X}\"/>")?;
        }
        out.write_all(b"</m:colorgroup>\n")?;
    }
    out.write_all(b"<object id=\"2\" type=\"model\">\n<mesh>\n<vertices>\n")?;
    for p in content.positions {
        for (name, x) in ["<vertex x=\"", "\" y=\"", "\" z=\""].into_iter().zip(p.to_array()) {
            out.write_all(name.as_bytes())?;
            write_number(out, x)?;
        }
        out.write_all(b"\"/>\n")?;
    }
    out.write_all(b"</vertices>\n<triangles>\n")?;
    for t in content.triangles {
        let [a, b, c] = t;
        write!(out, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"")?;
        if let Some(colors) = &colors {
            let [a, b, c] = t.map(|v| colors.of[v as usize]);
            write!(out, " pid=\"1\" p1=\"{a}\" p2=\"{b}\" p3=\"{c}\"")?;
        }
        out.write_all(b"/>\n")?;
    }
    out.write_all(
        b"</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid=\"2\"/>\n</build>\n</model>\n",
    )
}

/// The distinct colours of vertices.
struct Colors {
    list: Vec<[u8; 4]>,
    /// Index of each vertex's colour.
    of: Vec<usize>,
}

impl Colors {
    fn new(attribute: &Attribute) -> Colors {
        let full = attribute.scalar.full();
        let byte = |x: f64| Scalar::U8.bytes(x / full * 255.0).0[0];
        let mut colors = Colors { list: Vec::new(), of: Vec::new() };
        let mut numbers = HashMap::new();
        for row in attribute.values.chunks_exact(attribute.components) {
            let opacity = row.get(3).map_or(255, |&a| byte(a));
            let color = [byte(row[0]), byte(row[1]), byte(row[2]), opacity];
            let number = *numbers.entry(color).or_insert_with(|| {
                colors.list.push(color);
                colors.list.len() - 1
            });
            colors.of.push(number);
        }
        colors
    }
}
