//! OFF, the Object File Format of Geomview: vertices and polygons in text.
//!
//! The keyword is `OFF` with any of the prefixes `ST`, `C` and `N`, or missing. The prefixes announce that normals, colours
//! and texture coordinates follow the position of each vertex, in this order; anything else that follows it, and colours of
//! faces, are skipped up to the end of the line. The numbers of vertices and of faces must be on one line, with or without
//! the keyword; the number of edges is not read. The word `BINARY` after the keyword announces the same content in four-byte
//! numbers, most significant byte first; there, colours of vertices have four components, and those of faces a count of
//! their own. Not supported: the forms with other dimensions (`4OFF`, `nOFF`).
//!
//! Cost: one pass. The counts in the header are compared with the length of the file before memory is reserved.

mod binary;
mod further;

use crate::base::error::Result;
use crate::io::columns::Columns;
use crate::io::content::{Content, Parsed, Read};
use crate::io::faces::Faces;
use crate::io::text::{Words, quote, small_faces, whole, write_line};
use crate::mesh::triangle_mesh::Mesh;
use further::Further;
use glam::DVec3;
use std::io::{self, Write};

/// Bytes of the shortest vertex, `0 0 0` and a line end.
const VERTEX_BYTES: usize = 6;

/// Bytes of the shortest face with an area, `3 0 1 2` and a line end, and of the shortest one without, `0` and a line end.
const FACE_BYTES: (usize, usize) = (8, 2);

/// Maximum number of values of a vertex after its position: a normal, a colour with opacity, texture coordinates.
const MOST_COLUMNS: usize = 3 + 4 + 2;

/// Content of a file before its first vertex.
struct Header {
    /// Numbers of vertices and faces; `None` if the file is binary, which has them in bytes.
    counts: Option<(usize, usize)>,
    further: Further,
}

pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut words = Words::new(bytes).with_comments();
    let Header { counts, further } = header(&mut words)?;
    let Some((vertices, faces)) = counts else {
        words.next_line();
        return binary::parse(bytes, bytes.len() - words.remaining(), further);
    };
    let (positions, columns) = read_vertices(&mut words, vertices, further)?;
    let mut faces = read_faces(&mut words, faces, vertices)?;
    let mut notes = Vec::new();
    faces.keep_outside(&positions, &mut notes);
    let triangles = faces.triangles(&positions);
    small_faces(&mut notes, faces.dropped);
    if words.anywhere().is_some() {
        notes.push(format!("everything after the last face, from line {} on, is left out", words.line()));
    }
    let attributes = further.attributes(columns, &triangles, &mut notes);
    Ok(Read { mesh: Mesh { positions, triangles }, attributes, notes })
}

pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let Content { positions, triangles, attributes } = content;
    let (color, normal) = (attributes.color(), attributes.normal());
    let prefix = [color.map_or("", |_| "C"), normal.map_or("", |_| "N")].concat();
    writeln!(out, "{prefix}OFF\n{} {} 0", positions.len(), triangles.len())?;
    for (v, p) in positions.iter().enumerate() {
        let further = normal.into_iter().chain(color).flat_map(|a| a.of(v)).copied();
        write_line(out, "", p.to_array().into_iter().chain(further))?;
    }
    for [a, b, c] in *triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}

/// Whether a file starts with the keyword of this format.
pub(crate) fn has_keyword(bytes: &[u8]) -> bool {
    Words::new(bytes).with_comments().anywhere().is_some_and(|word| keyword(word).is_some())
}

/// Returns the prefixes of the keyword that a word starts with, and the rest of the word after the keyword. `OFF8 6 12`,
/// with the keyword and a count run together, occurs in some collections.
fn keyword(word: &[u8]) -> Option<(&[u8], &[u8])> {
    if word.eq_ignore_ascii_case(b"OFF") {
        return Some((b"", b""));
    }
    let start = word.windows(3).position(|three| three == b"OFF")?;
    let (prefix, rest) = (&word[..start], &word[start + 3..]);
    let is_known = prefix.iter().all(|b| b"STCN4n".contains(b)) && rest.iter().all(u8::is_ascii_digit);
    is_known.then_some((prefix, rest))
}

fn header(words: &mut Words) -> Result<Header> {
    let mut first = words.anywhere();
    let mut further = Further::default();
    if let Some((prefix, rest)) = first.and_then(keyword) {
        check_dimensions(words, prefix)?;
        further = Further::of_prefix(prefix);
        first = if rest.is_empty() { words.anywhere() } else { Some(rest) };
    }
    if first == Some(&b"BINARY"[..]) {
        return Ok(Header { counts: None, further });
    }
    let vertices = count(words, first, "vertices", VERTEX_BYTES)?;
    let second = words.anywhere();
    let faces = count(words, second, "faces", FACE_BYTES.1)?;
    words.next_line();
    Ok(Header { counts: Some((vertices, faces)), further })
}

fn check_dimensions(words: &Words, prefix: &[u8]) -> Result<()> {
    if prefix.contains(&b'4') || prefix.contains(&b'n') {
        let cause = "only three-dimensional OFF is supported";
        return Err(words.error(cause, "export the file as plain OFF, or as PLY or OBJ"));
    }
    Ok(())
}

fn count(words: &Words, word: Option<&[u8]>, what: &str, bytes_each: usize) -> Result<usize> {
    let Some(word) = word else { return Err(words.mistake(format!("the number of {what} is missing"))) };
    let Some(count) = whole(word) else {
        return Err(words.mistake(format!("{} is not a number of {what}", quote(word))));
    };
    let left = words.remaining();
    if count > (left + 1) / bytes_each {
        return Err(words.mistake(format!("the file declares {count} {what}, but only {left} bytes follow")));
    }
    Ok(count)
}

fn read_vertices(words: &mut Words, count: usize, further: Further) -> Result<(Vec<DVec3>, Columns)> {
    let mut positions = Vec::with_capacity(count);
    let mut columns = Columns::default();
    for found in 0..count {
        let Some(word) = words.anywhere() else {
            return Err(words.mistake(format!("the file ends after {found} of {count} vertices")));
        };
        let x = words.finite(word)?;
        let mut next = || words.coordinate(Words::anywhere);
        positions.push(DVec3::new(x, next()?, next()?));
        if !further.is_nothing() {
            columns.read_line(words, MOST_COLUMNS);
        }
        words.next_line();
    }
    Ok((positions, columns))
}

fn read_faces(words: &mut Words, count: usize, vertices: usize) -> Result<Faces> {
    let mut faces = Faces::with_capacity(count.min(words.remaining() / FACE_BYTES.0));
    for found in 0..count {
        let Some(word) = words.anywhere() else {
            return Err(words.mistake(format!("the file ends after {found} of {count} faces")));
        };
        let Some(corners) = whole(word) else {
            return Err(words.mistake(format!("{} is not a number of corners", quote(word))));
        };
        for _ in 0..corners {
            faces.push_corner(corner(words, vertices)?);
        }
        faces.end();
        words.next_line();
    }
    Ok(faces)
}

fn corner(words: &mut Words, vertices: usize) -> Result<u32> {
    let Some(word) = words.anywhere() else { return Err(words.mistake("the file ends within a face")) };
    let index = whole(word).filter(|&v| v < vertices).and_then(|v| u32::try_from(v).ok());
    index.ok_or_else(|| {
        let cause = format!("a face uses vertex {}, but vertices go from 0 to {}", quote(word), vertices as i64 - 1);
        words.mistake(cause)
    })
}

#[cfg(test)]
mod tests;
