//! Jobs on files that need not fit into memory. They read the file in blocks and keep temporary files meanwhile.
//!
//! Each call returns `None` where the job is better done in memory. The caller then reads the file as a whole.

mod cloud;
mod coarseness;
mod mesh;
mod workspace;

pub use cloud::{merge_pieces, remesh_in_pieces, sample_in_tiles};
pub use mesh::read_coarsened;

use crate::io::Format;
use std::fs;
use std::path::{Path, PathBuf};

/// Free memory assumed where the system does not report it, in bytes.
const UNKNOWN: u64 = 2_000_000_000;

/// How files larger than memory are processed.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OutOfCore {
    /// Whether any file is processed out of core, not only those larger than [`Self::memory`].
    pub always: bool,
    /// Memory limit in bytes; by default, half of the free memory.
    pub memory: Option<u64>,
    /// Folder for temporary files; by default, that of the system.
    pub temp: Option<PathBuf>,
    /// Whether finished parts are kept when the job fails or is interrupted, so that the next one can resume.
    pub resume: bool,
}

impl OutOfCore {
    /// Returns the memory limit in bytes.
    pub fn memory(&self) -> u64 {
        self.memory.unwrap_or_else(free_memory)
    }
}

/// Returns half of the free memory, in bytes.
pub fn free_memory() -> u64 {
    let known = fs::read_to_string(Path::new("/proc/meminfo")).ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:").map(str::to_string))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
    });
    known.unwrap_or(UNKNOWN) / 2
}

/// The input file of a job, and how it is read if it does not fit into memory.
#[derive(Debug, Clone, Copy)]
pub struct LargeFile<'a> {
    /// Path of the file.
    pub path: &'a Path,
    /// Format of the file; by default, decided by its extension and content.
    pub format: Option<Format>,
    /// Path of the result. The folder kept for resuming is named after it.
    pub output: &'a Path,
    /// How the file is read in blocks.
    pub out_of_core: &'a OutOfCore,
}

impl LargeFile<'_> {
    /// Returns whether the file is larger than the memory limit.
    fn is_large(&self) -> bool {
        self.bytes() > self.out_of_core.memory()
    }

    fn bytes(&self) -> u64 {
        fs::metadata(self.path).map_or(0, |found| found.len())
    }
}
