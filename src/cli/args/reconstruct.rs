//! The arguments of `remesh reconstruct`.

use crate::cli::args::shared::{FormatArgs, MeshFile, NormalArgs, Run, RunArgs, support_help};
use crate::cli::args::stop::{Stop, refused};
use crate::job::settings::ReconstructSettings;
use crate::job::words::positive;
use crate::pipeline::ReconstructOptions;
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Extracts the whole robust implicit surface of a point cloud, or of the vertices of a mesh, as an oriented manifold of
dense triangles of all shapes, about as large as the grid cells from which they are extracted. Noise is smoothed away. At
the border of a cloud, the surface extends beyond it by up to one point spacing. For even triangles, or a given number of
them, remesh the result.

Exit status: 0 done, 1 a file cannot be read or written, or has no surface, 2 wrong usage, 130 interrupted.";

#[derive(Debug, clap::Args)]
pub(super) struct ReconstructArgs {
    /// The points to read, or a mesh whose vertices are used
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The mesh to write; an existing file is replaced when the new one is complete
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Edge length of the grid cells, in the units of the input [default: half the mean spacing of the points]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = positive)]
    resolution: Option<f64>,
    #[arg(long, value_name = "W", allow_negative_numbers = true, help = support_help())]
    smooth: Option<f64>,
    #[command(flatten)]
    normals: NormalArgs,
    #[command(flatten)]
    formats: FormatArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// A job that reconstructs a surface from one file and writes it to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconstructing {
    /// The file to read.
    pub input: MeshFile,
    /// The file to write.
    pub output: MeshFile,
    /// How to reconstruct.
    pub options: ReconstructOptions,
    /// Settings of the run.
    pub run: Run,
}

impl ReconstructArgs {
    pub(super) fn resolve(self) -> Result<Reconstructing, Stop> {
        let ReconstructArgs { input, output, resolution, smooth, normals, formats, run } = self;
        let (input, output) = formats.resolve(input, output);
        let settings = ReconstructSettings { resolution, smooth, normals: normals.into() };
        let options = settings.resolve().map_err(|e| refused(&e))?;
        Ok(Reconstructing { input, output, options, run: Run::from(run).without_page("reconstructions")? })
    }
}
