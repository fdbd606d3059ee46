//! A coarser mesh of the same surface, where its edges are far shorter than those that the result is to have.
//!
//! Work on the sampled surface (samples, walks, projections) takes time for each triangle, and those far smaller than the spacing
//! have no detail that the result could follow. Here edges collapse into one of their ends, the shortest ones first, until those
//! left are long enough, as long as the vertex that goes stays near to the surface that is left.
//!
//! The triangles are treated in blocks that are near in space, beside each other. Vertices that blocks share stay. So there are
//! two turns, with blocks of other bounds.
//!
//! Vertices that are left stay where they are. The link condition keeps the topology. Those on the boundary stay, and those on
//! sharp edges go along these only: where the fine mesh turns is told better than where the coarse one does.
//!
//! Based on: P. Lindstrom, G. Turk, Fast and memory efficient polygonal simplification, 1998, DOI 10.1109/VISUAL.1998.745314,
//! in that the error is that of the mesh so far. Departure: an end instead of the best place, so that no noise is invented and
//! each vertex is one of the input.
//!
//! Cost: sorting the triangles, and about a microsecond for each vertex that goes; linear.

mod block;
mod parts;
mod whole;

pub use block::Coarseness;
pub use parts::Part;
pub use whole::{Coarsened, coarsened, in_spatial_order, share_of_edges_below};
