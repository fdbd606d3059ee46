//! Optimisation of a mesh over its domain: connectivity, vertex positions, vertex count, and error.

pub mod angles;
pub mod bridges;
pub mod coarse_to_fine;
pub mod contacts;
pub mod counts;
pub mod crossings;
pub mod exchange;
mod faults;
pub mod fit;
pub mod graft;
pub mod max_error;
mod newton;
mod places;
mod probes;
mod quadrature;
pub mod relax;
pub mod resize;
pub mod self_intersections;
mod shorten;
pub mod slide;
pub mod slivers;
pub mod untangle;
pub mod valence;
