//! Triangles all over an implicit surface.

pub mod extract;
pub mod lattice;
