//! What is done to a mesh so that its triangles are good, and as many as wanted.

pub mod angles;
pub mod counts;
pub mod fit;
pub mod levels;
pub mod relax;
mod step;
pub mod tips;
pub mod untangle;
pub mod valence;
