//! `remesh sample`: reads, samples, writes, reports.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{MeshFile, Sampling};
use crate::cli::files::{add_run, check_targets, hand_out, load, name, now_writing, watched};
use crate::io::file;
use crate::job::large::{LargeFile, sample_in_tiles};
use crate::job::{Input, sample, wanted_for_sampling};
use crate::pipeline::Sampled;
use crate::report::samples::SamplesReport;

pub(super) fn sample_file(job: &Sampling) -> Result<()> {
    job.options.validate()?;
    let format = file::points_format(&job.output, None)?;
    check_targets(&job.output, &job.run)?;
    let report = watched(job.run.voice, |monitor| {
        let (sampled, read_notes) = sampled(job, monitor)?;
        check(monitor)?;
        let lost = format.cannot_hold(&sampled.carried);
        let sampled = sampled.without(lost);
        now_writing(monitor);
        file::write_points_file(&job.output, &sampled.points, &sampled.attributes(), None)?;
        let mut report = SamplesReport::new(&sampled, &job.options, name(&job.input), job.output.display().to_string());
        report.run.notes.splice(0..0, read_notes);
        add_run(&mut report.run, monitor);
        Ok(report)
    })?;
    hand_out(&report.to_json(), &report.to_text(), &job.run)
}

/// Returns the samples, and notes from reading the input.
fn sampled(job: &Sampling, monitor: &dyn Monitor) -> Result<(Sampled, Vec<String>)> {
    let MeshFile { path, format } = &job.input;
    let file = LargeFile { path, format: *format, output: &job.output, out_of_core: &job.out_of_core };
    if let Some(sampled) = sample_in_tiles(&file, &job.options, monitor)? {
        return Ok((sampled, Vec::new()));
    }
    let loaded = load(&job.input, wanted_for_sampling(&job.options), monitor)?;
    let sampled = sample(&Input::from(&loaded), &job.options, monitor).map_err(|e| e.in_file(&name(&job.input)))?;
    Ok((sampled, loaded.notes))
}
