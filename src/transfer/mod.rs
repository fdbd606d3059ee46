//! Transfers attributes from one mesh to another mesh of the same surface.

mod texture;
pub mod vertex;
