//! What every layer needs: errors, progress and cancelling, random streams.

pub mod error;
pub mod progress;
pub mod rng;
