//! Samples of a part of a cloud, identical to those of a run over all of it.
//!
//! All computations are local and have a bounded reach in kernel widths: neighbours beyond it do not count, and a point with
//! too few neighbours within it is an outlier. The scan proceeds block by block, and a box depends on a known number of
//! blocks around it (see [`lattice`](crate::spectral::lattice)); the ascent moves all samples at once. Global information
//! comes from the [`Outline`].
//!
//! Departures from sampling a whole cloud: normals are those of planes, the spacing of points is limited where they are
//! sparse, and the number of samples meets the wanted one only approximately.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::base::parallel;
use crate::base::rng::Address;
use crate::pipeline::cloud::options::{FEW_NEIGHBORS, INTERPOLATING_SUPPORT};
use crate::pipeline::pieces::outline::Outline;
use crate::pipeline::sample::task::ASCENT_OF_SCAN;
use crate::prepare::cloud_normals::plane_normal;
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

/// Radius of a neighbourhood, in kernel widths; a point with fewer than [`FEW_NEIGHBORS`] neighbours in it is an outlier.
const NEIGHBORHOOD: f64 = 5.0;

/// Upper limit for the local spacing of points, in kernel widths, so that no point reaches far on the surface.
const SPARSE: f64 = 2.0;

/// Number of blocks around the samples of a tile whose points contribute to its surface or to their normals.
const MARGIN: i32 = 2;

/// Step of the ascent: all samples move at once, so two that approach each other move twice as far as one.
const STEP: f64 = 0.45;

/// Options of sampling that are the same for all tiles of a cloud.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TileOptions {
    /// Width of the kernel, in the units of the cloud.
    pub sigma: f64,
    /// Width of a cell, at least half of the reach of the kernel.
    pub cell: f64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Sweeps of gradient ascent; `None` if samples are points of the cloud, as the scan leaves them.
    pub sweeps: Option<usize>,
    /// Support radius of smoothing, in spacings of the points; `None` if nothing is smoothed.
    pub smooth: Option<f64>,
    /// Whether given normals are on a common side.
    pub is_sided: bool,
    /// Whether the surface has sharp edges.
    pub is_sharp: bool,
}

/// Point of a cloud.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TilePoint {
    /// Number in the cloud.
    pub number: u32,
    /// Position of the point.
    pub position: DVec3,
    /// Normal, of any length; zero if it is not known.
    pub normal: DVec3,
}

impl TileOptions {
    /// Width of a block, in the units of the cloud.
    pub fn block(&self) -> f64 {
        self.cell * f64::from(BLOCK)
    }

    /// Support radius of points on the surface, in their spacings.
    fn support(&self) -> f64 {
        self.smooth.unwrap_or(INTERPOLATING_SUPPORT)
    }

    /// Number of blocks around a tile whose samples influence its own while they move.
    fn ascent_halo(&self) -> IVec3 {
        let sweeps = self.sweeps.unwrap_or(0);
        IVec3::splat((reach_of(sweeps) * ASCENT_OF_SCAN * self.sigma / self.block()).ceil() as i32)
    }

    /// Blocks whose points are needed for the samples of `tile`.
    pub fn needed(&self, tile: BlockBox) -> BlockBox {
        let scanned = tile.grown(self.ascent_halo());
        let around = scanned.grown(IVec3::splat(MARGIN));
        let heard = scanned.heard().grown(IVec3::ONE);
        BlockBox { lo: around.lo.min(heard.lo), hi: around.hi.max(heard.hi) }
    }
}

/// Returns the samples in the blocks of `tile`, each with the number of the point from which it started. `points` are those
/// of the [`TileOptions::needed`] blocks, in a relative order that is the same in all tiles.
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
    let cloud = LocalCloud::new(points, options, outline);
    let scanned = tile.grown(options.ascent_halo());
    let kept = cloud.scan(scanned, monitor)?;
    let is_own = |&i: &u32| tile.contains(cloud.place(i));
    let Some(sweeps) = options.sweeps else {
        return Ok(kept.into_iter().filter(is_own).map(|i| cloud.point(i, &cloud.sample(i))).collect());
    };
    let mut samples: Vec<Sample> = kept.iter().map(|&i| cloud.sample(i)).collect();
    let surface = cloud.surface();
    let ascent = AscentParameters { sigma: ASCENT_OF_SCAN * options.sigma, step: STEP, sweeps };
    ascend_at_once::<_, 3>(&Lifted { surface: &surface, lift: Lift::NONE }, &mut samples, ascent, monitor)?;
    let own: Vec<(u32, Sample)> = kept.into_iter().zip(samples).filter(|(i, _)| is_own(i)).collect();
    let projected = |&(i, sample): &(u32, Sample)| cloud.point(i, &surface.sample(sample.position).unwrap_or(sample));
    Ok(parallel::map(&own[..], projected))
}

/// Returns the approximate number of samples that the scan keeps in the blocks of `tile`: the influence of points that are
/// not given is ignored.
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
    let cloud = LocalCloud::new(points, options, outline);
    let kept = cloud.scan(tile, monitor)?;
    Ok(kept.into_iter().filter(|&i| tile.contains(cloud.place(i))).count())
}

/// Points of a part of a cloud, without outliers, with neighbour information.
pub(in crate::pipeline) struct LocalCloud<'a> {
    options: &'a TileOptions,
    numbers: Vec<u32>,
    pub positions: Vec<DVec3>,
    /// Unit normals.
    pub normals: Vec<DVec3>,
    spacings: Vec<f64>,
    pub near: Neighbors,
}

impl<'a> LocalCloud<'a> {
    pub fn new(points: Vec<TilePoint>, options: &'a TileOptions, outline: &Outline) -> LocalCloud<'a> {
        let positions: Vec<DVec3> = points.iter().map(|p| p.position).collect();
        let near = Neighbors::new(&positions);
        let look = |found: &mut Vec<Neighbor>, p: usize| {
            near.collect_nearest_within(positions[p], DEGREE + 1, NEIGHBORHOOD * options.sigma, found);
            if found.len() <= FEW_NEIGHBORS {
                return None;
            }
            let farthest = found.last().map_or(0.0, |n| n.distance_squared.sqrt());
            let spacing = spacing_of(found.len() - 1, farthest).min(SPARSE * options.sigma);
            Some((normal(&points[p], p as u32, &positions, &near, found, options, outline), spacing))
        };
        let known: Vec<Option<(DVec3, f64)>> = parallel::map_with(0..points.len(), Vec::new, look);
        let kept = || points.iter().zip(&known).filter_map(|(point, known)| Some((point, (*known)?)));
        let (normals, spacings): (Vec<DVec3>, Vec<f64>) = kept().map(|(_, known)| known).unzip();
        let numbers = kept().map(|(point, _)| point.number).collect();
        let left: Vec<DVec3> = kept().map(|(point, _)| point.position).collect();
        let near = if left.len() < points.len() { Neighbors::new(&left) } else { near };
        LocalCloud { options, numbers, positions: left, normals, spacings, near }
    }

    /// Returns the implicit surface of the points.
    pub fn surface(&self) -> Rimls<'_> {
        Rimls::new(&self.positions, &self.normals, &self.near, &self.spacings, self.options.support())
    }

    /// Returns point `i` as a sample, whose triangle is `i`.
    fn sample(&self, i: u32) -> Sample {
        Sample { position: self.positions[i as usize], normal: self.normals[i as usize], triangle: i, size: 1.0 }
    }

    fn place(&self, i: u32) -> IVec3 {
        place_of(self.positions[i as usize], self.options.block())
    }

    /// Returns point `i` at the position and normal of `sample`.
    fn point(&self, i: u32, sample: &Sample) -> TilePoint {
        TilePoint { number: self.numbers[i as usize], position: sample.position, normal: sample.normal }
    }

    /// Returns the points that the scan keeps in the blocks of `scanned`, in their original order.
    fn scan(&self, scanned: BlockBox, monitor: &dyn Monitor) -> Result<Vec<u32>> {
        let heard = (0..self.positions.len() as u32).filter(|&i| scanned.hears(self.place(i))).collect();
        let candidates = Candidates { cloud: self, heard };
        let kernel = Kernel { sigma: self.options.sigma, lift: Lift::NONE };
        let kept = scan_lifted::<3>(&candidates, &[], kernel, self.options.seed, monitor)?;
        let mut kept: Vec<u32> = kept.into_iter().map(|k| candidates.heard[k as usize]).collect();
        kept.retain(|&i| scanned.contains(self.place(i)));
        kept.sort_unstable();
        Ok(kept)
    }
}

/// Returns the unit normal of a point, number `p` of all, whose nearest neighbours, itself first, are `found`.
fn normal(
    point: &TilePoint,
    p: u32,
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
    let nearest: Vec<u32> = found.iter().map(|n| n.point).filter(|&n| n != p).take(FEW_NEIGHBORS).collect();
    let more = |count: usize, found: &mut Vec<Neighbor>| {
        near.collect_nearest_within(point.position, count, NEIGHBORHOOD * options.sigma, found);
    };
    outline.sided(point.position, plane_normal(positions, p, &nearest, more))
}

/// Points that a scan considers.
struct Candidates<'a> {
    cloud: &'a LocalCloud<'a>,
    heard: Vec<u32>,
}

impl Choices for Candidates<'_> {
    fn count(&self) -> usize {
        self.heard.len()
    }

    #[inline]
    fn sample(&self, number: u32) -> Sample {
        self.cloud.sample(self.heard[number as usize])
    }

    #[inline]
    fn address(&self, number: u32) -> Address {
        (self.cloud.numbers[self.heard[number as usize] as usize], 0)
    }

    #[inline]
    fn patch_of(&self, _: &Sample) -> u32 {
        0
    }

    fn largest_size(&self) -> f64 {
        1.0
    }

    fn cell(&self, sigma: f64) -> f64 {
        debug_assert!(self.cloud.options.cell >= sigma * RADIUS / 2.0);
        self.cloud.options.cell
    }
}
