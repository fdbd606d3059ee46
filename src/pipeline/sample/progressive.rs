//! Progressive order of samples: every first part of them is a good sampling, too (paper, section 6.4, from fine to coarse).
//!
//! The kernel is widened step by step. Samples that the scan would not keep with the wider kernel are removed, those that
//! change the spectrum least first; the order is the reverse of the removal. So each sample comes where it is worth most.
//!
//! Departures from the paper: the paper scans the remaining samples in random order with a much wider kernel, which leaves
//! the samples between two levels unordered. Samples that do not influence each other, such as those of two components or of
//! the two sides of a plate, would never be removed; in the end they are ordered by their positions alone.
//!
//! Cost: a few times that of measuring all samples once; the steps are a geometric series.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::pipeline::density::FEWEST_POINTS;
use crate::pipeline::kernel::KernelFeatures;
use crate::spatial::kdtree::Neighbors;
use crate::spectral::subset::thin_to_scan;
use crate::surface::domain::Sample;
use crate::surface::lift::{Lifted, Surface};
use crate::surface::submanifold::Submanifold;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Factor by which the kernel is widened per step: it removes half of the samples of a surface.
const WIDER: f64 = std::f64::consts::SQRT_2;

/// Factor between the numbers of points of successive levels: on a surface it halves the spacing.
const POINTS_PER_LEVEL: usize = 4;

/// First samples of a progressive order, as a sampling of its own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SampleLevel {
    /// Number of samples.
    pub points: usize,
    /// Mean distance of each sample to its nearest neighbour, in the units of the input.
    pub spacing: f64,
    /// Smallest of these distances.
    pub smallest_distance: f64,
}

/// Returns the numbers of `samples` in progressive order. `sigma` is the kernel width of the samples.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub(in crate::pipeline) fn progressive_order<S: Surface, const D: usize>(
    surface: &S,
    features: &KernelFeatures,
    samples: &[Sample],
    sigma: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<u32>> {
    monitor.stage("order");
    let mut left: Vec<u32> = (0..samples.len() as u32).collect();
    let mut from_last = Vec::with_capacity(left.len());
    let extent = Aabb::of(samples.iter().map(|s| s.position)).unwrap_or_default().size().length();
    let mut width = sigma;
    while left.len() > 1 && width < 2.0 * extent {
        check(monitor)?;
        from_last.extend(features.with_kernel(width, |kernel| {
            thin_to_scan::<_, D>(&Lifted { surface, lift: kernel.lift }, samples, &mut left, width)
        }));
        monitor.progress(from_last.len() as f64 / samples.len() as f64);
        width *= WIDER;
    }
    let mut width = sigma;
    while left.len() > 1 {
        check(monitor)?;
        from_last.extend(thin_to_scan(&Places, samples, &mut left, width));
        width *= WIDER;
    }
    Ok(left.into_iter().chain(from_last.into_iter().rev()).collect())
}

/// Samples of which only the position counts, regardless of the sheet.
struct Places;

impl Submanifold<3> for Places {
    type Point = Sample;

    fn coordinates(&self, point: &Sample) -> [f64; 3] {
        point.position.to_array()
    }

    fn step(&self, from: &Sample, _way: &[f64; 3]) -> Sample {
        *from
    }
}

/// Returns at most `wanted` levels of points in progressive order, from coarse to fine.
pub(in crate::pipeline) fn sample_levels(positions: &[DVec3], wanted: usize) -> Vec<SampleLevel> {
    let finer =
        |&points: &usize| (points >= POINTS_PER_LEVEL * FEWEST_POINTS).then(|| points.div_ceil(POINTS_PER_LEVEL));
    let counts: Vec<usize> = std::iter::successors(Some(positions.len()), finer).take(wanted).collect();
    counts.into_iter().rev().map(|points| SampleLevel::of(&positions[..points])).collect()
}

impl SampleLevel {
    fn of(positions: &[DVec3]) -> SampleLevel {
        let near = Neighbors::new(positions);
        let nearest = |p: &DVec3| {
            let mut found = Vec::new();
            near.collect_nearest(*p, 2, &mut found);
            found.get(1).map_or(0.0, |other| other.distance_squared.sqrt())
        };
        let distances: Vec<f64> = parallel::map(positions, nearest);
        SampleLevel {
            points: positions.len(),
            spacing: distances.iter().sum::<f64>() / distances.len().max(1) as f64,
            smallest_distance: distances.iter().copied().reduce(f64::min).unwrap_or(0.0),
        }
    }
}
