//! Turns samples on a surface into an oriented 2-manifold with the topology of the surface.

pub mod agreement;
pub mod boundary_loops;
pub mod cell;
pub mod chords;
pub mod hole_filling;
pub mod inconsistent_stars;
pub mod mutual_tessellation;
mod neighborhood;
mod neighbors_of_patch;
mod patch_topology;
pub mod plan;
pub mod points;
pub mod rims;
pub mod star;
mod stars_to_manifold;
pub mod stitch;
pub mod surroundings;
pub mod triangulation;
pub mod unfold;

pub use stars_to_manifold::triangulate;
pub use triangulation::{Boundary, Triangulated};
