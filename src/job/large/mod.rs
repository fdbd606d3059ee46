//! Jobs on files that need not fit into memory. They read their file in blocks and keep temporary files meanwhile.
//!
//! Each of these calls returns `None` where the job is better done in memory: the caller reads the file as a whole then.

mod cloud;
mod coarseness;
mod mesh;
mod workspace;

pub use cloud::{merge_pieces, remesh_in_pieces, sample_in_tiles};
pub use mesh::read_coarsened;

use crate::io::format::Format;
use std::fs;
use std::path::{Path, PathBuf};

/// Memory that is taken to be free where the system does not tell, in bytes.
const UNKNOWN: u64 = 2_000_000_000;

/// When a job is done out of core, and with what.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OutOfCore {
    /// Whether it is done so even if the file is not larger than the memory for it.
    pub always: bool,
    /// The memory to make do with, in bytes; half of what is free without.
    pub memory: Option<u64>,
    /// The folder for temporary files; that of the system without.
    pub temp: Option<PathBuf>,
    /// Whether finished parts are kept if the job does not come to its end, for the next one to go on from.
    pub resume: bool,
}

impl OutOfCore {
    /// The memory to make do with, in bytes.
    pub fn memory(&self) -> u64 {
        self.memory.unwrap_or_else(free_memory)
    }
}

/// Half of the memory that is free, in bytes.
pub fn free_memory() -> u64 {
    let known = fs::read_to_string(Path::new("/proc/meminfo")).ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:").map(str::to_string))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
    });
    known.unwrap_or(UNKNOWN) / 2
}

/// The file of a job, and how it is read if it does not fit into memory.
#[derive(Debug, Clone, Copy)]
pub struct LargeFile<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its format, where neither ending nor content are to decide.
    pub format: Option<Format>,
    /// The file that the result is for. What is kept of an interrupted job is named after it.
    pub output: &'a Path,
    /// When and with what it is read in blocks.
    pub out_of_core: &'a OutOfCore,
}

impl LargeFile<'_> {
    /// Whether it is larger than the memory for it.
    fn is_large(&self) -> bool {
        self.bytes() > self.out_of_core.memory()
    }

    fn bytes(&self) -> u64 {
        fs::metadata(self.path).map_or(0, |found| found.len())
    }
}
