//! Carries attributes of one mesh over to another one of the same surface.

mod texture;
pub mod vertex;
