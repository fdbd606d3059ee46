//! Helpers shared by the readers and writers of several formats: numbers in bytes, and errors that do not name the file yet.

use crate::base::error::{Error, Place, Result};
use glam::DVec3;
use std::io;

/// Remedy for a file that ends too early.
pub(super) const CUT_SHORT: &str = "the file seems to be cut short: copy or export it again";
/// Remedy for a malformed line.
pub(super) const CORRECT_LINE: &str = "correct that line or export the file again";
/// Remedy for a file that contradicts itself.
pub(super) const EXPORT_AGAIN: &str = "export it again, or repair it with the program that made it";
/// Remedy for a file that holds only curves.
pub(super) const NO_LINES: &str = "export the faces of a surface, or its points without the lines between them";

/// Cause and remedy for a file that another program truncates while it is read.
pub(super) const BECAME_SHORTER: &str = "the file became shorter while it was being read";
pub(super) const LEAVE_IT: &str = "let no other program write to it meanwhile";

/// Returns the error for content that violates its format. The name of the file is filled in later.
pub(super) fn malformed(place: Place, cause: impl Into<String>, remedy: &str) -> Error {
    Error::Format { file: String::new(), place, cause: cause.into(), remedy: remedy.into() }
}

/// Returns `p`, or the error at `place` if one of its coordinates is not finite.
pub(super) fn finite(p: DVec3, place: impl FnOnce() -> Place) -> Result<DVec3> {
    if p.is_finite() {
        return Ok(p);
    }
    let cause = format!("the position ({}, {}, {}) is not finite", p.x, p.y, p.z);
    Err(malformed(place(), cause, "replace or remove this vertex"))
}

/// Returns the error for point number `point` whose coordinates are not finite.
pub(super) fn nowhere(point: usize) -> Error {
    malformed(Place::Part(format!("point {point}")), "a coordinate is not finite", EXPORT_AGAIN)
}

/// Rounds a position to single precision, for formats that have nothing better.
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

/// Maximum number of unpacked bytes per packed byte. Meshes need three to twenty; more is an attempt to exhaust memory.
const MOST_PER_BYTE: usize = 256;

/// Size that any file may unpack to.
const FEW: usize = 1 << 20;

/// Returns the maximum size, in bytes, that a file of `packed` bytes may unpack to before it is refused.
pub(super) fn most_unpacked(packed: usize) -> usize {
    packed.saturating_mul(MOST_PER_BYTE).max(FEW)
}

/// Returns the error for a file that would exhaust memory.
pub(super) fn unpacks_to_too_much(remedy: &str) -> Error {
    malformed(Place::Whole, format!("it unpacks to more than {MOST_PER_BYTE} times its size"), remedy)
}

/// Returns the `N` bytes from `at` on, if there are that many.
#[inline]
pub(super) fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

/// Returns the little-endian `u32` at `at`.
pub(super) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    array(bytes, at).map(u32::from_le_bytes)
}

/// Returns the bytes without a leading UTF-8 byte order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

#[cfg(test)]
pub(super) mod samples {
    use crate::base::error::{Error, Place, Result};
    use crate::mesh::triangle_mesh::Mesh;
    pub use crate::testing::tetrahedron;

    /// Six times the enclosed volume: positive if the faces of a closed mesh are oriented outwards.
    pub fn signed_volume(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum()
    }

    /// Returns the place and the cause of a format error.
    #[track_caller]
    pub fn fault<T>(read: Result<T>) -> (Place, String) {
        match read {
            Err(Error::Format { place, cause, .. }) => (place, cause),
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("the file can be read"),
        }
    }

    /// Asserts that reading failed on this line, with a cause that contains these words.
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
