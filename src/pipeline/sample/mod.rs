//! Sampling without triangles: blue noise on a surface by scan and ascent, or a subset of given points by the scan alone.
//!
//! A search finds the kernel width that gives about the wanted count. Then missing samples are added where s is largest, and
//! surplus ones removed where it is smallest.

pub(in crate::pipeline) mod bandwidth;
pub(in crate::pipeline) mod options;
pub(in crate::pipeline) mod progressive;
pub(in crate::pipeline) mod sampled;
pub(in crate::pipeline) mod task;

use crate::base::error::{Error, Fault, Result};
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::points::Points;
use crate::mesh::refine::refine;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::cloud::prepared;
use crate::pipeline::density::SampleDensity;
use crate::pipeline::input_checks::{refuse_bad_numbers, refuse_bad_positions};
use crate::pipeline::kernel::{KernelFeatures, Signal, check_signals, with_dimensions};
use crate::pipeline::sample::options::SampleOptions;
use crate::pipeline::sample::sampled::Sampled;
use crate::pipeline::sample::task::Task;
use crate::pipeline::scale::{CANDIDATES_PER_POINT, LONGEST_EDGE, SMALLEST_SPACING, Scale, refuse_no_area};
use crate::pipeline::unit::Unit;
use crate::prepare::repair::repair;
use crate::spectral::candidates::{Candidate, candidates};
use crate::spectral::scan::Given;
use crate::surface::domain::{Domain, Sample};
use crate::surface::lift::{BarePoints, bare_samples};
use glam::DVec3;

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
    let (sigma, samples) = with_dimensions!(features, D => task.on_surface::<D>(&domain, &candidates))?;
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
            return sample_bare_points(input, &inwards, &unit, options, monitor);
        }
        cloud => cloud?,
    };
    monitor.stage("sample");
    let at_source = |signal: &Signal| signal.with_values(|values| Ok(values.of(&cloud.source)));
    let signals: Vec<Signal> = options.signals.iter().map(at_source).collect::<Result<_>>()?;
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

/// Chooses a subset of points that do not form a surface; `inwards` has them in `unit`.
fn sample_bare_points(
    input: &Points,
    inwards: &Points,
    unit: &Unit,
    options: &SampleOptions,
    monitor: &dyn Monitor,
) -> Result<Sampled> {
    let bare = bare_samples(inwards);
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

/// Draws candidates on `domain` for `wanted` samples.
fn candidates_for(domain: &Domain, features: &KernelFeatures, wanted: usize, seed: u64) -> Vec<Candidate> {
    let more = if features.is_lifted() { MORE_CANDIDATES } else { 1 };
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

fn refuse_bad_points(positions: &[DVec3]) -> Result<()> {
    if positions.is_empty() {
        return Err(Error::Mesh {
            fault: Fault::Empty,
            cause: "there are no points".into(),
            remedy: "check what the file contains".into(),
        });
    }
    refuse_bad_positions(positions)
}
