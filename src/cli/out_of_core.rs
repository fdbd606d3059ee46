//! `remesh sample` of what is larger than memory: tile by tile, in a folder of temporary files.

use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::cli::args::{OutOfCore, Sampling, Voice};
use crate::cli::files::name;
use crate::cli::terminal;
use crate::pipeline::Sampled;
use crate::tiles::{PlanOptions, TileFolder, can_plan, make_plan, sample_all};
use std::fs;
use std::path::Path;

/// Memory that is taken to be free where the system does not tell.
const UNKNOWN: u64 = 2_000_000_000;

/// Half of the memory that is free, in bytes.
pub(super) fn free_memory() -> u64 {
    let known = fs::read_to_string(Path::new("/proc/meminfo")).ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:").map(str::to_string))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
    });
    known.unwrap_or(UNKNOWN) / 2
}

/// Whether a job is done out of core: if that is wanted, or if its file is larger than the memory for it and can be.
pub(super) fn is_out_of_core(job: &Sampling) -> bool {
    let OutOfCore { wanted, memory, .. } = &job.out_of_core;
    let is_large = || fs::metadata(&job.input.path).is_ok_and(|found| found.len() > memory.unwrap_or_else(free_memory));
    *wanted || is_large() && can_plan(&job.input.path, job.input.format, &job.options)
}

/// Samples the file of a job tile by tile.
pub(super) fn sample_out_of_core(job: &Sampling, monitor: &dyn Monitor) -> Result<Sampled> {
    let OutOfCore { memory, resume, .. } = &job.out_of_core;
    let options = PlanOptions { sample: job.options.clone(), memory: memory.unwrap_or_else(free_memory), tiles: 1 };
    let place = Place::of(job)?;
    let folder = place.folder()?;
    let is_begun = *resume && folder.is_of(&job.input.path, &options);
    if !is_begun {
        let size = fs::metadata(&job.input.path).map_or(0, |found| found.len());
        if job.run.voice != Voice::Quiet {
            terminal::complain(&format!(
                "{}: about {} MB of temporary files in {}",
                name(&job.input),
                (size + size / 4) / 1_000_000 + 1,
                place.path().display()
            ));
        }
        make_plan(&job.input.path, job.input.format, &folder, &options, monitor)?;
        folder.note(&job.input.path, &options)?;
    }
    let sampled = sample_all(&folder, monitor)?;
    place.clear();
    Ok(sampled)
}

/// The folder of temporary files.
enum Place {
    /// One that vanishes whatever happens.
    Passing(tempfile::TempDir),
    /// One that stays until the job is done.
    Kept(std::path::PathBuf),
}

impl Place {
    fn of(job: &Sampling) -> Result<Place> {
        let OutOfCore { temp, resume, .. } = &job.out_of_core;
        let parent = temp.clone().unwrap_or_else(std::env::temp_dir);
        TileFolder::at(&parent)?;
        if *resume {
            let output = job.output.file_name().unwrap_or_default().to_string_lossy().into_owned();
            return Ok(Place::Kept(parent.join(format!("{output}.remesh-tiles"))));
        }
        let made =
            tempfile::Builder::new().prefix(".remesh-tiles-").tempdir_in(&parent).map_err(|error| Error::File {
                file: parent.display().to_string(),
                cause: format!("no folder can be made in it: {error}"),
                remedy: "choose another one by --temp".into(),
            })?;
        terminal::remove_at_end(made.path());
        Ok(Place::Passing(made))
    }

    fn path(&self) -> &Path {
        match self {
            Place::Passing(folder) => folder.path(),
            Place::Kept(path) => path,
        }
    }

    fn folder(&self) -> Result<TileFolder> {
        TileFolder::make(self.path())
    }

    /// Takes away what was kept.
    fn clear(&self) {
        if let Place::Kept(path) = self {
            // All is done; what cannot be removed is no reason to fail.
            let _ = fs::remove_dir_all(path);
        }
    }
}
