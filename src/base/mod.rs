//! Foundations of every layer: errors, progress and cancelling, elementary functions, random numbers, parallel loops, heaps,
//! disjoint sets, compressed sparse rows, counts as words.

pub(crate) mod count;
pub(crate) mod csr;
pub mod error;
pub mod heap;
pub mod math;
pub mod monitor;
pub(crate) mod parallel;
pub mod rng;
pub mod union_find;
