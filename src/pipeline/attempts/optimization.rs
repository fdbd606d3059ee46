//! Optimises a triangulation: coarse levels first, then all vertices, angles, and the fit to the surface.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::topology::NONE;
use crate::optimize::angles::{Goal, improve_angles};
use crate::optimize::coarse_to_fine::{
    coarsen, indispensable, match_target_count, missed, narrow, remove_encroaching_vertices, split_to, tips, transition,
};
use crate::optimize::counts::{meet_count, split_longest};
use crate::optimize::exchange::{exchange_vertices, fill_narrow};
use crate::optimize::fit::{Fitted, fit};
use crate::optimize::graft::graft;
use crate::optimize::max_error::reduce_max_error;
use crate::optimize::relax::{Flips, relax, relax_within};
use crate::optimize::slivers::remove_slivers;
use crate::optimize::untangle::{Aim, untangle};
use crate::optimize::valence::{remove_defects, remove_near_defects};
use crate::pipeline::scale::Scale;
use crate::spectral::ascent::{ASCENT_SIGMA, AscentParameters, LONG_STEP, ascend};
use crate::surface::domain::Domain;

/// Optimises the mesh of the samples: arranges vertices coarse to fine, restores the wanted count, improves angles, and fits
/// the mesh to the surface, within `limit` (in the pipeline's unit) if possible.
pub(in crate::pipeline) fn optimize(
    domain: &Domain,
    mesh: &mut Manifold,
    scale: &Scale,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<()> {
    monitor.stage("untangle");
    untangle(domain, mesh, CROSSING, scale.spacing, monitor)?;
    order(domain, mesh, scale, monitor)?;
    let all = (0..domain.mesh.positions.len() as u32).collect();
    finish(domain, mesh, scale, all, limit, monitor)
}

/// Variant of [`optimize`] for the mesh of a part of the surface, the part around its `watched` vertices. The mesh is well
/// arranged except at its `disordered` vertices, which are rearranged together with those around them.
pub(in crate::pipeline) fn optimize_ordered(
    domain: &Domain,
    mesh: &mut Manifold,
    scale: &Scale,
    disordered: VertexSet,
    watched: Vec<u32>,
    monitor: &dyn Monitor,
) -> Result<()> {
    monitor.stage("untangle");
    untangle(domain, mesh, CROSSING, scale.spacing, monitor)?;
    monitor.stage("ascend");
    order_around(domain, mesh, disordered, &VertexSet::EMPTY, scale.spacing, monitor)?;
    monitor.stage("relax");
    relax_to_count(domain, mesh, scale, monitor)?;
    finish(domain, mesh, scale, watched, None, monitor)
}

/// Improves the angles of a well-arranged mesh and fits it to the surface.
fn finish(
    domain: &Domain,
    mesh: &mut Manifold,
    scale: &Scale,
    watched: Vec<u32>,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<()> {
    monitor.stage("improve angles");
    improve_angles(domain, mesh, Goal::GOOD, scale.spacing, monitor)?;
    monitor.stage("fit");
    let fitted = fit_to_surface(domain, mesh, watched, scale.spacing, limit, monitor)?;
    reduce_max_error(domain, mesh, scale.spacing, &fitted, monitor)
}

/// Fits a mesh, or a part of one, with good angles to the surface and its `watched` vertices, within `limit` (in the
/// pipeline's unit) if possible. Before and after the fit, vertices are exchanged between remaining small angles and other
/// places.
pub(in crate::pipeline) fn fit_to_surface(
    domain: &Domain,
    mesh: &mut Manifold,
    watched: Vec<u32>,
    spacing: f64,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Fitted> {
    exchange_vertices(domain, mesh, Goal::GOOD, spacing, monitor)?;
    // If some triangles cannot be good, the goal for all is the modest one.
    let goal = Goal::within_reach(mesh);
    if goal == Goal::MODEST {
        relax_within(domain, mesh, &tips(mesh), goal, spacing, monitor)?;
    }
    let fitted = fit(domain, mesh, watched, goal, spacing, limit, monitor)?;
    // The fit may have spoilt triangles of vertices that it moved back to the surface.
    improve_angles(domain, mesh, goal, spacing, monitor)?;
    exchange_vertices(domain, mesh, goal, spacing, monitor)?;
    Ok(fitted)
}

/// Brings the mesh to the wanted number of vertices with as few irregular ones as possible, coarse to fine. If the result
/// misses a part of the surface and mending fails, the process is repeated once with all vertices there kept.
fn order(domain: &Domain, mesh: &mut Manifold, scale: &Scale, monitor: &dyn Monitor) -> Result<()> {
    monitor.stage("ascend");
    arrange_narrow(domain, mesh, scale, monitor)?;
    let fine = mesh.clone();
    let mut kept = VertexSet::EMPTY;
    loop {
        coarse_to_fine(domain, mesh, &kept, scale, monitor)?;
        mend_refined(domain, mesh, &fine, scale.spacing, monitor)?;
        let lost = missed(&fine, mesh, scale.spacing);
        if lost.is_empty() || !kept.is_empty() {
            return relax_to_count(domain, mesh, scale, monitor);
        }
        kept = lost;
        mesh.clone_from(&fine);
    }
}

/// Arranges a quarter of the vertices and the `kept` ones, then splits edges until the wanted number is reached.
fn coarse_to_fine(
    domain: &Domain,
    mesh: &mut Manifold,
    kept: &VertexSet,
    scale: &Scale,
    monitor: &dyn Monitor,
) -> Result<()> {
    monitor.stage("ascend");
    let (dense, _) = arrange_coarse(domain, mesh, scale, &VertexSet::EMPTY, kept, monitor)?;
    monitor.stage("relax");
    relax_coarse(domain, mesh, &dense, 2.0 * scale.spacing, monitor)?;
    refine(domain, mesh, &dense, &VertexSet::EMPTY, scale, monitor)?;
    Ok(())
}

/// Arranges the patches that are too narrow for a coarser mesh, and gives them the number of vertices that they need along
/// curves.
fn arrange_narrow(domain: &Domain, mesh: &mut Manifold, scale: &Scale, monitor: &dyn Monitor) -> Result<()> {
    let Scale { wanted, spacing } = *scale;
    remove_encroaching_vertices(mesh);
    remove_slivers(mesh, spacing);
    if narrow(domain, mesh, spacing).is_empty() {
        return Ok(());
    }
    // Missing vertices are added before the rest is arranged.
    split_longest(domain, mesh, wanted);
    let patches = narrow(domain, mesh, spacing);
    let ascent = AscentParameters { sigma: COARSE_SIGMA * spacing, step: LONG_STEP, sweeps: COARSE_SWEEPS / 2 };
    ascend(domain, mesh, &!&patches, ascent, monitor)?;
    fill_narrow(domain, mesh, &patches, spacing, monitor)?;
    let patches = narrow(domain, mesh, spacing);
    let on_curves = VertexSet::new(mesh, |v| mesh.connectivity.is_on_curve(v));
    ascend(domain, mesh, &(&!&patches | &on_curves), ascent, monitor)
}

/// Reduces a mesh of the given scale to a quarter of its vertices, well arranged. Keeps all vertices where a coarser mesh
/// could not follow the surface, and the `arranged` ones, which do not move. If the mesh is large enough, it is first
/// arranged by a still coarser one, which this function also makes. The `kept` vertices are some of those that the coarse
/// mesh needs. Returns the dense vertices and the old number of each vertex.
fn arrange_coarse(
    domain: &Domain,
    mesh: &mut Manifold,
    scale: &Scale,
    arranged: &VertexSet,
    kept: &VertexSet,
    monitor: &dyn Monitor,
) -> Result<(VertexSet, Vec<u32>)> {
    let before = mesh.connectivity.vertex_count();
    let (mut dense, mut old) = reduce(domain, mesh, scale.spacing, arranged, kept, monitor)?;
    let mut sweeps = COARSE_SWEEPS;
    let count = mesh.connectivity.vertex_count();
    // On a rough surface hardly any edge can collapse, so a still coarser mesh would be the same.
    let is_coarser = count as f64 <= MOST_LEFT * before as f64;
    if is_coarser && count - dense.len() >= FEWEST_TO_COARSEN {
        let half = Scale { wanted: count, spacing: 2.0 * scale.spacing };
        let coarser = arrange_coarse(domain, mesh, &half, &dense, &dense, monitor)?;
        let split = refine_from(domain, mesh, coarser, &dense, &half, monitor)?;
        dense = dense.renumbered(&split);
        old = renumbered(&old, &split);
        sweeps = ORDERED_SWEEPS;
    }
    spread(domain, mesh, &dense, scale, sweeps, monitor)?;
    Ok((dense, old))
}

/// Arranges the vertices that no coarser mesh can do without, except the `arranged` ones, and collapses the mesh to a quarter
/// of the others. Returns these dense vertices and the old number of each vertex.
fn reduce(
    domain: &Domain,
    mesh: &mut Manifold,
    spacing: f64,
    arranged: &VertexSet,
    kept: &VertexSet,
    monitor: &dyn Monitor,
) -> Result<(VertexSet, Vec<u32>)> {
    let fine = AscentParameters { sigma: ASCENT_SIGMA * spacing, step: LONG_STEP, sweeps: FINE_SWEEPS };
    ascend(domain, mesh, &(&!&indispensable(mesh, kept) | arranged), fine, monitor)?;
    Ok(coarsen(domain, mesh, spacing, kept))
}

/// Spreads the coarse vertices of a mesh evenly by ascent, without moving the `dense` ones, and adjusts their number so that
/// refinement gives the wanted count.
fn spread(
    domain: &Domain,
    mesh: &mut Manifold,
    dense: &VertexSet,
    scale: &Scale,
    sweeps: usize,
    monitor: &dyn Monitor,
) -> Result<()> {
    let Scale { wanted, spacing } = *scale;
    let coarse = AscentParameters { sigma: COARSE_SIGMA * 2.0 * spacing, step: LONG_STEP, sweeps: sweeps / 2 };
    for _ in 0..2 {
        ascend(domain, mesh, dense, coarse, monitor)?;
        match_target_count(domain, mesh, dense, wanted, spacing);
    }
    Ok(())
}

/// Refines a `coarser` mesh, given by its dense vertices and old numbers, back to the given scale without moving the
/// `arranged` vertices. Returns the number that each vertex had before the reduction.
fn refine_from(
    domain: &Domain,
    mesh: &mut Manifold,
    coarser: (VertexSet, Vec<u32>),
    arranged: &VertexSet,
    scale: &Scale,
    monitor: &dyn Monitor,
) -> Result<Vec<u32>> {
    let (dense, old) = coarser;
    relax_coarse(domain, mesh, &dense, 2.0 * scale.spacing, monitor)?;
    let split = refine(domain, mesh, &dense, &arranged.renumbered(&old), scale, monitor)?;
    Ok(renumbered(&old, &split))
}

/// Removes neighbouring defects from a coarse mesh of that spacing and relaxes all but the `dense` vertices.
fn relax_coarse(
    domain: &Domain,
    mesh: &mut Manifold,
    dense: &VertexSet,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    remove_near_defects(mesh, dense, spacing);
    relax(domain, mesh, dense, spacing, Flips::KeepValence, VALENCE_ROUNDS, monitor)?;
    relax(domain, mesh, dense, spacing, Flips::Delaunay, ROUNDS, monitor)
}

/// Splits the longest edges of a coarse mesh until the wanted number of vertices is reached, and rearranges those around the
/// `dense` vertices except the `arranged` ones. Returns the old number of each vertex.
fn refine(
    domain: &Domain,
    mesh: &mut Manifold,
    dense: &VertexSet,
    arranged: &VertexSet,
    scale: &Scale,
    monitor: &dyn Monitor,
) -> Result<Vec<u32>> {
    let Scale { wanted, spacing } = *scale;
    let old = split_to(domain, mesh, wanted);
    let [dense, arranged] = [dense, arranged].map(|set| set.renumbered(&old));
    let anew = VertexSet::new(mesh, |v| dense.contains(v) && !arranged.contains(v));
    order_around(domain, mesh, anew, &arranged, spacing, monitor)?;
    Ok(old)
}

/// Rearranges the vertices `anew` and those around them by ascent, except the `arranged` ones.
fn order_around(
    domain: &Domain,
    mesh: &mut Manifold,
    anew: VertexSet,
    arranged: &VertexSet,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    let transition = transition(domain, mesh, anew, spacing);
    if transition.is_empty() {
        return Ok(());
    }
    let ascent = AscentParameters { sigma: COARSE_SIGMA * spacing, step: LONG_STEP, sweeps: TRANSITION_SWEEPS };
    ascend(domain, mesh, &(&!&transition | arranged), ascent, monitor)
}

/// Restores the parts of the `fine` mesh that the coarse one missed or where faces intersect.
fn mend_refined(
    domain: &Domain,
    mesh: &mut Manifold,
    fine: &Manifold,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    let missed = missed(fine, mesh, spacing);
    let grafted = graft(domain, mesh, fine, &missed, spacing);
    order_around(domain, mesh, grafted, &VertexSet::EMPTY, spacing, monitor)
}

/// Returns the original number of each vertex after two renumberings.
fn renumbered(first: &[u32], second: &[u32]) -> Vec<u32> {
    second.iter().map(|&v| first.get(v as usize).copied().unwrap_or(NONE)).collect()
}

/// Relaxes a refined mesh at the wanted number of vertices, with as few irregular ones as possible.
fn relax_to_count(domain: &Domain, mesh: &mut Manifold, scale: &Scale, monitor: &dyn Monitor) -> Result<()> {
    let Scale { wanted, spacing } = *scale;
    let locked = tips(mesh);
    remove_near_defects(mesh, &locked, spacing);
    relax(domain, mesh, &locked, spacing, Flips::Delaunay, ROUNDS, monitor)?;
    remove_encroaching_vertices(mesh);
    remove_slivers(mesh, spacing);
    meet_count(domain, mesh, wanted);
    let wide = !&narrow(domain, mesh, spacing);
    for _ in 0..2 {
        remove_defects(mesh, &locked, &wide);
        relax(domain, mesh, &locked, spacing, Flips::KeepValence, VALENCE_ROUNDS, monitor)?;
    }
    relax(domain, mesh, &locked, spacing, Flips::KeepValence, 2 * ROUNDS, monitor)
}

/// Untangling before vertices move, because only a well-connected mesh can be spread evenly. Without it, most faces of a
/// surface with thin walls everywhere come apart later.
const CROSSING: Aim = Aim { angles_below: 0.0, most_crossing: usize::MAX, farthest: 1.0, most_at_fault: 0.01 };

/// Number of vertices, without dense ones, from which a mesh is first arranged by a coarser one. Smooth models benefit from
/// 1,000 vertices on, but triangles of four spacings intersect curves that are close together.
const FEWEST_TO_COARSEN: usize = 2000;

/// Largest share of the vertices that a reduced mesh may have for a still coarser one to be made: above it, hardly any edge
/// can collapse.
const MOST_LEFT: f64 = 0.9;

/// Numbers of ascent sweeps: where no coarser mesh can follow the surface; over the coarsest mesh, in two halves; over a
/// mesh arranged by a coarser one, which only evens out its edges; and where dense and coarse vertices meet. More sweeps
/// leave fewer irregular vertices, with diminishing returns.
const FINE_SWEEPS: usize = 11;
const COARSE_SWEEPS: usize = 120;
const ORDERED_SWEEPS: usize = 40;
const TRANSITION_SWEEPS: usize = 30;

/// Kernel width of the ascent over the coarse mesh, in its spacings: slightly narrower than elsewhere ([`ASCENT_SIGMA`]).
const COARSE_SIGMA: f64 = 0.9;

/// Rounds of relaxation per level: after three, vertices move by a hundredth of an edge. The settling rounds, after defects
/// are removed, only give the rows room.
const ROUNDS: usize = 3;
const VALENCE_ROUNDS: usize = 2;
