//! `remesh quality`: reads, measures, reports.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{Measuring, Voice};
use crate::cli::files::{input, load, name, peak_memory_bytes, watched};
use crate::cli::terminal;
use crate::job::quality;

pub(super) fn measure_file(job: &Measuring) -> Result<()> {
    let report = watched(Voice::Normal, |monitor| {
        let mesh = load(&job.mesh, monitor)?;
        let against = job.against.as_ref().map(|file| load(file, monitor)).transpose()?;
        monitor.stage("measure");
        let measured = quality(&input(&mesh), against.as_ref().map(input).as_ref());
        let mut report = measured.map_err(|e| e.in_file(&name(&job.mesh)))?;
        check(monitor)?;
        report.add_files(&job.against.as_ref().map(name).unwrap_or_default(), &name(&job.mesh));
        report.notes = against.into_iter().chain([mesh]).flat_map(|loaded| loaded.notes).collect();
        report.add_run(&monitor.laps(), peak_memory_bytes(), rayon::current_num_threads());
        Ok(report)
    })?;
    terminal::print(&if job.json { report.to_json() } else { report.to_text() })
}
