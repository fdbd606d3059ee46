//! Gradient ascent on the measure for bare points of a manifold of any dimension (paper, section 6.2): x ← x + ½ ∇s(x)
//! in units of σ, then back onto the manifold.
//!
//! Departures from the paper: points of one colour, no two of them neighbours, move at the same time, so the result is
//! the same for any number of threads; neighbour lists are rebuilt every few sweeps; crowds are broken up, so the
//! ascent may start from random points.
//!
//! Cost: about three microseconds per point and sweep on a mesh, a third of that for the lists.
//!
//! Limits: nothing holds points together. Points next to a boundary end up on it, and only [`Submanifold::joined`] tells the
//! two sides of a thin sheet apart.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::geom::vector::{length_squared, scaled, shortened};
use crate::spectral::ascent::{AscentParameters, MOST_STEP};
use crate::spectral::cells::Cells;
use crate::spectral::measure::{GRADIENT_NEIGHBOURS, RADIUS, gradient};
use crate::spectral::nearest::Nearest;
use crate::surface::submanifold::Submanifold;

/// Sweeps between rebuilds of the neighbour lists.
const SWEEPS_OF_LISTS: usize = 3;

/// Maximum number of neighbours in a list: more than a gradient uses, since points move between rebuilds.
const LISTED: usize = 24;

/// Distance of the nearest neighbour, in units of σ, below which only that one counts. In a crowd of m points of size δ, s
/// is of the order δ^(2m - 2), so flat that they would hardly separate; from one neighbour alone a point moves away by twice
/// their distance.
const CROWDED: f64 = 0.25;

/// Share of its last move that a point repeats in the next sweep of [`ascend_at_once`].
const AGAIN: f64 = 0.45;

/// Moves all `points`. `ascent.sigma` is in the units of the coordinates.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn ascend_freely<S: Submanifold<D>, const D: usize>(
    manifold: &S,
    points: &mut [S::Point],
    ascent: AscentParameters,
    monitor: &dyn Monitor,
) -> Result<()> {
    let mut classes = Vec::new();
    let mut lists = Vec::new();
    for sweep in 0..ascent.sweeps {
        check(monitor)?;
        if sweep % SWEEPS_OF_LISTS == 0 {
            lists = neighbours(manifold, points, ascent.sigma);
            classes = colour_classes(&lists);
        }
        for class in &classes {
            let moved: Vec<S::Point> = parallel::map(&class[..], |&v| {
                stepped(manifold, points, v, way_up(manifold, points, &lists[v as usize], v, ascent), ascent)
            });
            class.iter().zip(moved).for_each(|(&v, point)| points[v as usize] = point);
        }
        monitor.progress((sweep + 1) as f64 / ascent.sweeps as f64);
    }
    Ok(())
}

/// Like [`ascend_freely`], but moves all points at once in each sweep. So a point depends only on those within [`reach_of`],
/// and a part of the points moves as it would among all. Since two neighbours both give way, the step has to be shorter;
/// repeating a part of each move in the next sweep makes up for that (B. T. Polyak, Some methods of speeding up the
/// convergence of iteration methods, 1964, DOI 10.1016/0041-5553(64)90137-5).
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn ascend_at_once<S: Submanifold<D>, const D: usize>(
    manifold: &S,
    points: &mut [S::Point],
    ascent: AscentParameters,
    monitor: &dyn Monitor,
) -> Result<()> {
    let mut lists = Vec::new();
    let mut last = vec![[0.0; D]; points.len()];
    for sweep in 0..ascent.sweeps {
        check(monitor)?;
        if sweep % SWEEPS_OF_LISTS == 0 {
            lists = neighbours(manifold, points, ascent.sigma);
        }
        let moved = |v: usize| {
            let mut way = way_up(manifold, points, &lists[v], v as u32, ascent);
            way.iter_mut().zip(&last[v]).for_each(|(x, last)| *x += AGAIN * last);
            stepped(manifold, points, v as u32, way, ascent)
        };
        let moved: Vec<S::Point> = parallel::map(0..points.len(), moved);
        last.iter_mut().zip(points.iter().zip(&moved)).for_each(|(last, (from, to))| {
            *last = manifold.offset(&manifold.coordinates(from), &manifold.coordinates(to));
        });
        points.copy_from_slice(&moved);
        monitor.progress((sweep + 1) as f64 / ascent.sweeps as f64);
    }
    Ok(())
}

/// Returns the distance, in units of σ, up to which a point can affect another one in [`ascend_at_once`]: each sweep adds
/// the radius of a neighbourhood and a step of both neighbours.
pub fn reach_of(sweeps: usize) -> f64 {
    sweeps as f64 * (RADIUS + 2.0 * MOST_STEP)
}

/// Returns where the step `way` takes point `v`.
fn stepped<S: Submanifold<D>, const D: usize>(
    manifold: &S,
    points: &[S::Point],
    v: u32,
    way: [f64; D],
    ascent: AscentParameters,
) -> S::Point {
    manifold.step(&points[v as usize], &shortened(&way, MOST_STEP * ascent.sigma))
}

/// Returns the step of point `v`, up the gradient.
fn way_up<S: Submanifold<D>, const D: usize>(
    manifold: &S,
    points: &[S::Point],
    list: &[u32],
    v: u32,
    AscentParameters { sigma, step, .. }: AscentParameters,
) -> [f64; D] {
    let here = manifold.coordinates(&points[v as usize]);
    let offset = |w: u32| manifold.offset(&here, &manifold.coordinates(&points[w as usize]));
    let mut found = Nearest::default();
    list.iter().for_each(|&w| found.add(length_squared(&offset(w)), w));
    let mut offsets = [[0.0; D]; GRADIENT_NEIGHBOURS];
    for (scaled, &(_, w)) in offsets.iter_mut().zip(found.list()) {
        *scaled = offset(w).map(|x| x / sigma);
    }
    let is_crowded = found.list().first().is_some_and(|nearest| nearest.0 < math::square(CROWDED * sigma));
    let counting = if is_crowded { 1 } else { found.list().len() };
    scaled(&gradient(&offsets[..counting]), step * sigma)
}

/// Returns the neighbours of each point, at most the nearest [`LISTED`].
fn neighbours<S: Submanifold<D>, const D: usize>(manifold: &S, points: &[S::Point], sigma: f64) -> Vec<Vec<u32>> {
    let radius = RADIUS * sigma;
    let mut cells = Cells::new(radius / 2.0);
    points.iter().zip(0..).for_each(|(point, v)| cells.insert(v, manifold.coordinates(point)));
    let of_point = |v: usize| {
        let point = &points[v];
        let mut found = Vec::new();
        for x in manifold.images(&manifold.coordinates(point), radius) {
            cells.near(&x, radius, |distance, w, _| {
                if w as usize != v && manifold.joined(point, &points[w as usize]) {
                    found.push((distance, w));
                }
            });
        }
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().take(LISTED).map(|f| f.1).collect()
    };
    parallel::map(0..points.len(), of_point)
}

/// Divides the points into classes in which no point lists an earlier one: each gets the lowest colour that no earlier
/// point on its list has.
fn colour_classes(lists: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut colours: Vec<usize> = Vec::with_capacity(lists.len());
    let mut classes: Vec<Vec<u32>> = Vec::new();
    for (v, list) in lists.iter().enumerate() {
        let taken: Vec<usize> = list.iter().filter(|&&w| (w as usize) < v).map(|&w| colours[w as usize]).collect();
        let colour = (0..).find(|colour| !taken.contains(colour)).expect("a list is finite");
        colours.push(colour);
        if colour == classes.len() {
            classes.push(Vec::new());
        }
        classes[colour].push(v as u32);
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::spectral::ascent::PAPER_STEP;
    use crate::surface::submanifold::{FlatTorus, UnitCube};

    fn ascent(sigma: f64, sweeps: usize) -> AscentParameters {
        AscentParameters { sigma, step: PAPER_STEP, sweeps }
    }

    #[test]
    fn two_points_part_until_they_do_not_hear_each_other() {
        let mut points = [[0.45, 0.5], [0.55, 0.5]];
        ascend_freely(&UnitCube, &mut points, ascent(0.2, 100), &()).unwrap();
        assert!(points[1][0] - points[0][0] > 0.35 && points[0][1] == 0.5, "{points:?}");
    }

    #[test]
    fn points_on_a_circle_come_to_be_equally_far_apart() {
        let mut rng = stream(2, Stage::Scan);
        let mut points: Vec<[f64; 1]> = (0..20).map(|_| [unit(&mut rng)]).collect();
        ascend_freely(&FlatTorus, &mut points, ascent(0.05, 400), &()).unwrap();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let gaps = (0..20).map(|i| FlatTorus.offset(&points[i], &points[(i + 1) % 20])[0]);
        gaps.for_each(|gap| assert!((gap - 0.05).abs() < 0.005, "{gap}"));
    }

    #[test]
    fn a_crowd_is_broken_up() {
        let mut rng = stream(3, Stage::Scan);
        let mut points: Vec<[f64; 2]> = (0..12).map(|_| [0.5, 0.5].map(|x| x + 1e-4 * unit(&mut rng))).collect();
        ascend_freely(&FlatTorus, &mut points, ascent(0.2, 30), &()).unwrap();
        for (i, x) in points.iter().enumerate() {
            let nearest = points[..i].iter().map(|y| length_squared(&FlatTorus.offset(x, y))).fold(1.0, f64::min);
            assert!(nearest.sqrt() > 0.1, "{nearest}");
        }
    }

    #[test]
    fn none_of_a_class_lists_another_before_it() {
        let lists = vec![vec![1, 2], vec![0], vec![0, 1], vec![]];
        assert_eq!(colour_classes(&lists), [vec![0, 3], vec![1], vec![2]]);
    }
}
