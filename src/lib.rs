//! Remeshing by spectral sampling.

pub mod base;
pub mod geom;
pub mod io;
pub mod optimize;
pub mod remesh;
pub mod spectral;
pub mod surface;
pub mod triangulate;

pub use base::error::{Error, Place, Result};
pub use base::progress::{Monitor, Stopwatch};
pub use remesh::{Density, Options, Remeshed, remesh};
pub use surface::mesh::Mesh;
