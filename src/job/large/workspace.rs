//! The folder for the temporary files of a job.

use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::job::large::{LargeFile, OutOfCore};
use crate::tiles::TileFolder;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder for temporary files.
pub(super) enum Workspace {
    /// A folder that is removed however the job ends.
    Passing(tempfile::TempDir),
    /// A folder that is kept until the job succeeds, so that the next one can resume.
    Kept(PathBuf),
}

impl Workspace {
    /// Makes the workspace of the job on `file`: a kept one if the job can be resumed.
    pub(super) fn of(file: &LargeFile) -> Result<Workspace> {
        if !file.out_of_core.resume {
            return Workspace::passing(&parent(file.out_of_core)?);
        }
        let output = file.output.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Workspace::Kept(parent(file.out_of_core)?.join(format!("{output}.remesh-tiles"))))
    }

    /// Makes a workspace in `parent` that is removed however the job ends.
    pub(super) fn passing(parent: &Path) -> Result<Workspace> {
        let made =
            tempfile::Builder::new().prefix(".remesh-tiles-").tempdir_in(parent).map_err(|error| Error::File {
                file: parent.display().to_string(),
                cause: format!("cannot create a folder in it: {error}"),
                remedy: "choose another folder for temporary files".into(),
            })?;
        Ok(Workspace::Passing(made))
    }

    /// Tells the monitor where the workspace is and how many bytes its files will take.
    pub(super) fn announce(&self, bytes: u64, monitor: &dyn Monitor) {
        monitor.temporary_files(self.path(), bytes, matches!(self, Workspace::Kept(_)));
    }

    pub(super) fn path(&self) -> &Path {
        match self {
            Workspace::Passing(folder) => folder.path(),
            Workspace::Kept(path) => path,
        }
    }

    /// Returns the folder for tiles.
    pub(super) fn folder(&self) -> Result<TileFolder> {
        TileFolder::make(self.path())
    }

    /// Removes a kept folder.
    pub(super) fn clear(&self) {
        if let Workspace::Kept(path) = self {
            // The job is done; a folder that cannot be removed is no reason to fail.
            let _ = fs::remove_dir_all(path);
        }
    }
}

/// Returns the folder in which workspaces are made.
///
/// # Errors
/// [`Error::File`] if there is no such folder.
pub(super) fn parent(out_of_core: &OutOfCore) -> Result<PathBuf> {
    let parent = out_of_core.temp.clone().unwrap_or_else(std::env::temp_dir);
    TileFolder::at(&parent)?;
    Ok(parent)
}
