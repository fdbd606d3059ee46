//! Samples clouds of any size tile by tile and meshes them piece by piece: on one machine out of core, or on many over a
//! shared folder.
//!
//! A folder is the interface. [`make_plan`] reads the file, sorts its points by place into the folder and decides
//! everything global; then each tile can be sampled by itself, by any process on any machine, any number of times
//! ([`sample_one`]); [`merge()`] joins the samples. Space is divided into the blocks of the scan, which are anchored at the
//! origin at multiples of the kernel width. The samples of a tile depend only on the points around it, so the result is the
//! same for any tiling.
//!
//! The mesh is made in pieces ([`mesh_one`]). These are not tiles but cubes whose size depends only on the kernel width, so
//! that the mesh, too, is the same for any tiling. [`merge_mesh`] joins them, and [`nearest_attributes`] gives their
//! vertices the attributes of the points.

mod folder;
mod joined;
mod made;
mod merge;
mod mesh;
mod nearest;
mod pieces;
mod plan;
mod planning;
mod points;
mod sample;
mod watch;

pub use folder::TileFolder;
pub use merge::{merge, merge_mesh};
pub use mesh::{mesh_one, mesh_pieces};
pub use nearest::nearest_attributes;
pub use pieces::rounds;
pub use plan::{Plan, PlanOptions};
pub use planning::{can_plan, make_plan};
pub use sample::{sample_one, sample_tiles};
