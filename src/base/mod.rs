//! What every layer needs: errors, progress and cancelling, random streams, order in heaps.

pub mod error;
pub mod progress;
pub mod ranked;
pub mod rng;
