//! `remesh IN OUT`: reads, remeshes, writes, reports.

use crate::base::error::Result;
use crate::cli::args::{Remeshing, Run, Sizing, Voice, is_page};
use crate::cli::files::{add_run, check_targets, hand_out, load, name, now_writing, watched};
use crate::cli::status::Status;
use crate::cli::terminal;
use crate::io::{Loaded, file};
use crate::job::{Carry, Input, Outcome, RemeshOptions, of_use_for_remeshing, remesh};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Grading, Values};
use crate::report::page::{Subject, page};

pub(super) fn remesh_file(job: &Remeshing) -> Result<Status> {
    job.options.surface.validate()?;
    file::output_format(&job.output.path, job.output.format)?;
    check_targets(&job.output.path, &job.run)?;
    let (outcome, page) = watched(job.run.voice, |monitor| {
        let loaded = load(&job.input, of_use(job), monitor)?;
        let options = options(job, &loaded)?;
        let mut outcome = remesh(&Input::from(&loaded), &options, monitor).map_err(|e| e.in_file(&name(&job.input)))?;
        now_writing(monitor);
        file::write_file(&job.output.path, &outcome.mesh, &outcome.attributes, job.output.format)?;
        if let Some(report) = &mut outcome.report {
            report.run.notes.splice(0..0, loaded.notes);
            report.add_files(&name(&job.input), &name(&job.output));
            add_run(&mut report.run, monitor);
        }
        let page = page_of(&outcome, &loaded.mesh, &job.run);
        Ok((outcome, page))
    })?;
    if let Some(report) = &outcome.report {
        hand_out(&page.unwrap_or_else(|| report.to_json()), &report.to_text(), &job.run)?;
    }
    // Without the report nothing else would tell.
    for warning in outcome.warnings.iter().filter(|_| job.run.voice == Voice::Quiet) {
        terminal::complain(&format!("{}: {warning}", name(&job.input)));
    }
    Ok(verdict(&outcome, job))
}

/// The report as a page, if that is wanted.
fn page_of(outcome: &Outcome, input: &Mesh, run: &Run) -> Option<String> {
    let report = outcome.report.as_ref().filter(|_| run.report.as_deref().is_some_and(is_page))?;
    let subject = Subject { report, mesh: &outcome.mesh, edges: Some(&outcome.edges) };
    Some(page(Some(outcome.of_points.as_ref().unwrap_or(input)), &[subject]))
}

/// How many points of a cloud are of use; `None` if that is not known, or if another file has a number for each.
fn of_use(job: &Remeshing) -> Option<usize> {
    let is_given = matches!(job.sizing, Some(Sizing::File(_)));
    of_use_for_remeshing(&job.options.surface).filter(|_| !is_given)
}

/// The options, with what other files say of them.
fn options(job: &Remeshing, loaded: &Loaded) -> Result<RemeshOptions> {
    let mut options = job.options.clone();
    if let Some(Sizing::File(path)) = &job.sizing {
        options.surface.grading = Grading::Field(Values::Given(file::read_numbers(path)?));
    }
    if options.carry == Carry::All {
        let format = file::output_format(&job.output.path, job.output.format)?;
        options.carry = Carry::AllBut(format.cannot_hold(&loaded.attributes));
    }
    options.without_report = job.run.voice == Voice::Quiet && job.run.report.is_none();
    Ok(options)
}

/// The exit status of a result that is written, and a line about one that is not verified.
fn verdict(outcome: &Outcome, job: &Remeshing) -> Status {
    if outcome.verified() {
        return Status::Done;
    }
    let why = outcome.shortcomings.join(", ");
    let output = name(&job.output);
    terminal::complain(&format!("{output}: written but not verified: {why}; try another --seed or more points"));
    Status::Unverified
}
