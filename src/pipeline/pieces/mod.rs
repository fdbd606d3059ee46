//! Pieces of a large cloud: samples of its tiles, and the mesh of these, each from the points around it.

pub(in crate::pipeline) mod base_mesh;
pub(in crate::pipeline) mod conform;
pub(in crate::pipeline) mod outline;
pub(in crate::pipeline) mod piece;
pub(in crate::pipeline) mod placing;
pub(in crate::pipeline) mod tile;
