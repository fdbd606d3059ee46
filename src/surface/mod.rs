//! The surface that everything is measured against: a triangle mesh, its topology, what was wrong with it.

pub mod bvh;
pub mod mesh;
pub mod repair;
pub mod topology;
