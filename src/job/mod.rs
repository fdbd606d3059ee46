//! Runs the whole job in one call: turns a mesh or points with attributes into a mesh with attributes, the origins of its
//! vertices, and a report. Nothing is printed here, and only [`large`] reads and writes files.

mod input;
#[cfg(feature = "fs")]
pub mod large;
mod outcome;
mod points;
mod remesh;
pub mod settings;
mod thinning;
mod threads;
pub mod words;

pub use input::Input;
pub use outcome::{Origin, Outcome};
pub use points::{reconstruct, sample};
pub use remesh::{Carry, RemeshOptions, quality, remesh, remesh_levels};
pub use thinning::{wanted_for_remeshing, wanted_for_sampling};
pub use threads::with_threads;
