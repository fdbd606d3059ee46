//! Pipeline from mesh to mesh.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::Monitor;
use crate::manifold::Manifold;
use crate::manifold::small_angles::smallest_unforced_angle;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::triangle_mesh::Mesh;
use crate::optimize::counts::meet_count;
use crate::optimize::self_intersections::resolve_self_intersections;
use crate::optimize::slide::slide;
use crate::pipeline::attempts::finished::Finished;
use crate::pipeline::attempts::mend::mended;
use crate::pipeline::attempts::optimization::optimize;
use crate::pipeline::attempts::triangulation::Triangulation;
use crate::pipeline::attempts::{Attempts, MOST_RUNS, Remedy};
use crate::pipeline::coarse::{coarse, far_wider_spacing};
use crate::pipeline::density::{Density, FEWEST_POINTS, FIRST_POINTS, MOST_POINTS};
use crate::pipeline::kernel::KernelFeatures;
use crate::pipeline::options::{Grading, Options};
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::result::edges::Edges;
use crate::pipeline::result::origins::origins;
use crate::pipeline::result::{Deviation, Remeshed, notes};
use crate::pipeline::sized::SizedSurface;
use crate::pipeline::sized::follow::ascend_as_asked;
use crate::pipeline::sized::pinholes::Pinholes;
use crate::pipeline::sized::resizing::{FINER, Resizing, sizes_at};
use crate::quality::bound::{Bounds, hausdorff_bounds};
use crate::surface::features::is_rough;
use crate::surface::narrow_patches::LeftOut;
use crate::triangulate::stitch::Torn;

/// Distances below this fraction of the allowed one are not resolved further.
const OF_INTEREST: f64 = 0.25;

/// Maximum number of slides, each without the vertices whose faces intersected after the previous one.
const MOST_SLIDES: usize = 4;

/// Remeshes `input`: returns the wanted number of vertices, evenly spread over its surface, and triangles of the same
/// topology.
///
/// An input that is not an oriented manifold is repaired first; [`Remeshed::repairs`] says how.
///
/// With [`Density::Auto`] the input is remeshed several times. The error is roughly inversely proportional to the number of
/// vertices, so the next number follows from the last error, between the largest number that was insufficient and the
/// smallest that sufficed. The search ends when both are within a tenth of each other, and returns the result for the
/// latter.
///
/// # Errors
/// [`Error::Mesh`] for an input without triangles or without area, or with bad numbers; [`Error::Option`] for options
/// out of range; [`Error::Cancelled`] if the monitor asks for it.
///
/// [`Error::Mesh`]: crate::base::error::Error::Mesh
/// [`Error::Option`]: crate::base::error::Error::Option
/// [`Error::Cancelled`]: crate::base::error::Error::Cancelled
pub fn remesh(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    Remesher::new(input, options, monitor)?.remesh(options.density, true, monitor)
}

/// Input that is repaired once and remeshed at several densities.
pub struct Remesher<'a> {
    prepared: PreparedInput<'a>,
    /// `None` while it is being remeshed, so that no copy takes memory beside it, and after the last density.
    repaired: Option<OrientedManifold>,
}

impl<'a> Remesher<'a> {
    /// Repairs `input`, and smooths it if `options` say so.
    ///
    /// # Errors
    /// Those of [`remesh`].
    pub fn new(input: &'a Mesh, options: &'a Options, monitor: &dyn Monitor) -> Result<Remesher<'a>> {
        options.validate()?;
        let (prepared, repaired) = PreparedInput::new(input, options, monitor)?;
        Ok(Remesher { prepared, repaired: Some(repaired) })
    }

    /// Remeshes the input at this density, like [`remesh`]. `is_last` says that no other density follows, which saves
    /// keeping a copy of the repaired input.
    ///
    /// # Errors
    /// Those of [`remesh`].
    pub fn remesh(&mut self, density: Density, is_last: bool, monitor: &dyn Monitor) -> Result<Remeshed> {
        let Remesher { prepared, repaired: kept } = self;
        let repaired = kept.take().unwrap_or_else(|| prepared.repaired_again());
        if density == Density::Auto {
            return with_fewest_points(prepared, &repaired, monitor);
        }
        if let Some(spacing) = far_wider_spacing(prepared, &repaired, density)? {
            let (coarse, fine) = coarse(prepared, repaired, spacing, monitor)?;
            prepared.fine = Some(fine);
            let made = remesh_to(prepared, || coarse.clone(), density, monitor);
            *kept = prepared.fine.take().map(|fine| fine.mesh);
            return made;
        }
        if !is_last {
            *kept = Some(repaired.clone());
        }
        // One run usually suffices; another one repairs the input again.
        let mut first = Some(repaired);
        let repaired = || first.take().unwrap_or_else(|| prepared.repaired_again());
        remesh_to(prepared, repaired, density, monitor)
    }
}

/// Maximum number of tries of the search for the fewest vertices, and the ratio of the two bounds at which it ends.
const MOST_TRIES: usize = 8;
const NEAR_ENOUGH: f64 = 1.1;

/// Maximum factor between the numbers of vertices of successive tries: one place with a large error says little about the
/// others.
const LARGEST_CHANGE: f64 = 8.0;

/// Returns the verified result with the fewest vertices among those tried; if there is none, the last one within the allowed
/// error, or else the last one.
fn with_fewest_points(
    prepared: &PreparedInput,
    repaired: &OrientedManifold,
    monitor: &dyn Monitor,
) -> Result<Remeshed> {
    let (mut too_few, mut enough) = (FEWEST_POINTS as f64, MOST_POINTS as f64);
    let (mut best, mut last) = (None, None);
    let mut n = FIRST_POINTS as f64;
    for _ in 0..MOST_TRIES {
        let density = Density::Points(n.round() as usize);
        let made = remesh_to(prepared, || repaired.clone(), density, monitor)?;
        let ratio = made.deviation.map_or(1.0, |d| d.reached / d.allowed);
        if made.verified() {
            enough = n;
            best = Some(made);
        } else {
            too_few = n;
            let is_near = |made: &Remeshed| made.deviation.is_none_or(|d| d.is_allowed());
            if is_near(&made) || !last.as_ref().is_some_and(is_near) {
                last = Some(made);
            }
        }
        if enough <= NEAR_ENOUGH * too_few || n == enough && n <= NEAR_ENOUGH * FEWEST_POINTS as f64 {
            break;
        }
        let wanted = n * ratio.clamp(1.0 / LARGEST_CHANGE, LARGEST_CHANGE);
        // Well inside the remaining range, so that each try narrows it.
        let step = math::pow(enough / too_few, 0.2).min(NEAR_ENOUGH);
        n = wanted.clamp(step * too_few, enough / step);
    }
    Ok(best.or(last).expect("at least one try was made"))
}

/// Remeshes at one density: returns the first sound result or, if there is none, the one with the best score. `repaired`
/// returns the repaired input for each run.
fn remesh_to(
    prepared: &PreparedInput,
    mut repaired: impl FnMut() -> OrientedManifold,
    density: Density,
    monitor: &dyn Monitor,
) -> Result<Remeshed> {
    let mut resizing = Resizing::default();
    let mut sized = |resizing: &Resizing| SizedSurface::new(prepared, repaired(), density, resizing, monitor);
    let mut surface = sized(&resizing)?;
    let mut attempts = Attempts::new(prepared.options.seed, surface.domain.is_sharp());
    let mut best: Option<(SizedSurface, Finished)> = None;
    loop {
        let (mut made_of, triangulation) = triangulated(surface, &mut attempts, monitor)?;
        if attempts.may_draw_again() {
            let [sparse, sparsest] = triangulation.sparse_places(prepared, &made_of);
            let has_room = || sizes_at(&sparse, FINER, &made_of.domain, made_of.scale.spacing).is_some();
            if !sparse.is_empty() && has_room() {
                attempts.draw_again();
                [sparse, sparsest].iter().for_each(|places| resizing.shorten_at(places));
                surface = sized(&resizing)?;
                continue;
            }
        }
        let finished = arranged(prepared, &made_of, triangulation, attempts.run(), monitor)?;
        resizing.shorten_at(&finished.unsound_places());
        let finished = mended(prepared, &mut made_of, finished, monitor)?;
        let is_better = best.as_ref().is_none_or(|(_, best)| finished.score < best.score);
        if is_better {
            best = Some((made_of, finished));
        }
        let (made_of, best) = best.as_ref().expect("a result was made");
        // If the topology requires more vertices than are wanted, edges cannot become shorter anywhere.
        let has_room = best.manifold.connectivity.vertex_count() <= made_of.scale.wanted;
        if !has_room || !is_better || !attempts.after_run(best.score, best.mesh.triangles.len()) {
            break;
        }
        surface = sized(&resizing)?;
    }
    let (surface, finished) = best.expect("a result was made");
    let finished = slid(prepared, &surface, finished, monitor)?;
    remeshed(prepared, &surface, finished, monitor)
}

/// Triangulates samples of a surface. Returns the surface, too, without the sharp edges that could not be kept.
fn triangulated(
    mut surface: SizedSurface,
    attempts: &mut Attempts,
    monitor: &dyn Monitor,
) -> Result<(SizedSurface, Triangulation)> {
    if !attempts.keeps_curves() && surface.domain.is_sharp() {
        surface = surface.smooth();
    }
    loop {
        let triangulation = Triangulation::new(&surface, attempts.current(), monitor)?;
        if !triangulation.has_other_topology(&surface) {
            return Ok((surface, triangulation));
        }
        let Torn { places, curves } = &triangulation.torn;
        let are_curves_torn = surface.domain.sharp_curves().any(|curve| curves.contains(&curve));
        match attempts.remedy(are_curves_torn) {
            Some(Remedy::Finer) => {
                if !surface.resize_at(places, FINER) {
                    attempts.sample_curves_closer();
                }
            }
            Some(Remedy::WithoutTornCurves) => surface = surface.without_curves(|curve| curves.contains(&curve)),
            Some(Remedy::Smooth) => surface = surface.smooth(),
            None => return Ok((surface, triangulation)),
        }
        monitor.stage("sample");
    }
}

/// Optimises the triangulation of an attempt and resolves self-intersections where possible.
fn arranged(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    triangulation: Triangulation,
    run: u64,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    let Triangulation { mesh: mut manifold, tessellated_patches, .. } = triangulation;
    arrange(prepared, surface, &mut manifold, monitor)?;
    monitor.stage("resolve self-intersections");
    resolve_self_intersections(&surface.domain, &mut manifold, monitor)?;
    Ok(Finished::new(prepared, surface, manifold, tessellated_patches, run))
}

/// Optimises the mesh or, if that is not wanted, gives it the wanted count and leaves it as the paper's ascent arranges it.
fn arrange(prepared: &PreparedInput, surface: &SizedSurface, mesh: &mut Manifold, monitor: &dyn Monitor) -> Result<()> {
    let SizedSurface { domain, scale, sigma, .. } = surface;
    let Options { grading, sweeps, .. } = prepared.options;
    if prepared.options.optimize {
        return optimize(domain, mesh, scale, prepared.limit(), monitor);
    }
    meet_count(domain, mesh, scale.wanted);
    monitor.stage("ascend");
    let features = match grading {
        Grading::Kernel { sigma_n, signals } => KernelFeatures::over(domain, *sigma_n, signals),
        _ => KernelFeatures::over(domain, f64::INFINITY, &[]),
    };
    ascend_as_asked(domain, mesh, &features, *sigma, *sweeps, monitor)
}

/// Slides vertices of `finished` to the best mean quality among the positions that leave the surface unchanged. Vertices
/// stay where faces would intersect that do not now.
fn slid(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    finished: Finished,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    if !prepared.options.optimize {
        return Ok(finished);
    }
    monitor.stage("slide");
    let mut locked = VertexSet::EMPTY;
    for _ in 0..MOST_SLIDES {
        let mut manifold = finished.manifold.clone();
        if !slide(&surface.domain, &mut manifold, &locked, surface.scale.spacing, monitor)? {
            break;
        }
        let next = finished.with(prepared, surface, manifold);
        let crossing = next.crossing_unlike(&finished);
        if next.score <= finished.score && crossing.is_empty() {
            return Ok(next);
        }
        let corners = crossing.into_iter().flat_map(|t| next.manifold.connectivity.triangle(3 * t));
        corners.for_each(|v| locked.insert(v));
        locked = locked.with_rings(&next.manifold, 1);
    }
    Ok(finished)
}

/// Bounds the distance of the result from the surface, if requested.
fn deviation(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    mesh: &Mesh,
    monitor: &dyn Monitor,
) -> Option<Deviation> {
    let PreparedInput { allowed, unit, .. } = prepared;
    let allowed = (*allowed)?;
    monitor.stage("bound");
    let Bounds { upper, place, .. } = hausdorff_bounds(mesh, &surface.domain.mesh, OF_INTEREST * allowed / unit.size)?;
    Some(Deviation { allowed, reached: unit.size * upper, place: unit.outwards_point(place).to_array() })
}

/// Note on a result that was mended.
const MENDED: &str = "vertices and edges were changed once more where faces crossed or angles were small";

fn note_on_run(run: u64) -> String {
    format!(
        "this is attempt {run} of at most {MOST_RUNS}, with different edge lengths where earlier attempts had self-intersections, slivers or bridges"
    )
}

/// Assembles the result and its notes.
fn remeshed(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    finished: Finished,
    monitor: &dyn Monitor,
) -> Result<Remeshed> {
    let deviation = deviation(prepared, surface, &finished.of_part, monitor);
    let SizedSurface { domain, scale, sigma, blunted, left_out, within, .. } = surface;
    let unit = &prepared.unit;
    let kept = within.as_ref().zip(finished.sewn.as_ref()).map(|(within, sewn)| within.kept(sewn));
    let origins = origins(prepared, surface, &finished.manifold, &finished.of_part, finished.sewn.as_ref());
    let [slivers, bridges] = [&finished.slivers, &finished.bridges]
        .map(|found| found.iter().map(|t| finished.kept_triangles() + t).collect::<Vec<u32>>());
    let first = kept.as_ref().map_or(0, |kept| kept.vertices.len());
    let edges = Edges::of(&finished.mesh, &finished.manifold, surface, unit, first);
    let lost = prepared.components.lost(&finished.mesh, &origins);
    let intersects = !finished.self_intersections.is_empty();
    let mut result = Remeshed {
        input: prepared.of_input,
        repaired: surface.of_whole,
        output: finished.topology,
        mesh: finished.mesh,
        origins,
        repairs: prepared.repairs,
        sigma_p: unit.size * sigma,
        spacing: unit.size * scale.spacing,
        spacing_range: domain.size_range().map(|size| unit.size * scale.spacing * size),
        wanted: within.as_ref().map_or(scale.wanted, |within| within.wanted(scale.wanted)),
        sharp_curves: domain.sharp_curves().count(),
        smoothed_curves: surface.smoothed_curves,
        pinholes: Pinholes { place: unit.outwards_point(surface.pinholes.place), ..surface.pinholes },
        tessellated_patches: finished.tessellated_patches,
        self_intersections_of_input: intersects.then(|| surface.self_intersections_of_input()),
        self_intersections: finished.self_intersections,
        new_self_intersections: finished.new_self_intersections,
        slivers,
        bridges,
        unforced_theta_min: smallest_unforced_angle(&finished.manifold),
        left_out: if *blunted { LeftOut::default() } else { left_out.times(unit.size) },
        blunted: *blunted,
        // Clouds are smoothed automatically, or deliberately not.
        is_rough: !prepared.options.of_points && is_rough(&domain.mesh, &domain.twin, scale.spacing),
        lost,
        deviation,
        edges,
        kept,
        notes: Vec::new(),
    };
    result.notes = notes(&result, prepared.cracks);
    if let (Some(within), Some(kept)) = (within, &result.kept) {
        result.notes.extend(within.notes(&result.mesh, kept));
    }
    let is_later_run = finished.run > 1 && result.is_sound();
    result.notes.extend(finished.is_mended.then(|| MENDED.to_string()));
    result.notes.extend(is_later_run.then(|| note_on_run(finished.run)));
    Ok(result)
}
