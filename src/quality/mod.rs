//! Quality of a mesh: the shape of its triangles, and its distance to another mesh.

pub mod bound;
pub mod distance;
pub mod fields;
pub mod sampling;
pub mod shape;
