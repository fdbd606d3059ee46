//! Surfaces that points are projected on, where there is no mesh.

pub mod extract;
pub mod lattice;
pub mod rimls;
