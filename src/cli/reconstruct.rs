//! `remesh reconstruct`: what it does.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, Stopwatch, check};
use crate::cli::args::Reconstructing;
use crate::cli::run::{hand_out, load, name, peak_memory_bytes};
use crate::cli::terminal::Terminal;
use crate::io::{Loaded, file};
use crate::mesh::attributes::Attributes;
use crate::mesh::points::Points;
use crate::pipeline::{points_of_mesh, reconstruct};
use crate::report::surface::SurfaceReport;

/// Reads, reconstructs, writes, reports.
pub(super) fn reconstruct_file(job: &Reconstructing) -> Result<()> {
    job.options.validate()?;
    file::output_format(&job.output.path, job.output.format)?;
    file::check_target(&job.output.path)?;
    job.run.report.iter().try_for_each(|path| file::check_target(path))?;
    let report = {
        let terminal = Terminal::new(job.run.voice);
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
    hand_out(&report.to_json(), &report.to_text(), &job.run)
}

/// The points of an input: those of a mesh have its normals.
fn points(input: Loaded) -> Points {
    if input.mesh.triangles.is_empty() { input.into_points() } else { points_of_mesh(&input.mesh) }
}
