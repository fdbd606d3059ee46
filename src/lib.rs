//! Remeshing by spectral sampling.

pub mod base;
#[cfg(feature = "cli")]
pub mod cli;
pub mod geom;
pub mod io;
pub mod optimize;
pub mod quality;
pub mod remesh;
pub mod report;
pub mod spectral;
pub mod surface;
pub mod triangulate;

pub use base::error::{Error, Place, Result};
pub use base::progress::{Monitor, Stopwatch};
pub use remesh::{Density, Options, Remeshed, remesh};
pub use surface::mesh::Mesh;
