//! Mends a result where it went wrong, in place: edges around faces that cross and around slivers become shorter or longer, and
//! as many vertices as that takes or gives come from elsewhere or go there.
//!
//! Chance decides, at each place separately, whether samples at a thin wall are joined well. Drawing all of them again would lose
//! the good places along with the bad ones; here each place changes by itself, only if that makes it better, and the rest stays.
//!
//! Cost: for each round that of the places, and a search for self-intersections.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::base::parallel;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::optimize::exchange::balance_count;
use crate::optimize::resize::resize;
use crate::optimize::self_intersections::resolve_self_intersections;
use crate::pipeline::finished::Finished;
use crate::pipeline::optimization::fit_to_surface;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::sized::SizedSurface;
use crate::pipeline::slivers::slivers;
use glam::DVec3;

/// The most rounds.
const MOST_ROUNDS: usize = 3 * FACTORS.len();

/// Rings of triangles around unsound ones that change with them.
const RINGS: usize = 6;

/// How many times as long edges become at unsound places, in turns: longer, so that they pass over folds that are finer than they
/// are, which takes few vertices from elsewhere, and shorter, so that triangles follow a thin wall.
const FACTORS: [f64; 4] = [2.0, 0.5, 4.0, 0.25];

/// The best of `finished` and what it becomes by mending, if it is unsound at single places. `surface` keeps the lengths.
pub(super) fn mended(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    finished: Finished,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    let mut best = finished;
    let mut failures = 0;
    for (round, &factor) in FACTORS.iter().cycle().enumerate().take(MOST_ROUNDS) {
        let is_mendable = !best.score.other_topology && best.score.is_of_places(best.mesh.triangles.len());
        if !prepared.options.optimize || !is_mendable || failures == FACTORS.len() {
            break;
        }
        if round == 0 {
            monitor.stage("mend");
        }
        let sizes = surface.domain.sizes();
        let next = resized(prepared, surface, &best, factor, monitor)?;
        match next {
            Some(next) if next.score < best.score => (best, failures) = (next, 0),
            _ => {
                surface.domain.grade(sizes);
                failures += 1;
            }
        }
    }
    Ok(best)
}

/// `best` with edges of other lengths around its unsound places, those that are better so; `None` if none is.
fn resized(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    best: &Finished,
    factor: f64,
    monitor: &dyn Monitor,
) -> Result<Option<Finished>> {
    let unsound = best.unsound_triangles();
    let corners =
        |triangles: &[u32]| -> Vec<DVec3> { triangles.iter().flat_map(|&t| best.manifold.corners(t)).collect() };
    let sizes = surface.domain.sizes();
    if !surface.resize_at(&corners(&unsound), factor) {
        return Ok(None);
    }
    let faces = Faces::new(&best.manifold);
    let pairs = faces.self_intersecting_pairs_of(&unsound).into_iter().map(|(t, u)| [t, u]);
    let groups: Vec<[u32; 2]> = pairs.chain(unsound.iter().map(|&t| [t, t])).collect();
    let places = Neighborhood::around_groups(&best.manifold, &groups, RINGS);
    let limit = prepared.limit();
    let better = parallel::each(&places, |place| better(surface, place, &faces, limit, monitor));
    let mut manifold = best.manifold.clone();
    let mut touched = vec![false; manifold.connectivity.half_edge_bound() as usize / 3];
    let mut changed = Vec::new();
    for (place, better) in places.iter().zip(better) {
        if better?.is_some_and(|better| better.put_back(&mut manifold, &mut touched)) {
            changed.extend(unsound.iter().copied().filter(|&t| place.has_triangle(t)));
        }
    }
    surface.domain.grade(sizes);
    if changed.is_empty() {
        return Ok(None);
    }
    surface.resize_at(&corners(&changed), factor);
    let wanted = best.manifold.connectivity.vertex_count();
    balance_count(&surface.domain, &mut manifold, wanted, surface.scale.spacing, monitor)?;
    let next = Finished::new(prepared, surface, manifold, best.tessellated_patches, best.run);
    Ok(Some(Finished { is_mended: true, ..next }))
}

/// `place` with edges of the lengths that are wanted now, if it is better so among these `faces`.
fn better(
    surface: &SizedSurface,
    place: &Neighborhood,
    faces: &Faces,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Option<Neighborhood>> {
    let SizedSurface { domain, scale, .. } = surface;
    let mut changed = place.clone();
    resize(domain, &mut changed.mesh, scale.spacing, monitor)?;
    // What was relaxed lies on the surface, of which its triangles are on the inner side.
    fit_to_surface(domain, &mut changed.mesh, Vec::new(), scale.spacing, limit, monitor)?;
    resolve_self_intersections(domain, &mut changed.mesh, monitor)?;
    let faults = |(crossing, place): (Vec<[DVec3; 3]>, &Neighborhood)| {
        let new = crossing.iter().filter(|&&corners| !domain.inherited().is_near(corners)).count();
        (new + slivers(&place.mesh).len(), crossing.len())
    };
    let [before, after] = changed.self_intersections(faces);
    let [before, after] = [(before, place), (after, &changed)].map(faults);
    Ok((after < before).then_some(changed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::pipeline::attempts::Score;
    use crate::pipeline::density::Density;
    use crate::pipeline::optimization::optimize;
    use crate::pipeline::options::Options;
    use crate::pipeline::resizing::Resizing;
    use crate::spectral::candidates::candidates;
    use crate::spectral::curve_samples::sample_curves;
    use crate::spectral::scan::linear_scan;
    use crate::surface::domain::Sample;
    use crate::testing;
    use crate::triangulate::{Boundary, triangulate};
    use glam::{DVec3, dvec3};

    /// Two spheres beside each other.
    fn spheres() -> Mesh {
        let one = testing::sphere();
        let count = one.positions.len() as u32;
        let moved = one.positions.iter().map(|&p| p + dvec3(4.0, 0.0, 0.0));
        let triangles = one.triangles.iter().map(|t| t.map(|v| v + count));
        Mesh {
            positions: one.positions.iter().copied().chain(moved).collect(),
            triangles: one.triangles.iter().copied().chain(triangles).collect(),
        }
    }

    #[test]
    fn slivers_are_mended_and_what_is_far_from_them_stays() {
        let input = spheres();
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
        let spacing = scale.spacing;
        let wanted = scale.wanted;
        // Onto a neighbour, all but.
        let v = manifold
            .triangles()
            .map(|t| manifold.connectivity.triangle(3 * t)[0])
            .next()
            .expect("a mesh has triangles");
        let first = manifold.samples[v as usize];
        let neighbour = manifold.connectivity.ring(v).next().expect("a vertex has neighbours");
        manifold.samples[v as usize].position = manifold.position(neighbour).lerp(first.position, 1e-3);
        let before = manifold.clone();
        let broken = Finished::new(&prepared, &surface, manifold, 0, 1);
        assert!(broken.score.slivers > 0 && !broken.score.other_topology, "{:?}", broken.score);
        let made = mended(&prepared, &mut surface, broken, &()).unwrap();
        assert!(made.score == Score::SOUND && made.is_mended, "{:?}", made.score);
        assert!(made.manifold.connectivity.vertex_count().abs_diff(wanted) < 30);
        let is_far = |p: DVec3| p.distance(first.position) > 12.0 * spacing;
        let far: Vec<_> = before.samples.iter().filter(|s| is_far(s.position)).collect();
        let stays = |s: &&&Sample| made.of_part.positions.contains(&s.position);
        assert!(far.len() > 100);
        let staying = far.iter().filter(stays).count();
        assert!(staying > far.len() / 2, "{staying} of {}", far.len());
    }
}
