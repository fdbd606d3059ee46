//! Changes to the mesh that sampling does not make: the wanted number of vertices.

pub mod counts;
