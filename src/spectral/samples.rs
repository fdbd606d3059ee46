//! Samples of a manifold of any dimension, without a triangulation: which of given points they are, and how many.
//!
//! The randomized linear scan (paper, algorithm 1) keeps those points that change the spectrum of the ones kept before
//! them by more than ε. An exact number comes of it by removing where s is smallest, or adding where it is largest, one
//! by one. A sample that goes makes s larger for others, one that comes makes it smaller; so what was worked out earlier
//! is a bound, and only the best of a heap is worked out anew (M. Minoux, Accelerated greedy algorithms for maximizing
//! submodular set functions, 1978, DOI 10.1007/BFb0006528).
//!
//! [`linear_scan`](crate::spectral::scan::linear_scan) is the same scan for candidates on a mesh, faster and on many
//! threads.
//!
//! Cost: a few microseconds a point; most are settled by the samples nearest to them.

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::base::ranked::Ranked;
use crate::base::rng::{Rng, Stage, stream};
use crate::spectral::cells::Cells;
use crate::spectral::measure::{MOST_NEIGHBOURS, Measure, RADIUS};
use crate::spectral::scan::{EPSILON, TOO_NEAR};
use crate::surface::submanifold::Submanifold;
use rayon::prelude::*;
use std::collections::BinaryHeap;

/// Points between two looks at the monitor.
const CHUNK: usize = 4096;

/// The measure of what is no other point than those that are there, but for rounding.
const LEAST_NEWS: f64 = 1e-9;

/// Width of a cell in units of σ.
const CELL: f64 = RADIUS / 2.0;

/// The samples that the scan keeps of `points`: their numbers, in the order in which they were kept. `sigma` is the
/// width of the kernel in the units of the coordinates.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn scan<S: Submanifold<D>, const D: usize>(
    manifold: &S,
    points: &[S::Point],
    sigma: f64,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Vec<u32>> {
    let mut rng = stream(seed, Stage::Scan);
    let mut order: Vec<(u32, u32)> = (0..points.len() as u32).map(|i| (rng.next_u32(), i)).collect();
    order.par_sort_unstable();
    let mut kept = Samples::new(manifold, points, sigma);
    for (i, chunk) in order.chunks(CHUNK).enumerate() {
        check(monitor)?;
        monitor.progress((i * CHUNK) as f64 / order.len() as f64);
        for &(_, point) in chunk {
            if kept.changes_spectrum(point) {
                kept.insert(point);
            }
        }
    }
    Ok(kept.numbers)
}

/// `wanted` of `points`, or fewer if no others differ from those, beginning with those numbered in `chosen`: what is too much is
/// removed where s is smallest, what is missing is added where it is largest.
pub fn meet_count<S: Submanifold<D>, const D: usize>(
    manifold: &S,
    points: &[S::Point],
    chosen: &[u32],
    sigma: f64,
    wanted: usize,
) -> Vec<u32> {
    let mut samples = Samples::new(manifold, points, sigma);
    chosen.iter().for_each(|&point| samples.insert(point));
    samples.thin_to(wanted);
    samples.fill_to(wanted);
    samples.numbers
}

/// Some of the given points.
struct Samples<'a, S: Submanifold<D>, const D: usize> {
    manifold: &'a S,
    points: &'a [S::Point],
    sigma: f64,
    cells: Cells<D>,
    numbers: Vec<u32>,
}

impl<'a, S: Submanifold<D>, const D: usize> Samples<'a, S, D> {
    fn new(manifold: &'a S, points: &'a [S::Point], sigma: f64) -> Self {
        Samples { manifold, points, sigma, cells: Cells::new(CELL * sigma), numbers: Vec::new() }
    }

    fn coordinates(&self, point: u32) -> [f64; D] {
        self.manifold.coordinates(&self.points[point as usize])
    }

    fn insert(&mut self, point: u32) {
        self.cells.insert(point, self.coordinates(point));
        self.numbers.push(point);
    }

    /// Whether s > ε at `point`, which is no sample yet: first with the nearest samples, which settle most.
    fn changes_spectrum(&self, point: u32) -> bool {
        let nearest = self.near(point, TOO_NEAR.sqrt() * self.sigma);
        nearest.is_empty() && self.measure(point, EPSILON) > EPSILON
    }

    /// The measure at `point` among the other samples; if it is no more than `least`, some number that is not, either.
    fn measure(&self, point: u32, least: f64) -> f64 {
        let mut measure = Measure::new();
        for (_, _, offset) in self.near(point, RADIUS * self.sigma).into_iter().take(MOST_NEIGHBOURS) {
            if measure.add(&offset.map(|x| x / self.sigma)) <= least {
                break;
            }
        }
        measure.value()
    }

    /// The other samples that count as neighbours of `point` within `radius`, nearest first: squared distance, number
    /// and offset.
    fn near(&self, point: u32, radius: f64) -> Vec<(f64, u32, [f64; D])> {
        let here = self.coordinates(point);
        let mut found = Vec::new();
        for x in self.manifold.images(&here, radius) {
            self.cells.near(&x, radius, |distance, number, y| {
                if number != point && self.joined(point, number) {
                    found.push((distance, number, self.manifold.offset(&x, y)));
                }
            });
        }
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found
    }

    fn joined(&self, one: u32, other: u32) -> bool {
        self.manifold.joined(&self.points[one as usize], &self.points[other as usize])
    }

    /// Removes samples until there are no more than `wanted`.
    fn thin_to(&mut self, wanted: usize) {
        if self.numbers.len() <= wanted {
            return;
        }
        let ranked: Vec<Ranked> = self.numbers.par_iter().map(|&i| Ranked::new(-self.measure(i, 0.0), i)).collect();
        let mut heap = BinaryHeap::from(ranked);
        let mut removed = vec![false; self.points.len()];
        let mut count = self.numbers.len();
        while count > wanted {
            let Some(top) = heap.pop() else { break };
            let now = -self.measure(top.index, 0.0);
            if now < top.rank {
                heap.push(Ranked::new(now, top.index));
                continue;
            }
            self.cells.remove(top.index, &self.coordinates(top.index));
            removed[top.index as usize] = true;
            count -= 1;
        }
        self.numbers.retain(|&i| !removed[i as usize]);
    }

    /// Adds samples until there are `wanted`, or no points any more.
    fn fill_to(&mut self, wanted: usize) {
        if self.numbers.len() >= wanted {
            return;
        }
        let mut taken = vec![false; self.points.len()];
        self.numbers.iter().for_each(|&i| taken[i as usize] = true);
        let free = (0..self.points.len() as u32).into_par_iter().filter(|&i| !taken[i as usize]);
        let ranked: Vec<Ranked> = free.map(|i| Ranked::new(self.measure(i, 0.0), i)).collect();
        let mut heap = BinaryHeap::from(ranked);
        while self.numbers.len() < wanted {
            let Some(top) = heap.pop() else { return };
            if top.rank <= LEAST_NEWS {
                return;
            }
            let now = self.measure(top.index, 0.0);
            if now < top.rank {
                heap.push(Ranked::new(now, top.index));
            } else {
                self.insert(top.index);
            }
        }
    }
}
