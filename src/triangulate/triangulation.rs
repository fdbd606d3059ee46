//! Input and output of a triangulation of samples.

use crate::manifold::Manifold;

/// Samples that must become vertices, which come first among all samples: those on the boundary of a domain, then those at
/// the ends of its spikes.
#[derive(Debug, Clone, Copy)]
pub struct Boundary<'a> {
    /// The side `3 t + k` of the domain that each sample lies on, and its position along it in 0..1.
    pub sites: &'a [(u32, f64)],
    /// The next sample on the boundary loop of each, with the surface to the left of the edge between them.
    pub successor: &'a [u32],
    /// Number of spikes.
    pub spikes: usize,
}

/// A triangulation of samples.
#[derive(Debug, Clone)]
pub struct Triangulated {
    /// The mesh.
    pub mesh: Manifold,
    /// The sample that each vertex is; the indices of vertices of the domain follow those of all samples.
    pub source: Vec<u32>,
    /// Number of smooth patches that were tessellated from the input as a whole since their stars were inconsistent.
    pub tessellated_patches: usize,
}
