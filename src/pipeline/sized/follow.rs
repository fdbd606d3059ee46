//! Makes vertices follow a kernel in more dimensions: the density of its samples becomes the target edge length.
//!
//! The scan in six dimensions or more determines how many samples each part of the surface gets. The pipeline then treats
//! these lengths like any others: samples, triangles and the optimiser respect them, and triangles are nearly equilateral,
//! whereas the kernel's own samples would be farther apart along a ridge than across it. Without optimisation, the ascent
//! uses the kernel in all its dimensions and leaves the vertices where it moves them.

use crate::base::error::{Result, Setting};
use crate::base::monitor::Monitor;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::pipeline::density::{Density, check_count};
use crate::pipeline::kernel::{KernelFeatures, with_dimensions};
use crate::pipeline::sample::bandwidth::find_bandwidth;
use crate::pipeline::sample::task::ASCENT_OF_SCAN;
use crate::pipeline::scale::{CANDIDATES_PER_POINT, Scale};
use crate::spectral::ascent::{AscentParameters, PAPER_STEP, ascend_lifted};
use crate::spectral::candidates::{Candidate, candidates};
use crate::spectral::scan::{Choices, OnDomain, scan_lifted};
use crate::spectral::spacing::spacings;
use crate::surface::domain::{Domain, Sample};
use crate::surface::sizing::field_sizes;

/// Pipeline parameters that result from following a kernel.
pub(in crate::pipeline) struct Followed {
    /// Scale with the wanted number of vertices, or with the number that the kernel keeps if its width is given.
    pub scale: Scale,
    /// Width of the kernel.
    pub sigma: f64,
    /// Target edge length at each vertex of the domain, relative to the mean one.
    pub sizes: Vec<f64>,
}

/// Derives the edge lengths from a scan with the kernel over `domain`.
pub(in crate::pipeline) fn follow(
    domain: &Domain,
    features: &KernelFeatures,
    scale: Scale,
    density: Density,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Followed> {
    let count = CANDIDATES_PER_POINT * scale.wanted;
    let candidates = candidates(domain, count, seed);
    let mut scan = |sigma: f64| scan_of(domain, features, &candidates, sigma, seed, monitor);
    let (scale, sigma, samples) = if let Density::SigmaP(width) = density {
        let samples = scan(scale.sigma())?;
        let n = samples.len();
        check_count(Setting::SigmaP, n, format!("a kernel width of {width} would give {n} vertices"))?;
        (Scale::of_points(n, domain.mesh.area()), scale.sigma(), samples)
    } else {
        let (sigma, samples) = find_bandwidth(scale.sigma(), scale.wanted, &mut scan)?;
        (scale, sigma, samples)
    };
    let sizes = field_sizes(domain, spacings(domain, &candidates, &samples, sigma), scale.spacing);
    Ok(Followed { scale, sigma, sizes })
}

fn scan_of(
    domain: &Domain,
    features: &KernelFeatures,
    candidates: &[Candidate],
    sigma: f64,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Vec<Sample>> {
    let choices = OnDomain { domain, candidates };
    let chosen = features.with_kernel(
        sigma,
        |kernel| with_dimensions!(features, D => scan_lifted::<D>(&choices, &[], kernel, seed, monitor)),
    )?;
    Ok(chosen.into_iter().map(|i| choices.sample(i)).collect())
}

/// Runs the paper's ascent on `mesh` with the kernel of width `sigma` in all its dimensions.
pub(in crate::pipeline) fn ascend_as_asked(
    domain: &Domain,
    mesh: &mut Manifold,
    features: &KernelFeatures,
    sigma: f64,
    sweeps: usize,
    monitor: &dyn Monitor,
) -> Result<()> {
    let ascent = AscentParameters { sigma: ASCENT_OF_SCAN * sigma, step: PAPER_STEP, sweeps };
    features.with_kernel(sigma, |kernel| {
        with_dimensions!(features, D => ascend_lifted::<D>(domain, mesh, &VertexSet::EMPTY, kernel.lift, ascent, monitor))
    })
}
