//! Files that are read in blocks.

use crate::base::error::{Error, Result};
use crate::io::bytes::{BECAME_SHORTER, LEAVE_IT};
use crate::io::disk::{file_error, read_error};
use crate::io::format::Format;
use crate::io::named::input_format;
use crate::io::table::Packed;
use crate::prepare::thin::{Levels, Wanted};
use std::fs::{self, File};
use std::io::{ErrorKind, Read as _, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Length of the head of a file, in bytes. It must contain everything before the vertices.
const HEAD: u64 = 1 << 16;

/// A file whose length, head and format are known.
pub(crate) struct Opened {
    path: PathBuf,
    file: File,
    pub format: Format,
    /// Its first bytes.
    pub head: Vec<u8>,
    /// Length, in bytes.
    pub length: u64,
}

impl Opened {
    /// Opens the file at `path`. Returns `None` if it is a pipe, whose first bytes would be lost, or if its format is
    /// unknown.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if there is no such file or it cannot be read.
    pub fn open(path: &Path, format: Option<Format>) -> Result<Option<Opened>> {
        let failed = |error| read_error(path, &error);
        let length = match fs::metadata(path).map_err(failed)? {
            found if found.is_file() => found.len(),
            _ => return Ok(None),
        };
        let mut file = File::open(path).map_err(failed)?;
        let mut head = Vec::new();
        file.by_ref().take(HEAD).read_to_end(&mut head).map_err(failed)?;
        // The reader of whole files will report what is wrong.
        let Ok(format) = input_format(&path.display().to_string(), &head, format) else { return Ok(None) };
        Ok(Some(Opened { path: path.to_path_buf(), file, format, head, length }))
    }

    /// Adds the name of the file to an error.
    pub fn locate(&self, error: Error) -> Error {
        error.in_file(&self.path.display().to_string())
    }

    /// Seeks to this byte.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if the file cannot be read.
    pub fn seek(&self, to: u64) -> Result<()> {
        (&self.file).seek(SeekFrom::Start(to)).map(|_| ()).map_err(|error| read_error(&self.path, &error))
    }

    /// Returns the maximum number of rows that `packed` yields from the file, if only the file tells.
    ///
    /// # Errors
    /// [`Error::Format`] if the file cannot be read.
    pub fn count(&self, packed: &dyn Packed) -> Result<Option<usize>> {
        self.seek(0)?;
        packed.count(&self.file).map_err(|error| self.locate(error))
    }

    /// Passes the rows that `packed` yields of the wanted points to `show`, in blocks of consecutive points of at most `full`
    /// bytes, with the number of the first of them. Returns the levels of detail by which they were chosen, if there are any.
    ///
    /// # Errors
    /// Those of `show`; errors of `packed` for a damaged file.
    pub fn unpack(
        &self,
        packed: &dyn Packed,
        full: usize,
        wanted: &Wanted,
        show: &mut dyn FnMut(usize, &[u8]) -> Result<()>,
    ) -> Result<Option<Levels>> {
        self.seek(0)?;
        let mut block = Vec::with_capacity(full);
        let (mut first, mut next) = (0, 0);
        let levels = packed
            .unpack_wanted(&self.file, wanted, &mut |number, row| {
                if !block.is_empty() && (number != next || block.len() + row.len() > full) {
                    show(first, &block)?;
                    block.clear();
                }
                if block.is_empty() {
                    first = number;
                }
                block.extend_from_slice(row);
                next = number + 1;
                Ok(())
            })
            .map_err(|error| self.locate(error))?;
        if !block.is_empty() {
            show(first, &block)?;
        }
        Ok(levels)
    }

    /// Fills `bytes` with the next bytes of the file.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if the file cannot be read or has become shorter.
    pub fn fill(&self, bytes: &mut [u8]) -> Result<()> {
        (&self.file).read_exact(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => file_error(&self.path, BECAME_SHORTER, LEAVE_IT),
            _ => read_error(&self.path, &error),
        })
    }
}
