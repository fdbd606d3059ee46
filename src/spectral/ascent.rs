//! Gradient ascent on the measure (paper, section 6.2): each sample moves to where it contributes more,
//! x ← x + ½ ∇s(x) in the units of the kernel, tangentially, and back on the surface.
//!
//! Departures from the paper: the samples are the vertices of a manifold already. Their two-rings are the
//! neighbourhoods, so nothing is searched, and a step that would turn a triangle against the surface is halved, so the
//! topology cannot be lost. Flips after each sweep keep the mesh Delaunay.
//!
//! Cost: some microseconds a vertex and sweep.
//!
//! Vertices on a curve, of the boundary or a sharp edge, move along it; corners stay where they are.

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::spectral::measure::Measure;
use crate::surface::domain::Domain;
use crate::surface::manifold::Manifold;
use crate::surface::motion::move_vertices;
use glam::DVec3;

/// Neighbours that count, the nearest first; more do not change where samples go.
const NEIGHBOURS: usize = 12;

/// Kernel width of the ascent in mean spacings: narrower ones leave clusters, wider ones blur the gradient.
pub const SIGMA_OF_SPACING: f64 = 0.94;

/// Moves all vertices of `mesh` for `sweeps` rounds. `sigma` is the kernel's width in the units of the domain.
pub fn ascend(domain: &Domain, mesh: &mut Manifold, sigma: f64, sweeps: usize, monitor: &dyn Monitor) -> Result<()> {
    mesh.make_delaunay();
    for sweep in 0..sweeps {
        check(monitor)?;
        move_vertices(domain, mesh, Measure::new, |mesh, v, measure| way_up(mesh, v, sigma, measure));
        mesh.make_delaunay();
        monitor.progress((sweep + 1) as f64 / sweeps as f64);
    }
    Ok(())
}

/// Where vertex `v` wants to go: up the gradient, half a kernel width at most.
fn way_up(mesh: &Manifold, v: u32, sigma: f64, measure: &mut Measure) -> DVec3 {
    measure.clear();
    for neighbour in nearest(mesh, v) {
        measure.add((mesh.position(neighbour) - mesh.position(v)) / sigma);
    }
    let way = (0.5 * sigma * measure.gradient()).clamp_length_max(0.5 * sigma);
    mesh.along(v).map_or(way, |along| way.project_onto_normalized(along))
}

/// The nearest vertices of the two-ring of `v`; of the second ring only those that face the same way.
fn nearest(mesh: &Manifold, v: u32) -> impl Iterator<Item = u32> {
    let here = &mesh.samples[v as usize];
    let mut found: Vec<(f64, u32)> = Vec::with_capacity(48);
    for w in mesh.connectivity.ring(v) {
        found.push((here.position.distance_squared(mesh.position(w)), w));
    }
    let first_ring = found.len();
    for i in 0..first_ring {
        for w in mesh.connectivity.ring(found[i].1) {
            let there = &mesh.samples[w as usize];
            if w != v && there.normal.dot(here.normal) >= 0.0 {
                found.push((here.position.distance_squared(there.position), w));
            }
        }
    }
    found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    found.dedup_by_key(|f| f.1);
    found.into_iter().take(NEIGHBOURS).map(|f| f.1)
}
