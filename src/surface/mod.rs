//! The surfaces that are sampled and projected on: a mesh cut open along its feature curves, or the implicit surface of
//! points; and the edge lengths that are wanted on them.

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
pub mod turns;
pub mod wedges;
