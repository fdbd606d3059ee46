//! A file that appears to end early, so that nothing beyond is read.

use std::io::{Read, Seek, SeekFrom};

/// A file that appears to end at `end`.
pub(super) struct Window<R> {
    source: R,
    /// Position of the next byte. Asking the file for it would take a system call.
    place: u64,
    pub end: u64,
}

impl<R: Read + Seek> Window<R> {
    /// Makes a file that appears to end at this byte.
    pub fn of(source: R, end: u64) -> Window<R> {
        Window { source, place: end, end }
    }

    /// Returns `count` bytes at this offset, if there are that many.
    pub fn at(&mut self, place: u64, count: usize) -> Option<Vec<u8>> {
        let is_there = place.checked_add(count as u64).is_some_and(|end| end <= self.end);
        let mut bytes = vec![0; if is_there { count } else { return None }];
        self.seek(SeekFrom::Start(place)).ok()?;
        self.read_exact(&mut bytes).ok()?;
        Some(bytes)
    }

    pub fn array<const N: usize>(&mut self, place: u64) -> Option<[u8; N]> {
        self.at(place, N)?.try_into().ok()
    }
}

impl<R: Read + Seek> Read for Window<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.place)).unwrap_or(usize::MAX);
        let most = buffer.len().min(left);
        let count = self.source.read(&mut buffer[..most])?;
        self.place += count as u64;
        Ok(count)
    }
}

impl<R: Read + Seek> Seek for Window<R> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.place = self.source.seek(to)?;
        Ok(self.place)
    }
}
