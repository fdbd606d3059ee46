//! Small geometry: what can be said about a few points without a mesh.

pub mod polygon;
pub mod triangle;
