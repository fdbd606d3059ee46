//! What the commands do, as lists of steps over the library.

use crate::base::error::{Error, Result};
use crate::base::progress::{Monitor, Stopwatch, check};
use crate::cli::Status;
use crate::cli::args::{Job, Measuring, MeshFile, Remeshing, Sizing, Voice};
use crate::cli::sample::{sample_file, signals};
use crate::cli::terminal::{self, Terminal};
use crate::io::{Format, Loaded, file};
use crate::remesh::{Options, Remeshed, Signal, remesh};
use crate::report::{Crossings, Named, Report, shortcomings};
use crate::surface::weld::weld;
use std::path::Path;

/// Does a job, and says how it went.
///
/// # Errors
/// Those of reading, remeshing and writing; a result that is not verified is not among them.
pub fn run(job: &Job) -> Result<Status> {
    terminal::listen_for_interrupts();
    match job {
        Job::Remesh(job) => with_threads(job.threads, || remesh_file(job))?,
        Job::Sample(job) => with_threads(job.threads, || sample_file(job))?.map(|()| Status::Done),
        Job::Measure(job) => with_threads(job.threads, || measure_file(job))?,
        Job::Complete(script) => terminal::print(script).map(|()| Status::Done),
    }
}

/// Reads, remeshes, measures, writes, reports.
fn remesh_file(job: &Remeshing) -> Result<Status> {
    job.options.validate()?;
    check_targets(job)?;
    let (remeshed, report) = {
        let terminal = Terminal::new(job.voice);
        let monitor = Stopwatch::new(&terminal);
        let (input, fields) = load_with_fields(job, &monitor)?;
        let remeshed = remesh_loaded(&input, fields, job, &monitor)?;
        let report = wants_report(job).then(|| measure(&remeshed, &input, job, &monitor));
        store(&remeshed, job, &monitor)?;
        (remeshed, report.map(|report| with_run(report, &monitor)))
    };
    if let Some(report) = &report {
        hand_out(report, job)?;
    }
    Ok(verdict(&remeshed, job))
}

/// Reads, measures, reports.
fn measure_file(job: &Measuring) -> Result<Status> {
    let report = {
        let terminal = Terminal::new(Voice::Normal);
        let monitor = Stopwatch::new(&terminal);
        let mesh = load(&job.mesh, &monitor)?;
        let against = job.against.as_ref().map(|input| load(input, &monitor)).transpose()?;
        monitor.stage("measure");
        let against_name = job.against.as_ref().map(name).unwrap_or_default();
        let mut report = Report::of_mesh(
            Named { file: &name(&job.mesh), mesh: &mesh.mesh },
            against.as_ref().map(|input| Named { file: &against_name, mesh: &input.mesh }),
        );
        report.notes = against.into_iter().chain([mesh]).flat_map(|loaded| loaded.notes).collect();
        check(&monitor)?;
        with_run(report, &monitor)
    };
    terminal::print(&if job.json { report.to_json() } else { report.to_text() })?;
    Ok(Status::Done)
}

/// Calls `work` where rayon has as many threads as are wanted.
fn with_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| Error::Option {
        option: "--threads",
        cause: e.to_string(),
        remedy: "use fewer".into(),
    })?;
    Ok(pool.install(work))
}

/// Refuses targets that nothing can be written to, before the work for them is done and not after.
fn check_targets(job: &Remeshing) -> Result<()> {
    file::output_format(&job.output.path, job.output.format)?;
    file::check_target(&job.output.path)?;
    job.report.iter().try_for_each(|path| file::check_target(path))
}

/// A mesh with triangles from a file.
fn load(from: &MeshFile, monitor: &dyn Monitor) -> Result<Loaded> {
    with_triangles(load_with_properties(from, &[], monitor)?.0, from)
}

/// A file and properties of its vertices. The facets of an STL file have corners of their own; here they share them.
pub(super) fn load_with_properties(
    from: &MeshFile,
    names: &[&str],
    monitor: &dyn Monitor,
) -> Result<(Loaded, Vec<Vec<f64>>)> {
    monitor.stage("read");
    let (mut loaded, values) = file::read_file_and_properties(&from.path, from.format, names)?;
    check(monitor)?;
    if loaded.format == Format::Stl {
        loaded.mesh = weld(&loaded.mesh);
    }
    Ok((loaded, values))
}

/// What is known at the vertices of an input.
struct Fields {
    sizing: Option<Vec<f64>>,
    signals: Vec<Signal>,
}

/// The input and what is wanted to be known at its vertices.
fn load_with_fields(job: &Remeshing, monitor: &dyn Monitor) -> Result<(Loaded, Fields)> {
    let mut names: Vec<&str> = job.properties.iter().map(|property| property.name.as_str()).collect();
    let mut sizing = match &job.sizing {
        Some(Sizing::File(path)) => Some(file::read_numbers(path)?),
        Some(Sizing::Property(name)) => {
            names.push(name);
            None
        }
        None => None,
    };
    let (loaded, mut values) = load_with_properties(&job.input, &names, monitor)?;
    if matches!(job.sizing, Some(Sizing::Property(_))) {
        sizing = values.pop();
    }
    Ok((with_triangles(loaded, &job.input)?, Fields { sizing, signals: signals(&job.properties, values) }))
}

/// A loaded mesh, which has to have triangles.
fn with_triangles(loaded: Loaded, from: &MeshFile) -> Result<Loaded> {
    if loaded.mesh.triangles.is_empty() {
        let vertices = loaded.mesh.positions.len();
        let cause = format!("{vertices} vertices and no triangles");
        let remedy = "a surface is needed: make one of the points first, for example by Poisson reconstruction";
        return Err(Error::Mesh { cause, remedy: remedy.into() }.in_file(&name(from)));
    }
    Ok(loaded)
}

fn remesh_loaded(input: &Loaded, fields: Fields, job: &Remeshing, monitor: &dyn Monitor) -> Result<Remeshed> {
    let Fields { sizing, signals } = fields;
    let options = Options { sizing, signals, ..job.options.clone() };
    let mut remeshed = remesh(&input.mesh, &options, monitor).map_err(|e| e.in_file(&name(&job.input)))?;
    remeshed.notes.splice(0..0, input.notes.iter().cloned());
    Ok(remeshed)
}

/// Whether anybody sees the report: measuring takes time.
fn wants_report(job: &Remeshing) -> bool {
    job.voice != Voice::Quiet || job.report.is_some()
}

fn measure(remeshed: &Remeshed, input: &Loaded, job: &Remeshing, monitor: &dyn Monitor) -> Report {
    monitor.stage("measure");
    let input = Named { file: &name(&job.input), mesh: &input.mesh };
    Report::of_remesh(remeshed, input, &name(&job.output), job.options.seed)
}

fn store(remeshed: &Remeshed, job: &Remeshing, monitor: &dyn Monitor) -> Result<()> {
    check(monitor)?;
    monitor.stage("write");
    file::write_file(&job.output.path, &remeshed.mesh, job.output.format)
}

/// The report with the times of the stages until now, the memory and the threads.
fn with_run(report: Report, stopwatch: &Stopwatch) -> Report {
    report.with_run(&stopwatch.laps(), peak_memory_bytes(), rayon::current_num_threads())
}

/// The report to its file and to standard output.
fn hand_out(report: &Report, job: &Remeshing) -> Result<()> {
    if let Some(path) = &job.report {
        file::replace_file(path, &mut |out| out.write_all(report.to_json().as_bytes()))?;
    }
    if job.voice == Voice::Quiet { Ok(()) } else { terminal::print(&report.to_text()) }
}

/// The exit status of a result that is written, and a line about one that is not verified.
fn verdict(remeshed: &Remeshed, job: &Remeshing) -> Status {
    if remeshed.verified() {
        return Status::Done;
    }
    let why = shortcomings(&remeshed.output, &remeshed.repaired, &Crossings::of(remeshed), remeshed.deviation.as_ref());
    let why = why.join(", ");
    terminal::complain(&format!(
        "{}: written but not verified: {why}; try another --seed or more points",
        name(&job.output)
    ));
    Status::Unverified
}

pub(super) fn name(file: &MeshFile) -> String {
    file.path.display().to_string()
}

/// The most memory that this process had at once, where Linux tells.
pub(super) fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string(Path::new("/proc/self/status")).ok()?;
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix("kB")?;
    kilobytes.trim().parse::<u64>().ok().map(|n| 1024 * n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_has_used_a_megabyte_and_less_than_a_terabyte() {
        let peak = peak_memory_bytes().unwrap();
        assert!((1 << 20..1 << 40).contains(&peak));
    }

    #[test]
    fn threads_are_as_many_as_wanted() {
        assert_eq!(with_threads(Some(3), rayon::current_num_threads), Ok(3));
    }
}
