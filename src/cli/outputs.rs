//! Where the results of a remeshing go: one file, a file for each level of detail, or one file with all levels.

use crate::base::error::Result;
use crate::cli::args::Remeshing;
use crate::cli::files::name;
use crate::io::{Format, file};
use crate::job::Outcome;
use crate::mesh::attributes::Attributes;
use crate::mesh::triangle_mesh::Mesh;
use std::path::PathBuf;

/// The files of the results.
pub(super) struct Outputs {
    paths: Vec<PathBuf>,
    format: Option<Format>,
    /// What the results are called.
    pub names: Vec<String>,
}

impl Outputs {
    /// Those of a job, which can be written as far as can be told before.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if one of them cannot, or its format is not known.
    pub(super) fn of(job: &Remeshing) -> Result<Outputs> {
        let (path, format) = (&job.output.path, job.output.format);
        let holds_levels = file::output_format(path, format)?.holds_levels();
        let numbers = 1..=job.levels.len();
        let paths = if job.levels.is_empty() || holds_levels {
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
        Ok(Outputs { paths, format, names })
    }

    /// Writes the results.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if that fails.
    pub(super) fn write(&self, outcomes: &[Outcome]) -> Result<()> {
        if self.paths.len() < outcomes.len() {
            let levels: Vec<(&Mesh, &Attributes)> = outcomes.iter().map(|o| (&o.mesh, &o.attributes)).collect();
            return file::write_levels_file(&self.paths[0], &levels, self.format);
        }
        let mut all = self.paths.iter().zip(outcomes);
        all.try_for_each(|(path, o)| file::write_file(path, &o.mesh, &o.attributes, self.format))
    }
}
