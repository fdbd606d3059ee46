//! The samples of a part of a cloud, the same as within a run over all of it.
//!
//! Everything is local and reaches no farther than a known number of kernel widths: neighbours beyond that do not count, and a
//! point with too few within it is an outlier. The scan goes block by block, and a box depends on a known number of blocks around
//! it (see [`lattice`](crate::spectral::lattice)); the ascent moves all samples at once. What is global comes from the
//! [`Outline`].
//!
//! Departures from sampling a whole cloud: normals are those of planes, the spacing of points has a limit where they are
//! sparse, and the number of samples is about the wanted one only.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::base::parallel;
use crate::base::rng::Address;
use crate::pipeline::cloud::FEW_NEIGHBORS;
use crate::pipeline::outline::Outline;
use crate::pipeline::sample::ASCENT_OF_SCAN;
use crate::prepare::cloud_normals::{MOST_ON_LINE, plane_normal};
use crate::spatial::kdtree::{Neighbor, Neighbors};
use crate::spatial::knn_graph::{DEGREE, spacing_of};
use crate::spectral::ascent::AscentParameters;
use crate::spectral::free_ascent::{ascend_at_once, reach_of};
use crate::spectral::lattice::{BlockBox, place_of};
use crate::spectral::measure::RADIUS;
use crate::spectral::scan::{BLOCK, Choices, Kernel, scan_lifted};
use crate::surface::domain::Sample;
use crate::surface::implicit::Rimls;
use crate::surface::lift::{Lift, Lifted};
use glam::{DVec3, IVec3};
use serde::{Deserialize, Serialize};

/// Neighbours of a point are within so many kernel widths; with fewer than [`FEW_NEIGHBORS`] there it is an outlier.
const NEIGHBORHOOD: f64 = 5.0;

/// Points are taken to be no farther apart than so many kernel widths, so that none reaches far on the surface.
const SPARSE: f64 = 2.0;

/// Blocks around the samples of a tile whose points take part in its surface, or in their normals.
const MARGIN: i32 = 2;

/// Step of the ascent: all samples move at once, so two that meet go twice as far as one.
const STEP: f64 = 0.45;

/// How the tiles of a cloud are sampled: the same for all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TileOptions {
    /// Width of the kernel, in the units of the cloud.
    pub sigma: f64,
    /// Width of a cell, at least half of what the kernel reaches.
    pub cell: f64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Sweeps of gradient ascent; `None` if samples are points of the cloud as the scan leaves them.
    pub sweeps: Option<usize>,
    /// How far points reach on the surface, in their spacings.
    pub reach: f64,
    /// Whether normals that points have are on a common side.
    pub is_sided: bool,
}

/// A point of a cloud.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TilePoint {
    /// Its number in the cloud.
    pub number: u32,
    /// Where it is.
    pub position: DVec3,
    /// Its normal, of any length; zero where none is known.
    pub normal: DVec3,
}

impl TileOptions {
    /// The width of a block, in the units of the cloud.
    pub fn block(&self) -> f64 {
        self.cell * f64::from(BLOCK)
    }

    /// The blocks around a tile whose samples its own depend on while they move.
    fn ascent_halo(&self) -> IVec3 {
        let sweeps = self.sweeps.unwrap_or(0);
        IVec3::splat((reach_of(sweeps) * ASCENT_OF_SCAN * self.sigma / self.block()).ceil() as i32)
    }

    /// The blocks whose points are needed for the samples of `tile`.
    pub fn needed(&self, tile: BlockBox) -> BlockBox {
        let scanned = tile.grown(self.ascent_halo());
        let around = scanned.grown(IVec3::splat(MARGIN));
        let heard = scanned.heard().grown(IVec3::ONE);
        BlockBox { lo: around.lo.min(heard.lo), hi: around.hi.max(heard.hi) }
    }
}

/// The samples of the blocks of `tile`: each has the number of the point that it was at first. `points` are those of
/// [`TileOptions::needed`] blocks, in an order that any two of them have in all tiles.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn sample_tile(
    points: Vec<TilePoint>,
    tile: BlockBox,
    options: &TileOptions,
    outline: &Outline,
    monitor: &dyn Monitor,
) -> Result<Vec<TilePoint>> {
    let part = Part::new(points, options, outline);
    let scanned = tile.grown(options.ascent_halo());
    let kept = part.scan(scanned, monitor)?;
    let is_own = |&i: &u32| tile.contains(part.place(i));
    let Some(sweeps) = options.sweeps else {
        return Ok(kept.into_iter().filter(is_own).map(|i| part.point(i, &part.samples[i as usize])).collect());
    };
    let mut samples: Vec<Sample> = kept.iter().map(|&i| part.samples[i as usize]).collect();
    let positions: Vec<DVec3> = part.samples.iter().map(|s| s.position).collect();
    let normals: Vec<DVec3> = part.samples.iter().map(|s| s.normal).collect();
    let surface = Rimls::new(&positions, &normals, &part.near, &part.spacings, options.reach);
    let ascent = AscentParameters { sigma: ASCENT_OF_SCAN * options.sigma, step: STEP, sweeps };
    ascend_at_once::<_, 3>(&Lifted { surface: &surface, lift: Lift::NONE }, &mut samples, ascent, monitor)?;
    let own: Vec<(u32, Sample)> = kept.into_iter().zip(samples).filter(|(i, _)| is_own(i)).collect();
    let settled = |&(i, sample): &(u32, Sample)| part.point(i, &surface.sample(sample.position).unwrap_or(sample));
    Ok(parallel::map(&own[..], settled))
}

/// How many samples the scan leaves in the blocks of `tile`, about: what is beyond the given points is not heard.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn count_in_tile(
    points: Vec<TilePoint>,
    tile: BlockBox,
    options: &TileOptions,
    outline: &Outline,
    monitor: &dyn Monitor,
) -> Result<usize> {
    let part = Part::new(points, options, outline);
    let kept = part.scan(tile, monitor)?;
    Ok(kept.into_iter().filter(|&i| tile.contains(part.place(i))).count())
}

/// Points of a part of a cloud, without outliers, and what is known of their neighbours.
pub(super) struct Part<'a> {
    options: &'a TileOptions,
    /// With unit normals; their triangles are their places in this list.
    pub samples: Vec<Sample>,
    numbers: Vec<u32>,
    pub spacings: Vec<f64>,
    pub near: Neighbors,
}

impl<'a> Part<'a> {
    pub fn new(points: Vec<TilePoint>, options: &'a TileOptions, outline: &Outline) -> Part<'a> {
        let positions: Vec<DVec3> = points.iter().map(|p| p.position).collect();
        let near = Neighbors::new(&positions);
        let look = |found: &mut Vec<Neighbor>, p: usize| {
            near.collect_nearest_within(positions[p], DEGREE + 1, NEIGHBORHOOD * options.sigma, found);
            if found.len() <= FEW_NEIGHBORS {
                return None;
            }
            let farthest = found.last().map_or(0.0, |n| n.distance_squared.sqrt());
            let spacing = spacing_of(found.len() - 1, farthest).min(SPARSE * options.sigma);
            Some((normal(&points[p], p, &positions, &near, found, options, outline), spacing))
        };
        let known: Vec<Option<(DVec3, f64)>> = parallel::map_with(0..points.len(), Vec::new, look);
        let mut part = Part { options, samples: Vec::new(), numbers: Vec::new(), spacings: Vec::new(), near };
        for (point, (normal, spacing)) in points.iter().zip(&known).filter_map(|(p, known)| Some((p, (*known)?))) {
            let triangle = part.samples.len() as u32;
            part.samples.push(Sample { position: point.position, normal, triangle, size: 1.0 });
            part.numbers.push(point.number);
            part.spacings.push(spacing);
        }
        if part.samples.len() < points.len() {
            let left: Vec<DVec3> = part.samples.iter().map(|s| s.position).collect();
            part.near = Neighbors::new(&left);
        }
        part
    }

    fn place(&self, i: u32) -> IVec3 {
        place_of(self.samples[i as usize].position, self.options.block())
    }

    /// What became of point `i`.
    fn point(&self, i: u32, sample: &Sample) -> TilePoint {
        TilePoint { number: self.numbers[i as usize], position: sample.position, normal: sample.normal }
    }

    /// What the scan keeps in the blocks of `scanned`, in the order of the points.
    fn scan(&self, scanned: BlockBox, monitor: &dyn Monitor) -> Result<Vec<u32>> {
        let heard = (0..self.samples.len() as u32).filter(|&i| scanned.hears(self.place(i))).collect();
        let candidates = Candidates { part: self, heard };
        let kernel = Kernel { sigma: self.options.sigma, lift: Lift::NONE };
        let kept = scan_lifted::<3>(&candidates, &[], kernel, self.options.seed, monitor)?;
        let mut kept: Vec<u32> = kept.into_iter().map(|k| candidates.heard[k as usize]).collect();
        kept.retain(|&i| scanned.contains(self.place(i)));
        kept.sort_unstable();
        Ok(kept)
    }
}

/// The unit normal of a point, whose nearest neighbours, itself first, are `found`.
fn normal(
    point: &TilePoint,
    p: usize,
    positions: &[DVec3],
    near: &Neighbors,
    found: &[Neighbor],
    options: &TileOptions,
    outline: &Outline,
) -> DVec3 {
    let given = point.normal.normalize_or_zero();
    if given != DVec3::ZERO {
        return if options.is_sided { given } else { outline.sided(point.position, given) };
    }
    let others = |found: &[Neighbor], count: usize| -> Vec<u32> {
        found.iter().map(|n| n.point).filter(|&n| n as usize != p).take(count).collect()
    };
    let (mut normal, mut is_line) = plane_normal(positions, p as u32, &others(found, FEW_NEIGHBORS));
    let mut count = FEW_NEIGHBORS;
    let mut more = Vec::new();
    while is_line && count < MOST_ON_LINE * FEW_NEIGHBORS {
        count *= 2;
        near.collect_nearest_within(positions[p], count + 1, NEIGHBORHOOD * options.sigma, &mut more);
        (normal, is_line) = plane_normal(positions, p as u32, &others(&more, count));
    }
    outline.sided(point.position, normal)
}

/// The points that a scan looks at.
struct Candidates<'a> {
    part: &'a Part<'a>,
    heard: Vec<u32>,
}

impl Choices for Candidates<'_> {
    fn count(&self) -> usize {
        self.heard.len()
    }

    #[inline]
    fn sample(&self, number: u32) -> Sample {
        self.part.samples[self.heard[number as usize] as usize]
    }

    #[inline]
    fn address(&self, number: u32) -> Address {
        (self.part.numbers[self.heard[number as usize] as usize], 0)
    }

    #[inline]
    fn patch_of(&self, _: &Sample) -> u32 {
        0
    }

    fn largest_size(&self) -> f64 {
        1.0
    }

    fn cell(&self, sigma: f64) -> f64 {
        debug_assert!(self.part.options.cell >= sigma * RADIUS / 2.0);
        self.part.options.cell
    }
}
