//! Prepares an input for sampling: repairs, coarsening, smoothing; for clouds, thinning, normals and their orientation, and
//! sharp edges.

pub mod bend;
pub mod cells;
pub mod clean;
pub mod cloud_normals;
pub mod coarsen;
pub mod flatten;
pub mod needles;
pub mod orient;
pub mod outside;
pub mod repair;
pub mod repairs;
pub mod sharpen;
pub mod stitch;
pub mod thin;
pub mod welded;
