//! Coarsens a mesh whose edges are far shorter than those wanted in the result.
//!
//! Work on the sampled surface (samples, walks, projections) takes time for each triangle, and triangles far smaller than
//! the spacing carry no detail that the result could follow. So edges are collapsed into one of their ends, shortest first,
//! until the remaining ones are long enough, provided that the removed vertex stays close to the remaining surface.
//!
//! The triangles are processed in parallel, in blocks that are compact in space. Vertices that blocks share stay. So there
//! are two turns, whose blocks have different bounds.
//!
//! Remaining vertices do not move. The link condition keeps the topology. Vertices on the boundary stay, and those on sharp
//! edges are collapsed along these only, because sharp turns are easier to tell on the fine mesh than on the coarse one.
//!
//! Based on: P. Lindstrom, G. Turk, Fast and memory efficient polygonal simplification, 1998, DOI
//! 10.1109/VISUAL.1998.745314, in that the error is that of the mesh so far. Departure: an edge collapses into one of its
//! ends instead of the best place, so that no noise is invented and each vertex is one of the input.
//!
//! Cost: sorting the triangles, and about a microsecond for each removed vertex; linear.

mod block;
mod parts;
mod whole;

pub use block::Coarseness;
pub use parts::Part;
pub use whole::{Coarsened, coarsened, in_spatial_order, share_of_edges_below};
