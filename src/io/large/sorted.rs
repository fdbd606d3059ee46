//! The triangles of a large mesh, grouped by cell, in memory or in a temporary file.

use crate::base::error::Result;
use crate::io::spill::{Chunk, SpillWriter, read_chunks};
use rustc_hash::FxHashMap;
use std::path::{Path, PathBuf};

/// Size of the three corners of a triangle, in bytes.
pub(super) const ROW: usize = 12;

/// Groups triangles, given in any order, by cell.
pub(super) enum Sorter {
    Memory(FxHashMap<[i32; 3], Vec<[u32; 3]>>),
    Disk(PathBuf, SpillWriter),
}

/// The triangles of one cell, in the order in which they came.
pub(super) enum OfPlace {
    Memory(Vec<[u32; 3]>),
    Disk(PathBuf, Vec<Chunk>),
}

impl Sorter {
    /// Creates a sorter that keeps triangles in memory, or in a new file at this path.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if it cannot be written.
    pub fn new(file: Option<&Path>) -> Result<Sorter> {
        Ok(match file {
            None => Sorter::Memory(FxHashMap::default()),
            Some(path) => Sorter::Disk(path.to_path_buf(), SpillWriter::create(path)?),
        })
    }

    /// Adds a triangle to a cell.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    #[inline]
    pub fn push(&mut self, place: [i32; 3], triangle: [u32; 3]) -> Result<()> {
        match self {
            Sorter::Memory(places) => {
                places.entry(place).or_default().push(triangle);
                Ok(())
            }
            Sorter::Disk(_, writer) => writer.push(place, bytemuck::bytes_of(&triangle), &[]),
        }
    }

    /// Returns all cells, in their order.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn finish(self) -> Result<Vec<OfPlace>> {
        match self {
            Sorter::Memory(places) => {
                let mut places: Vec<([i32; 3], Vec<[u32; 3]>)> = places.into_iter().collect();
                places.sort_unstable_by_key(|(place, _)| *place);
                Ok(places.into_iter().map(|(_, triangles)| OfPlace::Memory(triangles)).collect())
            }
            Sorter::Disk(path, writer) => {
                let chunks = writer.finish()?;
                let places = chunks.chunk_by(|a, b| a.place == b.place);
                Ok(places.map(|chunks| OfPlace::Disk(path.clone(), chunks.to_vec())).collect())
            }
        }
    }
}

impl OfPlace {
    /// Returns the triangles.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if they cannot be read from the file.
    pub fn into_triangles(self) -> Result<Vec<[u32; 3]>> {
        match self {
            OfPlace::Memory(triangles) => Ok(triangles),
            OfPlace::Disk(path, chunks) => {
                let rows = read_chunks(&path, &chunks)?;
                Ok(rows.chunks_exact(ROW).map(bytemuck::pod_read_unaligned).collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_and_a_file_give_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("triangles");
        let sorted = |file: Option<&Path>| {
            let mut sorter = Sorter::new(file).unwrap();
            for i in 0..20_000u32 {
                sorter.push([(i % 5) as i32 - 2, 0, (i % 3) as i32], [i, i + 1, i + 2]).unwrap();
            }
            let places = sorter.finish().unwrap();
            places.into_iter().map(|place| place.into_triangles().unwrap()).collect::<Vec<_>>()
        };
        let in_memory = sorted(None);
        assert_eq!((in_memory.len(), in_memory[0][0]), (15, [0, 1, 2]));
        assert_eq!(in_memory, sorted(Some(&path)));
    }
}
