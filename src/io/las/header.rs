//! The header of a LAS file.

use crate::base::error::{Place, Result};
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, array, malformed, u32_at};
use glam::DVec3;

/// First bytes of a file.
pub(crate) const MAGIC: &[u8] = b"LASF";

/// Size of a header of version 1.0, and of one with a 64-bit count, in bytes.
pub(super) const HEADERS: [usize; 2] = [227, 375];

/// For each layout, the size of a point, and the offset of its colour, in bytes.
pub(super) const LAYOUTS: [(usize, Option<usize>); 11] = [
    (20, None),
    (28, None),
    (26, Some(20)),
    (34, Some(28)),
    (57, None),
    (63, Some(28)),
    (30, None),
    (36, Some(30)),
    (38, Some(30)),
    (59, None),
    (67, Some(30)),
];

/// First layout that stores the class in a byte of its own.
pub(super) const WIDE: usize = 6;

/// Bit that is set in the layout number of compressed points.
pub(super) const COMPRESSED: u8 = 0x80;

/// Content of the header.
#[derive(Clone, Copy)]
pub(super) struct Header {
    pub layout: usize,
    pub compressed: bool,
    /// Size of a point, in bytes.
    pub length: usize,
    pub count: usize,
    /// Offset of the first point.
    pub start: usize,
    pub scale: DVec3,
    pub offset: DVec3,
}

/// Reads the header of a file that begins with `bytes`.
pub(super) fn header(bytes: &[u8]) -> Result<Header> {
    let wrong = |at: usize, cause: String| malformed(Place::Byte(at), cause, EXPORT_AGAIN);
    if !bytes.starts_with(MAGIC) || bytes.len() < HEADERS[0] {
        return Err(malformed(Place::Whole, "it does not begin with the header of a LAS file", CUT_SHORT));
    }
    let short = |at: usize| array(bytes, at).map_or(0, u16::from_le_bytes) as usize;
    let number = |at: usize| array(bytes, at).map_or(f64::NAN, f64::from_le_bytes);
    let vector = |at: usize| DVec3::new(number(at), number(at + 8), number(at + 16));
    let layout = (bytes[104] & 0x3F) as usize;
    let Some(&(least, _)) = LAYOUTS.get(layout) else {
        return Err(wrong(104, format!("point format {layout} is not known, only 0 to 10 are")));
    };
    let length = short(105);
    if length < least {
        return Err(wrong(
            105,
            format!("points have {length} bytes, but point format {layout} takes at least {least}"),
        ));
    }
    let (scale, offset) = (vector(131), vector(155));
    if !(scale.is_finite() && offset.is_finite()) {
        return Err(wrong(131, "the scale or the offset of coordinates is not finite".into()));
    }
    let has_long_count = bytes[25] >= 4 && short(94) >= HEADERS[1];
    let long_count = array(bytes, 247).map(u64::from_le_bytes).filter(|_| has_long_count);
    let count = long_count.unwrap_or_else(|| u32_at(bytes, 107).map_or(0, u64::from));
    let count = usize::try_from(count).map_err(|_| wrong(247, format!("{count} points are too many")))?;
    let start = u32_at(bytes, 96).map_or(0, |start| start as usize);
    Ok(Header { layout, compressed: bytes[104] & COMPRESSED != 0, length, count, start, scale, offset })
}
