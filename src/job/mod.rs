//! The whole job in one call: from a mesh or points with attributes to a mesh with attributes, where it came from, and a
//! report. Nothing is printed here, and nothing read or written but by [`large`].

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
pub use thinning::{of_use_for_remeshing, of_use_for_sampling};
pub use threads::with_threads;
