//! The input and the output of a triangulation of samples.

use crate::manifold::Manifold;

/// Samples that have to become vertices, the first ones of all samples: those on the boundary of a domain, then those at the ends of its
/// spikes.
#[derive(Debug, Clone, Copy)]
pub struct Boundary<'a> {
    /// The side `3 t + k` of the domain that each lies on, and how far along in 0..1.
    pub sites: &'a [(u32, f64)],
    /// The next one on its loop; the surface is on the left of the way there.
    pub successor: &'a [u32],
    /// The number of spikes.
    pub spikes: usize,
}

/// A triangulation of samples.
#[derive(Debug, Clone)]
pub struct Triangulated {
    /// The mesh.
    pub mesh: Manifold,
    /// For each of its vertices the sample that it is; vertices of the domain come after all samples.
    pub source: Vec<u32>,
    /// Smooth patches whose stars contradicted each other and that were tessellated from the input as a whole.
    pub tessellated_patches: usize,
}
