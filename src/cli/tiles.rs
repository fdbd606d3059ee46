//! `remesh tiles`: plans, samples, merges.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::cli::args::{Planning, Run, Tiling, Voice};
use crate::cli::files::{add_run, check_targets, hand_out, name, now_writing, watched};
use crate::cli::out_of_core::free_memory;
use crate::cli::terminal;
use crate::io::file;
use crate::pipeline::SampleOptions;
use crate::report::samples::SamplesReport;
use crate::tiles::{Plan, PlanOptions, TileFolder, make_plan, merge, sample_one};
use std::path::Path;

pub(super) fn do_tiles(job: &Tiling) -> Result<()> {
    match job {
        Tiling::Plan(job) => plan(job),
        Tiling::Sample { folder, numbers, run } => sample(folder, numbers, run.voice),
        Tiling::Merge { folder, output, run } => join(folder, output, run),
    }
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
    terminal::print(&format!(
        "{tiles} tiles of {points} points of {input}, \u{3c3}p {sigma:.4e}, {} MB\n",
        bytes / 1_000_000
    ))
}

fn sample(folder: &Path, numbers: &[usize], voice: Voice) -> Result<()> {
    let folder = TileFolder::at(folder)?;
    let count = folder.plan()?.tiles.len();
    let missing = || (0..count).filter(|&number| !folder.has_samples(number)).collect();
    let numbers = if numbers.is_empty() { missing() } else { numbers.to_vec() };
    watched(voice, |monitor| {
        monitor.stage("sample tiles");
        for (done, &number) in numbers.iter().enumerate() {
            sample_one(&folder, number, monitor)?;
            monitor.progress((done + 1) as f64 / numbers.len() as f64);
        }
        Ok(())
    })
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
