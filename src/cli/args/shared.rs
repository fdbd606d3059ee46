//! Arguments shared by several commands, and what they resolve to.

use crate::cli::args::stop::{Stop, wrong};
use crate::cli::args::words::bytes;
use crate::io::Format;
use crate::job::large::OutOfCore;
use crate::job::settings::NormalSettings;
use crate::job::words::{normal_fit, positive};
use crate::pipeline::{FEW_NEIGHBORS, INTERPOLATING_SUPPORT, NormalFit, SMOOTHING_SUPPORT};
use crate::prepare::cloud_normals::MANY_NEIGHBORS;
use clap::ArgAction;
use std::path::{Path, PathBuf};

/// How a command goes on, whatever it does.
#[derive(Debug, clap::Args)]
pub(super) struct RunArgs {
    /// Number of threads; the output does not depend on it [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Write the report to a file: as a page with pictures if it is named F.html, otherwise as JSON
    #[arg(long, value_name = "F")]
    report: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Name each stage on standard error as it begins
    #[arg(short, long, action = ArgAction::SetTrue)]
    verbose: bool,
}

/// Settings of a run, for any command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// Number of threads; by default, one per core.
    pub threads: Option<usize>,
    /// The file for the report, if one was requested.
    pub report: Option<PathBuf>,
    /// Amount of output during the run.
    pub voice: Voice,
}

impl From<RunArgs> for Run {
    fn from(args: RunArgs) -> Run {
        let RunArgs { threads, report, quiet, verbose } = args;
        let voice = match (quiet, verbose) {
            (true, _) => Voice::Quiet,
            (_, true) => Voice::Verbose,
            _ => Voice::Normal,
        };
        Run { threads: threads.map(usize::from), report, voice }
    }
}

impl Run {
    /// Rejects a page as the report of a command that has no page.
    pub(super) fn without_page(self, of: &str) -> Result<Run, Stop> {
        match self.report.as_deref().filter(|path| is_page(path)) {
            None => Ok(self),
            Some(path) => {
                let name = path.display();
                Err(wrong(&format!("{name}: there is no report page for {of}; choose a name that ends in .json")))
            }
        }
    }
}

/// What working out of core may take.
#[derive(Debug, clap::Args)]
pub(super) struct MemoryArgs {
    /// Memory to use at most, such as 400M or 2G [default: half of the free memory]
    #[arg(long, value_name = "M", value_parser = bytes)]
    memory: Option<u64>,
    /// Folder for temporary files, which are always removed [default: the system's]
    #[arg(long, value_name = "DIR")]
    temp: Option<PathBuf>,
    /// Keep the finished parts of a cloud in --temp if the run is interrupted, and continue from them in the next run
    #[arg(long, requires = "temp")]
    resume: bool,
}

impl MemoryArgs {
    /// Resolves how files larger than memory are processed; `always` requests it for all files.
    pub(super) fn resolve(self, always: bool) -> OutOfCore {
        let MemoryArgs { memory, temp, resume } = self;
        OutOfCore { always, memory, temp, resume }
    }
}

/// Returns whether a report with this name is a page rather than JSON.
pub fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html"))
}

/// Amount of output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Voice {
    /// Only errors.
    Quiet,
    /// The report, and a progress bar if there is a terminal.
    Normal,
    /// The report, and one line per stage.
    Verbose,
}

/// How normals of a cloud are estimated.
#[derive(Debug, clap::Args)]
pub(super) struct NormalArgs {
    /// Shape fitted to estimate the normals of a cloud without normals [default: plane, or sphere where noise is smoothed]
    #[arg(long, value_name = "plane|sphere", value_parser = normal_fit)]
    normal_fit: Option<NormalFit>,
    #[arg(long, value_name = "K", conflicts_with = "normal_radius", help = neighbors_help())]
    normal_neighbors: Option<usize>,
    /// Radius within which neighbours are used instead, in the units of the input
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = positive)]
    normal_radius: Option<f64>,
}

/// The help texts of options whose defaults are defined in the library.
fn neighbors_help() -> String {
    format!(
        "Number of neighbours used for each normal [default: {FEW_NEIGHBORS}, or {MANY_NEIGHBORS} where noise is smoothed]"
    )
}

pub(super) fn smoothing_help() -> String {
    format!(
        "Smooth noise away first, of clouds and of meshes, with a support radius of W mean distances between neighbours, \
         {SMOOTHING_SUPPORT} without W; 0 smooths nothing [default: {SMOOTHING_SUPPORT} for clouds with noise, else 0]"
    )
}

pub(super) fn support_help() -> String {
    format!(
        "Support radius of the points of a cloud, in mean distances between neighbours: the larger, the smoother; 0 stands for \
         {INTERPOLATING_SUPPORT}, the least that leaves no holes [default: {SMOOTHING_SUPPORT} for clouds with noise, else 0]"
    )
}

impl From<NormalArgs> for NormalSettings {
    fn from(args: NormalArgs) -> NormalSettings {
        let NormalArgs { normal_fit, normal_neighbors, normal_radius } = args;
        NormalSettings { fit: normal_fit, neighbors: normal_neighbors, radius: normal_radius }
    }
}

/// What the files are said to be.
#[derive(Debug, clap::Args)]
pub(super) struct FormatArgs {
    /// Format of the input [default: by its extension, else by its content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    /// Format of the output [default: by its extension]
    #[arg(long, value_name = "FORMAT")]
    output_format: Option<Format>,
}

impl FormatArgs {
    /// Returns the input and the output.
    pub(super) fn resolve(self, input: PathBuf, output: PathBuf) -> (MeshFile, MeshFile) {
        let FormatArgs { format, output_format } = self;
        (MeshFile { path: input, format }, MeshFile { path: output, format: output_format })
    }
}

/// A file and the format it was declared to have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFile {
    /// Its path, as it was given.
    pub path: PathBuf,
    /// The format, if it does not follow from the file's ending or content.
    pub format: Option<Format>,
}
