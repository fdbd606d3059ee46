//! `remesh quality`: reads, measures, reports.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{Measuring, MeshFile, Voice};
use crate::cli::files::{add_run, load, name, watched};
use crate::cli::terminal;
use crate::job::{Input, quality};

pub(super) fn measure_file(job: &Measuring) -> Result<()> {
    let report = watched(Voice::Normal, |monitor| {
        let load = |file: &MeshFile| {
            let loaded = load(file, monitor)?;
            Input::from(&loaded).refuse_points().map_err(|e| e.in_file(&name(file)))?;
            Ok(loaded)
        };
        let mesh = load(&job.mesh)?;
        let against = job.against.as_ref().map(load).transpose()?;
        monitor.stage("measure");
        let measured = quality(&Input::from(&mesh), against.as_ref().map(Input::from).as_ref());
        let mut report = measured.map_err(|e| e.in_file(&name(&job.mesh)))?;
        check(monitor)?;
        report.add_files(&job.against.as_ref().map(name).unwrap_or_default(), &name(&job.mesh));
        report.run.notes = against.into_iter().chain([mesh]).flat_map(|loaded| loaded.notes).collect();
        add_run(&mut report.run, monitor);
        Ok(report)
    })?;
    terminal::print(&if job.json { report.to_json() } else { report.to_text() })
}
