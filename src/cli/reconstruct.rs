//! `remesh reconstruct`: reads, reconstructs, writes, reports.

use crate::base::error::Result;
use crate::base::monitor::check;
use crate::cli::args::Reconstructing;
use crate::cli::files::{add_run, check_targets, hand_out, load, name, now_writing, watched};
use crate::io::file;
use crate::job::{Input, reconstruct};
use crate::mesh::attributes::Attributes;
use crate::prepare::thin::Wanted;
use crate::report::surface::SurfaceReport;

pub(super) fn reconstruct_file(job: &Reconstructing) -> Result<()> {
    job.options.validate()?;
    file::output_format(&job.output.path, job.output.format)?;
    check_targets(&job.output.path, &job.run)?;
    let report = watched(job.run.voice, |monitor| {
        let loaded = load(&job.input, Wanted::default(), monitor)?;
        let made =
            reconstruct(&Input::from(&loaded), &job.options, monitor).map_err(|e| e.in_file(&name(&job.input)))?;
        check(monitor)?;
        now_writing(monitor);
        file::write_file(&job.output.path, &made.mesh, &Attributes::default(), job.output.format)?;
        let mut report = SurfaceReport::new(&made, loaded.notes, name(&job.input), name(&job.output));
        add_run(&mut report.run, monitor);
        Ok(report)
    })?;
    hand_out(&report.to_json(), &report.to_text(), &job.run)
}
