//! What every layer needs: errors, progress and cancelling, elementary functions, random numbers, loops on all threads, heaps,
//! disjoint sets, compressed rows, counts in words.

pub(crate) mod count;
pub(crate) mod csr;
pub mod error;
pub mod heap;
pub mod math;
pub mod monitor;
pub(crate) mod parallel;
pub mod rng;
pub mod union_find;
