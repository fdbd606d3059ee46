//! `remesh quality`: reads, measures, reports.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{Measuring, MeshFile, Voice, is_page};
use crate::cli::files::{add_run, load, name, watched, write_report};
use crate::cli::terminal;
use crate::io::{Loaded, file};
use crate::job::{Input, quality};
use crate::report::page::{Subject, page};
use crate::report::{Report, all_to_json};

pub(super) fn measure_files(job: &Measuring) -> Result<()> {
    job.report.iter().try_for_each(|path| file::check_target(path))?;
    let (reports, written) = watched(Voice::Normal, |monitor| {
        let load = |file: &MeshFile| {
            let loaded = load(file, monitor)?;
            Input::from(&loaded).refuse_points().map_err(|e| e.in_file(&name(file)))?;
            Ok(loaded)
        };
        let meshes: Vec<Loaded> = job.meshes.iter().map(load).collect::<Result<_>>()?;
        let against = job.against.as_ref().map(load).transpose()?;
        monitor.stage("measure");
        let mut reports = Vec::new();
        for (file, mesh) in job.meshes.iter().zip(&meshes) {
            let measured = quality(&Input::from(mesh), against.as_ref().map(Input::from).as_ref());
            let mut report = measured.map_err(|e| e.in_file(&name(file)))?;
            check(monitor)?;
            report.add_files(&job.against.as_ref().map(name).unwrap_or_default(), &name(file));
            report.run.notes = against.iter().chain([mesh]).flat_map(|loaded| loaded.notes.clone()).collect();
            reports.push(report);
        }
        reports.iter_mut().for_each(|report| add_run(&mut report.run, monitor));
        let subjects: Vec<Subject> = reports
            .iter()
            .zip(&meshes)
            .map(|(report, mesh)| Subject { report, mesh: &mesh.mesh, edges: None })
            .collect();
        let written = job.report.as_ref().map(|path| match is_page(path) {
            true => page(against.as_ref().map(|loaded| &loaded.mesh), &subjects),
            false => all_to_json(&reports),
        });
        Ok((reports, written))
    })?;
    if let Some((path, written)) = job.report.as_ref().zip(written) {
        write_report(path, &written)?;
    }
    terminal::print(&if job.json { all_to_json(&reports) } else { tables(&reports) })
}

/// The table of each report, with a line between.
fn tables(reports: &[Report]) -> String {
    reports.iter().map(Report::to_text).collect::<Vec<_>>().join("\n")
}
