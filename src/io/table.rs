//! Points as rows of bytes, which can be read without reading all of the file.

use crate::base::error::Error;
use crate::io::content::Parsed;
use crate::prepare::thin::Seen;

/// The points of a file that are rows of equally many bytes.
pub(crate) struct Table<'a> {
    /// Where they begin, in bytes.
    pub start: u64,
    /// The bytes of each.
    pub row: usize,
    /// How many there are.
    pub points: usize,
    /// Where a point is, and its normal.
    pub look: Box<dyn Fn(&[u8]) -> Seen + Sync + 'a>,
    /// The error that the point of this number is nowhere.
    pub nowhere: Box<dyn Fn(usize, &[u8]) -> Error + 'a>,
    /// The error that the file ends at this byte.
    pub cut_short: Box<dyn Fn(u64) -> Error + 'a>,
    /// Reads points as if they were all of the file.
    pub read: Box<dyn Fn(&[u8]) -> Parsed + 'a>,
}
