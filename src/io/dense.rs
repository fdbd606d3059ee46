//! Point clouds with more points than wanted, thinned while they are read in blocks, so that memory depends on the number of
//! points wanted and not on the size of the file.
//!
//! A format takes part if its points are rows of equal length, or can be unpacked to such rows. The format's usual reader
//! then reads the rows that are kept, as if they were the whole file.

use crate::base::error::Result;
use crate::base::parallel;
use crate::io::format::Format;
use crate::io::opened::Opened;
use crate::io::read::{Loaded, checked};
use crate::io::table::Table;
use crate::io::{e57, las, ply, xyz};
use crate::prepare::thin::{Levels, Thinned, Thinner, Wanted};
use std::path::Path;

/// Approximate size of a block, in bytes.
const BLOCK: usize = 1 << 20;

/// A file whose points are rows of equal length, or can be unpacked to such rows.
pub(crate) struct PointFile {
    pub file: Opened,
    /// How its points are read.
    pub table: Table,
}

/// Returns how the rows of points are read, which also works for other files than the one they came from.
pub(crate) fn table(format: Format, head: &[u8], length: u64) -> Option<Table> {
    match format {
        Format::Ply => ply::table(head, length),
        Format::Las => las::table(head, length),
        Format::Xyz => xyz::table(head, length),
        Format::E57 => e57::table(head),
        _ => None,
    }
}

impl PointFile {
    /// Opens the file at `path`. Returns `None` if its points are not rows of equal length, or if it is a pipe.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if there is no such file or it cannot be read.
    pub fn open(path: &Path, format: Option<Format>) -> Result<Option<PointFile>> {
        let Some(file) = Opened::open(path, format)? else { return Ok(None) };
        let Some(mut table) = table(file.format, &file.head, file.length) else { return Ok(None) };
        if let Some(packed) = &table.packed
            && let Some(points) = file.count(packed.as_ref())?
        {
            table.points = points;
        }
        Ok((table.points < u32::MAX as usize).then_some(PointFile { file, table }))
    }

    /// Passes points to `take` in their order, as blocks of consecutive ones with the number of the first, after checking that
    /// all coordinates are finite. Points that are not `wanted` may be among them, or missing. Returns the levels of detail
    /// by which they were chosen, if there are any.
    ///
    /// # Errors
    /// Those of `take`; [`Error::File`](crate::Error::File) if the file cannot be read; an error with the place if the
    /// coordinates of a point are not finite.
    pub fn read(&self, wanted: &Wanted, take: &mut dyn FnMut(usize, &[u8]) -> Result<()>) -> Result<Option<Levels>> {
        let Table { start, row, points, rows, packed } = &self.table;
        let mut take_finite = |first: usize, bytes: &[u8]| {
            let count = bytes.len() / row;
            let of_point = |i: usize| &bytes[row * i..row * (i + 1)];
            let is_somewhere = |i: usize| rows.look(of_point(i)).position.is_finite();
            if !parallel::all(count, is_somewhere) {
                let i = (0..count).find(|&i| !is_somewhere(i)).expect("one of them is nowhere");
                return Err(self.file.locate(rows.nowhere(first + i, of_point(i))));
            }
            take(first, bytes)
        };
        let full = (BLOCK / row).max(1) * row;
        if let Some(packed) = packed {
            return self.file.unpack(packed.as_ref(), full, wanted, &mut take_finite);
        }
        self.file.seek(*start)?;
        let mut block = vec![0; full];
        let mut first = 0;
        while first < *points {
            let count = (full / row).min(points - first);
            let block = &mut block[..row * count];
            self.file.fill(block)?;
            take_finite(first, block)?;
            first += count;
        }
        Ok(None)
    }

    /// Returns the wanted points: which they are, and their rows.
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn thinned(&self, wanted: Wanted) -> Result<(Thinned, Vec<u8>)> {
        let mut thinner = Thinner::new(wanted, self.table.row, |row: &[u8]| self.table.rows.look(row));
        let levels = self.read(&wanted, &mut |first, block| {
            thinner.push(first, block);
            Ok(())
        })?;
        let (thinned, rows) = thinner.finish();
        // Only levels can leave points unread. Without them, the table may count too many.
        let points = if levels.is_some() { self.table.points } else { thinned.points };
        Ok((Thinned { points, levels, ..thinned }, rows))
    }
}

/// Reads the wanted points of the file at `path`. Returns `None` if these are all, or if it cannot be read in this way.
pub(super) fn read_thinned(path: &Path, format: Option<Format>, wanted: Wanted) -> Result<Option<Loaded>> {
    let points = PointFile::open(path, format)?;
    let Some(points) = points.filter(|points| !wanted.is_all_of(points.table.points)) else { return Ok(None) };
    let (thinned, rows) = points.thinned(wanted)?;
    thinned.refuse_empty(&wanted).map_err(|error| points.file.locate(error))?;
    let PointFile { file, table } = points;
    let read = table.rows.read(&rows).and_then(|read| checked(read, file.format));
    let loaded = read.map_err(|error| file.locate(error))?;
    let thinned = Some(thinned).filter(|thinned| thinned.numbers.len() < thinned.points);
    Ok(Some(Loaded { thinned, ..loaded }))
}
