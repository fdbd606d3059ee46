//! Sampling without triangles: blue noise on a surface by scan and ascent, or a subset of given points by the scan alone.
//!
//! A search finds the kernel width that gives about the wanted count. Then missing samples are added where s is largest, and
//! surplus ones removed where it is smallest.

use crate::base::count::counted;
use crate::base::error::{Error, Fault, Result, Setting};
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::base::rng::{Stage, units_at};
use crate::geom::aabb::Aabb;
use crate::pipeline::bandwidth::find_bandwidth;
use crate::pipeline::cloud::{CloudOptions, CloudSummary, INTERPOLATING_SUPPORT, Prepared, prepared};
use crate::pipeline::density::{SampleDensity, check_count, check_length};
use crate::pipeline::kernel::{KernelFeatures, Signal, check_kernel, check_signals};
use crate::pipeline::prepared::{refuse_bad_numbers, refuse_bad_positions};
use crate::pipeline::progressive::{SampleLevel, progressive_order, sample_levels};
use crate::pipeline::scale::{
    CANDIDATES_PER_POINT, LONGEST_EDGE, SIGMA_OF_SPACING, SMALLEST_SPACING, Scale, refuse_no_area,
};
use crate::pipeline::unit::Unit;
use crate::surface::implicit::Rimls;

use crate::mesh::attributes::{Attribute, Attributes, Lost, NORMAL, Scalar};
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::points::Points;
use crate::mesh::provenance::PointOnTriangle;
use crate::mesh::refine::refine;
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::repair::repair;
use crate::spectral::ascent::{AscentParameters, PAPER_STEP, SIGMA_OF_SPACING as ASCENT_SIGMA};
use crate::spectral::candidates::{Candidate, candidates};
use crate::spectral::free_ascent::ascend_freely;
use crate::spectral::scan::{Choices, Given, Kernel, OnDomain, scan_lifted};
use crate::spectral::subset::thin_or_fill;
use crate::surface::domain::{Domain, Sample};
use crate::surface::lift::{BarePoints, Lifted, MOST_SIGNALS, Surface};
use crate::surface::submanifold::Submanifold;
use glam::DVec3;
use std::f64::consts::TAU;

/// Options of sampling.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleOptions {
    /// Density of the samples. An edge length means the number of samples that have it at hexagonal packing on the input's
    /// area; with [`Self::scan_only`] it means the kernel width that would result in it. Default: 10,000 points.
    pub density: SampleDensity,
    /// Kernel width σn along unit normals: samples gather where the surface turns by more than this within a spacing.
    /// Default: infinite, samples are even.
    pub sigma_n: f64,
    /// Properties of the input that samples follow. Default: none.
    pub signals: Vec<Signal>,
    /// Whether the samples are a subset of the input's points, as the scan leaves them. Default: false.
    pub scan_only: bool,
    /// Number of levels. If given, samples are in progressive order, such that every first part of them is a good sampling
    /// of the whole, too, and each level has a quarter of the samples of the next one. Default: none, no such order.
    pub levels: Option<usize>,
    /// Seed of all random numbers. Default: 0.
    pub seed: u64,
    /// Sweeps of gradient ascent. Default: 10, as in the paper (section 6.3).
    pub sweeps: usize,
    /// How to treat a cloud: its normals, and the support radius of the implicit surface on which samples move, which is
    /// [`INTERPOLATING_SUPPORT`] if nothing is smoothed. Options on holes have no effect.
    pub cloud: CloudOptions,
}

impl Default for SampleOptions {
    fn default() -> Self {
        SampleOptions {
            density: SampleDensity::Points(10_000),
            sigma_n: f64::INFINITY,
            signals: Vec::new(),
            scan_only: false,
            levels: None,
            seed: 0,
            sweeps: 10,
            cloud: CloudOptions::default(),
        }
    }
}

impl SampleOptions {
    /// Refuses options that suit no input.
    ///
    /// # Errors
    /// [`Error::Option`] for a number of samples out of range, or a length or a width that is not positive.
    pub fn validate(&self) -> Result<()> {
        check_kernel(self.sigma_n, &self.signals)?;
        self.cloud.validate()?;
        if self.levels == Some(0) {
            let (cause, remedy) = ("there is at least one".into(), "give 1 or more".into());
            return Err(Error::Option { option: Setting::Levels, cause, remedy });
        }
        match self.density {
            SampleDensity::Points(n) => check_count(Setting::Points, n, format!("{n} samples are asked for")),
            SampleDensity::EdgeLength(l) => check_length(Setting::EdgeLength, l),
            SampleDensity::SigmaP(s) => check_length(Setting::SigmaP, s),
        }
    }
}

/// Samples and information about them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// Samples in the coordinates of the input, with unit normals if the input has some.
    pub points: Points,
    /// With [`SampleOptions::scan_only`], the number of each sample among the input's points.
    pub indices: Option<Vec<u32>>,
    /// Positions on the triangles of the input; empty if it has none, and with [`SampleOptions::scan_only`].
    pub origins: Vec<PointOnTriangle>,
    /// Attributes other than positions and normals; empty until they are set by [`carrying`](Self::carrying).
    pub carried: Attributes,
    /// Number of points of the input, or of candidates on its surface, that were examined.
    pub candidates: usize,
    /// Kernel width used, in the units of the input.
    pub sigma_p: f64,
    /// Wanted number of samples; `None` if the kernel width determined it.
    pub wanted: Option<usize>,
    /// Levels, from coarse to fine: each consists of that many of the first samples. Empty if none were requested.
    pub levels: Vec<SampleLevel>,
    /// Summary of how the points of a cloud were used as a surface; `None` for a mesh.
    pub cloud: Option<CloudSummary>,
    /// Notes for the user, one sentence each.
    pub notes: Vec<String>,
}

impl Sampled {
    /// Returns the attributes of the samples other than positions and normals: their numbers in the input, as `index`, if
    /// they are points of it, and the attributes that were carried over.
    pub fn attributes(&self) -> Attributes {
        let attribute = |indices: &Vec<u32>| Attribute {
            name: INDEX.into(),
            components: 1,
            values: indices.iter().map(|&i| f64::from(i)).collect(),
            scalar: Scalar::U32,
        };
        let carried = self.carried.vertex.iter().cloned();
        Attributes { vertex: self.indices.iter().map(attribute).chain(carried).collect(), ..Attributes::default() }
    }

    /// Removes some attributes, and notes which.
    #[must_use]
    pub fn without(mut self, lost: Vec<Lost>) -> Sampled {
        for Lost { name, cause } in lost {
            self.carried.remove(&name);
            self.notes.push(format!("attribute {name} is left out: {cause}"));
        }
        self
    }

    /// Adds attributes at the same positions, except normals and numbers, of which the samples have their own.
    #[must_use]
    pub fn carrying(self, mut attributes: Attributes) -> Sampled {
        [NORMAL, INDEX].iter().for_each(|name| attributes.remove(name));
        Sampled { carried: Attributes { vertex: attributes.vertex, ..Attributes::default() }, ..self }
    }
}

/// Name of the attribute with the number of a sample among the input's points.
const INDEX: &str = "index";

/// Ratio of the kernel width of the ascent to that of the scan.
pub(super) const ASCENT_OF_SCAN: f64 = ASCENT_SIGMA / SIGMA_OF_SPACING;

/// Factor of the number of candidates if more than the position counts, because samples are then unevenly dense.
const MORE_CANDIDATES: usize = 3;

/// Samples the surface of `input` or, with [`SampleOptions::scan_only`], its vertices.
///
/// # Errors
/// [`Error::Mesh`] for an input without triangles or without area, or with bad numbers; [`Error::Option`] for options
/// out of range; [`Error::Cancelled`] if the monitor asks for it.
pub fn sample(input: &Mesh, options: &SampleOptions, monitor: &dyn Monitor) -> Result<Sampled> {
    options.validate()?;
    monitor.stage("repair");
    refuse_bad_numbers(input)?;
    check_signals(&options.signals, input.positions.len())?;
    let unit = Unit::of(input);
    let (clean, _) = repair(&unit.inwards(input));
    refuse_no_area(&clean, &unit)?;
    check(monitor)?;
    if options.scan_only {
        sample_vertices(input, clean, &unit, options, monitor)
    } else {
        sample_surface(input, clean, &unit, options, monitor)
    }
}

/// Samples the surface `clean`, which is `input` repaired and in `unit`.
fn sample_surface(
    input: &Mesh,
    mut clean: OrientedManifold,
    unit: &Unit,
    options: &SampleOptions,
    monitor: &dyn Monitor,
) -> Result<Sampled> {
    let scale = Scale::new(options.density.into(), None, &clean, unit)?;
    monitor.stage("sample");
    let most = 4 * clean.triangles.len() + 16 * scale.wanted;
    refine(&mut clean, LONGEST_EDGE * scale.spacing, most);
    let domain = Domain::new(clean);
    let features = KernelFeatures::over(&domain, options.sigma_n, &options.signals);
    let wanted = (!matches!(options.density, SampleDensity::SigmaP(_))).then_some(scale.wanted);
    let task = Task { features: &features, first_sigma: scale.sigma(), wanted, options, monitor };
    let candidates = candidates_for(&domain, &features, scale.wanted, options.seed);
    let (sigma, samples) = match features.dimensions() {
        3 => task.on_surface::<3>(&domain, &candidates),
        6 => task.on_surface::<6>(&domain, &candidates),
        _ => task.on_surface::<MOST_DIMENSIONS>(&domain, &candidates),
    }?;
    let points = Points::from_pairs(samples.iter().map(|s| (unit.outwards_point(s.position), s.normal)));
    let origins = parallel::map(&samples[..], |sample| domain.origin(sample, 0.0, &input.triangles));
    Ok(Sampled { origins, ..task.sampled(points, None, candidates.len(), unit.size * sigma) })
}

/// Chooses a subset of the vertices of `input`, which lie on the surface `clean`.
fn sample_vertices(
    input: &Mesh,
    clean: OrientedManifold,
    unit: &Unit,
    options: &SampleOptions,
    monitor: &dyn Monitor,
) -> Result<Sampled> {
    monitor.stage("sample");
    let area = clean.area();
    let domain = Domain::new(clean);
    let features = KernelFeatures::over(&domain, options.sigma_n, &options.signals);
    let (vertices, numbers) = used_vertices(input, unit, &domain);
    let (first_sigma, wanted) = first_sigma(options.density, area, unit);
    let task = Task { features: &features, first_sigma, wanted, options, monitor };
    task.subset(&domain, &Given { samples: &vertices, domain: Some(&domain) }, &input.positions, Some(&numbers), unit)
}

/// Samples the implicit surface of the points `input` or, with [`SampleOptions::scan_only`], the points themselves. These
/// need not form a surface if normals do not count.
///
/// # Errors
/// [`Error::Mesh`] for an input without points, with bad numbers, or that no surface goes through; [`Error::Option`] for
/// options out of range; [`Error::Cancelled`] if the monitor asks for it.
pub fn sample_points(input: &Points, options: &SampleOptions, monitor: &dyn Monitor) -> Result<Sampled> {
    options.validate()?;
    check_signals(&options.signals, input.positions().len())?;
    refuse_bad_points(input.positions())?;
    let unit = Unit::of_points(input.positions());
    let positions = input.positions().iter().map(|&p| unit.inwards_point(p)).collect();
    let inwards = Points::new(positions, input.normals().to_vec())?;
    let needs_normals = options.sigma_n.is_finite() && input.normals().is_empty();
    let cloud = match prepared(&inwards, &options.cloud.within_unit(unit.size), monitor) {
        Err(Error::Mesh { .. }) if options.scan_only && !needs_normals => {
            monitor.stage("sample");
            return sample_bare_points(input, &unit, options, monitor);
        }
        cloud => cloud?,
    };
    monitor.stage("sample");
    let signals: Vec<Signal> = options.signals.iter().map(|signal| signal.of(&cloud.source)).collect();
    let features = KernelFeatures::of_points(options.sigma_n, &signals);
    let (first_sigma, wanted) = first_sigma(options.density, cloud.area(), &unit);
    let task = Task { features: &features, first_sigma, wanted, options, monitor };
    let sampled = if options.scan_only {
        let given = bare_samples(&cloud.points);
        task.subset(
            &BarePoints,
            &Given { samples: &given, domain: None },
            input.positions(),
            Some(&cloud.source),
            &unit,
        )?
    } else {
        task.on_cloud(&cloud, &unit)?
    };
    Ok(Sampled { cloud: Some(cloud.summary), ..sampled })
}

/// Chooses a subset of points that do not form a surface.
fn sample_bare_points(input: &Points, unit: &Unit, options: &SampleOptions, monitor: &dyn Monitor) -> Result<Sampled> {
    let positions = input.positions().iter().map(|&p| unit.inwards_point(p)).collect();
    let bare = bare_samples(&Points::new(positions, input.normals().to_vec())?);
    let (first_sigma, wanted) = first_sigma(options.density, area_of_box(&bare), unit);
    let features = KernelFeatures::of_points(options.sigma_n, &options.signals);
    let task = Task { features: &features, first_sigma, wanted, options, monitor };
    let given = Given { samples: &bare, domain: None };
    let mut sampled = task.subset(&BarePoints, &given, input.positions(), None, unit)?;
    if input.normals().is_empty() {
        sampled.points = sampled.points.with_normals(Vec::new());
    }
    Ok(sampled)
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

/// Number of dimensions of a kernel with signals.
pub(super) const MOST_DIMENSIONS: usize = 6 + MOST_SIGNALS;

/// Draws candidates on `domain` for `wanted` samples.
fn candidates_for(domain: &Domain, features: &KernelFeatures, wanted: usize, seed: u64) -> Vec<Candidate> {
    let more = if features.counts() { MORE_CANDIDATES } else { 1 };
    candidates(domain, more * CANDIDATES_PER_POINT * wanted, seed)
}

/// Returns the vertices of `input` that triangles use, as samples, and their numbers.
fn used_vertices(input: &Mesh, unit: &Unit, domain: &Domain) -> (Vec<Sample>, Vec<u32>) {
    let used = input.used_vertices();
    let numbers: Vec<u32> = (0..used.len() as u32).filter(|&v| used[v as usize]).collect();
    let at = |&v: &u32| {
        let position = unit.inwards_point(input.positions[v as usize]);
        Sample { position, ..domain.project_anywhere(position) }
    };
    (parallel::map(&numbers[..], at), numbers)
}

/// Returns the points as samples whose triangle is their number. Points without normals get a zero normal, for which all
/// points count as neighbours.
pub(super) fn bare_samples(input: &Points) -> Vec<Sample> {
    let sample = |(i, &position): (usize, &DVec3)| Sample {
        position,
        normal: input.normals().get(i).map_or(DVec3::ZERO, |n| n.normalize_or_zero()),
        triangle: i as u32,
        size: 1.0,
    };
    input.positions().iter().enumerate().map(sample).collect()
}

/// Returns half the area of the bounding box: roughly that of a surface of unknown area.
fn area_of_box(samples: &[Sample]) -> f64 {
    let size = Aabb::of(samples.iter().map(|s| s.position)).unwrap_or_default().size();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// Smallest area per sample with which a search for the width begins: points may lie on a line or all at one place.
const SMALLEST_AREA: f64 = 1e-12;

/// Returns the initial width for a subset of points of about the given area, and the wanted number of samples.
fn first_sigma(density: SampleDensity, area: f64, unit: &Unit) -> (f64, Option<usize>) {
    match density {
        SampleDensity::SigmaP(sigma) => ((sigma / unit.size).max(SMALLEST_SPACING), None),
        SampleDensity::EdgeLength(length) => (Scale::sigma_of_spacing(length / unit.size).max(SMALLEST_SPACING), None),
        SampleDensity::Points(n) => (Scale::of_points(n, area.max(SMALLEST_AREA * n as f64)).sigma(), Some(n)),
    }
}

/// Sampling parameters that do not depend on what is sampled.
struct Task<'a> {
    features: &'a KernelFeatures<'a>,
    first_sigma: f64,
    wanted: Option<usize>,
    options: &'a SampleOptions,
    monitor: &'a dyn Monitor,
}

impl Task<'_> {
    /// Returns the result for the points of the input at `positions` that the scan keeps of `given`; `numbers` maps these to
    /// points of the input, if not all were given.
    fn subset<S: Surface>(
        &self,
        surface: &S,
        given: &Given,
        positions: &[DVec3],
        numbers: Option<&[u32]>,
        unit: &Unit,
    ) -> Result<Sampled> {
        let (sigma, kept) = match self.features.dimensions() {
            3 => self.subset_of::<S, 3>(surface, given),
            6 => self.subset_of::<S, 6>(surface, given),
            _ => self.subset_of::<S, MOST_DIMENSIONS>(surface, given),
        }?;
        let indices: Vec<u32> = kept.iter().map(|&i| numbers.map_or(i, |numbers| numbers[i as usize])).collect();
        let pairs = indices.iter().zip(&kept).map(|(&i, &k)| (positions[i as usize], given.samples[k as usize].normal));
        Ok(self.sampled(Points::from_pairs(pairs), Some(indices), given.samples.len(), unit.size * sigma))
    }

    /// Returns the points of `given` that the scan keeps: in progressive order if levels are requested, otherwise in their
    /// original order.
    fn subset_of<S: Surface, const D: usize>(&self, surface: &S, given: &Given) -> Result<(f64, Vec<u32>)> {
        let (sigma, mut kept) = self.kept_of::<S, D>(surface, given)?;
        kept.sort_unstable();
        let samples: Vec<Sample> = kept.iter().map(|&i| given.samples[i as usize]).collect();
        let order = self.order::<S, D>(surface, &samples, sigma)?;
        Ok((sigma, order.map_or(kept.clone(), |order| order.into_iter().map(|i| kept[i as usize]).collect())))
    }

    /// Returns the progressive order of `samples`, if levels are requested.
    fn order<S: Surface, const D: usize>(
        &self,
        surface: &S,
        samples: &[Sample],
        sigma: f64,
    ) -> Result<Option<Vec<u32>>> {
        let order = || progressive_order::<S, D>(surface, self.features, samples, sigma, self.monitor);
        self.options.levels.map(|_| order()).transpose()
    }

    /// Returns the samples in progressive order if levels are requested, otherwise unchanged.
    fn in_order<S: Surface, const D: usize>(
        &self,
        surface: &S,
        samples: Vec<Sample>,
        sigma: f64,
    ) -> Result<Vec<Sample>> {
        let order = self.order::<S, D>(surface, &samples, sigma)?;
        Ok(order.map_or(samples.clone(), |order| order.into_iter().map(|i| samples[i as usize]).collect()))
    }

    /// Assembles the result from the samples and the number of examined candidates; `sigma_p` is in the units of the input.
    fn sampled(&self, points: Points, indices: Option<Vec<u32>>, candidates: usize, sigma_p: f64) -> Sampled {
        let levels = self.options.levels.map_or(Vec::new(), |wanted| sample_levels(points.positions(), wanted));
        let mut notes = count_notes(points.positions().len(), candidates, self.wanted);
        notes.extend(self.options.levels.filter(|&wanted| levels.len() < wanted).map(|wanted| {
            format!("{} levels instead of {wanted}: a coarser one would have less than three points", levels.len())
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
    fn on_surface<const D: usize>(&self, domain: &Domain, candidates: &[Candidate]) -> Result<(f64, Vec<Sample>)> {
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
            Ok((sigma, self.in_order::<_, D>(domain, samples, sigma)?))
        })
    }

    /// Samples the surface of a cloud by scan and ascent.
    fn on_cloud(&self, cloud: &Prepared, unit: &Unit) -> Result<Sampled> {
        let reach = cloud.smooth.unwrap_or(INTERPOLATING_SUPPORT);
        let surface = Rimls::new(cloud.points.positions(), cloud.points.normals(), &cloud.near, &cloud.spacings, reach);
        let expected = self.wanted.unwrap_or_else(|| Scale::count_of_sigma(self.first_sigma, cloud.area()));
        check_count(Setting::SigmaP, expected, format!("this width means {expected} samples"))?;
        let choices = choices_on(&surface, cloud, expected, self.options.seed);
        check(self.monitor)?;
        let (sigma, samples) = match self.features.dimensions() {
            3 => self.ascended::<3>(&surface, &choices),
            6 => self.ascended::<6>(&surface, &choices),
            _ => self.ascended::<MOST_DIMENSIONS>(&surface, &choices),
        }?;
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
        Ok((sigma, self.in_order::<_, D>(surface, samples, sigma)?))
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

/// Number of samples up to which they are only a handful.
const HANDFUL: usize = 12;

/// Returns the notes on the number of samples `kept` out of `candidates`.
pub fn count_notes(kept: usize, candidates: usize, wanted: Option<usize>) -> Vec<String> {
    match wanted {
        Some(wanted) if kept < wanted => {
            let samples = counted(kept, "sample", "samples");
            vec![format!("{samples} instead of {wanted}: there are no more points that differ")]
        }
        None if kept == candidates => {
            vec![format!("all {kept} points are kept: σp is below their distances; a larger one leaves fewer")]
        }
        None if kept <= HANDFUL => {
            let samples = counted(kept, "sample is", "samples are");
            vec![format!("only {samples} left: σp is about as large as the whole; a smaller one leaves more")]
        }
        _ => Vec::new(),
    }
}

fn refuse_bad_points(positions: &[DVec3]) -> Result<()> {
    if positions.is_empty() {
        return Err(Error::Mesh {
            fault: Fault::Empty,
            cause: "there are no points".into(),
            remedy: "check what the file is".into(),
        });
    }
    refuse_bad_positions(positions)
}
