//! Surfaces to sample and to project onto (a mesh cut along its feature curves, or the implicit surface of a point cloud),
//! and the target edge lengths on them.

pub mod dihedral_angles;
pub mod domain;
pub mod facets;
pub mod feature_curves;
pub mod features;
pub mod implicit;
pub mod lift;
pub mod narrow_patches;
pub mod planes;
pub mod sizing;
pub mod spikes;
pub mod submanifold;
pub mod wedges;
