//! The measure s(x): how much a point changes the Laplace-Beltrami spectrum of the samples so far.
//!
//! s(x) = 1 - kᵀ K⁻¹ k (paper, equation 9) with the Gaussian kernel k(x, y) = exp(-|x - y|²), x in units of σp, over
//! the neighbours of x, K their kernel matrix. K = L Lᵀ grows by a row of L for each neighbour; with L y = k the
//! measure is 1 - |y|², and each neighbour subtracts the square of one more entry of y. The paper updates the inverse
//! instead (equation 10), which gives the same numbers with more operations.
//!
//! Points have any dimension D: three in space, six with the normal as x = [p/σp, n/σn], more with further signals.
//!
//! Cost: n² / 2 multiplications and n kernels for the n-th neighbour.

use crate::base::math::gaussian;
use crate::geom::vector::{distance_squared, length_squared};

/// More neighbours than this, counted from the nearest, change s too little to matter.
pub const MOST_NEIGHBOURS: usize = 20;

/// Radius of the neighbourhood in units of σ (paper, section 6.3): k is below 0.002 outside.
pub const RADIUS: f64 = 2.5;

/// A pivot this near zero means that the neighbour lies in the span of those before it (paper, section 6.1).
const SMALLEST_PIVOT: f64 = 1e-9;

/// s(x) at one point, for neighbours that are added one by one.
pub struct Measure<const D: usize> {
    /// Rows of L, packed: row i begins at i (i + 1) / 2. The diagonal holds reciprocals, since only they are used.
    factor: [f64; MOST_NEIGHBOURS * (MOST_NEIGHBOURS + 1) / 2],
    /// L y = k.
    y: [f64; MOST_NEIGHBOURS],
    /// Offsets of the neighbours from x, in units of σ.
    offsets: [[f64; D]; MOST_NEIGHBOURS],
    count: usize,
    value: f64,
}

impl<const D: usize> Measure<D> {
    /// Starts without neighbours: s = 1.
    pub fn new() -> Self {
        Measure {
            factor: [0.0; MOST_NEIGHBOURS * (MOST_NEIGHBOURS + 1) / 2],
            y: [0.0; MOST_NEIGHBOURS],
            offsets: [[0.0; D]; MOST_NEIGHBOURS],
            count: 0,
            value: 1.0,
        }
    }

    /// Forgets all neighbours.
    pub fn clear(&mut self) {
        self.count = 0;
        self.value = 1.0;
    }

    /// Returns s(x) with the neighbours so far, in 0..=1.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Adds a neighbour at `offset` from x, in units of σ, and returns the new s(x). A neighbour in the span of the
    /// others, or beyond [`MOST_NEIGHBOURS`], changes nothing.
    #[inline]
    pub fn add(&mut self, offset: &[f64; D]) -> f64 {
        let n = self.count;
        if n == MOST_NEIGHBOURS {
            return self.value;
        }
        let (above, rest) = self.factor.split_at_mut(n * (n + 1) / 2);
        let new = &mut rest[..=n];
        let (mut pivot, mut entry) = (1.0, kernel(length_squared(offset)));
        let mut rows = &*above;
        for j in 0..n {
            let (row, below) = rows.split_at(j + 1);
            let known: f64 = row[..j].iter().zip(new.iter()).map(|(a, b)| a * b).sum();
            let l = row[j] * (kernel(distance_squared(offset, &self.offsets[j])) - known);
            new[j] = l;
            pivot -= l * l;
            entry -= l * self.y[j];
            rows = below;
        }
        if pivot > SMALLEST_PIVOT {
            new[n] = pivot.sqrt().recip();
            self.y[n] = entry * new[n];
            self.offsets[n] = *offset;
            self.value = (self.value - self.y[n] * self.y[n]).max(0.0);
            self.count += 1;
        }
        self.value
    }
}

impl<const D: usize> Default for Measure<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// Number of neighbours that the gradient uses, nearest first: more would not change where samples go.
pub const GRADIENT_NEIGHBOURS: usize = 12;

/// Returns ∇s(x) with respect to x in units of σ: 4 Σ aᵢ kᵢ (x - xᵢ), a = K⁻¹ k, for neighbours at `offsets` from x, at most
/// [`GRADIENT_NEIGHBOURS`]. It is the paper's double sum (section 6.2) with the symmetric half carried out.
///
/// K = L D Lᵀ is computed column by column, with k as an extra row, on whole columns of a fixed length, the part above
/// the diagonal included: for so few neighbours this is fastest.
pub fn gradient<const D: usize>(offsets: &[[f64; D]]) -> [f64; D] {
    const LAST: usize = GRADIENT_NEIGHBOURS;
    let n = offsets.len();
    let mut columns = [[0.0; LAST + 1]; LAST];
    let mut k = [0.0; LAST];
    for (j, offset) in offsets.iter().enumerate() {
        columns[j][j] = 1.0;
        for i in j + 1..n {
            columns[j][i] = kernel(distance_squared(offset, &offsets[i]));
        }
        k[j] = kernel(length_squared(offset));
        columns[j][LAST] = k[j];
    }
    let mut a = [0.0; LAST];
    for j in 0..n {
        let (done, right) = columns.split_at_mut(j + 1);
        let column = &done[j];
        // The reciprocal of the pivot, for now; a neighbour in the span of those before it gets no share.
        a[j] = if column[j] > SMALLEST_PIVOT { column[j].recip() } else { 0.0 };
        for i in j + 1..n {
            let factor = column[i] * a[j];
            right[i - j - 1].iter_mut().zip(column).for_each(|(x, c)| *x -= factor * c);
        }
    }
    let mut pull = [0.0; D];
    for j in (0..n).rev() {
        let known: f64 = (j + 1..n).map(|i| columns[j][i] * a[i]).sum();
        a[j] *= columns[j][LAST] - known;
        let share = a[j] * k[j];
        pull.iter_mut().zip(&offsets[j]).for_each(|(sum, x)| *sum += share * x);
    }
    pull.map(|x| -4.0 * x)
}

/// Returns the Gaussian kernel of a squared distance in units of σ.
#[inline]
pub fn kernel(distance_squared: f64) -> f64 {
    gaussian(distance_squared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::geom::vector::difference;
    use approx::assert_relative_eq;

    fn points<const D: usize>(n: usize, seed: u64) -> Vec<[f64; D]> {
        let mut rng = stream(seed, Stage::Candidates);
        (0..n).map(|_| [0.0; D].map(|_: f64| 2.0 * unit(&mut rng) - 1.0)).collect()
    }

    fn incremental<const D: usize>(x: &[f64; D], others: &[[f64; D]]) -> Measure<D> {
        let mut m = Measure::new();
        others.iter().for_each(|p| {
            m.add(&difference(p, x));
        });
        m
    }

    /// Computes s(x) by Gaussian elimination with pivoting on the whole matrix.
    fn dense<const D: usize>(x: &[f64; D], others: &[[f64; D]]) -> f64 {
        let n = others.len();
        let k: Vec<f64> = others.iter().map(|p| kernel(distance_squared(p, x))).collect();
        let mut rows: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let row = (0..n).map(|j| kernel(distance_squared(&others[i], &others[j])));
                row.chain([k[i]]).collect()
            })
            .collect();
        for c in 0..n {
            let best = (c..n).max_by(|&a, &b| rows[a][c].abs().total_cmp(&rows[b][c].abs())).unwrap();
            rows.swap(c, best);
            let pivot = rows[c].clone();
            for row in rows.iter_mut().skip(c + 1) {
                let f = row[c] / pivot[c];
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= f * p);
            }
        }
        let mut a = vec![0.0; n];
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| rows[i][j] * a[j]).sum();
            a[i] = (rows[i][n] - known) / rows[i][i];
        }
        1.0 - a.iter().zip(&k).map(|(a, k)| a * k).sum::<f64>()
    }

    fn the_measure_is_that_of_a_dense_solve_in<const D: usize>() {
        for seed in 0..20 {
            let all = points::<D>(13, seed);
            assert_relative_eq!(incremental(&all[0], &all[1..]).value(), dense(&all[0], &all[1..]), epsilon = 1e-8);
        }
    }

    #[test]
    fn the_measure_is_that_of_a_dense_solve() {
        the_measure_is_that_of_a_dense_solve_in::<3>();
        the_measure_is_that_of_a_dense_solve_in::<6>();
        the_measure_is_that_of_a_dense_solve_in::<10>();
    }

    #[test]
    fn one_neighbour_leaves_one_minus_k_squared() {
        assert_relative_eq!(incremental(&[0.0; 2], &[[0.3, 0.4]]).value(), 1.0 - (-0.5f64).exp(), epsilon = 1e-14);
        assert_relative_eq!(incremental(&[0.0; 4], &[[0.25; 4]]).value(), 1.0 - (-0.5f64).exp(), epsilon = 1e-14);
    }

    fn the_gradient_is_that_of_finite_differences_in<const D: usize>() {
        for seed in 0..20 {
            let all = points::<D>(11, seed);
            let (x, others) = (all[0], &all[1..]);
            let offsets: Vec<[f64; D]> = others.iter().map(|p| difference(p, &x)).collect();
            for (axis, g) in gradient(&offsets).into_iter().enumerate() {
                let h = 1e-5;
                let at = |h: f64| {
                    let mut moved = x;
                    moved[axis] += h;
                    dense(&moved, others)
                };
                assert_relative_eq!(g, (at(h) - at(-h)) / (2.0 * h), epsilon = 1e-6, max_relative = 1e-5);
            }
        }
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        the_gradient_is_that_of_finite_differences_in::<3>();
        the_gradient_is_that_of_finite_differences_in::<6>();
        the_gradient_is_that_of_finite_differences_in::<10>();
    }

    #[test]
    fn the_same_neighbour_twice_counts_once_and_a_coincident_one_leaves_nothing() {
        let p = [0.5, 0.2, -0.1];
        let once = incremental(&[0.0; 3], &[p]).value();
        assert_relative_eq!(incremental(&[0.0; 3], &[p, p]).value(), once, epsilon = 1e-12);
        let q = p.map(|x| -0.5 * x);
        assert!(distance_squared(&gradient(&[p, p, q]), &gradient(&[p, q])) < 1e-18);
        assert_relative_eq!(incremental(&p, &[p]).value(), 0.0, epsilon = 1e-12);
    }

    #[test]
    fn every_neighbour_lowers_the_measure() {
        let all = points::<3>(MOST_NEIGHBOURS + 5, 3);
        let mut m = Measure::new();
        let mut last = m.value();
        for p in &all[1..] {
            let now = m.add(&difference(p, &all[0]));
            assert!((0.0..=last).contains(&now));
            last = now;
        }
    }
}
