//! Pipelines: the only modules that know the order of the stages.

mod attempts;
mod cloud;
mod coarse;
mod density;
mod input_checks;
mod kernel;
mod options;
mod pieces;
mod prepared;
mod remesh;
mod result;
mod sample;
mod scale;
mod selection;
mod sized;
mod unit;
mod values;

pub use cloud::coverage::Coverage;
pub use cloud::options::{
    CloudOptions, FEW_NEIGHBORS, INTERPOLATING_SUPPORT, NormalFit, NormalNeighborhood, SMOOTHING_SUPPORT,
};
pub use cloud::reconstruct::{ReconstructOptions, Reconstructed, points_of_mesh, reconstruct};
pub use cloud::summary::CloudSummary;
pub use cloud::terrain::mesh_of_cloud;
pub use cloud::{MeshOfPoints, mesh_of_points, volume};
pub use coarse::coarseness_for;
pub use density::{Density, FEWEST_POINTS, MOST_POINTS, SampleDensity, check_levels};
pub use input_checks::{refuse_bad_numbers, refuse_bad_positions};
pub use kernel::Signal;
pub use options::{Grading, MaxError, Options};
pub use pieces::base_mesh::{MOST_OF_BASE, base_mesh, nodes};
pub use pieces::outline::{Outline, Survey, has_sharp_edges, survey};
pub use pieces::piece::{MadeAnew, PartOfMesh, optimize_piece, triangulate_nodes};
pub use pieces::placing::place_nodes;
pub use pieces::tile::{TileOptions, TilePoint, count_in_tile, sample_tile};
pub use remesh::{Remesher, remesh};
pub use result::edges::Edges;
pub use result::lost::LostComponents;
pub use result::shortcomings::{shortcomings, topology_faults};
pub use result::{Deviation, Remeshed};
pub use sample::options::SampleOptions;
pub use sample::progressive::SampleLevel;
pub use sample::sampled::{Sampled, count_notes};
pub use sample::{sample, sample_points};
pub use scale::spacing_on;
pub use selection::Selection;
pub use sized::pinholes::Pinholes;
pub use values::Values;
