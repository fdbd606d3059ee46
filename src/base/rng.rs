//! Random numbers that are the same on every machine and with every version: ChaCha8, one stream per stage.
//!
//! This file is the only one that knows where the generator comes from; what the stages need of it is re-exported.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

pub use rand::{Rng, SeedableRng};

/// The generator that all stages use. `rand`'s own standard generators may change between versions; this one does not.
pub type Random = ChaCha8Rng;

/// The stream of one stage: streams of different names, and of different seeds, are independent.
pub fn stream(seed: u64, stage: Stage) -> Random {
    let mut rng = Random::seed_from_u64(seed);
    rng.set_stream(stage as u64);
    rng
}

/// The stages that draw random numbers. The numbers are part of what makes a run repeatable: do not reorder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Where candidates lie on the surface.
    Candidates = 1,
    /// In which order the scan looks at them.
    Scan = 2,
    /// Where the distance between two surfaces is measured.
    Distance = 3,
    /// By how much points of a cloud are moved so that no four are on one circle.
    Jitter = 4,
}

/// A number in 0..1, 1 excluded, with 53 random bits: one draw of 64 bits.
pub fn unit(rng: &mut Random) -> f64 {
    rng.random()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_numbers_are_the_upper_bits_of_a_draw() {
        let (mut rng, mut bits) = (stream(7, Stage::Scan), stream(7, Stage::Scan));
        for _ in 0..1000 {
            assert_eq!(unit(&mut rng), (bits.next_u64() >> 11) as f64 / (1u64 << 53) as f64);
        }
    }

    #[test]
    fn the_numbers_do_not_change_between_versions() {
        let mut rng = stream(0, Stage::Candidates);
        assert_eq!([rng.next_u64(), rng.next_u64()], [13_937_087_304_575_520_531, 13_615_851_043_850_391_654]);
    }
}
