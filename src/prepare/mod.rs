//! What is done to an input before it is sampled: repairs, refinement, smoothing; and for clouds normals and their sides.

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
pub mod stitch;
pub mod thin;
pub mod welded;
