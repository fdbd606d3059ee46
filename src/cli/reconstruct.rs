//! `remesh reconstruct`: its arguments, and what it does.

use crate::base::error::Result;
use crate::base::progress::{Monitor, Stopwatch, check};
use crate::cli::args::{MeshFile, NormalArgs, Voice, positive, voice};
use crate::cli::run::{load, name, peak_memory_bytes};
use crate::cli::terminal::{self, Terminal};
use crate::io::{Format, Loaded, file};
use crate::remesh::{ReconstructOptions, points_of_mesh, reconstruct};
use crate::report::surface::SurfaceReport;
use crate::surface::attributes::Attributes;
use crate::surface::points::Points;
use clap::ArgAction;
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Extracts all of the robust implicit surface of a cloud of points, or of the vertices of a mesh, as triangles about as
large as the cells that they are extracted with: dense, of all shapes, an oriented manifold. Noise is smoothed away. Where
the cloud has a border, the surface goes on for up to a spacing. For even triangles, or a number of them, remesh the result.

Exit status: 0 done, 1 a file cannot be read or written, or has no surface, 2 wrong usage, 130 interrupted.";

#[derive(Debug, clap::Args)]
pub(super) struct ReconstructArgs {
    /// The points to read, or a mesh whose vertices are taken
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The mesh to write; an existing file is replaced when the new one is complete
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Edge length of the cells, in the units of the input [default: half the mean spacing of the points]
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = positive)]
    resolution: Option<f64>,
    /// How far points reach, in mean distances of neighbouring ones: the larger, the smoother [default: 2.3]
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    smooth: Option<f64>,
    #[command(flatten)]
    normals: NormalArgs,
    /// Threads to use; the output does not depend on it [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Format of the input [default: by its ending, else by its content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    /// Format of the output [default: by its ending]
    #[arg(long, value_name = "FORMAT")]
    output_format: Option<Format>,
    /// Write the report to a file, as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Name each stage on standard error as it begins
    #[arg(short, long, action = ArgAction::SetTrue)]
    verbose: bool,
}

/// Reconstruct a file into another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconstructing {
    /// What to read.
    pub input: MeshFile,
    /// What to write.
    pub output: MeshFile,
    /// What to make of it.
    pub options: ReconstructOptions,
    /// Where the report goes as JSON, if it is wanted.
    pub report: Option<PathBuf>,
    /// As many as there are cores without.
    pub threads: Option<usize>,
    /// How much to say meanwhile.
    pub voice: Voice,
}

impl ReconstructArgs {
    pub(super) fn resolve(self) -> Reconstructing {
        let ReconstructArgs {
            input,
            output,
            resolution,
            smooth,
            normals,
            threads,
            format,
            output_format,
            report,
            quiet,
            verbose,
        } = self;
        Reconstructing {
            input: MeshFile { path: input, format },
            output: MeshFile { path: output, format: output_format },
            options: ReconstructOptions { resolution, cloud: normals.resolve(smooth, 0.0) },
            report,
            threads: threads.map(usize::from),
            voice: voice(quiet, verbose),
        }
    }
}

/// Reads, reconstructs, writes, reports.
pub(super) fn reconstruct_file(job: &Reconstructing) -> Result<()> {
    job.options.validate()?;
    file::output_format(&job.output.path, job.output.format)?;
    file::check_target(&job.output.path)?;
    job.report.iter().try_for_each(|path| file::check_target(path))?;
    let report = {
        let terminal = Terminal::new(job.voice);
        let monitor = Stopwatch::new(&terminal);
        let input = load(&job.input, &monitor)?;
        let notes = input.notes.clone();
        let made = reconstruct(&points(input), &job.options, &monitor).map_err(|e| e.in_file(&name(&job.input)))?;
        check(&monitor)?;
        monitor.stage("write");
        file::write_file(&job.output.path, &made.mesh, &Attributes::default(), job.output.format)?;
        let report = SurfaceReport::new(&made, notes, name(&job.input), name(&job.output));
        report.with_run(&monitor.laps(), peak_memory_bytes(), rayon::current_num_threads())
    };
    if let Some(path) = &job.report {
        file::replace_file(path, &mut |out| out.write_all(report.to_json().as_bytes()))?;
    }
    if job.voice == Voice::Quiet { Ok(()) } else { terminal::print(&report.to_text()) }
}

/// The points of an input: those of a mesh have its normals.
fn points(input: Loaded) -> Points {
    if input.mesh.triangles.is_empty() { input.into_points() } else { points_of_mesh(&input.mesh) }
}
