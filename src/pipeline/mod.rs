//! The pipelines: the only places that know the order of the stages.

mod bandwidth;
mod cloud;
mod follow;
mod kernel;
mod optimization;
mod options;
mod reconstruct;
mod remesh;
mod result;
mod sample;
mod scale;
mod source;
mod unit;
mod within;

pub use cloud::{CloudOptions, CloudSummary, DEFAULT_SUPPORT, MeshOfPoints, NormalFit, Reach, mesh_of_points};
pub use kernel::Signal;
pub use options::{Density, FEWEST_POINTS, MOST_POINTS, MaxError, Options, check_field};
pub use reconstruct::{ReconstructOptions, Reconstructed, points_of_mesh, reconstruct};
pub use remesh::remesh;
pub use result::{Deviation, Remeshed};
pub use sample::{SampleOptions, Sampled, sample, sample_points};
pub use within::Selection;
