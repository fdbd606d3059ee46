//! Mends a result in place where it is faulty. First, intersecting faces and slivers are untangled, and edges around the
//! remaining ones become longer or shorter. Then small angles are untangled, and inherited self-intersections if there are
//! more of them than in the input. The number of vertices is restored elsewhere.
//!
//! Whether samples at a thin wall are joined well is decided by chance, at each place separately. Drawing all of them again
//! would lose the good places along with the bad ones. Here each place changes by itself, only if that improves it, and the
//! rest stays.
//!
//! Cost: for each round, that of the faulty places and a search for self-intersections.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::base::parallel;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::small_angles::{SLIVER, slivers, with_angles_below};
use crate::optimize::bridges::bridges;
use crate::optimize::exchange::{balance_count, is_near};
use crate::optimize::resize::resize;
use crate::optimize::self_intersections::resolve_self_intersections;
use crate::optimize::untangle::{Aim, untangle};
use crate::pipeline::attempts::Score;
use crate::pipeline::attempts::finished::Finished;
use crate::pipeline::attempts::optimization::fit_to_surface;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::sized::SizedSurface;
use glam::DVec3;

/// Factors by which edges at faulty places are lengthened or shortened, in turn. Longer edges pass over folds that are finer
/// than the edges, which takes few vertices from elsewhere; shorter ones let triangles follow a thin wall.
const FACTORS: [f64; 4] = [2.0, 0.5, 4.0, 0.25];

/// Maximum number of rounds through all factors.
const MOST_ROUNDS: usize = 3;

/// Rings of triangles around faulty ones that change with them.
const RINGS: usize = 6;

/// Aims of untangling: a sound result, and angles that meet the modest goal. For the latter the surface may move less, or
/// ears would be cut off.
const SOUND: Aim = Aim { angles_below: SLIVER, most_crossing: usize::MAX, farthest: 1.0, most_at_fault: 0.1 };
pub(in crate::pipeline) const MODEST: Aim = Aim { angles_below: 30.0, farthest: 0.6, ..SOUND };

/// Aim of untangling for the good goal, after the modest one: done in one step, three times as many angles would stay below
/// the modest goal. The surface may hardly move: with as much leeway as above, corners of CAD parts were cut off by 1 % of
/// the diagonal.
const GOOD: Aim = Aim { angles_below: 40.0, farthest: 0.1, ..MODEST };

/// Mends `finished` and returns the best result. `surface` keeps the changed lengths.
pub(in crate::pipeline) fn mended(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    finished: Finished,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    if !prepared.options.optimize || finished.score.other_topology {
        return Ok(finished);
    }
    let mut best = sound(prepared, surface, finished, monitor)?;
    // If the distance is limited, it takes precedence over angles.
    if prepared.limit().is_some() {
        return Ok(best);
    }
    let most_crossing = if best.self_intersections.is_empty() { 0 } else { surface.self_intersections_of_input() };
    for aim in [Aim { most_crossing, ..MODEST }, GOOD] {
        let is_worth_it = small_angles(&best, aim) > 0 || best.self_intersections.len() > aim.most_crossing;
        if best.score == Score::SOUND && is_worth_it {
            best = untangled(prepared, surface, best, aim, monitor)?;
        }
    }
    Ok(best)
}

/// Number of triangles with an angle below that of `aim`.
fn small_angles(result: &Finished, aim: Aim) -> usize {
    with_angles_below(&result.manifold, aim.angles_below).len()
}

/// Mends `finished` at intersecting faces, slivers and bridges, and returns the best result.
fn sound(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    finished: Finished,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    let mut best = finished;
    let mut tried = Tried::default();
    for _ in 0..MOST_ROUNDS {
        if !best.unsound_triangles().is_empty() {
            best = untangled(prepared, surface, best, SOUND, monitor)?;
        }
        let before = best.score;
        if best.score.is_of_places(best.mesh.triangles.len()) {
            monitor.stage("mend");
        }
        for factor in FACTORS {
            if !best.score.is_of_places(best.mesh.triangles.len()) {
                break;
            }
            let sizes = surface.domain.sizes();
            match resized(prepared, surface, &best, factor, &mut tried, monitor)? {
                Some(next) if next.score < best.score => best = next,
                _ => surface.domain.grade(sizes),
            }
        }
        if best.score >= before {
            break;
        }
    }
    Ok(best)
}

/// Untangles `best` at its faults and returns the better of both results: by what makes it unsound, then by all intersecting
/// faces, then by small angles.
fn untangled(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    best: Finished,
    aim: Aim,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    let Some(mut next) = with_other_edges(prepared, surface, &best, aim, monitor)? else { return Ok(best) };
    // Places that changed at the same time may intersect each other.
    if best.score == Score::SOUND && next.score != Score::SOUND {
        next = with_other_edges(prepared, surface, &next, SOUND, monitor)?.unwrap_or(next);
    }
    let rank = |result: &Finished| (result.score, result.self_intersections.len(), small_angles(result, aim));
    Ok(if rank(&next) < rank(&best) { next } else { best })
}

/// Untangles `result` at its faults and restores its number of vertices; `None` if nothing helps.
fn with_other_edges(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    result: &Finished,
    aim: Aim,
    monitor: &dyn Monitor,
) -> Result<Option<Finished>> {
    monitor.stage("untangle");
    let SizedSurface { domain, scale, .. } = surface;
    let mut manifold = result.manifold.clone();
    let wanted = manifold.connectivity.vertex_count();
    if !untangle(domain, &mut manifold, aim, scale.spacing, monitor)? {
        return Ok(None);
    }
    balance_count(domain, &mut manifold, wanted, scale.spacing, monitor)?;
    Ok(Some(Finished { is_mended: true, ..result.with(prepared, surface, manifold) }))
}

/// Factors that did not help at a place, which is identified by its faulty triangles.
#[derive(Default)]
struct Tried(Vec<(f64, Vec<[DVec3; 3]>)>);

/// Makes edges `factor` times as long where `best` is unsound and that improves it; `None` if it improves nowhere. Skips
/// places where the factor failed before.
fn resized(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    best: &Finished,
    factor: f64,
    Tried(tried): &mut Tried,
    monitor: &dyn Monitor,
) -> Result<Option<Finished>> {
    let corners =
        |triangles: &[u32]| -> Vec<DVec3> { triangles.iter().flat_map(|&t| best.manifold.corners(t)).collect() };
    let triangles = best.unsound_triangles();
    let sizes = surface.domain.sizes();
    if !surface.resize_at(&corners(&triangles), factor) {
        return Ok(None);
    }
    let faces = Faces::new(&best.manifold);
    let pairs = faces.self_intersecting_pairs_of(&triangles).into_iter().map(|(t, u)| [t, u]);
    let groups: Vec<[u32; 2]> = pairs.chain(triangles.iter().map(|&t| [t, t])).collect();
    let of_place = |place: &Neighborhood| {
        let inside = triangles.iter().filter(|&&t| place.has_triangle(t));
        (factor, inside.map(|&t| best.manifold.corners(t)).collect())
    };
    let mut places = Neighborhood::around_groups(&best.manifold, &groups, RINGS);
    places.retain(|place| !tried.contains(&of_place(place)));
    let wanted = best.manifold.connectivity.vertex_count();
    let better = parallel::each(&places, |place| {
        let changed = changed(surface, place, prepared.limit(), monitor)?;
        let is_better = has_fewer_faults(surface, &changed, place, &faces);
        let stays = || is_near(&place.mesh, &changed.mesh, SOUND.farthest * surface.scale.spacing);
        Ok((is_better && stays()).then_some(changed))
    });
    let mut manifold = best.manifold.clone();
    let mut touched = vec![false; manifold.connectivity.half_edge_bound() as usize / 3];
    let mut changed = Vec::new();
    for (place, better) in places.iter().zip(better) {
        let Some(better) = better? else {
            tried.push(of_place(place));
            continue;
        };
        if better.put_back(&mut manifold, &mut touched) {
            changed.extend(triangles.iter().copied().filter(|&t| place.has_triangle(t)));
        }
    }
    surface.domain.grade(sizes);
    if changed.is_empty() {
        return Ok(None);
    }
    surface.resize_at(&corners(&changed), factor);
    balance_count(&surface.domain, &mut manifold, wanted, surface.scale.spacing, monitor)?;
    Ok(Some(Finished { is_mended: true, ..best.with(prepared, surface, manifold) }))
}

/// Gives `place` edges of the current target lengths, on the surface.
fn changed(
    surface: &SizedSurface,
    place: &Neighborhood,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Neighborhood> {
    let SizedSurface { domain, scale, .. } = surface;
    let mut changed = place.clone();
    resize(domain, &mut changed.mesh, scale.spacing, monitor)?;
    // Relaxed vertices lie on the surface, so the triangles between them lie on its inner side.
    fit_to_surface(domain, &mut changed.mesh, Vec::new(), scale.spacing, limit, monitor)?;
    resolve_self_intersections(domain, &mut changed.mesh, monitor)?;
    Ok(changed)
}

/// Returns whether `changed` has fewer faults among `faces` than `place`, by its score, then by all self-intersections.
fn has_fewer_faults(surface: &SizedSurface, changed: &Neighborhood, place: &Neighborhood, faces: &Faces) -> bool {
    let SizedSurface { domain, scale, .. } = surface;
    let count = |(crossing, place): (Vec<[DVec3; 3]>, &Neighborhood)| {
        let score = Score {
            self_intersections: crossing.iter().filter(|&&corners| !domain.intersects_itself_near(corners)).count(),
            slivers: slivers(&place.mesh).len(),
            bridges: bridges(domain, &place.mesh, scale.spacing).len(),
            ..Score::SOUND
        };
        (score, crossing.len())
    };
    let [before, after] = changed.self_intersections(faces);
    count((after, changed)) < count((before, place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifold::Manifold;
    use crate::pipeline::attempts::optimization::optimize;
    use crate::pipeline::density::Density;
    use crate::pipeline::options::Options;
    use crate::pipeline::sized::resizing::Resizing;
    use crate::spectral::candidates::candidates;
    use crate::spectral::curve_samples::sample_curves;
    use crate::spectral::scan::linear_scan;
    use crate::testing::{joined, moved, sphere};
    use crate::triangulate::{Boundary, triangulate};
    use glam::DVec3;

    /// Returns a mesh of 10,000 vertices after one of them was moved to a neighbour by this share of the way, the original
    /// place of the vertex, and the mended mesh.
    fn mended_after_moving(share: f64) -> (Finished, DVec3, Finished) {
        let input = joined([sphere(), moved(sphere(), 4.0 * DVec3::X)]);
        let options = Options::default();
        let (prepared, repaired) = PreparedInput::new(&input, &options, &()).unwrap();
        let mut surface =
            SizedSurface::new(&prepared, repaired, Density::Points(10_000), &Resizing::default(), &()).unwrap();
        let SizedSurface { domain, scale, .. } = &surface;
        let samples = linear_scan(domain, &candidates(domain, 20 * 10_000, 1), &[], scale.sigma(), 1, &()).unwrap();
        let curves = sample_curves(domain, scale.spacing);
        let boundary = Boundary { sites: &curves.sites, successor: &curves.successor, spikes: 0 };
        let mut manifold = triangulate(domain, &samples, boundary, scale.spacing, &()).unwrap().mesh;
        optimize(domain, &mut manifold, scale, None, &()).unwrap();
        assert_eq!(manifold.connectivity.vertex_count(), 10_000);
        let v = manifold
            .triangles()
            .map(|t| manifold.connectivity.triangle(3 * t)[0])
            .next()
            .expect("a mesh has triangles");
        let first = *manifold.sample(v);
        let neighbour = manifold.connectivity.ring(v).next().expect("a vertex has neighbours");
        manifold.place_at(v, manifold.position(neighbour).lerp(first.position, 1.0 - share));
        let broken = |manifold: Manifold| Finished::new(&prepared, &surface, manifold, 0, 1);
        let (before, broken) = (broken(manifold.clone()), broken(manifold));
        let made = mended(&prepared, &mut surface, broken, &()).unwrap();
        (before, first.position, made)
    }

    #[test]
    fn slivers_are_mended_and_what_is_far_from_them_stays() {
        let (before, place, made) = mended_after_moving(0.999);
        assert!(before.score.slivers > 0 && !before.score.other_topology, "{:?}", before.score);
        assert!(made.score == Score::SOUND && made.is_mended, "{:?}", made.score);
        assert_eq!(made.of_part.positions.len(), before.of_part.positions.len());
        let far = before.of_part.positions.iter().filter(|p| p.distance(place) > 0.05);
        let (staying, moved): (Vec<DVec3>, Vec<DVec3>) = far.copied().partition(|p| made.of_part.positions.contains(p));
        assert!(
            staying.len() > 20 * moved.len() && staying.len() > 5000,
            "{} stay, {} do not",
            staying.len(),
            moved.len()
        );
    }

    #[test]
    fn small_angles_are_mended_although_the_result_is_sound() {
        let (before, _, made) = mended_after_moving(0.8);
        assert!(before.score == Score::SOUND && small_angles(&before, MODEST) > 0);
        assert!(made.score == Score::SOUND && made.is_mended);
        assert_eq!([MODEST, GOOD].map(|aim| small_angles(&made, aim)), [0, 0]);
        assert_eq!(made.of_part.positions.len(), before.of_part.positions.len());
    }
}
