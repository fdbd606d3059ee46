//! `remesh tiles`: plans, samples, makes pieces of a mesh, merges.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{Planning, Run, Tiling, Voice};
use crate::cli::files::{add_run, check_targets, hand_out, name, now_writing, watched};
use crate::cli::out_of_core::free_memory;
use crate::cli::status::Status;
use crate::cli::terminal;
use crate::io::file;
use crate::mesh::attributes::Attributes;
use crate::pipeline::SampleOptions;
use crate::report::samples::SamplesReport;
use crate::report::{Report, all_to_text};
use crate::tiles::{Plan, PlanOptions, TileFolder, make_plan, merge, merge_mesh, mesh_one, rounds, sample_one};
use std::path::Path;

pub(super) fn do_tiles(job: &Tiling) -> Result<Status> {
    match job {
        Tiling::Plan(job) => plan(job)?,
        Tiling::Sample { folder, numbers, run } => sample(folder, numbers, run.voice)?,
        Tiling::Mesh { folder, numbers, run } => mesh(folder, numbers, run.voice)?,
        Tiling::Merge { folder, output, mesh: false, run } => join(folder, output, run)?,
        Tiling::Merge { folder, output, mesh: true, run } => return join_mesh(folder, output, run),
    }
    Ok(Status::Done)
}

fn plan(job: &Planning) -> Result<()> {
    job.options.validate()?;
    let folder = TileFolder::make(&job.folder)?;
    let memory = job.memory.unwrap_or_else(free_memory);
    let options = PlanOptions { sample: job.options.clone(), memory, tiles: job.tiles };
    let plan =
        watched(job.run.voice, |monitor| make_plan(&job.input.path, job.input.format, &folder, &options, monitor))?;
    if job.run.voice == Voice::Quiet {
        return Ok(());
    }
    let (tiles, points, bytes) = (plan.tiles.len(), plan.points, plan.bytes());
    let (input, sigma) = (name(&job.input), plan.sampling.sigma);
    let rounds: Vec<String> = rounds(&plan).iter().map(|round| format!("{}-{}", round.start, round.end - 1)).collect();
    terminal::print(&format!(
        "{tiles} tiles of {points} points of {input}, \u{3c3}p {sigma:.4e}, {} MB, pieces of the mesh {}\n",
        bytes / 1_000_000,
        rounds.join(" ")
    ))
}

fn sample(folder: &Path, numbers: &[usize], voice: Voice) -> Result<()> {
    let folder = TileFolder::at(folder)?;
    let missing = (0..folder.plan()?.tiles.len()).filter(|&number| !folder.has_samples(number)).collect();
    one_by_one("sample tiles", numbers, missing, voice, |number, monitor| sample_one(&folder, number, monitor))
}

fn mesh(folder: &Path, numbers: &[usize], voice: Voice) -> Result<()> {
    let folder = TileFolder::at(folder)?;
    let all = rounds(&folder.plan()?).into_iter().flatten();
    let missing = all.filter(|&number| !folder.has_piece(number)).collect();
    one_by_one("mesh pieces", numbers, missing, voice, |number, monitor| mesh_one(&folder, number, monitor))
}

/// Does `work` for each of the `numbers`, or without any for all that are `missing`.
fn one_by_one(
    stage: &'static str,
    numbers: &[usize],
    missing: Vec<usize>,
    voice: Voice,
    work: impl Fn(usize, &dyn Monitor) -> Result<()>,
) -> Result<()> {
    let numbers = if numbers.is_empty() { missing } else { numbers.to_vec() };
    watched(voice, |monitor| {
        monitor.stage(stage);
        for (done, &number) in numbers.iter().enumerate() {
            work(number, monitor)?;
            monitor.progress((done + 1) as f64 / numbers.len() as f64);
        }
        Ok(())
    })
}

fn join_mesh(folder: &Path, output: &Path, run: &Run) -> Result<Status> {
    file::output_format(output, None)?;
    check_targets(output, run)?;
    let folder = TileFolder::at(folder)?;
    let Plan { input, wanted, .. } = folder.plan()?;
    let report = watched(run.voice, |monitor| {
        monitor.stage("merge");
        let mesh = merge_mesh(&folder)?;
        check(monitor)?;
        now_writing(monitor);
        file::write_file(output, &mesh, &Attributes::default(), None)?;
        monitor.stage("measure");
        let mut report = Report::of_pieces(&mesh, wanted);
        report.add_files(&input, &output.display().to_string());
        add_run(&mut report.run, monitor);
        Ok(report)
    })?;
    hand_out(&report.to_json(), &all_to_text(std::slice::from_ref(&report)), run)?;
    let faults = report.faults();
    if faults.is_empty() {
        return Ok(Status::Done);
    }
    let remedy = "plan it with more points or with --smooth";
    terminal::complain(&format!("{}: written but not sound: {}; {remedy}", output.display(), faults.join(", ")));
    Ok(Status::Unverified)
}

fn join(folder: &Path, output: &Path, run: &Run) -> Result<()> {
    file::points_format(output, None)?;
    check_targets(output, run)?;
    let folder = TileFolder::at(folder)?;
    let report = watched(run.voice, |monitor| {
        monitor.stage("merge");
        let sampled = merge(&folder)?;
        check(monitor)?;
        now_writing(monitor);
        file::write_points_file(output, &sampled.points, &sampled.attributes(), None)?;
        let Plan { input, sampling, .. } = folder.plan()?;
        let sweeps = sampling.sweeps.unwrap_or(0);
        let options = SampleOptions { seed: sampling.seed, sweeps, ..SampleOptions::default() };
        let mut report = SamplesReport::new(&sampled, &options, input, output.display().to_string());
        add_run(&mut report.run, monitor);
        Ok(report)
    })?;
    hand_out(&report.to_json(), &report.to_text(), run)
}
