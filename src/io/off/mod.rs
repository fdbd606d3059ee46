//! OFF, the Object File Format of Geomview: vertices and polygons in text.
//!
//! The keyword is `OFF` with any of the prefixes `ST`, `C` and `N`, or missing. They announce that normals, colours and
//! texture coordinates follow the position of each vertex, in this order; what else follows it, and colours of faces, are
//! skipped up to the end of the line. The number of vertices and of faces must be on one line with or without the
//! keyword; the number of edges is not read. The word `BINARY` behind the keyword announces the same in numbers of four
//! bytes, the most significant first; colours of vertices have four components there, and those of faces a count of
//! their own. Not supported: the forms with other dimensions (`4OFF`, `nOFF`).
//!
//! Cost: one pass; what a header promises is held against the length of the file before memory is reserved.

mod binary;

use crate::base::error::Result;
use crate::io::columns::{Columns, color, cut, normal};
use crate::io::content::{Content, Parsed, Read};
use crate::io::faces::Faces;
use crate::io::text::{Words, quote, small_faces, whole, write_line};
use crate::mesh::attributes::Attributes;
use crate::mesh::triangle_mesh::Mesh;
use glam::{DVec2, DVec3};
use std::io::{self, Write};

/// The shortest vertex is `0 0 0` and an end of line.
const VERTEX_BYTES: usize = 6;

/// The shortest face with an area is `3 0 1 2` and an end of line; without one it is `0` and an end of line.
const FACE_BYTES: (usize, usize) = (8, 2);

/// Numbers of a vertex behind its position: a normal, a colour with opacity, texture coordinates.
const MOST_COLUMNS: usize = 3 + 4 + 2;

/// What a file says before its first vertex.
struct Header {
    /// The numbers of vertices and of faces; none in text if the file is binary.
    counts: Option<(usize, usize)>,
    further: Further,
}

/// What follows the position of each vertex.
#[derive(Clone, Copy, Default)]
struct Further {
    normals: bool,
    colors: bool,
    texture: bool,
}

pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut words = Words::new(bytes).with_comments();
    let Header { counts, further } = header(&mut words)?;
    let Some((vertices, faces)) = counts else {
        words.next_line();
        return binary::parse(bytes, bytes.len() - words.remaining(), further);
    };
    let (positions, columns) = read_vertices(&mut words, vertices, further)?;
    let faces = read_faces(&mut words, faces, vertices)?;
    let triangles = faces.triangles(&positions);
    let mut notes = Vec::new();
    small_faces(&mut notes, faces.dropped);
    if words.anywhere().is_some() {
        notes.push(format!("what follows the last face, from line {} on, is left out", words.line()));
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

impl Further {
    fn of_prefix(prefix: &[u8]) -> Further {
        let has = |word: &[u8]| prefix.windows(word.len()).any(|w| w == word);
        Further { normals: has(b"N"), colors: has(b"C"), texture: has(b"ST") }
    }

    /// The numbers of a vertex behind its position in a binary file.
    fn width(self) -> usize {
        3 * usize::from(self.normals) + 4 * usize::from(self.colors) + 2 * usize::from(self.texture)
    }

    fn is_nothing(self) -> bool {
        !(self.normals || self.colors || self.texture)
    }

    /// What the numbers of vertices are; a note if they are not what the keyword announces.
    fn attributes(self, columns: Columns, triangles: &[[u32; 3]], notes: &mut Vec<String>) -> Attributes {
        let (values, width) = columns.into_table();
        self.attributes_of(values, width, triangles, notes)
    }

    /// What `values` are, `width` for each vertex.
    fn attributes_of(
        self,
        values: Vec<f64>,
        width: usize,
        triangles: &[[u32; 3]],
        notes: &mut Vec<String>,
    ) -> Attributes {
        let normals = if self.normals { 3 } else { 0 };
        let texture = if self.texture { 2 } else { 0 };
        let colors = width.saturating_sub(normals + texture);
        let as_announced = if self.colors { matches!(colors, 3 | 4) } else { width == normals + texture };
        let mut attributes = Attributes::default();
        if self.is_nothing() || values.is_empty() || !as_announced {
            if !self.is_nothing() && !triangles.is_empty() {
                notes.push("normals, colours and texture coordinates are left out: not as the keyword says".into());
            }
            return attributes;
        }
        if self.normals {
            attributes.vertex.push(normal(cut(&values, width, 0, 3)));
        }
        if self.colors {
            attributes.vertex.extend(color(cut(&values, width, normals, normals + colors), colors));
        }
        if self.texture {
            let row = |v: u32| &values[v as usize * width + width - 2..][..2];
            attributes.texture = triangles.iter().map(|t| t.map(|v| DVec2::from_slice(row(v)))).collect();
        }
        attributes
    }
}

/// Whether a file starts with the keyword of this format.
pub(crate) fn has_keyword(bytes: &[u8]) -> bool {
    Words::new(bytes).with_comments().anywhere().is_some_and(|word| keyword(word).is_some())
}

/// The prefixes of the keyword that a word starts with, and what follows the keyword in the same word: `OFF8 6 12`, a
/// keyword and a count run together, is found in some collections.
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
        let cause = "OFF with other than three dimensions is not supported";
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
        return Err(words.mistake(format!("the file promises {count} {what}, but only {left} bytes follow")));
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
mod tests {
    use super::*;
    use crate::io::bytes::samples;

    fn mesh(text: &str) -> Mesh {
        parse(text.as_bytes()).unwrap().mesh
    }

    #[track_caller]
    fn fails_at(text: &str, line: usize, words: &str) {
        samples::fails_at(parse(text.as_bytes()), line, words);
    }

    fn right_angle() -> Mesh {
        Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] }
    }

    #[test]
    fn headers_in_all_forms() {
        for header in ["OFF\n3 1 3", "OFF 3 1 3", "# a\nOFF # b\n\n# c\r\n3 1 0", "off\n3 1", "3 1 0", "OFF3 1 0"] {
            assert_eq!(mesh(&format!("{header}\n0 0 0\n1 0 0\n# d\n\n0 1 0\n3 0 1 2")), right_angle(), "{header}");
        }
    }

    #[test]
    fn further_values_are_skipped() {
        for header in ["COFF", "NOFF", "STOFF", "CNOFF", "NCOFF", "STCNOFF", "OFF"] {
            let text = format!("{header}\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 nan 1 2 3\n0 1 0 7\n3 0 1 2 0.5 0.5 0.5\n");
            assert_eq!(mesh(&text), right_angle(), "{header}");
        }
    }

    #[test]
    fn polygons_points_and_faces_without_area() {
        let m = mesh("OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3 255 0 0\n3 0 1 4\n");
        assert_eq!(m.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
        assert_eq!(mesh("OFF\n1 0 0\n0 0 0\n").positions.len(), 1);
        let Read { mesh: m, notes, .. } = parse(b"OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n0\n3 0 1 2\nmore").unwrap();
        assert_eq!(m, right_angle());
        assert_eq!(
            notes,
            [
                "2 faces with fewer than three corners are left out",
                "what follows the last face, from line 9 on, is left out",
            ]
        );
    }

    #[test]
    fn errors_name_the_line() {
        fails_at("4OFF\n3 1 0\n", 1, "dimensions");
        fails_at("nOFF\n3\n3 1 0\n", 1, "dimensions");
        fails_at("C4OFF\n3 1 0\n", 1, "dimensions");
        fails_at("OFF\n", 1, "number of vertices is missing");
        fails_at("OFF\n0", 2, "number of faces is missing");
        fails_at("ply\n", 1, "'ply' is not a number of vertices");
        fails_at("OFF\n999999999999 1 0\n0 0 0\n", 2, "promises 999999999999 vertices, but only");
        fails_at("OFF\n1 888888888 0\n0 0 0\n", 2, "promises 888888888 faces");
        fails_at("OFF\n99999999999999999999999 1 0\n0 0 0\n", 2, "not a number of vertices");
        fails_at("OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", 4, "not finite");
        fails_at("OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", 4, "'x' is not a number");
        fails_at("OFF\n3 0 0\n0 0 0\n1 0 0.000000000000\n", 4, "ends after 2 of 3 vertices");
        fails_at("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 6, "ends after 1 of 2 faces");
        fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", 6, "ends within a face");
        fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6, "vertex '3', but vertices go from 0 to 2");
        fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 6, "vertex '-1'");
        fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9999999999 0 1 2\n", 6, "ends within a face");
    }

    #[test]
    fn the_keyword_is_known() {
        assert!(has_keyword(b"# x\n\nCOFF\n1 1 1"));
        assert!(has_keyword(b"4OFF BINARY"));
        assert!(!has_keyword(b"OFFICE 1") && !has_keyword(b"ply\n") && !has_keyword(b"v 1 2 3 OFF"));
    }
}
