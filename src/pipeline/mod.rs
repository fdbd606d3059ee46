//! The pipelines: the only places that know the order of the stages.

mod attempts;
mod bandwidth;
mod base_mesh;
mod cloud;
mod coarse;
mod coverage;
mod density;
mod edges;
mod expected;
mod finished;
mod flakes;
mod follow;
mod kernel;
mod lost;
mod mend;
mod optimization;
mod options;
mod origins;
mod outline;
mod piece;
mod placing;
mod prepared;
mod progressive;
mod reconstruct;
mod remesh;
mod resizing;
mod result;
mod sample;
mod scale;
mod selection;
mod sharp_edges;
mod shortcomings;
mod sized;
mod terrain;
mod tile;
mod triangulation;
mod unit;
mod values;
mod within;

pub use base_mesh::{MOST_OF_BASE, base_mesh, nodes};
pub use cloud::{
    CloudOptions, CloudSummary, FEW_NEIGHBORS, INTERPOLATING_SUPPORT, MeshOfPoints, NormalFit, Reach,
    SMOOTHING_SUPPORT, mesh_of_points, volume,
};
pub use coarse::coarseness_for;
pub use coverage::Coverage;
pub use density::{Density, FEWEST_POINTS, MOST_POINTS, SampleDensity, check_levels};
pub use edges::Edges;
pub use kernel::Signal;
pub use lost::LostComponents;
pub use options::{Grading, MaxError, Options};
pub use outline::{Outline, Survey, survey};
pub use piece::{MadeAnew, PartOfMesh, optimize_piece, triangulate_nodes};
pub use placing::place_nodes;
pub use prepared::{refuse_bad_numbers, refuse_bad_positions};
pub use progressive::SampleLevel;
pub use reconstruct::{ReconstructOptions, Reconstructed, points_of_mesh, reconstruct};
pub use remesh::{Remesher, remesh};
pub use result::{Deviation, Remeshed};
pub use sample::{SampleOptions, Sampled, count_notes, sample, sample_points};
pub use scale::spacing_on;
pub use selection::Selection;
pub use shortcomings::{shortcomings, topology_faults};
pub use terrain::mesh_of_cloud;
pub use tile::{TileOptions, TilePoint, count_in_tile, sample_tile};
pub use values::Values;
