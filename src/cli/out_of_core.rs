//! Inputs larger than memory: meshes that are coarsened while they are read, and the folder of temporary files.

use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::cli::args::{MeshFile, OutOfCore, Remeshing, Voice};
use crate::cli::files::name;
use crate::cli::terminal;
use crate::io::Loaded;
use crate::io::dense::PointFile;
use crate::io::large::LargeMesh;
use crate::job::{coarseness_within, is_far_finer, refuse_coarser};
use crate::tiles::TileFolder;
use std::fs;
use std::path::{Path, PathBuf};

/// Memory that is assumed to be free if the system does not report it.
const UNKNOWN: u64 = 2_000_000_000;

/// Triangles that take more than the memory limit divided by this number are sorted in a file.
const OF_MEMORY: u64 = 10;

impl OutOfCore {
    /// Returns the memory limit in bytes.
    pub(super) fn memory(&self) -> u64 {
        self.memory.unwrap_or_else(free_memory)
    }
}

/// Returns half of the free memory, in bytes.
pub(super) fn free_memory() -> u64 {
    let known = fs::read_to_string(Path::new("/proc/meminfo")).ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:").map(str::to_string))?;
        line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
    });
    known.unwrap_or(UNKNOWN) / 2
}

/// Returns whether a file is larger than its memory limit.
pub(super) fn is_large(input: &MeshFile, wanted: &OutOfCore) -> bool {
    fs::metadata(&input.path).is_ok_and(|found| found.len() > wanted.memory())
}

/// Returns the mesh of a job, coarsened while it is read, if it is larger than memory or far finer than the result, or if
/// this is requested; else `None`.
///
/// # Errors
/// [`Error::Option`] if this is requested with options that need the whole mesh; [`Error::File`] if the file cannot be read
/// this way, or the memory does not suffice.
pub(super) fn load_coarsened(job: &Remeshing, monitor: &dyn Monitor) -> Result<Option<Loaded>> {
    let options = &job.options.surface;
    let is_wanted = job.out_of_core.wanted;
    match refuse_coarser(options) {
        Err(error) if is_wanted => return Err(error),
        Err(_) => return Ok(None),
        Ok(()) => {}
    }
    let MeshFile { path, format } = &job.input;
    let Some(mesh) = LargeMesh::open(path, *format)? else {
        // Points are thinned while they are read.
        let is_impossible = is_wanted && PointFile::open(path, *format)?.is_none();
        return if is_impossible { Err(not_in_blocks(path)) } else { Ok(None) };
    };
    let is_finer = mesh.keeps_attributes() && is_far_finer(mesh.faces(), options);
    if !is_wanted && !is_finer && !is_large(&job.input, &job.out_of_core) {
        return Ok(None);
    }
    monitor.stage("read");
    let parent = parent(&job.out_of_core)?;
    let memory = job.out_of_core.memory();
    let coarseness = |extent| coarseness_within(memory, extent, options).map_err(|e| e.in_file(&name(&job.input)));
    let bytes = mesh.bytes_of_triangles();
    let loaded = if bytes <= memory / OF_MEMORY {
        mesh.coarsened(None, coarseness, monitor)?
    } else {
        let folder = Place::passing(&parent)?;
        announce(&job.input, &folder, bytes, job.run.voice);
        mesh.coarsened(Some(&folder.path().join("triangles")), coarseness, monitor)?
    };
    if loaded.is_none() && is_wanted { Err(not_in_blocks(path)) } else { Ok(loaded) }
}

fn not_in_blocks(path: &Path) -> Error {
    Error::File {
        file: path.display().to_string(),
        cause:
            "it cannot be read in blocks: only faces in OBJ, binary PLY and binary STL can, and points in binary PLY, \
                LAS, LAZ, E57 and text (XYZ)"
                .into(),
        remedy: "convert it, or read it as a whole, without --out-of-core".into(),
    }
}

/// Reports how much space temporary files take.
pub(super) fn announce(input: &MeshFile, place: &Place, bytes: u64, voice: Voice) {
    if voice != Voice::Quiet {
        let (name, folder) = (name(input), place.path().display());
        terminal::complain(&format!("{name}: about {} MB of temporary files in {folder}", bytes / 1_000_000 + 1));
    }
}

/// The folder of temporary files.
pub(super) enum Place {
    /// A folder that is removed in any case.
    Passing(tempfile::TempDir),
    /// A folder that is kept until the job is done.
    Kept(PathBuf),
}

impl Place {
    /// Returns the folder for `output`.
    pub(super) fn of(output: &Path, wanted: &OutOfCore) -> Result<Place> {
        let parent = parent(wanted)?;
        if !wanted.resume {
            return Place::passing(&parent);
        }
        let output = output.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Place::Kept(parent.join(format!("{output}.remesh-tiles"))))
    }

    fn passing(parent: &Path) -> Result<Place> {
        let made =
            tempfile::Builder::new().prefix(".remesh-tiles-").tempdir_in(parent).map_err(|error| Error::File {
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

    pub(super) fn folder(&self) -> Result<TileFolder> {
        TileFolder::make(self.path())
    }

    /// Removes a folder that was kept.
    pub(super) fn clear(&self) {
        if let Place::Kept(path) = self {
            // The job is done; a folder that cannot be removed is no reason to fail.
            let _ = fs::remove_dir_all(path);
        }
    }
}

/// Returns the folder in which the folder of temporary files is created.
fn parent(wanted: &OutOfCore) -> Result<PathBuf> {
    let parent = wanted.temp.clone().unwrap_or_else(std::env::temp_dir);
    TileFolder::at(&parent)?;
    Ok(parent)
}
