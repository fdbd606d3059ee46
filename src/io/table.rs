//! Points as rows of bytes, which can be read without reading the whole file.

use crate::base::error::{Error, Result};
use crate::io::bytes::nowhere;
use crate::io::content::Parsed;
use crate::prepare::thin::{Levels, Seen, Wanted};
use std::fs::File;

/// The points of a file, if they are rows of equal length or can be unpacked to such rows.
pub(crate) struct Table {
    /// Offset of the first point in the file, in bytes.
    pub start: u64,
    /// Size of each point, in bytes.
    pub row: usize,
    /// Number of points; an upper bound if they are packed.
    pub points: usize,
    /// Interprets the rows for a format.
    pub rows: Box<dyn Rows>,
    /// Unpacks the rows, if the file does not contain them as they are.
    pub packed: Option<Box<dyn Packed>>,
}

/// Rows that a file contains in another form.
pub(crate) trait Packed: Sync {
    /// Returns the maximum number of rows, if only the file tells.
    ///
    /// # Errors
    /// [`Error::Format`] if it cannot be read.
    fn count(&self, _: &File) -> Result<Option<usize>> {
        Ok(None)
    }

    /// Passes all rows of the file to `show`, in their order.
    ///
    /// # Errors
    /// Those of `show`; an error with the place of the damage.
    fn unpack(&self, file: &File, show: &mut dyn FnMut(&[u8]) -> Result<()>) -> Result<()>;

    /// Passes rows with their numbers to `show`, in ascending order, where those of unwanted points may be missing. Returns
    /// the levels of detail by which they were chosen, if there are any.
    ///
    /// # Errors
    /// Those of [`Self::unpack`].
    fn unpack_wanted(
        &self,
        file: &File,
        _: &Wanted,
        show: &mut dyn FnMut(usize, &[u8]) -> Result<()>,
    ) -> Result<Option<Levels>> {
        let mut numbers = 0..;
        self.unpack(file, &mut |row| show(numbers.next().expect("numbers do not end"), row)).map(|()| None)
    }
}

/// The faces of a file, which are rows of different lengths.
pub(crate) struct Faces {
    /// Offset of the first face, in bytes.
    pub start: u64,
    /// Number of faces.
    pub count: u64,
    /// Whether they have properties besides corners, such as texture coordinates.
    pub have_more: bool,
    /// Interprets the rows for a format.
    pub rows: Box<dyn FaceRows>,
}

/// Interpretation of faces by a format.
pub(crate) trait FaceRows: Sync {
    /// Passes the corners of the complete faces at the start of `bytes`, at most `most` faces, to `show`. Returns the number
    /// of these faces and of their bytes. `at` is the offset of `bytes` in the file.
    ///
    /// # Errors
    /// Those of `show`; an error with the place of an invalid vertex index, or of a list that is longer than the file.
    fn show(
        &self,
        bytes: &[u8],
        most: u64,
        at: u64,
        show: &mut dyn FnMut(&[u32]) -> Result<()>,
    ) -> Result<(u64, usize)>;

    /// Returns the error that the file ends at this byte.
    fn cut_short(&self, end: u64) -> Error;
}

/// Interpretation of points by a format.
pub(crate) trait Rows: Sync {
    /// Returns the position and the normal of the point in a row.
    fn look(&self, row: &[u8]) -> Seen;

    /// Returns the error that point number `point`, in this row, has coordinates that are not finite.
    fn nowhere(&self, point: usize, _row: &[u8]) -> Error {
        nowhere(point)
    }

    /// Reads points as if they were the whole file.
    fn read(&self, rows: &[u8]) -> Parsed;
}
