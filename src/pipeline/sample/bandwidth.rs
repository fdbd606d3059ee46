//! Search for the kernel width that gives a wanted number of samples (the bandwidth).
//!
//! If only the position counts, the width follows from the area; in more dimensions the area is not known. If a width σ
//! leaves M samples where N are wanted, the next width is σ (M / N)^(1/e). The exponent e is 2 at first, then the one
//! estimated from the last two widths.
//!
//! Cost: usually two or three scans.

use crate::base::error::Result;
use crate::base::math;
use crate::pipeline::scale::SMALLEST_SPACING;

/// Maximum number of scans per search, and the relative error of the count at which it ends.
const MOST_SCANS: usize = 12;
const NEAR_ENOUGH: f64 = 0.02;

/// Maximum factor between the widths of successive scans, and the range of plausible exponents.
const LARGEST_STEP: f64 = 8.0;
const EXPONENTS: [f64; 2] = [0.5, 3.0];

/// Returns the width that gives about `wanted` samples, and these samples: the closest count of all that were tried.
pub(in crate::pipeline) fn find_bandwidth<T>(
    first: f64,
    wanted: usize,
    scan: &mut dyn FnMut(f64) -> Result<Vec<T>>,
) -> Result<(f64, Vec<T>)> {
    let excess = |samples: &[T]| math::ln(samples.len().max(1) as f64 / wanted as f64);
    let (mut sigma, mut samples) = (first, scan(first)?);
    let (mut best_sigma, mut exponent) = (sigma, 2.0);
    let mut now = excess(&samples);
    let mut best = now;
    for _ in 1..MOST_SCANS {
        if best.abs() <= NEAR_ENOUGH {
            break;
        }
        let step = math::exp(now / exponent).clamp(1.0 / LARGEST_STEP, LARGEST_STEP);
        let next = (step * sigma).max(SMALLEST_SPACING);
        if next == sigma {
            break;
        }
        let found = scan(next)?;
        let then = excess(&found);
        let shown = -(then - now) / math::ln(next / sigma);
        if shown.is_finite() {
            exponent = shown.clamp(EXPONENTS[0], EXPONENTS[1]);
        }
        (sigma, now) = (next, then);
        if then.abs() < best.abs() {
            (best_sigma, best, samples) = (next, then, found);
        }
    }
    Ok((best_sigma, samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the width found if a scan keeps `count` samples, the number of samples, and the number of scans.
    fn found(wanted: usize, count: impl Fn(f64) -> f64) -> (f64, usize, usize) {
        let mut scans = 0;
        let mut scan = |sigma: f64| {
            scans += 1;
            Ok(vec![(); count(sigma).round() as usize])
        };
        let (sigma, samples) = find_bandwidth(0.1, wanted, &mut scan).unwrap();
        (sigma, samples.len(), scans)
    }

    #[test]
    fn of_an_even_surface_two_scans_are_enough() {
        let (sigma, count, scans) = found(5000, |sigma| 2.0 / (sigma * sigma));
        assert!((sigma - 0.02).abs() < 1e-12 && (count, scans) == (5000, 2));
    }

    #[test]
    fn other_exponents_are_learnt() {
        let (_, count, scans) = found(3000, |sigma| 1.0 / (sigma * sigma) + 50.0 / sigma);
        assert!((2940..=3060).contains(&count) && scans <= 5, "{count} {scans}");
    }

    #[test]
    fn what_cannot_be_is_met_as_nearly_as_it_can() {
        assert_eq!(found(100, |_| 7.0).1, 7);
        assert_eq!(found(100, |sigma| if sigma > 0.03 { 10.0 } else { 400.0 }).1, 400);
    }
}
