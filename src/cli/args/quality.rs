//! The arguments of `remesh quality`.

use crate::cli::args::shared::MeshFile;
use crate::io::Format;
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Measures the triangles of a mesh as they are: angles, quality Q = 6S/(√3 p h), edge lengths, valences and topology;
and, with --against, the distance to another mesh, in percent of the diagonal of that mesh's bounding box. Several meshes
are measured one after the other; --report F.html shows them side by side.

Exit status: 0 measured, 1 a file cannot be read, 2 wrong usage, 130 interrupted.";

#[derive(Debug, clap::Args)]
pub(super) struct QualityArgs {
    /// The mesh to measure, or several to compare
    #[arg(value_name = "MESH", required = true)]
    meshes: Vec<PathBuf>,
    /// Also measure the distance to this mesh
    #[arg(long, value_name = "INPUT")]
    against: Option<PathBuf>,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
    /// Write the report to a file: as a page with pictures if it is named F.html, otherwise as JSON
    #[arg(long, value_name = "F")]
    report: Option<PathBuf>,
    /// Format of the meshes [default: by their extension, else by their content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    /// Number of threads; the figures do not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// A job that measures files.
#[derive(Debug, Clone, PartialEq)]
pub struct Measuring {
    /// The meshes to measure, at least one.
    pub meshes: Vec<MeshFile>,
    /// The mesh to which distances are measured, if any.
    pub against: Option<MeshFile>,
    /// Whether to print JSON instead of a table.
    pub json: bool,
    /// The file for the report, if one was requested.
    pub report: Option<PathBuf>,
    /// Number of threads; by default, one per core.
    pub threads: Option<usize>,
}

impl QualityArgs {
    pub(super) fn resolve(self) -> Measuring {
        let QualityArgs { meshes, against, json, report, format, threads } = self;
        Measuring {
            meshes: meshes.into_iter().map(|path| MeshFile { path, format }).collect(),
            against: against.map(|path| MeshFile { path, format: None }),
            json,
            report,
            threads: threads.map(usize::from),
        }
    }
}
