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
use crate::io::{las, ply};
use crate::prepare::thin::Thinner;
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes of the beginning of a file that has to have all that stands before its points.
const HEAD: u64 = 1 << 16;

/// About the bytes of a block.
const BLOCK: usize = 1 << 20;

/// The points of the file at `path`, about `wanted` of them, if it has more and is of a kind that can be read so; else `None`.
pub(super) fn read_thinned(path: &Path, format: Option<Format>, wanted: usize) -> Result<Option<Loaded>> {
    let failed = |error| read_error(path, &error);
    let name = path.display().to_string();
    let found = fs::metadata(path).map_err(failed)?;
    // Opening a pipe would take its beginning away.
    if !found.is_file() {
        return Ok(None);
    }
    let mut file = File::open(path).map_err(failed)?;
    let mut head = Vec::new();
    file.by_ref().take(HEAD).read_to_end(&mut head).map_err(failed)?;
    // What is wrong with a file is said by those who read all of it.
    let Ok(format) = input_format(&name, &head, format) else { return Ok(None) };
    let table = match format {
        Format::Ply => ply::table(&head, found.len()),
        Format::Las => las::table(&head, found.len()),
        _ => None,
    };
    let Some(table) = table.filter(|table| table.points > wanted) else { return Ok(None) };
    file.seek(SeekFrom::Start(table.start)).map_err(failed)?;
    let look = |row: &[u8]| table.rows.look(row);
    let mut thinner = Thinner::new(wanted, table.row, &look);
    let mut block = vec![0; (BLOCK / table.row).max(1) * table.row];
    let mut first = 0;
    while first < table.points {
        let rows = (block.len() / table.row).min(table.points - first);
        let bytes = &mut block[..rows * table.row];
        file.read_exact(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => {
                table.rows.cut_short(file.metadata().map_or(0, |found| found.len())).in_file(&name)
            }
            _ => failed(error),
        })?;
        let is_nowhere = |row: &[u8]| !look(row).position.is_finite();
        if let Some((i, row)) = bytes.chunks_exact(table.row).enumerate().find(|(_, row)| is_nowhere(row)) {
            return Err(table.rows.nowhere(first + i, row).in_file(&name));
        }
        thinner.push(bytes);
        first += rows;
    }
    let (thinned, rows) = thinner.finish();
    let read = table.rows.read(&rows).map_err(|error| error.in_file(&name))?;
    let loaded = checked(read, format).map_err(|error| error.in_file(&name))?;
    Ok(Some(Loaded { thinned: Some(thinned), ..loaded }))
}
