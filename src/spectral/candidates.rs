//! Candidates for the linear scan: points of a mesh as dense everywhere, relative to the wanted edge length.
//!
//! The vertices of a mesh are no good as candidates (a CAD part has none on its flat sides), so the surface is covered
//! evenly: of n candidates the i-th lies at the share (i + u) / n of the area, u random. Stratified like this no part
//! of the surface is missed by chance. Where edges of relative length h are wanted, area counts 1 / h² times: candidates
//! come as dense as the smallest h of their triangle wants them, and stay with probability (smallest h / h)².
//!
//! Cost: linear in candidates and triangles.

use crate::base::rng::{Random, unit};
use crate::surface::domain::{Domain, Sample};

/// A candidate, small enough that there can be hundreds of millions of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The triangle of the domain that it lies on.
    pub triangle: u32,
    /// Barycentric coordinates of the first two corners.
    weights: [f32; 2],
}

impl Candidate {
    /// The candidate as a point of the surface.
    #[inline]
    pub fn sample(&self, domain: &Domain) -> Sample {
        let [a, b] = self.weights.map(f64::from);
        // Rounded to f32 the two may sum to more than 1, which would be off the triangle.
        let b = b.min(1.0 - a);
        domain.sample(self.triangle, [a, b, 1.0 - a - b])
    }
}

/// About `count` points of the surface, exactly as many if sizes are even, in the order of its triangles.
pub fn candidates(domain: &Domain, count: usize, rng: &mut Random) -> Vec<Candidate> {
    let step = 2.0 * domain.mesh.area() / count as f64;
    let mut result = Vec::with_capacity(count);
    let (mut covered, mut drawn) = (0.0, 0);
    let mut next = step * unit(rng);
    for t in 0..domain.mesh.triangles.len() {
        let sizes = domain.mesh.triangles[t].map(|v| domain.size_at(v));
        let smallest = sizes.into_iter().fold(f64::INFINITY, f64::min);
        let is_even = sizes == [smallest; 3];
        covered += domain.mesh.area_vector(t).length() / (smallest * smallest);
        while next < covered {
            let (root, u) = (unit(rng).sqrt(), unit(rng));
            let weights = [1.0 - root, root * (1.0 - u)].map(|w| w as f32);
            let candidate = Candidate { triangle: t as u32, weights };
            if is_even || unit(rng) < (smallest / candidate.sample(domain).size).powi(2) {
                result.push(candidate);
            }
            drawn += 1;
            next = step * (drawn as f64 + unit(rng));
        }
    }
    result
}
