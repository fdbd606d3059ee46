//! Random numbers that are the same on every machine and with every version: ChaCha8, one stream per stage.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The generator that all stages use.
pub type Random = ChaCha8Rng;

/// The stream of one stage: streams of different names, and of different seeds, are independent.
pub fn stream(seed: u64, stage: Stage) -> Random {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stage as u64);
    rng
}

/// The stages that draw random numbers. The numbers are part of what makes a run repeatable: do not reorder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    Candidates = 1,
    Scan = 2,
    Distance = 3,
}

/// A number in 0..1 with 53 random bits.
pub fn unit(rng: &mut Random) -> f64 {
    (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}
