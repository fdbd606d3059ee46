//! Clouds of any size, sampled tile by tile: on one machine out of core, or on many over a shared folder.
//!
//! A folder is the interface. [`make_plan`] reads the file once, sorts its points by place into the folder and decides what
//! is global; then each tile can be sampled by itself, by any process on any machine, and as often as one likes
//! ([`sample_one`]); [`merge`] joins them. Space is cut into blocks, which are those of the scan, anchored at the origin at
//! multiples of the kernel's width. What a tile gets follows from the points around it alone, so the result is the same for
//! any tiling.

mod folder;
mod merge;
mod plan;
mod points;

pub use folder::TileFolder;
pub use merge::merge;
pub use plan::{Plan, PlanOptions, can_plan, make_plan};

use crate::base::error::{Error, Result};
use crate::base::monitor::{Monitor, check};
use crate::pipeline::{Sampled, sample_tile};
use points::points_of;

/// A monitor of one tile of many: it only passes on that all shall end.
struct OfTile<'a>(&'a dyn Monitor);

impl Monitor for OfTile<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// Samples the tile of this number, from 0, and writes what it gets to the folder.
///
/// # Errors
/// [`Error::File`] if the folder lacks something, cannot be written, or there is no such tile; [`Error::Cancelled`] if the
/// monitor asks for it.
pub fn sample_one(folder: &TileFolder, number: usize, monitor: &dyn Monitor) -> Result<()> {
    let plan = folder.plan()?;
    let outline = folder.outline()?;
    if number >= plan.tiles.len() {
        let cause = format!("it has {} tiles, from 0; there is no tile {number}", plan.tiles.len());
        return Err(folder.error(cause, "give the number of one that there is"));
    }
    let tile = plan.tile_box(number);
    let points = points_of(folder, &plan, plan.sampling.needed(tile), monitor)?;
    check(monitor)?;
    let samples = sample_tile(points, tile, &plan.sampling, &outline, &OfTile(monitor))?;
    folder.write_samples(number, samples)
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

/// What is not possible tile by tile, in words of the one who asked for it.
fn impossible(option: crate::base::error::Setting, cause: &str) -> Error {
    Error::Option { option, cause: cause.into(), remedy: "leave it out, or sample in memory".into() }
}
