//! Rows of equal length in a file, grouped by place: sorts data that does not fit into memory.
//!
//! The rows of each place gather in memory and are appended to the file a chunk at a time. Within a place they keep the
//! order in which they came.
//!
//! Memory: a chunk per place while the file is written. Limits: the number of places.

use crate::base::error::{Error, Result};
use crate::io::disk::{file_error, read_error, write_error};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Number of bytes that are gathered for a place.
const CHUNK: usize = 1 << 14;

/// Rows of one place that are contiguous in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Chunk {
    /// Place of the rows.
    pub place: [i32; 3],
    /// Byte at which they begin.
    pub start: u64,
    /// Length, in bytes.
    pub length: u32,
}

/// A file that rows are sorted into.
pub(crate) struct SpillWriter {
    written: Written,
    gathered: FxHashMap<[i32; 3], Vec<u8>>,
}

/// The file as written so far.
struct Written {
    path: PathBuf,
    file: File,
    chunks: Vec<Chunk>,
    end: u64,
}

impl SpillWriter {
    /// Creates a file at `path`.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be written.
    pub fn create(path: &Path) -> Result<SpillWriter> {
        let file = File::create(path).map_err(|error| write_error(path, &error))?;
        let written = Written { path: path.into(), file, chunks: Vec::new(), end: 0 };
        Ok(SpillWriter { written, gathered: FxHashMap::default() })
    }

    /// Adds a row, given in two parts, to a place.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be written, for example for lack of space.
    #[inline]
    pub fn push(&mut self, place: [i32; 3], first: &[u8], rest: &[u8]) -> Result<()> {
        let gathered = self.gathered.entry(place).or_default();
        gathered.extend_from_slice(first);
        gathered.extend_from_slice(rest);
        if gathered.len() >= CHUNK {
            self.written.put(place, gathered)?;
            gathered.clear();
        }
        Ok(())
    }

    /// Returns where the rows of all places are in the file, sorted by place.
    ///
    /// # Errors
    /// Those of [`Self::push`].
    pub fn finish(mut self) -> Result<Vec<Chunk>> {
        let mut rest: Vec<([i32; 3], Vec<u8>)> =
            self.gathered.into_iter().filter(|(_, rows)| !rows.is_empty()).collect();
        rest.sort_unstable_by_key(|(place, _)| *place);
        for (place, rows) in rest {
            self.written.put(place, &rows)?;
        }
        self.written.chunks.sort_unstable();
        Ok(self.written.chunks)
    }
}

impl Written {
    fn put(&mut self, place: [i32; 3], bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).map_err(|error| write_error(&self.path, &error))?;
        self.chunks.push(Chunk { place, start: self.end, length: bytes.len() as u32 });
        self.end += bytes.len() as u64;
        Ok(())
    }
}

/// Reads the rows of these chunks of the file at `path`.
///
/// # Errors
/// [`Error::File`] if they cannot be read or no longer exist.
pub(crate) fn read_chunks(path: &Path, chunks: &[Chunk]) -> Result<Vec<u8>> {
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::UnexpectedEof => shorter(path),
        _ => read_error(path, &error),
    };
    let mut file = File::open(path).map_err(failed)?;
    let mut rows = vec![0; chunks.iter().map(|chunk| chunk.length as usize).sum()];
    let mut rest = &mut rows[..];
    for chunk in chunks {
        let (own, after) = rest.split_at_mut(chunk.length as usize);
        file.seek(SeekFrom::Start(chunk.start)).map_err(failed)?;
        file.read_exact(own).map_err(failed)?;
        rest = after;
    }
    Ok(rows)
}

fn shorter(path: &Path) -> Error {
    file_error(path, "it is shorter than it was when it was written", "make the plan again")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_place_come_back_in_their_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows");
        let mut writer = SpillWriter::create(&path).unwrap();
        let place = |i: u32| [(i % 7) as i32 - 3, 0, (i % 2) as i32];
        for i in 0..40_000u32 {
            writer.push(place(i), &i.to_le_bytes(), &[1; 8]).unwrap();
        }
        let chunks = writer.finish().unwrap();
        let places: Vec<&[Chunk]> = chunks.chunk_by(|a, b| a.place == b.place).collect();
        assert_eq!(places.len(), 14);
        for own in places {
            let rows = read_chunks(&path, own).unwrap();
            let numbers: Vec<u32> =
                rows.chunks(12).map(|row| u32::from_le_bytes(row[..4].try_into().unwrap())).collect();
            let expected: Vec<u32> = (0..40_000).filter(|&i| place(i) == own[0].place).collect();
            assert_eq!(numbers, expected);
        }
        std::fs::write(&path, b"short").unwrap();
        let message = read_chunks(&path, &chunks).unwrap_err().to_string();
        assert!(message.contains("shorter than it was") && message.contains("; "), "{message}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told() {
        let mut writer = SpillWriter::create(Path::new("/dev/full")).unwrap();
        let written = (0..10_000u32).try_for_each(|i| writer.push([0; 3], &i.to_le_bytes(), &[1; 8]));
        let message = written.unwrap_err().to_string();
        assert!(message.contains("no space is left for it; free some space or choose another folder"), "{message}");
    }
}
