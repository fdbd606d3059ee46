//! What is done to a mesh so that its triangles are good, and as many as wanted.

pub mod angles;
pub mod coarse_to_fine;
pub mod counts;
pub mod fit;
pub mod max_error;
mod newton;
pub mod relax;
pub mod self_intersections;
pub mod valence;
