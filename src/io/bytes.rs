//! What the readers and writers of several formats share: words of a text, numbers in bytes, errors without a file.

use crate::base::error::{Error, Place, Result};
use glam::DVec3;
use std::io;

/// What to do about a file that ends too early.
pub(super) const CUT_SHORT: &str = "the file seems to be cut short: copy or export it again";
/// What to do about a file that contradicts itself.
pub(super) const EXPORT_AGAIN: &str = "export it again, or repair it with the program that made it";

/// The error for content that is not what the format says; the name of the file is filled in later.
pub(super) fn malformed(place: Place, cause: impl Into<String>, remedy: &str) -> Error {
    Error::Format { file: String::new(), place, cause: cause.into(), remedy: remedy.into() }
}

/// `p`, or the error at `place` if one of its coordinates is not a finite number.
pub(super) fn finite(p: DVec3, place: impl FnOnce() -> Place) -> Result<DVec3> {
    if p.is_finite() {
        return Ok(p);
    }
    let cause = format!("the position ({}, {}, {}) is not finite", p.x, p.y, p.z);
    Err(malformed(place(), cause, "replace or remove this vertex"))
}

/// A position in single precision, for the formats that have nothing better.
///
/// # Errors
/// `InvalidData` if a coordinate is beyond the range of `f32`.
pub(super) fn narrow(p: DVec3) -> io::Result<[f32; 3]> {
    let narrow = p.as_vec3();
    if narrow.is_finite() {
        return Ok(narrow.to_array());
    }
    let cause =
        format!("the position ({}, {}, {}) is beyond single precision; write OBJ or PLY instead", p.x, p.y, p.z);
    Err(io::Error::new(io::ErrorKind::InvalidData, cause))
}

/// The first `N` bytes from `at` on, if there are that many.
#[inline]
pub(super) fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

/// The little-endian `u32` at `at`.
pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(u32::from_le_bytes)
}

/// The words of a text between white space, and the line they are on.
#[derive(Clone)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    /// The words of `rest`, which begins on line `line`.
    pub fn new(rest: &'a [u8], line: usize) -> Self {
        Words { rest, line }
    }

    /// The next word. Afterwards, [`Words::line`] is its line.
    #[inline]
    pub fn next(&mut self) -> Option<&'a [u8]> {
        let blank = self.rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(self.rest.len());
        let (space, rest) = self.rest.split_at(blank);
        self.line += space.iter().filter(|&&b| b == b'\n').count();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// Leaves out what is left of this line.
    pub fn skip_line(&mut self) {
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
        self.rest = &self.rest[end..];
    }

    /// The line of the last word, or of the end, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// How many bytes are left.
    pub fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The error that `cause` is wrong on this line.
    pub fn error(&self, cause: impl Into<String>, remedy: &str) -> Error {
        malformed(Place::Line(self.line), cause, remedy)
    }
}

/// The number that a word spells.
#[inline]
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as it can stand in a message: short and printable.
pub(super) fn quote(word: &[u8]) -> String {
    let short = &word[..word.len().min(24)];
    let dots = if short.len() < word.len() { "..." } else { "" };
    format!("'{}{dots}'", short.escape_ascii())
}

/// The bytes after a byte order mark of UTF-8, if there is one.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

#[cfg(test)]
pub(super) mod samples {
    use crate::surface::mesh::Mesh;
    use glam::DVec3;

    /// A tetrahedron whose faces look outwards.
    pub fn tetrahedron() -> Mesh {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        Mesh { positions, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] }
    }

    /// Six times the enclosed volume: positive when the faces of a closed mesh look outwards.
    pub fn signed_volume(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_know_their_line() {
        let mut words = Words::new(b"one  two\r\n\nthree", 1);
        assert_eq!((words.next(), words.line()), (Some(&b"one"[..]), 1));
        assert_eq!((words.next(), words.line()), (Some(&b"two"[..]), 1));
        assert_eq!((words.next(), words.line()), (Some(&b"three"[..]), 3));
        assert_eq!((words.next(), words.remaining()), (None, 0));
    }

    #[test]
    fn a_line_can_be_skipped() {
        let mut words = Words::new(b"solid my part\rfacet", 1);
        words.next();
        words.skip_line();
        assert_eq!(words.next(), Some(&b"facet"[..]));
    }

    #[test]
    fn single_precision_has_a_range() {
        assert_eq!(narrow(DVec3::new(1.0, -2.0, 0.5)).unwrap(), [1.0, -2.0, 0.5]);
        assert_eq!(narrow(DVec3::splat(1e39)).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote(b"a\x00b"), "'a\\x00b'");
        assert_eq!(quote(&[b'x'; 30]), format!("'{}...'", "x".repeat(24)));
    }
}
