//! Random numbers that are the same on every machine and in every version.
//!
//! The pipelines draw all numbers by address: a number depends on the seed, the stage, the item that it is drawn for and its
//! index there, not on earlier draws. So every thread or machine draws the same numbers in any order, and a part of a
//! surface draws the same numbers as the whole would. The generator is Philox2x64-10, a bijection of counters under a key,
//! with the seed as key and the address as counter.
//!
//! Based on: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3, 2011, DOI
//! 10.1145/2063384.2063405. There, it passes all tests of TestU01's BigCrush.
//!
//! Cost: about five nanoseconds for a draw of two numbers.
//!
//! [`stream`] returns a ChaCha8 sequence, for callers that draw one number after the other: measurements, tests and
//! examples.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

pub use rand::{Rng, SeedableRng};

/// The generator of sequences. Unlike `rand`'s own standard generators, it does not change between versions.
pub type Random = ChaCha8Rng;

/// Returns the stream of a stage. Streams of different stages or seeds are independent.
pub fn stream(seed: u64, stage: Stage) -> Random {
    let mut rng = Random::seed_from_u64(seed);
    rng.set_stream(stage as u64);
    rng
}

/// The stages that draw random numbers. The numbers of the stages are part of what makes a run repeatable: do not reorder
/// them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Positions of candidates on the surface.
    Candidates = 1,
    /// The order in which the scan visits candidates.
    Scan = 2,
    /// Positions at which the distance between two surfaces is measured.
    Distance = 3,
    /// Displacements of cloud points, so that no four are on one circle.
    Jitter = 4,
    /// Number of candidates of a triangle.
    Counts = 5,
    /// The choice of candidates to keep where target edge lengths vary.
    Thinning = 6,
}

/// The item that a number is drawn for: a triangle or a point, and the index of the number there.
pub type Address = (u32, u64);

/// Returns 128 random bits for an address; different stages, seeds and addresses are independent.
#[inline]
pub fn bits_at(seed: u64, stage: Stage, (item, number): Address) -> [u64; 2] {
    philox([number, u64::from(item) | (stage as u64) << 32], seed)
}

/// Returns two numbers in 0..1, 1 excluded, with 53 random bits each, for an address.
#[inline]
pub fn units_at(seed: u64, stage: Stage, address: Address) -> [f64; 2] {
    bits_at(seed, stage, address).map(unit_of)
}

/// Returns a number in 0..1, 1 excluded, with 53 random bits, from one draw of 64 bits.
pub fn unit(rng: &mut Random) -> f64 {
    rng.random()
}

/// Converts the upper 53 bits to a number in 0..1.
#[inline]
fn unit_of(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// The multiplier of a round, and the increment of the key between rounds: the golden ratio.
const MULTIPLIER: u64 = 0xd2b7_4407_b1ce_6e93;
const KEY_STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// Rounds of Philox2x64; six already pass all tests.
const ROUNDS: usize = 10;

#[inline]
fn philox([mut low, mut high]: [u64; 2], mut key: u64) -> [u64; 2] {
    for _ in 0..ROUNDS {
        let product = u128::from(low) * u128::from(MULTIPLIER);
        (low, high) = ((product >> 64) as u64 ^ key ^ high, product as u64);
        key = key.wrapping_add(KEY_STEP);
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_numbers_are_the_upper_bits_of_a_draw() {
        let (mut rng, mut bits) = (stream(7, Stage::Scan), stream(7, Stage::Scan));
        for _ in 0..1000 {
            assert_eq!(unit(&mut rng), unit_of(bits.next_u64()));
        }
    }

    #[test]
    fn the_numbers_do_not_change_between_versions() {
        let mut rng = stream(0, Stage::Candidates);
        assert_eq!([rng.next_u64(), rng.next_u64()], [13_937_087_304_575_520_531, 13_615_851_043_850_391_654]);
    }

    /// The known answers of Random123, the authors' own implementation.
    #[test]
    fn philox_is_that_of_its_authors() {
        assert_eq!(philox([0; 2], 0), [0xca00_a045_9843_d731, 0x66c2_4222_c9a8_45b5]);
        assert_eq!(philox([u64::MAX; 2], u64::MAX), [0x65b0_21d6_0cd8_310f, 0x4d02_f322_2f86_df20]);
        let digits_of_pi = [0x243f_6a88_85a3_08d3, 0x1319_8a2e_0370_7344];
        assert_eq!(philox(digits_of_pi, 0xa409_3822_299f_31d0), [0x0a5e_742c_2997_341c, 0xb0f8_83d3_8000_de5d]);
    }

    /// χ² of pairs of numbers in 16 by 16 equal cells, as a deviation in standard deviations from that of independent
    /// numbers.
    fn excess(pair: impl Fn(u32) -> [f64; 2]) -> f64 {
        const DRAWS: u32 = 1 << 17;
        let mut counts = [0.0; 256];
        for i in 0..DRAWS {
            let [x, y] = pair(i).map(|u| (16.0 * u) as usize);
            counts[16 * x + y] += 1.0;
        }
        let expected = f64::from(DRAWS) / 256.0;
        let sum: f64 = counts.iter().map(|count| (count - expected) * (count - expected) / expected).sum();
        (sum - 255.0) / (2.0 * 255f64).sqrt()
    }

    #[test]
    fn numbers_are_uniform_and_those_of_neighbouring_addresses_independent() {
        let first = |seed, stage, address| units_at(seed, stage, address)[0];
        let found = [
            excess(|i| units_at(1, Stage::Candidates, (i, 0))),
            excess(|i| units_at(1, Stage::Candidates, (5, i.into()))),
            excess(|i| [i, i + 1].map(|item| first(1, Stage::Scan, (item, 3)))),
            excess(|i| [i, i + 1].map(|number| first(1, Stage::Scan, (7, number.into())))),
            excess(|i| [1, 2].map(|seed| first(seed, Stage::Scan, (i, 0)))),
            excess(|i| [Stage::Candidates, Stage::Scan].map(|stage| first(1, stage, (i, 0)))),
        ];
        assert!(found.iter().all(|deviations| deviations.abs() < 4.0), "{found:?}");
        // A generator as bad as early ones.
        assert!(excess(|i| [i, i + 1].map(|x| unit_of(u64::from(x).wrapping_mul(KEY_STEP)))) > 100.0);
    }
}
