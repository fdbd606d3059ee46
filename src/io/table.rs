//! Points as rows of bytes, which can be read without reading all of the file.

use crate::base::error::{Error, Result};
use crate::io::bytes::nowhere;
use crate::io::content::Parsed;
use crate::prepare::thin::Seen;
use std::fs::File;

/// The points of a file that are, or become, rows of equally many bytes.
pub(crate) struct Table {
    /// Where they begin in the file, in bytes.
    pub start: u64,
    /// The bytes of each.
    pub row: usize,
    /// How many there are; at most, where they are packed.
    pub points: usize,
    /// What a format knows of them.
    pub rows: Box<dyn Rows>,
    /// How the rows are made of what the file has, if it does not have them.
    pub packed: Option<Box<dyn Packed>>,
}

/// Rows that the file has in another form.
pub(crate) trait Packed: Sync {
    /// How many rows there are at most, if only the file tells.
    ///
    /// # Errors
    /// [`Error::Format`] if it cannot be read.
    fn count(&self, _: &File) -> Result<Option<usize>> {
        Ok(None)
    }

    /// Shows all rows of the file, in their order.
    ///
    /// # Errors
    /// Those of `show`; an error with the place of what is damaged.
    fn unpack(&self, file: &File, show: &mut dyn FnMut(&[u8]) -> Result<()>) -> Result<()>;
}

/// The faces of a file, which are rows of different lengths.
pub(crate) struct Faces {
    /// Where they begin, in bytes.
    pub start: u64,
    /// How many there are.
    pub count: u64,
    /// Whether they have more than corners, such as texture coordinates.
    pub have_more: bool,
    /// What a format knows of them.
    pub rows: Box<dyn FaceRows>,
}

/// What a format knows of its faces.
pub(crate) trait FaceRows: Sync {
    /// Shows the corners of the complete faces at the start of `bytes`, `most` of them at most. Returns how many faces and bytes
    /// these were. `at` is where the bytes are in the file.
    ///
    /// # Errors
    /// Those of `show`; an error with the place of an index that no vertex has, or of a list that is longer than the file.
    fn show(
        &self,
        bytes: &[u8],
        most: u64,
        at: u64,
        show: &mut dyn FnMut(&[u32]) -> Result<()>,
    ) -> Result<(u64, usize)>;

    /// The error that the file ends at this byte.
    fn cut_short(&self, end: u64) -> Error;
}

/// What a format knows of its points.
pub(crate) trait Rows: Sync {
    /// Where the point of this row is, and its normal.
    fn look(&self, row: &[u8]) -> Seen;

    /// The error that the point of this number and row has coordinates that are not finite.
    fn nowhere(&self, point: usize, _row: &[u8]) -> Error {
        nowhere(point)
    }

    /// Reads points as if they were all of the file.
    fn read(&self, rows: &[u8]) -> Parsed;
}
