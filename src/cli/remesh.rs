//! `remesh IN OUT`: reads, remeshes, writes, reports.

use crate::base::error::Result;
use crate::base::monitor::Stopwatch;
use crate::cli::args::{Remeshing, Run, Sizing, Voice, is_page};
use crate::cli::files::{add_run, check_report, hand_out, load, name, now_writing, watched};
use crate::cli::outputs::Outputs;
use crate::cli::status::Status;
use crate::cli::terminal;
use crate::io::{Loaded, file};
use crate::job::large::{LargeFile, read_coarsened, remesh_in_pieces};
use crate::job::{Carry, Input, Outcome, RemeshOptions, remesh, remesh_levels, wanted_for_remeshing};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Grading, Values};
use crate::prepare::thin::Wanted;
use crate::report::page::{Subject, page};
use crate::report::{Report, all_to_json, all_to_text};

pub(super) fn remesh_file(job: &Remeshing) -> Result<Status> {
    job.options.surface.validate()?;
    let outputs = Outputs::of(job)?;
    check_report(&job.run)?;
    let (outcomes, reports, page) = watched(job.run.voice, |monitor| {
        let Made { mut outcomes, input, notes } = match in_pieces(job, &outputs, monitor)? {
            Some(outcome) => Made { outcomes: vec![outcome], input: None, notes: Vec::new() },
            None => in_memory(job, &outputs, monitor)?,
        };
        now_writing(monitor);
        outputs.write(&outcomes)?;
        for (outcome, output) in outcomes.iter_mut().zip(&outputs.names) {
            if let Some(report) = &mut outcome.report {
                report.run.notes.splice(0..0, notes.clone());
                report.add_files(&name(&job.input), output);
            }
        }
        outcomes
            .last_mut()
            .and_then(|last| last.report.as_mut())
            .iter_mut()
            .for_each(|report| add_run(&mut report.run, monitor));
        let page = page_of(&outcomes, input.as_ref(), &job.run);
        let reports: Vec<Report> = outcomes.iter_mut().filter_map(|outcome| outcome.report.take()).collect();
        Ok((outcomes, reports, page))
    })?;
    if !reports.is_empty() {
        hand_out(&page.unwrap_or_else(|| all_to_json(&reports)), &all_to_text(&reports), &job.run)?;
    }
    // Without a printed report, nothing else would show the warnings.
    let mut warnings: Vec<&String> = outcomes.iter().flat_map(|outcome| &outcome.warnings).collect();
    warnings.dedup();
    for warning in warnings.into_iter().filter(|_| job.run.voice == Voice::Quiet) {
        terminal::complain(&format!("{}: {warning}", name(&job.input)));
    }
    Ok(verdict(&outcomes, &outputs.names))
}

/// The results of a job.
struct Made {
    outcomes: Vec<Outcome>,
    /// The input; `None` if it was never in memory as a whole.
    input: Option<Mesh>,
    /// Notes from reading the input.
    notes: Vec<String>,
}

/// Returns the input of a job as a file that may be larger than memory.
fn large(job: &Remeshing) -> LargeFile<'_> {
    let Remeshing { input, output, out_of_core, .. } = job;
    LargeFile { path: &input.path, format: input.format, output: &output.path, out_of_core }
}

/// Remeshes a cloud piece by piece; returns `None` for jobs that pieces cannot do.
fn in_pieces(job: &Remeshing, outputs: &Outputs, monitor: &Stopwatch) -> Result<Option<Outcome>> {
    if outputs.are_tiles || !job.levels.is_empty() || job.sizing.is_some() {
        return Ok(None);
    }
    remesh_in_pieces(&large(job), &job.options, Some(outputs.format), monitor)
}

/// Remeshes an input that is read as a whole, or that is coarsened while it is read.
fn in_memory(job: &Remeshing, outputs: &Outputs, monitor: &Stopwatch) -> Result<Made> {
    let loaded = match read_coarsened(&large(job), &job.options.surface, monitor)? {
        Some(loaded) => loaded,
        None => load(&job.input, wanted(job), monitor)?,
    };
    let options = options(job, outputs, &loaded)?;
    let outcomes = outcomes(job, &loaded, &options, monitor).map_err(|e| e.in_file(&name(&job.input)))?;
    Ok(Made { outcomes, input: Some(loaded.mesh), notes: loaded.notes })
}

/// Returns the results: one, or one for each level. Each report has the stages since the previous one.
fn outcomes(job: &Remeshing, loaded: &Loaded, options: &RemeshOptions, monitor: &Stopwatch) -> Result<Vec<Outcome>> {
    let input = Input::from(loaded);
    if job.levels.is_empty() {
        return Ok(vec![remesh(&input, options, monitor)?]);
    }
    let mut outcomes = Vec::new();
    let keep = &mut |mut outcome: Outcome| {
        if outcomes.len() + 1 < job.levels.len() {
            outcome.report.iter_mut().for_each(|report| add_run(&mut report.run, monitor));
            monitor.restart();
        }
        outcomes.push(outcome);
        Ok(())
    };
    remesh_levels(&input, options, &job.levels, keep, monitor)?;
    Ok(outcomes)
}

/// Returns the reports as a page, if one was requested.
fn page_of(outcomes: &[Outcome], input: Option<&Mesh>, run: &Run) -> Option<String> {
    run.report.as_deref().filter(|path| is_page(path))?;
    let reference = outcomes.first().and_then(|outcome| outcome.of_points.as_deref());
    let shown = |report: &Report| if run.voice == Voice::Verbose { report.clone() } else { report.without_run() };
    let reports: Option<Vec<Report>> = outcomes.iter().map(|outcome| outcome.report.as_ref().map(shown)).collect();
    let reports = reports?;
    let subject = |(outcome, report)| subject(outcome, report);
    let subjects: Vec<Subject> = outcomes.iter().zip(&reports).map(subject).collect();
    Some(page(reference.or(input), &subjects))
}

fn subject<'a>(outcome: &'a Outcome, report: &'a Report) -> Subject<'a> {
    Subject { report, mesh: &outcome.mesh, edges: Some(&outcome.edges) }
}

/// Returns which points of a cloud are wanted, of any number if another file has a number for each point.
fn wanted(job: &Remeshing) -> Wanted {
    let wanted = wanted_for_remeshing(&job.options.surface);
    let is_given = matches!(job.sizing, Some(Sizing::File(_)));
    Wanted { points: wanted.points.filter(|_| !is_given), ..wanted }
}

/// Returns the options, completed from other files.
fn options(job: &Remeshing, outputs: &Outputs, loaded: &Loaded) -> Result<RemeshOptions> {
    let mut options = job.options.clone();
    if let Some(Sizing::File(path)) = &job.sizing {
        options.surface.grading = Grading::Field(Values::Given(file::read_numbers(path)?));
    }
    if options.carry == Carry::All {
        options.carry = Carry::AllBut(outputs.format.cannot_hold(&loaded.attributes));
    }
    // Tiles state the distance of their level to the input, which the report contains.
    options.without_report = job.run.voice == Voice::Quiet && job.run.report.is_none() && !outputs.are_tiles;
    Ok(options)
}

/// Returns the exit status of results that were written, and prints a line about each result that is not verified.
fn verdict(outcomes: &[Outcome], names: &[String]) -> Status {
    let mut status = Status::Done;
    for (outcome, output) in outcomes.iter().zip(names).filter(|(outcome, _)| !outcome.verified()) {
        let why = outcome.shortcomings.join(", ");
        terminal::complain(&format!("{output}: written but not verified: {why}; try another --seed or more points"));
        status = Status::Unverified;
    }
    status
}
