//! Follows wanted lengths that have become shorter at some places: splits the edges there that are too long now, and collapses
//! as many short ones elsewhere.
//!
//! Only the surroundings of what has changed are relaxed, so that the rest stays as good as it was.
//!
//! Cost: that of the vertices which change, and a sort of the edges.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::angles::improve_angles;
use crate::optimize::counts::{collapse_away_from_curves, meet_count, split_longer};
use crate::optimize::relax::{Flips, relax};
use crate::optimize::slivers::remove_slivers;
use crate::surface::domain::Domain;

/// Share of its length before from which on a length is shorter.
const SHORTER: f64 = 0.9;

/// Longest edge that is left, in wanted lengths: the halves of a longer one are nearer to that.
const LONGEST: f64 = std::f64::consts::SQRT_2;

/// The most vertices before as many are collapsed elsewhere, in those wanted: hardly any of the mesh would be left.
const MOST: usize = 2;

/// Rings around what has changed that are relaxed, and rounds of it.
const RINGS: usize = 2;
const ROUNDS: usize = 4;

/// Gives `mesh`, of `wanted` vertices, the lengths that `domain` wants now; the vertices around which nothing was to change.
/// `spacing` is the length that is wanted where the size of samples is 1.
pub fn follow_shorter_lengths(
    domain: &Domain,
    mesh: &mut Manifold,
    wanted: usize,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<VertexSet> {
    let shorter = take_sizes(domain, mesh);
    let before: Vec<usize> = valences(mesh);
    split_longer(domain, mesh, LONGEST * spacing, |v| shorter.contains(v), MOST * wanted);
    remove_slivers(mesh, spacing);
    collapse_away_from_curves(mesh, wanted);
    meet_count(domain, mesh, wanted);
    let valences = valences(mesh);
    let has_changed = |v: u32| shorter.contains(v) || before.get(v as usize) != valences.get(v as usize);
    let still = !&VertexSet::new(mesh, has_changed).with_rings(mesh, RINGS);
    relax(domain, mesh, &still, spacing, Flips::Delaunay, ROUNDS, monitor)?;
    improve_angles(domain, mesh, spacing, monitor)?;
    Ok(still)
}

/// Gives the samples of `mesh` the sizes that `domain` has at their places; those whose size has become shorter.
fn take_sizes(domain: &Domain, mesh: &mut Manifold) -> VertexSet {
    let mut shorter = VertexSet::EMPTY;
    for (sample, v) in mesh.samples.iter_mut().zip(0..) {
        let size = domain.size_near(sample.position, sample.triangle);
        if size < SHORTER * sample.size {
            shorter.insert(v);
        }
        sample.size = size;
    }
    shorter
}

/// The number of edges at each vertex; 0 for those that have been removed.
fn valences(mesh: &Manifold) -> Vec<usize> {
    let c = &mesh.connectivity;
    (0..c.vertex_bound()).map(|v| if c.has_vertex(v) { c.valence(v) } else { 0 }).collect()
}
