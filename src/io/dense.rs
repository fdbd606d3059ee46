//! Clouds with more points than are wanted, read in blocks and thinned while they are read, so that memory follows from the
//! points wanted and not from the size of the file.
//!
//! A format takes part if its points are rows of equally many bytes. Those that are kept are read by its usual reader, as
//! if they were the whole file.

use crate::base::error::Result;
use crate::io::disk::read_error;
use crate::io::format::Format;
use crate::io::named::input_format;
use crate::io::read::{Loaded, checked};
use crate::io::table::Table;
use crate::io::{las, ply};
use crate::prepare::thin::{Thinned, Thinner};
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// The first bytes of a file, which must hold everything before its points.
const HEAD: u64 = 1 << 16;

/// About the bytes of a block.
const BLOCK: usize = 1 << 20;

/// A file whose points are rows of equally many bytes.
pub(crate) struct PointFile {
    path: PathBuf,
    file: File,
    format: Format,
    head: Vec<u8>,
    length: u64,
    table: Table,
}

/// How the rows of points are read, also from other files than the one they came from.
pub(crate) fn table(format: Format, head: &[u8], length: u64) -> Option<Table> {
    match format {
        Format::Ply => ply::table(head, length),
        Format::Las => las::table(head, length),
        _ => None,
    }
}

impl PointFile {
    /// The file at `path`; `None` if its points are no such rows, or if it is a pipe, whose first bytes would be lost.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if there is no such file or it cannot be read.
    pub fn open(path: &Path, format: Option<Format>) -> Result<Option<PointFile>> {
        let failed = |error| read_error(path, &error);
        let length = match fs::metadata(path).map_err(failed)? {
            found if found.is_file() => found.len(),
            _ => return Ok(None),
        };
        let mut file = File::open(path).map_err(failed)?;
        let mut head = Vec::new();
        file.by_ref().take(HEAD).read_to_end(&mut head).map_err(failed)?;
        // The reader of whole files says what is wrong with a file.
        let Ok(format) = input_format(&path.display().to_string(), &head, format) else { return Ok(None) };
        let table = table(format, &head, length);
        Ok(table.map(|table| PointFile { path: path.to_path_buf(), file, format, head, length, table }))
    }

    /// The points of a file that has more than these, as `table` says.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if there is no such file or it cannot be read.
    pub fn with(path: PathBuf, format: Format, head: Vec<u8>, length: u64, table: Table) -> Result<PointFile> {
        let file = File::open(&path).map_err(|error| read_error(&path, &error))?;
        Ok(PointFile { path, file, format, head, length, table })
    }

    /// How its points are read.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// What [`table`] takes to read points of it.
    pub fn kind(&self) -> (Format, &[u8], u64) {
        (self.format, &self.head, self.length)
    }

    /// Shows all points to `take`, in their order and block by block. All coordinates are finite.
    ///
    /// # Errors
    /// Those of `take`; an error with the place in the file if that has become shorter, or if a point is nowhere.
    pub fn read(&self, take: &mut dyn FnMut(&[u8]) -> Result<()>) -> Result<()> {
        let Table { start, row, points, rows } = &self.table;
        let (path, name) = (&self.path, self.path.display().to_string());
        let failed = |error| read_error(path, &error);
        let mut file = &self.file;
        file.seek(SeekFrom::Start(*start)).map_err(failed)?;
        let mut block = vec![0; (BLOCK / row).max(1) * row];
        let mut first = 0;
        while first < *points {
            let count = (block.len() / row).min(points - first);
            let bytes = &mut block[..count * row];
            file.read_exact(bytes).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => {
                    rows.cut_short(file.metadata().map_or(0, |found| found.len())).in_file(&name)
                }
                _ => failed(error),
            })?;
            let is_nowhere = |row: &[u8]| !rows.look(row).position.is_finite();
            if let Some((i, row)) = bytes.chunks_exact(*row).enumerate().find(|(_, row)| is_nowhere(row)) {
                return Err(rows.nowhere(first + i, row).in_file(&name));
            }
            take(bytes)?;
            first += count;
        }
        Ok(())
    }

    /// About `wanted` of the points: which, and their rows.
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn thinned(&self, wanted: usize) -> Result<(Thinned, Vec<u8>)> {
        let mut thinner = Thinner::new(wanted, self.table.row, |row: &[u8]| self.table.rows.look(row));
        self.read(&mut |block| {
            thinner.push(block);
            Ok(())
        })?;
        Ok(thinner.finish())
    }
}

/// The points of the file at `path`, about `wanted` of them, if it has more and is of a kind that can be read so; else `None`.
pub(super) fn read_thinned(path: &Path, format: Option<Format>, wanted: usize) -> Result<Option<Loaded>> {
    let file = PointFile::open(path, format)?;
    let Some(file) = file.filter(|file| file.table.points > wanted) else { return Ok(None) };
    let (thinned, rows) = file.thinned(wanted)?;
    let name = path.display().to_string();
    let read = file.table.rows.read(&rows).map_err(|error| error.in_file(&name))?;
    let loaded = checked(read, file.format).map_err(|error| error.in_file(&name))?;
    Ok(Some(Loaded { thinned: Some(thinned), ..loaded }))
}
