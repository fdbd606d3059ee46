//! What the commands do, as lists of steps over the library.

use crate::base::error::{Error, Result};
use crate::base::monitor::{Monitor, Stopwatch, check};
use crate::cli::Status;
use crate::cli::args::{Job, Mark, Measuring, MeshFile, Remeshing, Run, Sizing, Voice};
use crate::cli::reconstruct::reconstruct_file;
use crate::cli::sample::{sample_file, signals};
use crate::cli::terminal::{self, Terminal};
use crate::io::{Format, Loaded, file};
use crate::mesh::attributes::Attributes;
use crate::mesh::points::Points;
use crate::mesh::weld::weld;
use crate::pipeline::{CloudSummary, Options, Remeshed, Selection, Signal, check_field, mesh_of_points, remesh};
use crate::report::{Crossings, Named, Report, shortcomings};
use crate::transfer::vertex::{Carried, carry};
use std::path::Path;

/// Does a job, and says how it went.
///
/// # Errors
/// Those of reading, remeshing and writing; a result that is not verified is not among them.
pub fn run(job: &Job) -> Result<Status> {
    terminal::listen_for_interrupts();
    match job {
        Job::Remesh(job) => with_threads(job.run.threads, || remesh_file(job))?,
        Job::Sample(job) => with_threads(job.run.threads, || sample_file(job))?.map(|()| Status::Done),
        Job::Reconstruct(job) => with_threads(job.run.threads, || reconstruct_file(job))?.map(|()| Status::Done),
        Job::Measure(job) => with_threads(job.threads, || measure_file(job))?,
        Job::Complete(script) => terminal::print(script).map(|()| Status::Done),
    }
}

/// Reads, remeshes, measures, writes, reports.
fn remesh_file(job: &Remeshing) -> Result<Status> {
    job.options.validate()?;
    check_targets(job)?;
    let (remeshed, report) = {
        let terminal = Terminal::new(job.run.voice);
        let monitor = Stopwatch::new(&terminal);
        let mut input = load(&job.input, &monitor)?;
        let mut fields = fields(&input, job)?;
        let cloud = connect_points(&mut input, &mut fields, job, &monitor)?;
        let mut remeshed = remesh_loaded(&input, fields, cloud.is_none(), job, &monitor)?;
        let carried = carry_attributes(&mut input, &mut remeshed, job, &monitor)?;
        let report = wants_report(job).then(|| measure(&remeshed, &carried, &input, job, &monitor));
        let report = report.map(|report| Report { cloud, ..report });
        store(&remeshed, &carried.attributes, job, &monitor)?;
        (remeshed, report.map(|report| with_run(report, &monitor)))
    };
    if let Some(report) = &report {
        hand_out(&report.to_json(), &report.to_text(), &job.run)?;
    }
    Ok(verdict(&remeshed, job))
}

/// Reads, measures, reports.
fn measure_file(job: &Measuring) -> Result<Status> {
    let report = {
        let terminal = Terminal::new(Voice::Normal);
        let monitor = Stopwatch::new(&terminal);
        let load = |from: &MeshFile| load(from, &monitor).and_then(|loaded| refuse_points(loaded, from));
        let mesh = load(&job.mesh)?;
        let against = job.against.as_ref().map(load).transpose()?;
        monitor.stage("measure");
        let against_name = job.against.as_ref().map(name).unwrap_or_default();
        let mut report = Report::of_mesh(
            Named { file: &name(&job.mesh), mesh: &mesh.mesh },
            against.as_ref().map(|input| Named { file: &against_name, mesh: &input.mesh }),
        );
        report.run.notes = against.into_iter().chain([mesh]).flat_map(|loaded| loaded.notes).collect();
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
    job.run.report.iter().try_for_each(|path| file::check_target(path))
}

/// What is in a file. The facets of an STL file have corners of their own; here they share them.
pub(super) fn load(from: &MeshFile, monitor: &dyn Monitor) -> Result<Loaded> {
    monitor.stage("read");
    let mut loaded = file::read_file(&from.path, from.format)?;
    if loaded.format == Format::Stl {
        loaded.mesh = weld(&loaded.mesh);
    }
    check(monitor)?;
    Ok(loaded)
}

/// What is known at the vertices of an input.
struct Fields {
    sizing: Option<Vec<f64>>,
    signals: Vec<Signal>,
    part: Option<Selection>,
}

/// What is wanted to be known at the vertices of the input.
fn fields(input: &Loaded, job: &Remeshing) -> Result<Fields> {
    let sizing = match &job.sizing {
        Some(Sizing::Property(property)) => {
            Some(input.attributes.numbers(property).map_err(|e| e.in_file(&name(&job.input)))?)
        }
        Some(Sizing::File(path)) => Some(file::read_numbers(path)?),
        None => None,
    };
    let signals = signals(&job.properties, input).map_err(|e| e.in_file(&name(&job.input)))?;
    let part = match &job.select {
        Some(mark) => Some(selection(input, mark).map_err(|e| e.in_file(&name(&job.input)))?),
        None => job.options.part.clone(),
    };
    Ok(Fields { sizing, signals, part })
}

/// The marked vertices of the input.
fn selection(input: &Loaded, mark: &Mark) -> Result<Selection> {
    let numbers = input.attributes.numbers(&mark.property)?;
    let is_marked = |number: f64| mark.value.map_or(number != 0.0 && !number.is_nan(), |value| number == value);
    Ok(Selection::Vertices(numbers.into_iter().map(is_marked).collect()))
}

/// What was loaded, if it has triangles.
fn refuse_points(loaded: Loaded, from: &MeshFile) -> Result<Loaded> {
    if !loaded.mesh.triangles.is_empty() {
        return Ok(loaded);
    }
    let cause = format!("{} points and no triangles", loaded.mesh.positions.len());
    Err(Error::Mesh { cause, remedy: "make a mesh of them first, by remeshing them".into() }.in_file(&name(from)))
}

/// Makes a mesh of an input that has points only, and what is known at its vertices that of the mesh's.
fn connect_points(
    input: &mut Loaded,
    fields: &mut Fields,
    job: &Remeshing,
    monitor: &dyn Monitor,
) -> Result<Option<CloudSummary>> {
    if !input.mesh.triangles.is_empty() {
        return Ok(None);
    }
    if fields.part.is_some() {
        let option = if job.select.is_some() { "select" } else { "within" };
        let cause = "the input has points and no triangles, so nothing could stay as it is".into();
        return Err(Error::Option { option, cause, remedy: "make a mesh of it first, by remeshing all of it".into() });
    }
    let points = Points { positions: std::mem::take(&mut input.mesh.positions), normals: input.attributes.normals() };
    let made = mesh_of_points(&points, &job.cloud, monitor).map_err(|e| e.in_file(&name(&job.input)))?;
    input.attributes = input.attributes.of_vertices(&made.source);
    fields.sizing.iter().try_for_each(|lengths| check_field(points.positions.len(), lengths))?;
    for values in fields.sizing.iter_mut().chain(fields.signals.iter_mut().map(|signal| &mut signal.values)) {
        *values = made.source.iter().map(|&p| values[p as usize]).collect();
    }
    input.mesh = made.mesh;
    Ok(Some(made.summary))
}

/// Remeshes the input, which is smooth already if it is made of points.
fn remesh_loaded(
    input: &Loaded,
    fields: Fields,
    is_mesh: bool,
    job: &Remeshing,
    monitor: &dyn Monitor,
) -> Result<Remeshed> {
    let Fields { sizing, signals, part } = fields;
    let smooth = job.options.smooth.filter(|_| is_mesh);
    let options = Options { sizing, signals, smooth, of_points: !is_mesh, part, ..job.options.clone() };
    let mut remeshed = remesh(&input.mesh, &options, monitor).map_err(|e| e.in_file(&name(&job.input)))?;
    remeshed.notes.splice(0..0, input.notes.iter().cloned());
    Ok(remeshed)
}

/// The attributes of the input on the output, as far as its file has a place for them; notes on the others go with those
/// of the result.
fn carry_attributes(
    input: &mut Loaded,
    remeshed: &mut Remeshed,
    job: &Remeshing,
    monitor: &dyn Monitor,
) -> Result<Carried> {
    if !job.attributes || input.attributes.is_empty() {
        return Ok(Carried::default());
    }
    monitor.stage("carry attributes");
    let lost = file::output_format(&job.output.path, job.output.format)?.cannot_hold(&input.attributes);
    let mut attributes = std::mem::take(&mut input.attributes);
    lost.iter().for_each(|l| attributes.remove(&l.name));
    let mut carried = carry(&input.mesh, &attributes, &remeshed.mesh);
    if let Some(kept) = &remeshed.kept {
        carried.keep(&input.mesh, &attributes, &remeshed.mesh, kept);
    }
    carried.lost.splice(0..0, lost);
    remeshed.notes.append(&mut carried.notes);
    check(monitor)?;
    Ok(carried)
}

/// Whether anybody sees the report: measuring takes time.
fn wants_report(job: &Remeshing) -> bool {
    job.run.voice != Voice::Quiet || job.run.report.is_some()
}

fn measure(remeshed: &Remeshed, carried: &Carried, input: &Loaded, job: &Remeshing, monitor: &dyn Monitor) -> Report {
    monitor.stage("measure");
    let input = Named { file: &name(&job.input), mesh: &input.mesh };
    let report = Report::of_remesh(remeshed, input, &name(&job.output), job.options.seed);
    Report { attributes: job.attributes.then(|| carried.into()), ..report }
}

fn store(remeshed: &Remeshed, attributes: &Attributes, job: &Remeshing, monitor: &dyn Monitor) -> Result<()> {
    check(monitor)?;
    monitor.stage("write");
    file::write_file(&job.output.path, &remeshed.mesh, attributes, job.output.format)
}

/// The report with the times of the stages until now, the memory and the threads.
fn with_run(report: Report, stopwatch: &Stopwatch) -> Report {
    report.with_run(&stopwatch.laps(), peak_memory_bytes(), rayon::current_num_threads())
}

/// A report to its file and to standard output.
pub(super) fn hand_out(json: &str, text: &str, run: &Run) -> Result<()> {
    if let Some(path) = &run.report {
        file::replace_file(path, &mut |out| out.write_all(json.as_bytes()))?;
    }
    if run.voice == Voice::Quiet { Ok(()) } else { terminal::print(text) }
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
