//! Attributes of one mesh carried over to another one of the same surface.

mod texture;
pub mod vertex;
