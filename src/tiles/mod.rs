//! Clouds of any size, sampled tile by tile: on one machine out of core, or on many over a shared folder.
//!
//! A folder is the interface. [`make_plan`] reads the file once, sorts its points by place into the folder and decides what
//! is global; then each tile can be sampled by itself, by any process on any machine, and as often as one likes
//! ([`sample_one`]); [`merge()`] joins them. Space is cut into blocks, which are those of the scan, anchored at the origin at
//! multiples of the kernel's width. What a tile gets follows from the points around it alone, so the result is the same for
//! any tiling.

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
