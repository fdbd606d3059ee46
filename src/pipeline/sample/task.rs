//! Scan and ascent with given kernel features, on a surface, a cloud or given points.

use crate::base::error::{Result, Setting};
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::base::rng::{Stage, units_at};
use crate::mesh::attributes::Attributes;
use crate::mesh::points::Points;
use crate::pipeline::cloud::Prepared;
use crate::pipeline::density::check_count;
use crate::pipeline::kernel::{KernelFeatures, with_dimensions};
use crate::pipeline::sample::bandwidth::find_bandwidth;
use crate::pipeline::sample::options::SampleOptions;
use crate::pipeline::sample::progressive::{progressive_order, sample_levels};
use crate::pipeline::sample::sampled::{Sampled, count_notes};
use crate::pipeline::scale::{SIGMA_OF_SPACING, Scale};
use crate::pipeline::unit::Unit;
use crate::spectral::ascent::{ASCENT_SIGMA, AscentParameters, PAPER_STEP};
use crate::spectral::candidates::Candidate;
use crate::spectral::free_ascent::ascend_freely;
use crate::spectral::scan::{Choices, Given, Kernel, OnDomain, scan_lifted};
use crate::spectral::subset::thin_or_fill;
use crate::surface::domain::{Domain, Sample};
use crate::surface::implicit::Rimls;
use crate::surface::lift::{Lifted, Surface, bare_samples};
use crate::surface::submanifold::Submanifold;
use glam::DVec3;
use std::f64::consts::TAU;

/// Ratio of the kernel width of the ascent to that of the scan.
pub(in crate::pipeline) const ASCENT_OF_SCAN: f64 = ASCENT_SIGMA / SIGMA_OF_SPACING;

/// Sampling parameters that do not depend on what is sampled.
pub(in crate::pipeline) struct Task<'a> {
    pub features: &'a KernelFeatures<'a>,
    pub first_sigma: f64,
    pub wanted: Option<usize>,
    pub options: &'a SampleOptions,
    pub monitor: &'a dyn Monitor,
}

impl Task<'_> {
    /// Returns the result for the points of the input at `positions` that the scan keeps of `given`; `numbers` maps these to
    /// points of the input, if not all were given.
    pub(in crate::pipeline) fn subset<S: Surface>(
        &self,
        surface: &S,
        given: &Given,
        positions: &[DVec3],
        numbers: Option<&[u32]>,
        unit: &Unit,
    ) -> Result<Sampled> {
        let (sigma, kept) = with_dimensions!(self.features, D => self.subset_of::<S, D>(surface, given))?;
        let indices: Vec<u32> = kept.iter().map(|&i| numbers.map_or(i, |numbers| numbers[i as usize])).collect();
        let pairs = indices.iter().zip(&kept).map(|(&i, &k)| (positions[i as usize], given.samples[k as usize].normal));
        Ok(self.sampled(Points::from_pairs(pairs), Some(indices), given.samples.len(), unit.size * sigma))
    }

    /// Returns the points of `given` that the scan keeps: in progressive order if levels are requested, otherwise in their
    /// original order.
    fn subset_of<S: Surface, const D: usize>(&self, surface: &S, given: &Given) -> Result<(f64, Vec<u32>)> {
        let (sigma, mut kept) = self.kept_of::<S, D>(surface, given)?;
        kept.sort_unstable();
        Ok((sigma, self.in_order::<S, D, _>(surface, kept, |&i| given.samples[i as usize], sigma)?))
    }

    /// Returns `items`, each of which stands for a sample, in progressive order if levels are requested, otherwise unchanged.
    fn in_order<S: Surface, const D: usize, T: Copy>(
        &self,
        surface: &S,
        items: Vec<T>,
        sample: impl Fn(&T) -> Sample,
        sigma: f64,
    ) -> Result<Vec<T>> {
        if self.options.levels.is_none() {
            return Ok(items);
        }
        let samples: Vec<Sample> = items.iter().map(sample).collect();
        let order = progressive_order::<S, D>(surface, self.features, &samples, sigma, self.monitor)?;
        Ok(order.into_iter().map(|i| items[i as usize]).collect())
    }

    /// Assembles the result from the samples and the number of examined candidates; `sigma_p` is in the units of the input.
    pub(in crate::pipeline) fn sampled(
        &self,
        points: Points,
        indices: Option<Vec<u32>>,
        candidates: usize,
        sigma_p: f64,
    ) -> Sampled {
        let levels = self.options.levels.map_or(Vec::new(), |wanted| sample_levels(points.positions(), wanted));
        let mut notes = count_notes(points.positions().len(), candidates, self.wanted);
        notes.extend(self.options.levels.filter(|&wanted| levels.len() < wanted).map(|wanted| {
            format!("{} levels instead of {wanted}: a coarser one would have fewer than three points", levels.len())
        }));
        Sampled {
            points,
            indices,
            origins: Vec::new(),
            carried: Attributes::default(),
            candidates,
            sigma_p,
            wanted: self.wanted,
            levels,
            cloud: None,
            notes,
        }
    }

    fn kept_of<S: Surface, const D: usize>(&self, surface: &S, given: &Given) -> Result<(f64, Vec<u32>)> {
        let (sigma, kept) =
            self.search(given.count(), |kernel| scan_lifted::<D>(given, &[], kernel, self.options.seed, self.monitor))?;
        let Some(wanted) = self.wanted else { return Ok((sigma, kept)) };
        let kept = self.features.with_kernel(sigma, |kernel| {
            thin_or_fill::<_, D>(&Lifted { surface, lift: kernel.lift }, given.samples, &kept, sigma, wanted)
        });
        Ok((sigma, kept))
    }

    /// Samples `domain` by scan and ascent.
    pub(in crate::pipeline) fn on_surface<const D: usize>(
        &self,
        domain: &Domain,
        candidates: &[Candidate],
    ) -> Result<(f64, Vec<Sample>)> {
        let choices = OnDomain { domain, candidates };
        let (sigma, samples) = self.search(candidates.len(), |kernel| {
            scan_lifted::<D>(&choices, &[], kernel, self.options.seed, self.monitor)
        })?;
        let samples = samples.into_iter().map(|i| choices.sample(i)).collect();
        self.features.with_kernel(sigma, |kernel| {
            let surface = Lifted { surface: domain, lift: kernel.lift };
            let mut samples = match self.wanted {
                Some(wanted) => exactly::<_, D>(&surface, domain, candidates, samples, sigma, wanted),
                None => samples,
            };
            self.ascend::<_, D>(domain, kernel, &mut samples)?;
            Ok((sigma, self.in_order::<_, D, _>(domain, samples, |s| *s, sigma)?))
        })
    }

    /// Samples the surface of a cloud by scan and ascent.
    pub(in crate::pipeline) fn on_cloud(&self, cloud: &Prepared, unit: &Unit) -> Result<Sampled> {
        let support = cloud.support();
        let surface =
            Rimls::new(cloud.points.positions(), cloud.points.normals(), &cloud.near, &cloud.spacings, support);
        let expected = self.wanted.unwrap_or_else(|| Scale::count_of_sigma(self.first_sigma, cloud.area()));
        check_count(Setting::SigmaP, expected, format!("this width would give {expected} samples"))?;
        let choices = choices_on(&surface, cloud, expected, self.options.seed);
        check(self.monitor)?;
        let (sigma, samples) = with_dimensions!(self.features, D => self.ascended::<D>(&surface, &choices))?;
        let points = Points::from_pairs(samples.iter().map(|s| (unit.outwards_point(s.position), s.normal)));
        Ok(self.sampled(points, None, choices.len(), unit.size * sigma))
    }

    /// Returns those of `choices` that the scan keeps, after ascent on `surface`.
    fn ascended<const D: usize>(&self, surface: &Rimls, choices: &[Sample]) -> Result<(f64, Vec<Sample>)> {
        let (sigma, mut kept) = self.kept_of::<_, D>(surface, &Given { samples: choices, domain: None })?;
        // In the order of the points, samples close in space are close in memory.
        kept.sort_unstable();
        let mut samples: Vec<Sample> = kept.into_iter().map(|i| choices[i as usize]).collect();
        self.features.with_kernel(sigma, |kernel| self.ascend::<_, D>(surface, kernel, &mut samples))?;
        let samples: Vec<Sample> = parallel::map(&samples[..], |s| surface.sample(s.position).unwrap_or(*s));
        Ok((sigma, self.in_order::<_, D, _>(surface, samples, |s| *s, sigma)?))
    }

    fn ascend<S: Surface, const D: usize>(&self, surface: &S, kernel: Kernel, samples: &mut [Sample]) -> Result<()> {
        self.monitor.stage("ascend");
        let ascent =
            AscentParameters { sigma: ASCENT_OF_SCAN * kernel.sigma, step: PAPER_STEP, sweeps: self.options.sweeps };
        ascend_freely::<_, D>(&Lifted { surface, lift: kernel.lift }, samples, ascent, self.monitor)
    }

    /// Returns the kernel width with which a scan of `most` candidates keeps about the wanted number, and the points that it
    /// keeps; if no number is wanted, uses the first width.
    fn search<T>(&self, most: usize, mut scan: impl FnMut(Kernel) -> Result<Vec<T>>) -> Result<(f64, Vec<T>)> {
        let mut scan = |sigma: f64| self.features.with_kernel(sigma, &mut scan);
        let Some(wanted) = self.wanted else { return Ok((self.first_sigma, scan(self.first_sigma)?)) };
        find_bandwidth(self.first_sigma, wanted.min(most), &mut scan)
    }
}

/// Number of candidates considered for each missing sample.
const SPARE_PER_MISSING: usize = 256;

/// Returns exactly `wanted` samples by removing some or adding other candidates.
fn exactly<S: Submanifold<D, Point = Sample>, const D: usize>(
    surface: &S,
    domain: &Domain,
    candidates: &[Candidate],
    mut samples: Vec<Sample>,
    sigma: f64,
    wanted: usize,
) -> Vec<Sample> {
    let chosen: Vec<u32> = (0..samples.len() as u32).collect();
    if samples.len() < wanted {
        let spare = SPARE_PER_MISSING * (wanted - samples.len());
        samples.extend(candidates.iter().step_by((candidates.len() / spare).max(1)).map(|c| c.sample(domain)));
    }
    let kept = thin_or_fill::<S, D>(surface, &samples, &chosen, sigma, wanted);
    kept.into_iter().map(|i| samples[i as usize]).collect()
}

/// Number of points to choose from per wanted sample on a cloud. If the cloud has fewer, more are placed between its points,
/// in a disk of this radius, in spacings, around each point.
const CHOICES_PER_POINT: usize = 4;
const DISK: f64 = 0.6;

/// Number of points per wanted sample that is enough to choose from.
const FEWER_CHOICES: usize = 3;

/// Returns the candidates for `wanted` samples of a cloud: its points as they are if there are enough, since the chosen ones
/// are projected onto the surface later; otherwise points on its surface, with more between them.
fn choices_on(surface: &Rimls, cloud: &Prepared, wanted: usize, seed: u64) -> Vec<Sample> {
    let (positions, normals) = (cloud.points.positions(), cloud.points.normals());
    let each = (CHOICES_PER_POINT * wanted).div_ceil(positions.len()).max(1);
    if FEWER_CHOICES * wanted <= positions.len() {
        return bare_samples(&cloud.points);
    }
    let place = |p: usize, k: u64| {
        let [turn, share] = units_at(seed, Stage::Candidates, (p as u32, k));
        let (sin, cos) = math::sin_cos(TAU * turn);
        let (across, along) = normals[p].any_orthonormal_pair();
        positions[p] + DISK * cloud.spacings[p] * share.sqrt() * (cos * across + sin * along)
    };
    let between = (1..each as u64).flat_map(|k| (0..positions.len()).map(move |p| (p, k)));
    let places: Vec<DVec3> = positions.iter().copied().chain(between.map(|(p, k)| place(p, k))).collect();
    parallel::collect(&places[..], |block| block.iter().filter_map(|&place| surface.sample(place)))
}
