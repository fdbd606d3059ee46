//! Clouds of any size, sampled tile by tile: on one machine out of core, or on many over a shared folder.
//!
//! A folder is the interface. [`make_plan`] reads the file once, sorts its points by place into the folder and decides
//! what is global; then each tile can be sampled by itself, by any process on any machine, any number of times
//! ([`sample_one`]); [`merge()`] joins the samples. Space is divided into the blocks of the scan, which are anchored at
//! the origin at multiples of the kernel width. The samples of a tile depend only on the points around it, so the
//! result is the same for any tiling.

mod folder;
mod merge;
mod plan;
mod planning;
mod points;
mod sample;
mod watch;

pub use folder::TileFolder;
pub use merge::merge;
pub use plan::{Plan, PlanOptions};
pub use planning::{can_plan, make_plan};
pub use sample::{sample_all, sample_one};
