//! Triangulates an entire implicit surface.

pub mod extract;
pub mod lattice;
