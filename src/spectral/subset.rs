//! Chooses samples of a manifold of any dimension from given points, without a triangulation.
//!
//! The randomized linear scan (paper, algorithm 1) keeps the points that change the spectrum of those kept before them
//! by more than ε. To reach an exact number, samples are removed where s is smallest, or added where it is largest, one
//! by one. Removing a sample makes s larger for others, adding one makes it smaller; so an earlier value is a bound,
//! and only the top of a heap is recomputed (M. Minoux, Accelerated greedy algorithms for maximizing submodular set
//! functions, 1978, DOI 10.1007/BFb0006528).
//!
//! [`scan_lifted`](crate::spectral::scan::scan_lifted) is the same scan for points in space, block by block: faster and
//! on many threads.
//!
//! Cost: a few microseconds a point; most are settled by the samples nearest to them.

use crate::base::error::Result;
use crate::base::heap::Ranked;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::base::rng::{Stage, bits_at};
use crate::spectral::cells::Cells;
use crate::spectral::measure::{MOST_NEIGHBOURS, Measure, RADIUS};
use crate::spectral::scan::{EPSILON, TOO_NEAR};
use crate::surface::submanifold::Submanifold;
use rayon::slice::ParallelSliceMut;
use std::collections::BinaryHeap;

/// Points between two checks of the monitor.
const CHUNK: usize = 4096;

/// Measure at or below which a point differs from the samples only by rounding.
const LEAST_NEWS: f64 = 1e-9;

/// Number of points to examine for each missing sample, and the minimum.
const POINTS_PER_MISSING: usize = 32;
const FEWEST_POINTS: usize = 1024;

/// Width of a cell in units of σ.
const CELL: f64 = RADIUS;

/// Scans `points` and returns the numbers of those kept, in the order in which they were kept. `sigma` is the width of
/// the kernel in the units of the coordinates.
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
    let turn = |i: u32| bits_at(seed, Stage::Scan, (i, 0))[0] as u32;
    let mut order: Vec<(u32, u32)> = parallel::map(0..points.len() as u32, |i| (turn(i), i));
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

/// Chooses `wanted` of `points`, or fewer if no more of them differ, starting from those numbered in `chosen`: removes
/// surplus samples where s is smallest, or adds missing ones where it is largest.
pub fn thin_or_fill<S: Submanifold<D>, const D: usize>(
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

/// Removes the points numbered in `chosen` that the scan would not keep among the others, the least important first. Returns
/// the removed ones in this order.
pub fn thin_to_scan<S: Submanifold<D>, const D: usize>(
    manifold: &S,
    points: &[S::Point],
    chosen: &mut Vec<u32>,
    sigma: f64,
) -> Vec<u32> {
    let mut samples = Samples::new(manifold, points, sigma);
    chosen.iter().for_each(|&point| samples.insert(point));
    let removed = samples.thin_while(|_, measure| measure <= EPSILON);
    *chosen = samples.numbers;
    removed
}

/// The points chosen so far.
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

    /// Returns whether s > ε at `point`, which is not a sample yet. The nearest samples, tested first, settle most cases.
    fn changes_spectrum(&self, point: u32) -> bool {
        let nearest = self.near(point, TOO_NEAR.sqrt() * self.sigma);
        nearest.is_empty() && self.measure(point, EPSILON) > EPSILON
    }

    /// Returns the measure at `point` among the other samples; if that is at most `least`, any value up to `least`.
    fn measure(&self, point: u32, least: f64) -> f64 {
        let mut measure = Measure::new();
        for (_, _, offset) in self.near(point, RADIUS * self.sigma).into_iter().take(MOST_NEIGHBOURS) {
            if measure.add(&offset.map(|x| x / self.sigma)) <= least {
                break;
            }
        }
        measure.value()
    }

    /// Returns the other samples that count as neighbours of `point` within `radius`, nearest first: squared distance,
    /// number and offset.
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
        if self.numbers.len() > wanted {
            self.thin_while(|count, _| count > wanted);
        }
    }

    /// Removes the sample with the smallest s while `goes` holds for the number of samples and that s. Returns the removed
    /// samples in this order.
    fn thin_while(&mut self, goes: impl Fn(usize, f64) -> bool) -> Vec<u32> {
        let ranked: Vec<Ranked> = parallel::map(&self.numbers[..], |&i| Ranked::new(-self.measure(i, 0.0), i));
        let mut heap = BinaryHeap::from(ranked);
        let mut removed = Vec::new();
        let mut is_removed = vec![false; self.points.len()];
        while let Some(top) = heap.pop() {
            let now = -self.measure(top.index, 0.0);
            if now < top.rank {
                heap.push(Ranked::new(now, top.index));
                continue;
            }
            if !goes(self.numbers.len() - removed.len(), -now) {
                break;
            }
            self.cells.remove(top.index, &self.coordinates(top.index));
            is_removed[top.index as usize] = true;
            removed.push(top.index);
        }
        self.numbers.retain(|&i| !is_removed[i as usize]);
        removed
    }

    /// Adds samples, first from a part of the points, until there are `wanted` or no remaining point differs.
    fn fill_to(&mut self, wanted: usize) {
        let missing = wanted.saturating_sub(self.numbers.len());
        let part = (self.points.len() / (POINTS_PER_MISSING * missing + FEWEST_POINTS)).max(1);
        for step in [part, 1] {
            if self.numbers.len() < wanted {
                self.fill_from((0..self.points.len() as u32).step_by(step).collect(), wanted);
            }
        }
    }

    /// Adds samples from `pool`.
    fn fill_from(&mut self, mut pool: Vec<u32>, wanted: usize) {
        let mut taken = vec![false; self.points.len()];
        self.numbers.iter().for_each(|&i| taken[i as usize] = true);
        pool.retain(|&i| !taken[i as usize]);
        let ranked: Vec<Ranked> = parallel::map(&pool[..], |&i| Ranked::new(self.measure(i, 0.0), i));
        let mut heap = BinaryHeap::from(ranked);
        while self.numbers.len() < wanted {
            let Some(top) = heap.pop().filter(|top| top.rank > LEAST_NEWS) else { return };
            let now = self.measure(top.index, 0.0);
            if now < top.rank {
                heap.push(Ranked::new(now, top.index));
            } else {
                self.insert(top.index);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{stream, unit};
    use crate::surface::submanifold::{FlatTorus, UnitCube};

    fn points(n: usize) -> Vec<[f64; 2]> {
        let mut rng = stream(9, Stage::Candidates);
        (0..n).map(|_| [unit(&mut rng), unit(&mut rng)]).collect()
    }

    #[test]
    fn samples_are_what_the_scan_says() {
        let (points, sigma) = (points(3000), 0.06);
        let kept = scan(&FlatTorus, &points, sigma, 5, &()).unwrap();
        let mut samples = Samples::new(&FlatTorus, &points, sigma);
        for &point in &kept {
            assert!(samples.measure(point, 0.0) > EPSILON);
            samples.insert(point);
        }
        // None of the others would add more than ε now.
        assert!((0..3000).all(|i| kept.contains(&i) || samples.measure(i, 0.0) <= EPSILON + 1e-12));
    }

    /// Thins one by one, with all measures recomputed each time.
    fn thinned_by_hand(points: &[[f64; 2]], sigma: f64, wanted: usize) -> Vec<u32> {
        let mut numbers: Vec<u32> = (0..points.len() as u32).collect();
        while numbers.len() > wanted {
            let mut samples = Samples::new(&UnitCube, points, sigma);
            numbers.iter().for_each(|&i| samples.insert(i));
            let least = numbers.iter().map(|&i| Ranked::new(-samples.measure(i, 0.0), i)).max().unwrap();
            numbers.retain(|&i| i != least.index);
        }
        numbers
    }

    #[test]
    fn the_least_important_go_first_and_the_most_important_come_first() {
        let (points, sigma) = (points(60), 0.15);
        let all: Vec<u32> = (0..60).collect();
        assert_eq!(thin_or_fill(&UnitCube, &points, &all, sigma, 40), thinned_by_hand(&points, sigma, 40));
        // The first one has the lowest number, since all are equally good; the second is the one least determined by it.
        let two = thin_or_fill(&UnitCube, &points, &[], 10.0, 2);
        let distance = |i: u32| length(&points[two[0] as usize], &points[i as usize]);
        assert_eq!((two[0], two.len()), (0, 2));
        assert!((0..60).all(|i| distance(i) <= distance(two[1])));
    }

    fn length(a: &[f64; 2], b: &[f64; 2]) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    #[test]
    fn the_same_point_twice_is_no_other_point() {
        let points = vec![[0.5, 0.5]; 9];
        assert_eq!(thin_or_fill(&UnitCube, &points, &[], 0.1, 5).len(), 1);
        assert_eq!(scan(&UnitCube, &points, 0.1, 0, &()).unwrap().len(), 1);
    }
}
