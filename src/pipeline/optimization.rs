//! Optimisation of a triangulation: a coarse level first, then all the vertices, good angles, and the fit to the surface.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::angles::improve_angles;
use crate::optimize::coarse_to_fine::{
    coarsen, indispensable, keep_at_self_intersections, match_target_count, narrow, remove_encroaching_vertices,
    split_to, tips, transition,
};
use crate::optimize::counts::meet_count;
use crate::optimize::fit::fit;
use crate::optimize::max_error::reduce_max_error;
use crate::optimize::relax::{Flips, relax};
use crate::optimize::slivers::remove_slivers;
use crate::optimize::valence::{remove_defects, remove_near_defects};
use crate::pipeline::scale::Scale;
use crate::spectral::ascent::{AscentParameters, LONG_STEP, SIGMA_OF_SPACING as ASCENT_SIGMA, ascend};
use crate::surface::domain::Domain;

/// Optimises the mesh of the samples, coarse to fine, at the wanted count, with good angles, and fitted to the surface: to
/// within `limit`, in the pipeline's unit, if possible.
pub(super) fn optimize(
    domain: &Domain,
    mesh: &mut Manifold,
    scale: &Scale,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<()> {
    let dense = arrange_coarse(domain, mesh, scale, monitor)?;
    refine_to_count(domain, mesh, &dense, scale, monitor)?;
    let spacing = scale.spacing;
    monitor.stage("improve angles");
    improve_angles(domain, mesh, spacing, monitor)?;
    monitor.stage("fit");
    let fitted = fit(domain, mesh, spacing, limit, monitor)?;
    // The fit may have spoilt triangles of vertices that it took back to the surface.
    improve_angles(domain, mesh, spacing, monitor)?;
    reduce_max_error(domain, mesh, spacing, &fitted, monitor)
}

/// Reduces the mesh to a quarter of the vertices, in good order, and leaves all of them where a coarser mesh could not
/// follow the surface; these dense vertices.
fn arrange_coarse(domain: &Domain, mesh: &mut Manifold, scale: &Scale, monitor: &dyn Monitor) -> Result<VertexSet> {
    let spacing = scale.spacing;
    monitor.stage("ascend");
    remove_encroaching_vertices(mesh);
    remove_slivers(mesh, spacing);
    let narrow = narrow(domain, mesh, spacing);
    if !narrow.is_empty() {
        let ascent = AscentParameters { sigma: COARSE_SIGMA * spacing, step: LONG_STEP, sweeps: COARSE_SWEEPS };
        ascend(domain, mesh, &!&narrow, ascent, monitor)?;
    }
    let fine = mesh.clone();
    let (mut kept, mut dense) = (VertexSet::EMPTY, VertexSet::EMPTY);
    for _ in 0..MOST_COARSE_MESHES {
        *mesh = fine.clone();
        dense = build_coarse_level(domain, mesh, scale, &kept, monitor)?;
        if !keep_at_self_intersections(&mut kept, &fine, mesh, spacing) {
            break;
        }
    }
    monitor.stage("relax");
    remove_near_defects(mesh, &dense, 2.0 * spacing);
    relax(domain, mesh, &dense, 2.0 * spacing, Flips::KeepValence, SETTLING_ROUNDS, monitor)?;
    relax(domain, mesh, &dense, 2.0 * spacing, Flips::Delaunay, ROUNDS, monitor)?;
    Ok(dense)
}

/// Reduces the mesh to a quarter of the vertices, ordered by ascent, and leaves those in `kept` and others that a coarser
/// mesh needs; the dense vertices.
fn build_coarse_level(
    domain: &Domain,
    mesh: &mut Manifold,
    scale: &Scale,
    kept: &VertexSet,
    monitor: &dyn Monitor,
) -> Result<VertexSet> {
    let Scale { wanted, spacing } = *scale;
    let fine = AscentParameters { sigma: ASCENT_SIGMA * spacing, step: LONG_STEP, sweeps: FINE_SWEEPS };
    ascend(domain, mesh, &!&indispensable(mesh, kept), fine, monitor)?;
    let dense = coarsen(domain, mesh, spacing, kept);
    let coarse = AscentParameters { sigma: COARSE_SIGMA * 2.0 * spacing, step: LONG_STEP, sweeps: COARSE_SWEEPS / 2 };
    for _ in 0..2 {
        ascend(domain, mesh, &dense, coarse, monitor)?;
        match_target_count(domain, mesh, &dense, wanted, spacing);
    }
    Ok(dense)
}

/// Splits edges up to the wanted number of vertices, and relaxes them with as few irregular ones as possible.
fn refine_to_count(
    domain: &Domain,
    mesh: &mut Manifold,
    dense: &VertexSet,
    scale: &Scale,
    monitor: &dyn Monitor,
) -> Result<()> {
    let Scale { wanted, spacing } = *scale;
    let (finer, dense) = split_to(domain, mesh, dense, wanted);
    *mesh = finer;
    let transition = transition(domain, mesh, dense, spacing);
    if !transition.is_empty() {
        let ascent = AscentParameters { sigma: COARSE_SIGMA * spacing, step: LONG_STEP, sweeps: TRANSITION_SWEEPS };
        ascend(domain, mesh, &!&transition, ascent, monitor)?;
    }
    let locked = tips(mesh);
    remove_near_defects(mesh, &locked, spacing);
    relax(domain, mesh, &locked, spacing, Flips::Delaunay, ROUNDS, monitor)?;
    remove_encroaching_vertices(mesh);
    remove_slivers(mesh, spacing);
    meet_count(domain, mesh, wanted);
    let wide = !&narrow(domain, mesh, spacing);
    for _ in 0..2 {
        remove_defects(mesh, &locked, &wide);
        relax(domain, mesh, &locked, spacing, Flips::KeepValence, SETTLING_ROUNDS, monitor)?;
    }
    relax(domain, mesh, &locked, spacing, Flips::KeepValence, 2 * ROUNDS, monitor)
}

/// Most coarse meshes that are made, each with more vertices kept dense, until one has no self-intersections.
const MOST_COARSE_MESHES: usize = 3;

/// Sweeps of ascent in the places that no coarser mesh can follow, those over the coarse mesh, in two halves, and those
/// where dense and coarse vertices meet: with more there are fewer irregular vertices, though less and less so.
const FINE_SWEEPS: usize = 11;
const COARSE_SWEEPS: usize = 120;
const TRANSITION_SWEEPS: usize = 30;

/// Kernel width of the ascent over the coarse mesh, in its spacings: a little narrower than elsewhere ([`ASCENT_SIGMA`]).
const COARSE_SIGMA: f64 = 0.9;

/// Rounds of relaxation at each level: after three, vertices move by a hundredth of an edge. Those after defects have
/// gone only give the rows room.
const ROUNDS: usize = 3;
const SETTLING_ROUNDS: usize = 2;
