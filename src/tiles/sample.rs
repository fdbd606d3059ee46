//! Samples one or all tiles of a plan.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::pipeline::sample_tile;
use crate::tiles::folder::TileFolder;
use crate::tiles::points::{CELLS, points_of};
use crate::tiles::watch::{OfTile, one_by_one};

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
    let points = points_of(folder, &plan, plan.sampling.needed(tile), CELLS, monitor)?;
    check(monitor)?;
    let samples = sample_tile(points, tile, &plan.sampling, &outline, &OfTile(monitor))?;
    folder.write_samples(number, samples)
}

/// Samples the tiles with these numbers, one after the other; without numbers, all that are not sampled yet.
///
/// # Errors
/// Those of [`sample_one`].
pub fn sample_tiles(folder: &TileFolder, numbers: Option<&[usize]>, monitor: &dyn Monitor) -> Result<()> {
    monitor.stage("sample tiles");
    let missing: Vec<usize> = (0..folder.plan()?.tiles.len()).filter(|&number| !folder.has_samples(number)).collect();
    one_by_one(numbers.unwrap_or(&missing), |number| sample_one(folder, number, monitor), monitor)
}
