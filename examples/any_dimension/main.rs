//! A single sampler for manifolds of any dimension: a square, a square whose opposite sides are joined, a cube, and a
//! surface in ten dimensions. First, gradient ascent moves random points until they are as far apart as possible. Then, the
//! linear scan selects a subset of many random points that is even from the start.
//!
//! `cargo run --release --example any_dimension`

#![allow(clippy::disallowed_methods)]

mod ten;

use spectral_remesh::stages::base::error::Result;
use spectral_remesh::stages::base::rng::{Random, Stage, stream, unit};
use spectral_remesh::stages::geom::vector::length_squared;
use spectral_remesh::stages::spectral::ascent::{AscentParameters, PAPER_STEP};
use spectral_remesh::stages::spectral::free_ascent::ascend_freely;
use spectral_remesh::stages::spectral::subset::scan;
use spectral_remesh::stages::surface::submanifold::{FlatTorus, Submanifold, UnitCube};
use ten::FiveCircles;

/// Number of points on each manifold, and number of points from which the scan selects.
const POINTS: usize = 1000;
const CANDIDATES: usize = 20_000;

/// Kernel widths in spacings: for moving points, and for selecting them.
const ASCENT_SIGMA: f64 = 0.94;
const SCAN_SIGMA: f64 = 0.866;

fn main() -> Result<()> {
    let unit_point = |rng: &mut Random| [unit(rng), unit(rng)];
    let spacing = |area: f64| (2.0 * area / (3f64.sqrt() * POINTS as f64)).sqrt();
    show("square", &UnitCube::<2>, unit_point, spacing(1.0))?;
    show("square, sides joined", &FlatTorus::<2>, unit_point, spacing(1.0))?;
    // The densest packing in three dimensions is that of stacked oranges: √2 balls in a volume of spacing³.
    let in_cube = (2f64.sqrt() / POINTS as f64).cbrt();
    show("cube", &UnitCube::<3>, |rng| [unit(rng), unit(rng), unit(rng)], in_cube)?;
    show("surface in ten dimensions", &FiveCircles, FiveCircles::random, spacing(FiveCircles::area()))
}

/// Samples a manifold and prints how even the samples are: the distance of the closest pair in units of `spacing`, the
/// distance in the densest packing.
fn show<S: Submanifold<D>, const D: usize>(
    name: &str,
    manifold: &S,
    random: impl Fn(&mut Random) -> S::Point,
    spacing: f64,
) -> Result<()> {
    let mut rng = stream(1, Stage::Candidates);
    let mut points: Vec<S::Point> = (0..POINTS).map(|_| random(&mut rng)).collect();
    let before = nearest_pair(manifold, &points) / spacing;
    ascend_freely(
        manifold,
        &mut points,
        AscentParameters { sigma: ASCENT_SIGMA * spacing, step: PAPER_STEP, sweeps: 10 },
        &(),
    )?;
    let after = nearest_pair(manifold, &points) / spacing;
    println!("{name}: {POINTS} random points, nearest two {before:.3} of a spacing apart, after ten sweeps {after:.3}");

    let candidates: Vec<S::Point> = (0..CANDIDATES).map(|_| random(&mut rng)).collect();
    let kept = scan(manifold, &candidates, SCAN_SIGMA * spacing, 1, &())?;
    let kept: Vec<S::Point> = kept.iter().map(|&i| candidates[i as usize]).collect();
    let apart = nearest_pair(manifold, &kept) / spacing;
    println!("  {} of {CANDIDATES} points kept by the scan, nearest two {apart:.3} apart", kept.len());
    Ok(())
}

/// Returns the distance of the closest pair of points.
fn nearest_pair<S: Submanifold<D>, const D: usize>(manifold: &S, points: &[S::Point]) -> f64 {
    let places: Vec<[f64; D]> = points.iter().map(|point| manifold.coordinates(point)).collect();
    let mut nearest = f64::INFINITY;
    for (i, x) in places.iter().enumerate() {
        for y in &places[..i] {
            nearest = nearest.min(length_squared(&manifold.offset(x, y)));
        }
    }
    nearest.sqrt()
}
