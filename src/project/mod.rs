//! Surfaces that points are projected on, where there is no mesh.

pub mod rimls;
