//! STL, ASCII and binary.
//!
//! A file is a list of facets, each with three corners of its own. The normals are not used; the order of the corners
//! defines the outside. Many binary files begin with `solid` as ASCII files do: a file is taken as binary if its size is
//! exactly what its facet count requires, or if it has a zero byte near its beginning.
//!
//! Limits: colours and the attribute bytes of binary facets are left out; several solids become one mesh.

use super::bytes::{CUT_SHORT, EXPORT_AGAIN, array, finite, malformed, narrow, u32_at, without_mark};
use super::text::{Words, number, quote};
use crate::base::error::{Error, Place, Result};
use crate::io::content::{Content, Parsed, Read};
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::weld::weld;
use glam::{DVec3, Vec3};
use std::io::{self, Write};

/// Size of 80 arbitrary bytes and the number of facets.
pub(super) const HEADER: usize = 84;
/// Size of a normal, three corners and two attribute bytes.
pub(super) const FACET: usize = 50;
/// U+FFFD in UTF-8, which stands for what is no text, and the maximum number of bytes for each of them in a binary file that was
/// copied as text. In other files there is one in sixteen million bytes.
const REPLACEMENT: &[u8] = "\u{fffd}".as_bytes();
const BYTES_PER_REPLACEMENT: usize = 100;
/// Number of leading bytes that are searched for a zero byte. They include the facet count, whose high byte is zero in all
/// files below 800 MB.
const PROBE: usize = 512;

/// Reads the mesh in an STL file. Corners of facets at exactly the same position are merged to one vertex.
///
/// # Errors
/// `Error::Format` with the line or byte that is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let read = if is_text(bytes) { parse_text(bytes) } else { parse_binary(bytes) }?;
    Ok(Read { mesh: weld(&read.mesh), ..read })
}

fn is_text(bytes: &[u8]) -> bool {
    let solid = without_mark(bytes).trim_ascii_start().get(..5).is_some_and(|word| is(word, "solid"));
    solid && !has_exact_size(bytes) && !bytes[..bytes.len().min(PROBE)].contains(&0)
}

fn has_exact_size(bytes: &[u8]) -> bool {
    u32_at(bytes, HEADER - 4).is_some_and(|count| HEADER as u64 + FACET as u64 * u64::from(count) == bytes.len() as u64)
}

/// Returns whether many bytes that are no text were replaced.
fn was_copied_as_text(bytes: &[u8]) -> bool {
    let replaced = bytes.windows(REPLACEMENT.len()).filter(|window| *window == REPLACEMENT).count();
    BYTES_PER_REPLACEMENT * replaced > bytes.len()
}

fn parse_binary(bytes: &[u8]) -> Parsed {
    let end = Place::Byte(bytes.len());
    let Some(count) = u32_at(bytes, HEADER - 4) else {
        let cause = "neither an ASCII STL file (no 'solid') nor long enough for the header of a binary one";
        return Err(malformed(end, cause, "check that this is a complete STL file"));
    };
    if !has_exact_size(bytes) && was_copied_as_text(bytes) {
        let cause = "the binary file was copied as if it were text, which replaced many of its bytes";
        return Err(malformed(Place::Whole, cause, "copy the original again as binary data"));
    }
    let whole = (bytes.len() - HEADER) / FACET;
    let count = count as usize;
    if count > whole {
        let cause = format!("the header declares {count} facets, but the file ends after {whole}");
        return Err(malformed(end, cause, CUT_SHORT));
    }
    let mut mesh = Mesh::default();
    mesh.positions.reserve_exact(3 * count);
    for i in 0..count {
        let at = HEADER + i * FACET;
        mesh.positions.extend(corners(&bytes[at..at + FACET], at)?.map(Vec3::as_dvec3));
    }
    number_corners(&mut mesh)?;
    let extra = bytes.len() - HEADER - count * FACET;
    let notes = (extra > 0).then(|| format!("{extra} bytes after the last of {count} facets are left out"));
    Ok(Read { mesh, notes: notes.into_iter().collect(), ..Read::default() })
}

/// Returns the number of facets in a file of this length that begins with `head`, if it is binary and has exactly this size.
#[cfg(feature = "fs")]
pub(super) fn facets(head: &[u8], length: u64) -> Option<usize> {
    let count = u32_at(head, HEADER - 4)?;
    (HEADER as u64 + FACET as u64 * u64::from(count) == length).then_some(count as usize)
}

/// Reads the corners of a facet, which is at byte `at` of the file.
pub(super) fn corners(facet: &[u8], at: usize) -> Result<[Vec3; 3]> {
    let mut corners = [Vec3::ZERO; 3];
    for (corner, start) in corners.iter_mut().zip([12, 24, 36]) {
        let coordinate = |k: usize| array(facet, start + 4 * k).map_or(f32::NAN, f32::from_le_bytes);
        *corner = Vec3::new(coordinate(0), coordinate(1), coordinate(2));
        finite(corner.as_dvec3(), || Place::Byte(at + start))?;
    }
    Ok(corners)
}

/// Makes a triangle of every three vertices.
fn number_corners(mesh: &mut Mesh) -> Result<()> {
    let Ok(count) = u32::try_from(mesh.positions.len()) else {
        return Err(malformed(Place::Whole, "more than 4 294 967 295 vertices", "split the file"));
    };
    mesh.triangles = (0..count / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Ok(())
}

fn parse_text(bytes: &[u8]) -> Parsed {
    let mut words = Words::new(bytes);
    let mut mesh = Mesh::default();
    let mut open = false;
    let mut last_facet = 0;
    while let Some(word) = words.anywhere() {
        if is(word, "solid") || is(word, "endsolid") {
            open = is(word, "solid");
            words.next_line();
        } else if open && is(word, "facet") {
            push_text(&mut mesh, &mut words)?;
            last_facet = words.line();
        } else if words.line() != last_facet {
            let wanted = if open { "'facet' or 'endsolid'" } else { "'solid'" };
            return Err(unexpected(&words, wanted, Some(word)));
        }
    }
    if open && mesh.positions.is_empty() {
        return Err(unexpected(&words, "'facet' or 'endsolid'", None));
    }
    number_corners(&mut mesh)?;
    let notes = open.then(|| {
        format!("the file ends after {} whole facets without 'endsolid': it may be cut short", mesh.triangles.len())
    });
    Ok(Read { mesh, notes: notes.into_iter().collect(), ..Read::default() })
}

/// Adds the corners of a facet, from after `facet` to its `endfacet`. Further words on the line of an ending keyword are
/// ignored.
fn push_text(mesh: &mut Mesh, words: &mut Words) -> Result<()> {
    skip_normal(words)?;
    expect(words, "loop")?;
    for _ in 0..3 {
        expect(words, "vertex")?;
        let mut p = DVec3::ZERO;
        for k in 0..3 {
            let word = words.anywhere();
            p[k] = word.and_then(number).ok_or_else(|| unexpected(words, "a coordinate", word))?;
        }
        mesh.positions.push(finite(p, || Place::Line(words.line()))?);
    }
    expect(words, "endloop")?;
    while let Some(word) = words.here() {
        if is(word, "endfacet") {
            return Ok(());
        }
    }
    expect(words, "endfacet")
}

/// Skips a normal. It is not used, so it may be anything: some writers put `nan` there, or nothing.
fn skip_normal(words: &mut Words) -> Result<()> {
    for _ in 0..5 {
        match words.anywhere() {
            Some(word) if is(word, "outer") => return Ok(()),
            Some(_) => {}
            None => break,
        }
    }
    Err(unexpected(words, "'outer loop'", None))
}

fn expect(words: &mut Words, keyword: &str) -> Result<()> {
    match words.anywhere() {
        Some(word) if is(word, keyword) => Ok(()),
        other => Err(unexpected(words, &format!("'{keyword}'"), other)),
    }
}

fn unexpected(words: &Words, wanted: &str, found: Option<&[u8]>) -> Error {
    match found {
        Some(word) => words.error(format!("{wanted} expected, {} found", quote(word)), EXPORT_AGAIN),
        None if words.remaining() == 0 => words.error(format!("the file ends where {wanted} should be"), CUT_SHORT),
        None => words.error(format!("{wanted} expected"), EXPORT_AGAIN),
    }
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

/// Writes binary STL, in single precision, with the normals of the triangles.
///
/// # Errors
/// `InvalidData` for coordinates beyond single precision; else errors of `out`.
pub(crate) fn write(content: &Content, out: &mut dyn Write) -> io::Result<()> {
    let Content { positions, triangles, .. } = content;
    // Must not begin with 'solid', or readers take it for ASCII.
    let mut header = [b' '; HEADER - 4];
    let title = b"binary STL by spectral-remesh";
    header[..title.len()].copy_from_slice(title);
    out.write_all(&header)?;
    let count = u32::try_from(triangles.len()).map_err(|_| io::Error::other("too many triangles for STL"))?;
    out.write_all(&count.to_le_bytes())?;
    triangles.iter().try_for_each(|t| out.write_all(&facet(t.map(|v| positions[v as usize]))?))
}

fn facet([a, b, c]: [DVec3; 3]) -> io::Result<[u8; FACET]> {
    let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3().to_array();
    let numbers = [normal, narrow(a)?, narrow(b)?, narrow(c)?];
    let mut facet = [0; FACET];
    for (bytes, number) in facet.chunks_exact_mut(4).zip(numbers.as_flattened()) {
        bytes.copy_from_slice(&number.to_le_bytes());
    }
    Ok(facet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::bytes::samples::{fault, signed_volume, tetrahedron};
    use crate::mesh::attributes::Attributes;

    const ONE: &str = "solid a part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5 0 0\n   \
                       vertex 0 1e0 -2\n  endloop\n endfacet\nendsolid a part\n";

    /// Returns the mesh and the notes.
    fn parse(bytes: &[u8]) -> Result<(Mesh, Vec<String>)> {
        super::parse(bytes).map(|read| (read.mesh, read.notes))
    }

    fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
        let attributes = &Attributes::default();
        super::write(&Content { positions: &mesh.positions, triangles: &mesh.triangles, attributes }, out)
    }

    fn binary() -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&tetrahedron(), &mut bytes).unwrap();
        bytes
    }

    fn place(bytes: &[u8]) -> Place {
        fault(parse(bytes)).0
    }

    #[test]
    fn text_with_one_facet() {
        let (mesh, notes) = parse(ONE.as_bytes()).unwrap();
        assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::new(1.5, 0.0, 0.0), DVec3::new(0.0, 1.0, -2.0)]);
        assert_eq!((mesh.triangles, notes.len()), (vec![[0, 1, 2]], 0));
    }

    #[test]
    fn text_in_capitals_with_other_line_ends_and_a_mark() {
        let text = format!("\u{feff}{}", ONE.to_uppercase().replace('\n', "\r\n"));
        assert_eq!(parse(text.as_bytes()).unwrap(), parse(ONE.as_bytes()).unwrap());
        let text = ONE.replace('\n', "\r");
        assert_eq!(parse(text.as_bytes()).unwrap(), parse(ONE.as_bytes()).unwrap());
    }

    #[test]
    fn several_solids_and_names_that_are_not_text() {
        let mut bytes = format!("{ONE}\n{ONE}").into_bytes();
        bytes[8] = 0xe4;
        let (mesh, _) = parse(&bytes).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2]; 2]);
    }

    #[test]
    fn normals_may_be_anything() {
        for normal in ["normal nan nan nan", "normal", ""] {
            let text = ONE.replace("normal 0 0 1", normal);
            assert_eq!(parse(text.as_bytes()).unwrap(), parse(ONE.as_bytes()).unwrap());
        }
    }

    #[test]
    fn facets_without_area_stay() {
        let text = ONE.replace("vertex 1.5 0 0", "vertex 0 0 0");
        assert_eq!(parse(text.as_bytes()).unwrap().0.triangles.len(), 1);
    }

    #[test]
    fn malformed_text_has_a_line() {
        assert_eq!(place(ONE.replace("1.5", "1,5").as_bytes()), Place::Line(5));
        assert_eq!(place(ONE.replace("1.5", "nan").as_bytes()), Place::Line(5));
        assert_eq!(place(ONE.replace("1.5", "inf").as_bytes()), Place::Line(5));
        assert_eq!(place(ONE.replace("endloop", "vertex 0 0 7").as_bytes()), Place::Line(7));
        assert_eq!(place(ONE.replace("vertex 0 0 0\n", "\n").as_bytes()), Place::Line(7));
        assert_eq!(place(ONE.replace("outer", "inner").as_bytes()), Place::Line(3));
        assert_eq!(place(format!("{ONE}what").as_bytes()), Place::Line(10));
    }

    #[test]
    fn text_cut_within_a_facet_is_an_error_and_after_it_is_told() {
        let [whole, closed] = ["endfacet", "endsolid"].map(|word| ONE.find(word).unwrap() + word.len());
        for end in 0..ONE.len() {
            let read = parse(&ONE.as_bytes()[..end]);
            let last_word_is_cut = end > whole + 1 && end < closed;
            assert_eq!(read.is_ok(), end >= whole && !last_word_is_cut, "{end}");
            assert!(read.is_err() || (end < closed) == (read.unwrap().1.len() == 1), "{end}");
        }
    }

    #[test]
    fn more_on_lines_that_end_something_is_left_out() {
        let text = ONE.replace("endloop", "endloop foo").replace("endfacet", "endfacet a bar").repeat(2);
        assert_eq!(parse(text.as_bytes()).unwrap(), parse(ONE.repeat(2).as_bytes()).unwrap());
        let on_one_line = ONE.replacen('\n', "\r", 1).replace('\n', " ");
        assert_eq!(parse(on_one_line.as_bytes()).unwrap().0, parse(ONE.as_bytes()).unwrap().0);
    }

    #[test]
    fn binary_round_trip() {
        let (mesh, notes) = parse(&binary()).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len(), notes.len()), (4, 4, 0));
        assert_eq!(signed_volume(&mesh), signed_volume(&tetrahedron()));
    }

    #[test]
    fn normals_are_written() {
        let bytes = binary();
        assert_eq!(&bytes[HEADER..HEADER + 12], [0.0f32, 0.0, -1.0].map(f32::to_le_bytes).as_flattened());
    }

    #[test]
    fn binary_that_begins_with_solid() {
        let mut bytes = binary();
        bytes[..6].copy_from_slice(b"solid ");
        assert_eq!(parse(&bytes).unwrap(), parse(&binary()).unwrap());
        bytes.push(b'\n');
        assert_eq!(parse(&bytes).unwrap().0, parse(&binary()).unwrap().0);
        bytes.truncate(HEADER + 3 * FACET);
        assert_eq!(place(&bytes), Place::Byte(HEADER + 3 * FACET));
    }

    #[test]
    fn binary_cut_anywhere_is_an_error() {
        let bytes = binary();
        for end in 0..bytes.len() {
            assert_eq!(place(&bytes[..end]), Place::Byte(end));
        }
    }

    #[test]
    fn more_bytes_than_facets_are_noted() {
        let mut bytes = binary();
        bytes.extend([0; 7]);
        let (mesh, notes) = parse(&bytes).unwrap();
        assert_eq!(mesh.triangles.len(), 4);
        assert_eq!(notes, ["7 bytes after the last of 4 facets are left out"]);
    }

    #[test]
    fn a_file_that_was_copied_as_text_is_refused() {
        let copied = String::from_utf8_lossy(&binary()).into_owned();
        let (place, cause) = fault(parse(copied.as_bytes()));
        assert!(place == Place::Whole && cause.contains("copied as if it were text"), "{cause}");
    }

    #[test]
    fn a_header_that_lies() {
        let mut bytes = binary();
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(place(&bytes), Place::Byte(bytes.len()));
    }

    #[test]
    fn binary_coordinates_must_be_finite() {
        let mut bytes = binary();
        let at = HEADER + FACET + 24;
        bytes[at + 4..at + 8].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(place(&bytes), Place::Byte(at));
    }

    #[test]
    fn coordinates_beyond_single_precision_are_not_written() {
        let mut mesh = tetrahedron();
        mesh.positions[1].x = 1e200;
        assert_eq!(write(&mesh, &mut Vec::new()).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
