//! `remesh quality`: reads, measures, reports.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, Stopwatch, check};
use crate::cli::args::{Measuring, MeshFile, Voice, is_page};
use crate::cli::files::{add_run, load, name, watched, write_report};
use crate::cli::terminal;
use crate::io::{Loaded, file};
use crate::job::{Input, quality};
use crate::prepare::thin::Wanted;
use crate::report::page::{Subject, page};
use crate::report::{Report, all_to_json, all_to_text};

pub(super) fn measure_files(job: &Measuring) -> Result<()> {
    job.report.iter().try_for_each(|path| file::check_target(path))?;
    let (reports, written) = watched(Voice::Normal, |monitor| {
        let meshes: Vec<Loaded> = job.meshes.iter().map(|file| load_mesh(file, monitor)).collect::<Result<_>>()?;
        let against = job.against.as_ref().map(|file| load_mesh(file, monitor)).transpose()?;
        let reports = measured(job, &meshes, against.as_ref(), monitor)?;
        let written = job.report.as_ref().map(|path| match is_page(path) {
            true => page_of(&reports, &meshes, against.as_ref()),
            false => all_to_json(&reports),
        });
        Ok((reports, written))
    })?;
    if let Some((path, written)) = job.report.as_ref().zip(written) {
        write_report(path, &written)?;
    }
    terminal::print(&if job.json { all_to_json(&reports) } else { all_to_text(&reports) })
}

fn load_mesh(file: &MeshFile, monitor: &dyn Monitor) -> Result<Loaded> {
    let loaded = load(file, Wanted::default(), monitor)?;
    Input::from(&loaded).refuse_points().map_err(|e| e.in_file(&name(file)))?;
    Ok(loaded)
}

/// Returns the report on each mesh.
fn measured(job: &Measuring, meshes: &[Loaded], against: Option<&Loaded>, monitor: &Stopwatch) -> Result<Vec<Report>> {
    monitor.stage("measure");
    let mut reports = Vec::new();
    for (file, mesh) in job.meshes.iter().zip(meshes) {
        let measured = quality(&Input::from(mesh), against.map(Input::from).as_ref());
        let mut report = measured.map_err(|e| e.in_file(&name(file)))?;
        check(monitor)?;
        report.add_files(&job.against.as_ref().map(name).unwrap_or_default(), &name(file));
        report.run.notes = against.into_iter().chain([mesh]).flat_map(|loaded| loaded.notes.clone()).collect();
        reports.push(report);
    }
    reports.iter_mut().for_each(|report| add_run(&mut report.run, monitor));
    Ok(reports)
}

fn page_of(reports: &[Report], meshes: &[Loaded], against: Option<&Loaded>) -> String {
    let meshes = meshes.iter().map(|loaded| &loaded.mesh);
    let reports: Vec<Report> = reports.iter().map(Report::without_run).collect();
    let subjects = reports.iter().zip(meshes).map(|(report, mesh)| Subject { report, mesh, edges: None });
    page(against.map(|loaded| &loaded.mesh), &subjects.collect::<Vec<_>>())
}
