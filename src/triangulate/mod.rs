//! From samples on a surface to an oriented 2-manifold with the surface's topology.

pub mod agreement;
pub mod holes;
pub mod star;
pub mod unfold;

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::surface::domain::{Domain, Sample};
use rayon::prelude::*;
use star::StarMaker;
use unfold::{SamplesByTriangle, Unfolding};

/// Samples that one task makes the stars of: enough to outweigh the memory that a walk needs.
const CHUNK: usize = 512;

/// The stars of all samples, as triangles that begin with the centre of the star.
pub fn stars(
    domain: &Domain,
    samples: &[Sample],
    successor: &[u32],
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<[u32; 3]>> {
    check(monitor)?;
    let by_triangle = SamplesByTriangle::new(domain.mesh.triangles.len(), samples);
    let maker = || StarMaker::new(Unfolding::new(domain, samples, &by_triangle), spacing, successor);
    let chunks: Vec<Vec<[u32; 3]>> = (0..samples.len().div_ceil(CHUNK))
        .into_par_iter()
        .map_init(maker, |maker, chunk| {
            let mut triangles = Vec::with_capacity(6 * CHUNK);
            for centre in CHUNK * chunk..(CHUNK * (chunk + 1)).min(samples.len()) {
                maker.star(centre as u32, &mut triangles);
            }
            triangles
        })
        .collect();
    Ok(chunks.concat())
}
