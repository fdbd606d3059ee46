//! The pipeline from mesh to mesh: the only place that knows the order of the stages.

use crate::base::error::Result;
use crate::base::progress::Monitor;
use crate::surface::mesh::Mesh;
use crate::surface::repair::Repairs;
use crate::surface::topology::Topology;

/// How dense the result shall be. One of the three says it all: with the area they follow from each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// The number of vertices of the result.
    Points(usize),
    /// The mean edge length, in the units of the input.
    EdgeLength(f64),
    /// The kernel width σp of the sampler, in the units of the input.
    SigmaP(f64),
}

/// What to make of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// How dense the result shall be. Default: as many vertices as the input has is not a number known here, so 10,000.
    pub density: Density,
    /// Seed of all random numbers: same seed, same input, same result. Default 0.
    pub seed: u64,
    /// Sweeps of gradient ascent over all samples (paper, section 6.2). Default 10.. see code.
    pub sweeps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options { density: Density::Points(10_000), seed: 0, sweeps: 30 }
    }
}

/// A remeshed surface and what there is to say about it.
#[derive(Debug, Clone)]
pub struct Remeshed {
    pub mesh: Mesh,
    /// The input as it was read, before repairs.
    pub input: Topology,
    /// The input after repairs: what the result's topology is held against.
    pub repaired: Topology,
    /// The result.
    pub output: Topology,
    pub repairs: Repairs,
    /// Kernel width used, in the units of the input.
    pub sigma_p: f64,
    /// The spacing d that N points at hexagonal packing have on the input's area, in the units of the input.
    pub spacing: f64,
    /// Vertices wanted, as the density says.
    pub wanted: usize,
    /// Things a user should know, a sentence each.
    pub notes: Vec<String>,
}

impl Remeshed {
    /// Whether the result is an oriented manifold of the repaired input's Euler characteristic, components and
    /// boundary loops.
    pub fn verified(&self) -> bool {
        let (a, b) = (&self.output, &self.repaired);
        a.is_manifold()
            && a.is_oriented()
            && (a.euler, a.components, a.boundary_loops) == (b.euler, b.components, b.boundary_loops)
    }
}

/// Remeshes `input`.
pub fn remesh(_input: &Mesh, _options: &Options, _monitor: &dyn Monitor) -> Result<Remeshed> {
    todo!()
}
