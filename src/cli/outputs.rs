//! Destinations of the results of remeshing: one file, one file per level of detail, one file with all levels, or tiles.

use crate::base::error::Result;
use crate::cli::args::Remeshing;
use crate::cli::files::name;
use crate::io::Format;
use crate::io::file::{self, Level};
use crate::job::Outcome;
use crate::mesh::attributes::Attributes;
use crate::mesh::triangle_mesh::Mesh;
use std::path::PathBuf;

/// The files of the results.
pub(super) struct Outputs {
    paths: Vec<PathBuf>,
    /// The format of each file; for tiles, that of their content.
    pub format: Format,
    /// Whether the single path is that of a tileset.
    pub are_tiles: bool,
    /// The names of the results.
    pub names: Vec<String>,
}

impl Outputs {
    /// Returns the files of a job, checked as far as possible in advance.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if one of them cannot be written, or its format is not known.
    pub(super) fn of(job: &Remeshing) -> Result<Outputs> {
        let path = &job.output.path;
        let are_tiles = job.output.format.is_none() && file::is_tileset(path);
        let format = if are_tiles { Format::Glb } else { file::output_format(path, job.output.format)? };
        let numbers = 1..=job.levels.len();
        let paths = if job.levels.is_empty() || format.holds_levels() {
            vec![path.clone()]
        } else {
            numbers.clone().map(|number| file::level_path(path, number)).collect::<Result<_>>()?
        };
        paths.iter().try_for_each(|path| file::check_target(path))?;
        let names = if job.levels.len() > paths.len() {
            numbers.map(|number| format!("{}, level {number}", name(&job.output))).collect()
        } else {
            paths.iter().map(|path| path.display().to_string()).collect()
        };
        Ok(Outputs { paths, format, are_tiles, names })
    }

    /// Writes the results.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if this fails.
    pub(super) fn write(&self, outcomes: &[Outcome]) -> Result<()> {
        if self.are_tiles {
            let levels: Vec<Level> = outcomes.iter().map(level).collect();
            return file::write_tileset(&self.paths[0], &levels);
        }
        if self.paths.len() < outcomes.len() {
            let levels: Vec<(&Mesh, &Attributes)> = outcomes.iter().map(|o| (&o.mesh, &o.attributes)).collect();
            return file::write_levels_file(&self.paths[0], &levels, Some(self.format));
        }
        let mut all = self.paths.iter().zip(outcomes);
        all.try_for_each(|(path, o)| file::write_file(path, &o.mesh, &o.attributes, Some(self.format)))
    }
}

/// Converts a result to a level of a tileset, with its measured distance.
fn level(outcome: &Outcome) -> Level<'_> {
    let error = outcome.largest_distance().unwrap_or(0.0);
    Level { mesh: &outcome.mesh, attributes: &outcome.attributes, error }
}
