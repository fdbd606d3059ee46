//! The folder for the temporary files of a job.

use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::job::large::{LargeFile, OutOfCore};
use crate::tiles::TileFolder;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder for temporary files.
pub(super) enum Workspace {
    /// One that is removed however the job ends.
    Passing(tempfile::TempDir),
    /// One that stays until the job is done, so that the next one can go on.
    Kept(PathBuf),
}

impl Workspace {
    /// The one for the job on `file`: kept if that can be resumed.
    pub(super) fn of(file: &LargeFile) -> Result<Workspace> {
        if !file.out_of_core.resume {
            return Workspace::passing(file.out_of_core);
        }
        let output = file.output.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Workspace::Kept(parent(file.out_of_core)?.join(format!("{output}.remesh-tiles"))))
    }

    /// One that is removed.
    pub(super) fn passing(out_of_core: &OutOfCore) -> Result<Workspace> {
        let parent = parent(out_of_core)?;
        let made =
            tempfile::Builder::new().prefix(".remesh-tiles-").tempdir_in(&parent).map_err(|error| Error::File {
                file: parent.display().to_string(),
                cause: format!("no folder can be made in it: {error}"),
                remedy: "choose another folder for temporary files".into(),
            })?;
        Ok(Workspace::Passing(made))
    }

    /// Tells the caller where it is, and how many bytes its files will take.
    pub(super) fn announce(&self, bytes: u64, monitor: &dyn Monitor) {
        monitor.temporary_files(self.path(), bytes, matches!(self, Workspace::Kept(_)));
    }

    pub(super) fn path(&self) -> &Path {
        match self {
            Workspace::Passing(folder) => folder.path(),
            Workspace::Kept(path) => path,
        }
    }

    /// The folder for tiles.
    pub(super) fn folder(&self) -> Result<TileFolder> {
        TileFolder::make(self.path())
    }

    /// Removes what was kept.
    pub(super) fn clear(&self) {
        if let Workspace::Kept(path) = self {
            // The job is done; a folder that cannot be removed is no reason to fail.
            let _ = fs::remove_dir_all(path);
        }
    }
}

/// The folder in which the one for temporary files is made.
fn parent(out_of_core: &OutOfCore) -> Result<PathBuf> {
    let parent = out_of_core.temp.clone().unwrap_or_else(std::env::temp_dir);
    TileFolder::at(&parent)?;
    Ok(parent)
}
