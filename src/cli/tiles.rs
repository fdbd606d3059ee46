//! `remesh tiles`: plans, samples, makes pieces of a mesh, merges.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{Planning, Run, Tiling, Voice};
use crate::cli::files::{add_run, check_targets, hand_out, name, now_writing, watched};
use crate::cli::status::Status;
use crate::cli::terminal;
use crate::io::file;
use crate::job::Carry;
use crate::job::large::{free_memory, merge_pieces};
use crate::pipeline::SampleOptions;
use crate::report::all_to_text;
use crate::report::samples::SamplesReport;
use crate::tiles::{Plan, PlanOptions, TileFolder, make_plan, merge, mesh_pieces, rounds, sample_tiles};
use std::path::Path;

pub(super) fn do_tiles(job: &Tiling) -> Result<Status> {
    match job {
        Tiling::Plan(job) => plan(job)?,
        Tiling::Sample { folder, numbers, run } => {
            watched(run.voice, |monitor| sample_tiles(&TileFolder::at(folder)?, numbers.as_deref(), monitor))?;
        }
        Tiling::Mesh { folder, numbers, run } => {
            watched(run.voice, |monitor| mesh_pieces(&TileFolder::at(folder)?, numbers.as_deref(), monitor))?;
        }
        Tiling::Merge { folder, output, mesh: false, run } => join(folder, output, run)?,
        Tiling::Merge { folder, output, mesh: true, run } => return join_mesh(folder, output, run),
    }
    Ok(Status::Done)
}

fn plan(job: &Planning) -> Result<()> {
    job.options.validate()?;
    let folder = TileFolder::make(&job.folder)?;
    let memory = job.memory.unwrap_or_else(free_memory);
    let options = PlanOptions { sample: job.options.clone(), memory, tiles: job.tiles, sharp_edges: true };
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

fn join_mesh(folder: &Path, output: &Path, run: &Run) -> Result<Status> {
    let format = file::output_format(output, None)?;
    check_targets(output, run)?;
    let folder = TileFolder::at(folder)?;
    let input = folder.plan()?.input;
    let outcome = watched(run.voice, |monitor| {
        let mut outcome = merge_pieces(&folder, &Carry::All, Some(format), monitor)?;
        check(monitor)?;
        now_writing(monitor);
        file::write_file(output, &outcome.mesh, &outcome.attributes, None)?;
        if let Some(report) = &mut outcome.report {
            report.add_files(&input, &output.display().to_string());
            add_run(&mut report.run, monitor);
        }
        Ok(outcome)
    })?;
    if let Some(report) = &outcome.report {
        hand_out(&report.to_json(), &all_to_text(std::slice::from_ref(report)), run)?;
    }
    if outcome.verified() {
        return Ok(Status::Done);
    }
    let faults = outcome.shortcomings.join(", ");
    let remedy = "plan again with more points or with --smooth";
    terminal::complain(&format!("{}: written but not sound: {faults}; {remedy}", output.display()));
    Ok(Status::Unverified)
}

fn join(folder: &Path, output: &Path, run: &Run) -> Result<()> {
    let format = file::points_format(output, None)?;
    check_targets(output, run)?;
    let folder = TileFolder::at(folder)?;
    let report = watched(run.voice, |monitor| {
        monitor.stage("merge");
        let sampled = merge(&folder, monitor)?;
        check(monitor)?;
        let lost = format.cannot_hold(&sampled.carried);
        let sampled = sampled.without(lost);
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
