//! Sampling the tiles of a plan, one or all.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::pipeline::{Sampled, sample_tile};
use crate::tiles::folder::TileFolder;
use crate::tiles::merge::merge;
use crate::tiles::pieces::counts;
use crate::tiles::points::points_of;
use crate::tiles::watch::OfTile;

/// Samples the tile with this number, counted from 0, and writes its samples to the folder.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if the folder lacks something or cannot be written, or there is no such tile;
/// [`Error::Cancelled`](crate::Error::Cancelled) if the monitor asks for it.
pub fn sample_one(folder: &TileFolder, number: usize, monitor: &dyn Monitor) -> Result<()> {
    let plan = folder.plan()?;
    let outline = folder.outline()?;
    if number >= plan.tiles.len() {
        let cause = format!("it has {} tiles, numbered from 0; there is no tile {number}", plan.tiles.len());
        return Err(folder.error(cause, "give a smaller number"));
    }
    let tile = plan.tile_box(number);
    let points = points_of(folder, &plan, plan.sampling.needed(tile), monitor)?;
    check(monitor)?;
    let samples = sample_tile(points, tile, &plan.sampling, &outline, &OfTile(monitor))?;
    let counts = counts(samples.iter().map(|sample| sample.position), plan.sampling.block());
    folder.write_samples(number, samples, &counts)
}

/// Samples all tiles that are not sampled yet, one after the other, and joins them.
///
/// # Errors
/// Those of [`sample_one`] and [`merge`].
pub fn sample_all(folder: &TileFolder, monitor: &dyn Monitor) -> Result<Sampled> {
    let count = folder.plan()?.tiles.len();
    monitor.stage("sample tiles");
    for number in (0..count).filter(|&number| !folder.has_samples(number)) {
        check(monitor)?;
        sample_one(folder, number, monitor)?;
        monitor.progress((number + 1) as f64 / count as f64);
    }
    monitor.stage("merge");
    merge(folder)
}
