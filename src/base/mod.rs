//! What every layer needs: errors, progress and cancelling, random streams, order in heaps, disjoint sets, compressed rows.

pub(crate) mod csr;
pub mod error;
pub mod heap;
pub mod monitor;
pub mod rng;
pub mod union_find;
