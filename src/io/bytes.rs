//! What the readers and writers of several formats share: numbers in bytes, errors without a file.

use crate::base::error::{Error, Place, Result};
use glam::DVec3;
use std::io;

/// What to do about a file that ends too early.
pub(super) const CUT_SHORT: &str = "the file seems to be cut short: copy or export it again";
/// What to do about a line that makes no sense.
pub(super) const CORRECT_LINE: &str = "correct that line or export the file again";
/// What to do about a file that contradicts itself.
pub(super) const EXPORT_AGAIN: &str = "export it again, or repair it with the program that made it";
/// What to do about a file of curves.
pub(super) const NO_LINES: &str = "export the faces of a surface, or its points without the lines between them";

/// What is wrong with a file that another program cuts short meanwhile, and what helps.
pub(super) const BECAME_SHORTER: &str = "it became shorter while it was read";
pub(super) const LEAVE_IT: &str = "let no other program write it meanwhile";

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

/// The error that the point of this number has coordinates that are not finite.
pub(super) fn nowhere(point: usize) -> Error {
    malformed(Place::Part(format!("point {point}")), "a coordinate is not finite", EXPORT_AGAIN)
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

/// How many bytes one packed byte may stand for. Meshes take three to twenty; more is meant to exhaust memory.
const MOST_PER_BYTE: usize = 256;

/// What any file may unpack to.
const FEW: usize = 1 << 20;

/// What a file of this many bytes may unpack to, in bytes, before it is refused.
pub(super) fn most_unpacked(packed: usize) -> usize {
    packed.saturating_mul(MOST_PER_BYTE).max(FEW)
}

/// The error that a file would fill the memory.
pub(super) fn unpacks_to_too_much(remedy: &str) -> Error {
    malformed(Place::Whole, format!("it unpacks to more than {MOST_PER_BYTE} times its size"), remedy)
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

/// The bytes after a byte order mark of UTF-8, if there is one.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

#[cfg(test)]
pub(super) mod samples {
    use crate::base::error::{Error, Place, Result};
    use crate::mesh::triangle_mesh::Mesh;
    pub use crate::testing::tetrahedron;

    /// Six times the enclosed volume: positive when the faces of a closed mesh look outwards.
    pub fn signed_volume(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum()
    }

    /// Where, and why, a file is not of its format.
    #[track_caller]
    pub fn fault<T>(read: Result<T>) -> (Place, String) {
        match read {
            Err(Error::Format { place, cause, .. }) => (place, cause),
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("the file can be read"),
        }
    }

    /// Holds a file to be wrong in this line, for a cause with these words.
    #[track_caller]
    pub fn fails_at<T>(read: Result<T>, line: usize, words: &str) {
        let (place, cause) = fault(read);
        assert_eq!(place, Place::Line(line), "{cause}");
        assert!(cause.contains(words), "{cause}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_has_a_range() {
        assert_eq!(narrow(DVec3::new(1.0, -2.0, 0.5)).unwrap(), [1.0, -2.0, 0.5]);
        assert_eq!(narrow(DVec3::splat(1e39)).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
