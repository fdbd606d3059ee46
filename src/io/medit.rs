//! Medit, the format of Medit and libMeshb: `.mesh` in text, `.meshb` in binary.
//!
//! A text file is a list of keywords, most of them followed by a count and that number of lines. A binary file has numbers
//! instead of keywords, each followed by the offset of the next one; its version determines how wide numbers are. Vertices,
//! triangles and quadrilaterals are read, or, if there are no faces, the outer surface of volume cells. Their references and
//! everything else are left out, lines and volumes with a note.
//!
//! The counts in a file are compared with its length before memory is reserved.

use super::bytes::{EXPORT_AGAIN, malformed, u32_at};
use super::cells::Kind;
use super::grid::Grid;
use super::mixed::Mixed;
use super::numbers::{Order, Type, index};
use super::text::{Words, number, quote, whole};
use crate::base::error::{Error, Place, Result};
use crate::io::content::{Parsed, Read};
use glam::DVec3;

/// An entry that is read or counted. [`ENTRIES`] has its keyword, and its number in binary files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Entry {
    Vertices,
    Edges,
    /// Polygons with this number of corners.
    Faces(usize),
    /// Volume cells.
    Cells(Kind),
}

const ENTRIES: [(&str, u32, Entry); 8] = [
    ("vertices", 4, Entry::Vertices),
    ("edges", 5, Entry::Edges),
    ("triangles", 6, Entry::Faces(3)),
    ("quadrilaterals", 7, Entry::Faces(4)),
    ("tetrahedra", 8, Entry::Cells(Kind::Tetrahedron)),
    ("prisms", 9, Entry::Cells(Kind::Prism)),
    ("hexahedra", 10, Entry::Cells(Kind::Hexahedron)),
    ("pyramids", 49, Entry::Cells(Kind::Pyramid)),
];

/// Numbers of further keywords in binary files.
const DIMENSION: u32 = 3;
const END: u32 = 54;

/// Whether a file that starts with these bytes is in this format.
pub(crate) fn has_signature(head: &[u8]) -> bool {
    let first = Words::new(head).with_comments().anywhere();
    binary_order(head).is_some() || first.is_some_and(|word| word.eq_ignore_ascii_case(b"MeshVersionFormatted"))
}

/// Returns the byte order of a binary file, which begins with the number 1, a version from 1 to 4, and the first keyword.
fn binary_order(bytes: &[u8]) -> Option<Order> {
    let number = |at: usize| u32_at(bytes, at);
    let is_sound =
        |one: u32, version: u32, keyword: u32| one == 1 && (1..=4).contains(&version) && keyword == DIMENSION;
    let [one, version, keyword] = [number(0)?, number(4)?, number(8)?];
    if is_sound(one, version, keyword) {
        return Some(Order::Little);
    }
    is_sound(one.swap_bytes(), version.swap_bytes(), keyword.swap_bytes()).then_some(Order::Big)
}

/// Reads the surface in a Medit file.
///
/// # Errors
/// `Error::Format` with the line or byte that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut surface = Surface { dimension: 3, ..Surface::default() };
    match binary_order(bytes) {
        Some(order) => read_binary(bytes, order, &mut surface)?,
        None => read_text(bytes, &mut surface)?,
    }
    surface.finish()
}

/// The content of a file while it is read. Faces may come before vertices.
#[derive(Default)]
struct Surface {
    dimension: usize,
    grid: Grid,
    /// Number of corners and corners of each face, counted from 1.
    corners: Vec<(usize, [f64; 4])>,
    /// Kinds of all volume cells, and their corners, counted from 1.
    cells: Vec<Kind>,
    of_cells: Vec<f64>,
}

impl Surface {
    /// Adds an entry with its numbers, the last of which is its reference.
    fn add(&mut self, entry: Entry, numbers: &[f64]) -> std::result::Result<(), String> {
        match entry {
            Entry::Vertices => {
                let mut position = [0.0; 3];
                position[..self.dimension].copy_from_slice(&numbers[..self.dimension]);
                let position = DVec3::from(position);
                if !position.is_finite() {
                    return Err("a coordinate is not finite".into());
                }
                self.grid.positions.push(position);
            }
            Entry::Faces(count) => {
                let mut corners = [0.0; 4];
                corners[..count].copy_from_slice(&numbers[..count]);
                self.corners.push((count, corners));
            }
            Entry::Cells(kind) => {
                self.cells.push(kind);
                self.of_cells.extend(&numbers[..kind.corners()]);
            }
            Entry::Edges => {}
        }
        Ok(())
    }

    fn finish(mut self) -> Parsed {
        let vertices = self.grid.positions.len();
        let vertex = |what: &str, i: usize, corner: f64| {
            let place = || Place::Part(format!("{what} {i}"));
            let wrong = || format!("it uses vertex {corner}, but vertices go from 1 to {vertices}");
            index(corner - 1.0, vertices).ok_or_else(|| malformed(place(), wrong(), EXPORT_AGAIN))
        };
        for (i, (count, corners)) in self.corners.iter().enumerate() {
            let face: Vec<u32> = corners[..*count].iter().map(|&c| vertex("face", i, c)).collect::<Result<_>>()?;
            self.grid.add_face(face);
        }
        let mut rest = &self.of_cells[..];
        for (i, &kind) in self.cells.iter().enumerate() {
            let (corners, others) = rest.split_at(kind.corners());
            let cell: Vec<u32> = corners.iter().map(|&c| vertex("cell", i, c)).collect::<Result<_>>()?;
            self.grid.cells.push(kind, cell);
            rest = others;
        }
        let (mesh, notes) = self.grid.into_mesh()?;
        Ok(Read { mesh, notes, ..Read::default() })
    }
}

impl Entry {
    /// Returns the number of values per entry, if they are read.
    fn width(self, dimension: usize) -> Option<usize> {
        match self {
            Entry::Vertices => Some(dimension + 1),
            Entry::Faces(corners) => Some(corners + 1),
            Entry::Cells(kind) => Some(kind.corners() + 1),
            Entry::Edges => None,
        }
    }
}

fn check_dimension(dimension: usize) -> std::result::Result<usize, String> {
    if matches!(dimension, 2 | 3) {
        Ok(dimension)
    } else {
        Err(format!("{dimension} dimensions are not supported, only 2 and 3 are"))
    }
}

fn read_text(bytes: &[u8], surface: &mut Surface) -> Result<()> {
    let mut words = Words::new(bytes).with_comments();
    if !has_signature(bytes) {
        let cause = "it does not begin with MeshVersionFormatted";
        return Err(malformed(Place::Line(1), cause, "check that this is a Medit file"));
    }
    while let Some(word) = words.anywhere() {
        let keyword = String::from_utf8_lossy(word).to_ascii_lowercase();
        let entry = ENTRIES.iter().find(|(name, ..)| *name == keyword).map(|(.., entry)| *entry);
        match (keyword.as_str(), entry) {
            ("end", _) => return Ok(()),
            ("dimension", _) => {
                let dimension = count(&mut words)?;
                surface.dimension = check_dimension(dimension).map_err(|cause| words.mistake(cause))?;
            }
            (_, Some(entry)) => read_entries(&mut words, entry, surface)?,
            // Numbers of other keywords are skipped as words here.
            _ => {}
        }
    }
    Ok(())
}

fn count(words: &mut Words) -> Result<usize> {
    let word = words.anywhere();
    let count = word.and_then(whole);
    count.ok_or_else(|| words.mistake(format!("{} is not a count", quote(word.unwrap_or_default()))))
}

fn read_entries(words: &mut Words, entry: Entry, surface: &mut Surface) -> Result<()> {
    let count = count(words)?;
    let Some(width) = entry.width(surface.dimension) else {
        surface.grid.lines = surface.grid.lines.saturating_add(count);
        return Ok(());
    };
    let mut row = [0.0; 9];
    for found in 0..count {
        for number_of_row in &mut row[..width] {
            let word = words.anywhere();
            let Some(word) = word else {
                return Err(words.mistake(format!("the file ends after {found} of {count} entries")));
            };
            let value = number(word);
            *number_of_row = value.ok_or_else(|| words.mistake(format!("{} is not a number", quote(word))))?;
        }
        surface.add(entry, &row[..width]).map_err(|cause| words.mistake(cause))?;
    }
    Ok(())
}

fn read_binary(bytes: &[u8], order: Order, surface: &mut Surface) -> Result<()> {
    let mut source = Mixed::new(bytes);
    source.binary = Some(order);
    source.skip(4);
    let version = source.number(Type::I32)?;
    let real = if version < 2.0 { Type::F32 } else { Type::F64 };
    let position = if version < 3.0 { Type::I32 } else { Type::I64 };
    let integer = if version < 4.0 { Type::I32 } else { Type::I64 };
    loop {
        let keyword = source.number(Type::I32)? as u32;
        if keyword == END {
            return Ok(());
        }
        let next = source.number(position)? as usize;
        if keyword == DIMENSION {
            let dimension = source.number(Type::I32)? as usize;
            surface.dimension = check_dimension(dimension).map_err(|cause| source.wrong(cause))?;
        } else if let Some((.., entry)) = ENTRIES.iter().find(|(_, number, _)| *number == keyword) {
            read_binary_entries(&mut source, *entry, (real, integer), surface)?;
        }
        if next == 0 {
            return Ok(());
        }
        source.go_on_to(next).ok_or_else(|| not_there(&source, next))?;
    }
}

fn not_there(source: &Mixed, next: usize) -> Error {
    source.wrong(format!("byte {next}, where the next keyword should be, is out of range"))
}

fn read_binary_entries(
    source: &mut Mixed,
    entry: Entry,
    (real, integer): (Type, Type),
    surface: &mut Surface,
) -> Result<()> {
    let Some(width) = entry.width(surface.dimension) else {
        let count = source.size(integer, 1)?;
        surface.grid.lines = surface.grid.lines.saturating_add(count);
        return Ok(());
    };
    let kind = if entry == Entry::Vertices { real } else { integer };
    let count = source.size(integer, (width - 1) * kind.size() + integer.size())?;
    let mut row = [0.0; 9];
    for _ in 0..count {
        for number in &mut row[..width - 1] {
            *number = source.number(kind)?;
        }
        source.number(integer)?;
        surface.add(entry, &row[..width]).map_err(|cause| source.wrong(cause))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::bytes::samples::{fails_at, fault};

    const TEXT: &str = "# a\nMeshVersionFormatted 2\nDimension\n3\nTriangles\n1\n1 2 3 7\nVertices\n4\n0 0 0 1\n1 0 0 1\n\
                        1 1 0 1\n0 1 0 1\nQuadrilaterals 1\n1 2 3 4 7\nEdges\n1\n1 2 0\nRidges\n1\n1\nEnd\n";

    fn binary(version: i32) -> Vec<u8> {
        let mut bytes = [1i32, version].map(i32::to_le_bytes).concat();
        let int = |x: i64| if version < 4 { (x as i32).to_le_bytes().to_vec() } else { x.to_le_bytes().to_vec() };
        let real = |x: f64| if version < 2 { (x as f32).to_le_bytes().to_vec() } else { x.to_le_bytes().to_vec() };
        let mut add = |keyword: i32, body: Vec<u8>| {
            let wide = version >= 3;
            let next = bytes.len() + if wide { 12 } else { 8 } + body.len();
            bytes.extend(keyword.to_le_bytes());
            bytes.extend(if wide {
                (next as i64).to_le_bytes().to_vec()
            } else {
                (next as i32).to_le_bytes().to_vec()
            });
            bytes.extend(body);
        };
        add(3, 3i32.to_le_bytes().to_vec());
        let vertex = |[x, y]: [f64; 2]| [real(x), real(y), real(0.0), int(1)].concat();
        let vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(vertex).concat();
        add(4, [int(4), vertices].concat());
        add(14, [int(1), int(1)].concat());
        add(6, [1, 1, 2, 3, 7].map(int).concat());
        add(7, [1, 1, 2, 3, 4, 7].map(int).concat());
        add(5, [1, 1, 2, 0].map(int).concat());
        bytes.extend(54i32.to_le_bytes());
        bytes
    }

    #[test]
    fn all_forms_are_the_same() {
        for bytes in [TEXT.into(), binary(1), binary(2), binary(3), binary(4)] {
            assert!(has_signature(&bytes));
            let read = parse(&bytes).unwrap();
            assert_eq!(read.mesh.positions, [DVec3::ZERO, DVec3::X, DVec3::ONE - DVec3::Z, DVec3::Y]);
            assert_eq!(read.mesh.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
            assert_eq!(read.notes, ["1 line is left out"]);
        }
        for version in 1..5 {
            let bytes = binary(version);
            (0..bytes.len() - 4).for_each(|end| assert!(parse(&bytes[..end]).is_err(), "{end}"));
        }
    }

    #[test]
    fn flat_meshes_are_in_the_plane() {
        let text = "MeshVersionFormatted 1 Dimension 2 Vertices 3 0 0 0 1 0 0 0 1 0 Triangles 1 1 2 3 0 End";
        assert_eq!(parse(text.as_bytes()).unwrap().mesh.positions[2], DVec3::Y);
    }

    #[test]
    fn the_outside_of_a_volume_is_read() {
        let text = "MeshVersionFormatted 2 Dimension 3 Tetrahedra 2 1 2 3 4 0 2 3 4 5 0 \
                    Vertices 5 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0 1 1 1 0 End";
        let Read { mesh, notes, .. } = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles.len(), 6);
        assert_eq!(notes, ["2 cells fill a volume: only its outer surface is used"]);
        let wrong = text.replace("2 3 4 5", "2 3 4 6");
        let (place, cause) = fault(parse(wrong.as_bytes()));
        assert_eq!(
            (place, cause.as_str()),
            (Place::Part("cell 1".into()), "it uses vertex 6, but vertices go from 1 to 5")
        );
    }

    #[test]
    fn errors_have_a_place() {
        for (from, to, line, words) in [
            ("Dimension\n3", "Dimension\n4", 4, "4 dimensions"),
            ("1 1 0 1", "1 x 0 1", 12, "'x' is not a number"),
            ("1 1 0 1", "1 nan 0 1", 12, "not finite"),
            ("Vertices\n4", "Vertices\nx", 9, "'x' is not a count"),
            ("Vertices\n4", "Vertices\n5", 14, "'Quadrilaterals' is not a number"),
            ("MeshVersion", "NoVersion", 1, "does not begin with"),
        ] {
            fails_at(parse(TEXT.replace(from, to).as_bytes()), line, words);
        }
        let (place, cause) = fault(parse(TEXT.replace("1 2 3 7", "1 2 5 7").as_bytes()));
        assert_eq!(
            (place, cause.as_str()),
            (Place::Part("face 0".into()), "it uses vertex 5, but vertices go from 1 to 4")
        );
        let volume = "MeshVersionFormatted 1 Dimension 3 Vertices 1 0 0 0 0 Tetrahedra 5 1 1 1";
        assert!(fault(parse(volume.as_bytes())).1.contains("the file ends after 0 of 5 entries"));
    }
}
