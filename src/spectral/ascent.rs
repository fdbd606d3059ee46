//! Gradient ascent on the measure (paper, section 6.2): each sample moves to where it contributes more, x ← x + ½ ∇s(x)
//! in the units of the kernel, tangentially, and then back onto the surface.
//!
//! Departures from the paper: the samples are already the vertices of a manifold. Their two-rings are the neighbourhoods, so
//! no search is needed, and a step that would turn a triangle against the surface is halved, so the topology stays. Flips
//! after each sweep keep the mesh Delaunay. Steps may be longer than the paper's.
//!
//! Cost: about a microsecond per vertex and sweep.
//!
//! Where more than the position counts (a [`Lift`]), kernel and gradient have more dimensions, and a vertex moves along
//! the first three, those of space.
//!
//! Vertices on a curve (the boundary or a sharp edge) move along it; corners do not move.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::geom::vector::length_squared;
use crate::manifold::Manifold;
use crate::manifold::motion::move_vertices;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::next;
use crate::spectral::measure::{GRADIENT_NEIGHBOURS, gradient};
use crate::spectral::nearest::Nearest;
use crate::surface::domain::{Domain, Sample};
use crate::surface::lift::Lift;
use glam::DVec3;

/// The parameters of an ascent.
#[derive(Debug, Clone, Copy)]
pub struct AscentParameters {
    /// Width of the kernel where the wanted size is 1, in the units of the domain.
    pub sigma: f64,
    /// Share of the gradient that a vertex moves in one sweep: [`PAPER_STEP`] or [`LONG_STEP`].
    pub step: f64,
    /// Rounds over all vertices.
    pub sweeps: usize,
}

/// The paper's step.
pub const PAPER_STEP: f64 = 0.5;

/// A longer step, with which two sweeps order the vertices as well as three with the paper's. With 1 the vertices oscillate.
pub const LONG_STEP: f64 = 0.75;

/// Maximum move of a vertex in one sweep, in kernel widths.
pub(super) const MOST_STEP: f64 = 0.5;

/// Kernel width of the ascent in mean spacings: narrower ones leave clusters, wider ones blur the gradient.
pub const ASCENT_SIGMA: f64 = 0.94;

/// Moves all vertices of `mesh` that are not `locked`.
pub fn ascend(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    ascent: AscentParameters,
    monitor: &dyn Monitor,
) -> Result<()> {
    ascend_lifted::<3>(domain, mesh, locked, Lift::NONE, ascent, monitor)
}

/// Like [`ascend`], with a kernel of as many dimensions D as `lift` needs.
pub fn ascend_lifted<const D: usize>(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    lift: Lift,
    ascent: AscentParameters,
    monitor: &dyn Monitor,
) -> Result<()> {
    mesh.make_delaunay();
    for sweep in 0..ascent.sweeps {
        check(monitor)?;
        move_vertices(domain, mesh, locked, |mesh, v| way_up::<D>(mesh, lift, v, ascent));
        mesh.make_delaunay();
        monitor.progress((sweep + 1) as f64 / ascent.sweeps as f64);
    }
    Ok(())
}

/// Returns the step of vertex `v`, up the gradient.
fn way_up<const D: usize>(
    mesh: &Manifold,
    lift: Lift,
    v: u32,
    AscentParameters { sigma, step, .. }: AscentParameters,
) -> DVec3 {
    let mut offsets = [[0.0; D]; GRADIENT_NEIGHBOURS];
    let here = mesh.sample(v);
    let found = nearest::<D>(mesh, lift, v);
    for (offset, &(_, w)) in offsets.iter_mut().zip(found.list()) {
        let there = mesh.sample(w);
        let sigma = sigma * mean_width::<D>(lift, here, there);
        *offset = lift.offset(here, there).map(|x| x / sigma);
    }
    let sigma = sigma * lift.width::<D>(here);
    let uphill = DVec3::from_slice(&gradient(&offsets[..found.list().len()]));
    let way = (step * sigma * uphill).clamp_length_max(MOST_STEP * sigma);
    mesh.along(v).map_or(way, |along| way.project_onto_normalized(along))
}

/// Returns the kernel width between two samples, the mean of theirs. With the width of only one of them, all would move to
/// where kernels are wider.
#[inline]
fn mean_width<const D: usize>(lift: Lift, one: &Sample, other: &Sample) -> f64 {
    0.5 * (lift.width::<D>(one) + lift.width::<D>(other))
}

/// Returns the nearest vertices in the two-ring of `v`, by distance relative to the kernel width; of the second ring, only
/// those that face the same way.
fn nearest<const D: usize>(mesh: &Manifold, lift: Lift, v: u32) -> Nearest {
    let (c, here) = (&mesh.connectivity, mesh.sample(v));
    let mut found = Nearest::default();
    let mut add = |w: u32| {
        let there = mesh.sample(w);
        let width = mean_width::<D>(lift, here, there);
        found.add(length_squared(&lift.offset::<D>(here, there)) / (width * width), w)
    };
    c.ring(v).for_each(&mut add);
    let mut add_facing = |w: u32| {
        if mesh.sample(w).normal.dot(here.normal) >= 0.0 {
            add(w);
        }
    };
    if c.is_boundary(v) {
        c.ring(v).for_each(|w| c.ring(w).filter(|&w| w != v).for_each(&mut add_facing));
        return found;
    }
    for out in c.outgoing(v) {
        let w = c.target(out);
        if c.is_boundary(w) {
            c.ring(w).filter(|&w| w != v).for_each(&mut add_facing);
            continue;
        }
        // Goes around `w`, from beyond the triangle on the left of `out` to the one on its right.
        let last = c.apex(c.twin(out));
        let mut across = c.twin(next(out));
        while c.apex(across) != last {
            add_facing(c.apex(across));
            across = c.twin(next(across));
        }
    }
    found
}
