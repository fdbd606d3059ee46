//! Adapts a part of a mesh to new target edge lengths: splits edges that are too long, and collapses those that are too
//! short.
//!
//! Cost: that of the changed vertices, and a sort of the edges.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::angles::{Goal, improve_angles};
use crate::optimize::counts::{collapse_shorter, split_longer};
use crate::optimize::relax::{Flips, relax};
use crate::optimize::slivers::remove_slivers;
use crate::surface::domain::Domain;

/// Ratio of new to old target edge length below which the length became shorter; ratio of old to new below which it became
/// longer.
const SHORTER: f64 = 0.9;

/// Longest edge that is left, in target edge lengths: the halves of a longer one are closer to the target. Also the
/// shortest, half of it.
const LONGEST: f64 = std::f64::consts::SQRT_2;
const SHORTEST: f64 = 0.5 * LONGEST;

/// Maximum number of vertices afterwards, as a multiple of that before; more would be too many to make up for elsewhere.
const MOST: usize = 4;

/// Number of rings around changed vertices that are relaxed, and rounds of relaxation.
const RINGS: usize = 2;
const ROUNDS: usize = 4;

/// Gives the edges of `mesh` the current target edge lengths of `domain`. `spacing` is the target edge length at samples of
/// size 1.
pub fn resize(domain: &Domain, mesh: &mut Manifold, spacing: f64, monitor: &dyn Monitor) -> Result<()> {
    let [shorter, longer] = take_sizes(domain, mesh);
    let before = valences(mesh);
    let most = MOST * mesh.connectivity.vertex_count();
    split_longer(domain, mesh, LONGEST * spacing, |v| shorter.contains(v), most);
    collapse_shorter(mesh, SHORTEST * spacing, |v| longer.contains(v));
    remove_slivers(mesh, spacing);
    let (resized, valences) = (&shorter | &longer, valences(mesh));
    let has_changed = |v: u32| resized.contains(v) || before.get(v as usize) != valences.get(v as usize);
    let still = !&VertexSet::new(mesh, has_changed).with_rings(mesh, RINGS);
    relax(domain, mesh, &still, spacing, Flips::Delaunay, ROUNDS, monitor)?;
    improve_angles(domain, mesh, Goal::GOOD, spacing, monitor)
}

/// Gives the samples of `mesh` the sizes that `domain` has at their positions. Returns the vertices whose size became
/// smaller, and those whose size became larger.
fn take_sizes(domain: &Domain, mesh: &mut Manifold) -> [VertexSet; 2] {
    let [mut shorter, mut longer] = [VertexSet::EMPTY, VertexSet::EMPTY];
    mesh.change_samples(|v, sample| {
        let size = domain.size_near(sample.position, sample.triangle);
        if size < SHORTER * sample.size {
            shorter.insert(v);
        } else if sample.size < SHORTER * size {
            longer.insert(v);
        }
        sample.size = size;
    });
    [shorter, longer]
}

/// Returns the valence of each vertex; 0 for removed ones.
fn valences(mesh: &Manifold) -> Vec<usize> {
    let c = &mesh.connectivity;
    (0..c.vertex_bound()).map(|v| if c.has_vertex(v) { c.valence(v) } else { 0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::sheet;

    #[test]
    fn edges_follow_lengths_that_become_longer_or_shorter() {
        let even = sheet(20, |_, _| 0.0);
        let mut domain = Domain::new(even.clone().try_into().unwrap());
        let samples = even.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &even.triangles);
        mesh.lock_boundary();
        let spacing = 1.0 / 20.0;
        let mean = |mesh: &Manifold| {
            let inner = mesh.edges().filter(|&h| {
                let c = &mesh.connectivity;
                !c.is_on_curve(c.origin(h)) && !c.is_on_curve(c.target(h))
            });
            let lengths: Vec<f64> = inner.map(|h| mesh.length_squared(h).sqrt()).collect();
            lengths.iter().sum::<f64>() / lengths.len() as f64
        };
        let before = mean(&mesh);
        for factor in [2.0, 0.5] {
            domain.grade(vec![factor; domain.mesh.positions.len()]);
            let mut resized = mesh.clone();
            resize(&domain, &mut resized, spacing, &()).unwrap();
            let ratio = mean(&resized) / before;
            assert!(ratio > 0.7 * factor && ratio < 1.2 * factor, "{factor}: {ratio}");
        }
    }
}
