//! Pictures of meshes, without a display or a graphics card.

pub mod png;
pub mod raster;
