//! `remesh quality`: reads, measures, reports.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{Measuring, MeshFile, Voice};
use crate::cli::files::{input, load, name, peak_memory_bytes, watched};
use crate::cli::terminal;
use crate::job::quality;

pub(super) fn measure_file(job: &Measuring) -> Result<()> {
    let report = watched(Voice::Normal, |monitor| {
        let load = |file: &MeshFile| {
            let loaded = load(file, monitor)?;
            input(&loaded).refuse_points().map_err(|e| e.in_file(&name(file)))?;
            Ok(loaded)
        };
        let mesh = load(&job.mesh)?;
        let against = job.against.as_ref().map(load).transpose()?;
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
