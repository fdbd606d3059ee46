//! Samples along the open boundaries of a surface: a loop is a curve, and evenly spaced points of it are what the
//! measure of section 3 of the paper would settle on in one dimension.

use crate::surface::connectivity::next;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

/// Samples on the boundary loops of a surface.
#[derive(Debug, Clone, Default)]
pub struct BoundarySamples {
    /// The samples, loop by loop, in the order along each.
    pub samples: Vec<Sample>,
    /// For each sample the side `3 t + k` of the domain that it lies on and how far along, in 0..1.
    pub sites: Vec<(u32, f64)>,
    /// For each sample the one after it on its loop; the surface is on the left of the way there.
    pub successor: Vec<u32>,
}

/// Fewest samples of a loop: with less it would not be one.
const FEWEST: usize = 3;

/// Samples all boundary loops at distances of about `spacing` along them.
pub fn sample_boundaries(domain: &Domain, spacing: f64) -> BoundarySamples {
    let mut result = BoundarySamples::default();
    for chain in domain.boundary_loops() {
        sample_loop(domain, &chain, spacing, &mut result);
    }
    result
}

fn ends(domain: &Domain, side: u32) -> [DVec3; 2] {
    let corner = |s: u32| domain.mesh.positions[domain.mesh.triangles[s as usize / 3][s as usize % 3] as usize];
    [corner(side), corner(next(side))]
}

fn sample_loop(domain: &Domain, chain: &[u32], spacing: f64, result: &mut BoundarySamples) {
    let lengths: Vec<f64> = chain.iter().map(|&s| ends(domain, s)).map(|[a, b]| a.distance(b)).collect();
    let total: f64 = lengths.iter().sum();
    let count = ((total / spacing).round() as usize).max(FEWEST);
    let first = result.samples.len() as u32;
    let (mut covered, mut i) = (0.0, 0);
    for k in 0..count {
        let at = total * (k as f64 + 0.5) / count as f64;
        while i + 1 < chain.len() && covered + lengths[i] < at {
            covered += lengths[i];
            i += 1;
        }
        let along = ((at - covered) / lengths[i]).clamp(0.0, 1.0);
        let side = chain[i];
        let mut weights = [0.0; 3];
        weights[side as usize % 3] = 1.0 - along;
        weights[next(side) as usize % 3] = along;
        result.samples.push(domain.sample(side / 3, weights));
        result.sites.push((side, along));
        result.successor.push(first + (k as u32 + 1) % count as u32);
    }
}
