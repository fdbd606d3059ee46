//! Elementary functions whose results have the same bits on every processor and system.
//!
//! The elementary functions of `std` call the system's C library. Their last bits differ between systems and, on the same
//! system, between processors with and without fused multiply-add. The functions here come from the crate `libm`, which is
//! compiled with the program and uses only exactly rounded operations. `clippy.toml` disallows those of `std` elsewhere.
//! Square roots, absolute values and rounding to integers are exact in `std`, too.

/// The sine and cosine of an angle in radians.
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// The arc sine in radians of a number in -1..=1.
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// The angle in radians, in -π..=π, from the x axis to the point (x, y).
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// e to the power of `x`.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// The natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// The logarithm to base 10.
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// `x` to the power of `exponent`.
pub fn pow(x: f64, exponent: f64) -> f64 {
    libm::pow(x, exponent)
}

/// x²
#[inline]
pub fn square(x: f64) -> f64 {
    x * x
}

/// x³
#[inline]
pub fn cube(x: f64) -> f64 {
    x * x * x
}

/// The smallest normal power of two that is at least `x`.
pub fn next_power_of_two(x: f64) -> f64 {
    let x = x.max(f64::MIN_POSITIVE);
    let below = f64::from_bits(x.to_bits() & f64::INFINITY.to_bits());
    if below == x { x } else { 2.0 * below }
}

/// Coefficients of the polynomial p(r) = 1 + r + r² (c₀ + c₁ r + ...), which differs from eʳ by at most 1e-17 eʳ for |r| ≤
/// ln 2 / 2: the minimax coefficients (E. Remez, 1934), rounded.
const EXPONENTIAL: [f64; 10] = [
    0.500_000_000_000_001,
    0.166_666_666_666_666_74,
    0.041_666_666_666_521_88,
    0.008_333_333_333_322_198,
    0.001_388_888_894_785_627_8,
    0.000_198_412_698_866_182_1,
    2.480_148_728_598_697_4e-5,
    2.755_724_230_590_181_4e-6,
    2.763_267_084_474_969e-7,
    2.511_006_149_615_507_5e-8,
];

/// ln 2 in two parts. The upper part has 32 bits, so that its product with an exponent is exact.
const LN_2_UPPER: f64 = 0.693_147_180_369_123_8;
const LN_2_LOWER: f64 = 1.908_214_929_270_587_7e-10;

/// Adding and then subtracting this constant, 1.5 · 2⁵², rounds to an integer. In between, the lowest bits hold that
/// integer.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// The largest argument of [`gaussian`], which clamps to it: the value there is still a normal number.
const FARTHEST: f64 = 707.0;

/// The Gaussian e^(-d) of a squared distance d ≥ 0. Its error is at most one unit in the last place up to d = 707; beyond,
/// its value is at most 1e-307.
///
/// The sampler spends half of its time here; there are no branches or calls, so that compilers vectorize it. With k the
/// integer nearest to -d / ln 2, e^(-d) = 2ᵏ p(-d - k ln 2).
#[inline]
pub fn gaussian(d: f64) -> f64 {
    let x = -if d > FARTHEST { FARTHEST } else { d };
    let shifted = x * std::f64::consts::LOG2_E + ROUNDING;
    let k = shifted - ROUNDING;
    let r = (x - k * LN_2_UPPER) - k * LN_2_LOWER;
    let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9] = EXPONENTIAL;
    let (r2, r4) = (r * r, r * r * (r * r));
    let low = (c0 + c1 * r) + (c2 + c3 * r) * r2;
    let high = ((c4 + c5 * r) + (c6 + c7 * r) * r2) + (c8 + c9 * r) * r4;
    let p = 1.0 + (r + r2 * (low + high * r4));
    p * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};

    /// The error of [`gaussian`] in units in the last place; the error of libm itself is below one.
    fn error(d: f64) -> f64 {
        let exact = libm::exp(-d);
        (gaussian(d) - exact).abs() / (exact * f64::EPSILON / 2.0)
    }

    #[test]
    fn a_gaussian_is_the_exponential_of_libm_within_two_units() {
        let mut rng = stream(1, Stage::Scan);
        let (mut largest, mut sum) = (0.0f64, 0.0);
        for i in 0..200_000 {
            let near = error(25.0 * unit(&mut rng));
            largest = largest.max(near).max(error(FARTHEST * unit(&mut rng))).max(error(f64::from(i) * 1e-9));
            sum += near;
        }
        assert!(largest <= 4.0, "{largest} half units");
        assert!(sum / 200_000.0 < 0.5, "{sum}");
    }

    #[test]
    fn a_gaussian_at_its_ends() {
        assert_eq!([gaussian(0.0), gaussian(-0.0), gaussian(f64::MIN_POSITIVE)], [1.0; 3]);
        assert!(gaussian(FARTHEST) > f64::MIN_POSITIVE);
        assert!([708.0, 1e9, f64::INFINITY].iter().all(|&d| gaussian(d) <= 1e-307));
        assert!(gaussian(f64::NAN).is_nan());
    }

    /// The bits of some values: if one of them differs, so do the results of the library.
    #[test]
    fn the_bits_do_not_change_between_machines() {
        let (sin, cos) = sin_cos(1.2);
        let found = [
            gaussian(0.7),
            gaussian(6.1),
            exp(0.3),
            ln(7.0),
            log10(7.0),
            pow(3.0, 0.2),
            sin,
            cos,
            asin(0.4),
            atan2(2.0, -3.0),
        ]
        .map(f64::to_bits);
        assert_eq!(
            found,
            [
                0x3fdfc80db9dd5542,
                0x3f625fa270246b28,
                0x3ff599058c8c1a96,
                0x3fff2272ae325a57,
                0x3feb0b0b0b78cc3f,
                0x3ff3ee8390d43956,
                0x3fedd343a21a55c4,
                0x3fd730de943b79d4,
                0x3fda564ac0e73a34,
                0x40046dc09ec29433
            ]
        );
    }

    #[test]
    fn the_next_power_of_two_is_the_smallest_that_is_no_smaller() {
        assert_eq!([1.0, 1.5, 2.0, 0.3, 1e-310].map(next_power_of_two), [1.0, 2.0, 2.0, 0.5, f64::MIN_POSITIVE]);
        for x in [1e-300, 7e-5, 5e100, 4.0, 4.0 + 1e-15] {
            let power = next_power_of_two(x);
            assert!(power >= x && power / 2.0 < x && power.to_bits() << 12 == 0, "{x} {power}");
        }
    }
}
