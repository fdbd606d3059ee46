//! Mends a result where it went wrong, in place: faces that cross and slivers are untangled, edges around those that are left and
//! around small angles become longer or shorter, and as many vertices as that gives or takes go elsewhere or come from there.
//!
//! Chance decides, at each place separately, whether samples at a thin wall are joined well. Drawing all of them again would lose
//! the good places along with the bad ones; here each place changes by itself, only if that makes it better, and the rest stays.
//!
//! Cost: for each round that of the places, and a search for self-intersections.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::base::parallel;
use crate::geom::triangle::smallest_angle;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::small_angles::{slivers, with_small_angles};
use crate::optimize::exchange::{balance_count, is_near};
use crate::optimize::resize::resize;
use crate::optimize::self_intersections::resolve_self_intersections;
use crate::optimize::untangle::untangle;
use crate::pipeline::attempts::Score;
use crate::pipeline::finished::Finished;
use crate::pipeline::optimization::fit_to_surface;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::sized::SizedSurface;
use glam::DVec3;

/// How many times as long edges become at places to mend, in turns: longer, so that they pass over folds that are finer than they
/// are, which takes few vertices from elsewhere, and shorter, so that triangles follow a thin wall.
const FACTORS: [f64; 4] = [2.0, 0.5, 4.0, 0.25];

/// The most rounds through all of them.
const MOST_ROUNDS: usize = 3;

/// The share of the triangles up to which they are untangled: of more, too many stay for the time that it takes.
const MOST_TO_UNTANGLE: f64 = 0.1;

/// Rings of triangles around those to mend that change with them.
const RINGS: usize = 6;

/// Angle in degrees that is small, unless it is forced. With 30, more vertices are needed at such places than the rest can spare.
const SMALL: f64 = 20.0;

/// Share of the triangles that have small angles to be looked at, the smallest first, and of the vertices that may come from elsewhere
/// or go there for their sake in a round: each leaves irregular ones.
const MOST_SMALL: f64 = 0.01;
const MOST_MOVED: f64 = 0.02;

/// How far the surface may move so that it is sound, and for the sake of angles, in wanted lengths. Longer edges would cut off ears.
const FARTHEST: f64 = 1.0;
const FARTHEST_FOR_ANGLES: f64 = 0.6;

/// What is mended.
#[derive(Debug, Clone, Copy)]
enum Aim {
    /// Faces that cross, and slivers.
    Sound,
    /// Small angles of a result that is sound.
    Angles,
}

impl Aim {
    /// The triangles to mend, by their number in the manifold.
    fn triangles(self, result: &Finished) -> Vec<u32> {
        let Finished { score, manifold, .. } = result;
        let is_sound = score.self_intersections == 0 && score.slivers == 0;
        match self {
            Aim::Sound if score.is_of_places(result.mesh.triangles.len()) => result.unsound_triangles(),
            Aim::Angles if is_sound => {
                let mut small = with_small_angles(manifold, SMALL);
                let angle = |t: u32| smallest_angle(manifold.corners(t));
                small.sort_by(|&t, &u| angle(t).total_cmp(&angle(u)).then(t.cmp(&u)));
                small.truncate((MOST_SMALL * result.of_part.triangles.len() as f64).ceil() as usize);
                small
            }
            _ => Vec::new(),
        }
    }

    /// How good a result is: less is better.
    fn rank(self, result: &Finished) -> (Score, usize) {
        let small = match self {
            Aim::Sound => 0,
            Aim::Angles => with_small_angles(&result.manifold, SMALL).len(),
        };
        (result.score, small)
    }

    /// How far the surface may move, in wanted lengths, and how many of so many vertices.
    fn limits(self, vertices: usize) -> (f64, usize) {
        match self {
            Aim::Sound => (FARTHEST, usize::MAX),
            Aim::Angles => (FARTHEST_FOR_ANGLES, (MOST_MOVED * vertices as f64) as usize),
        }
    }
}

/// The best of `finished` and what it becomes by mending. `surface` keeps the lengths.
pub(super) fn mended(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    finished: Finished,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    if !prepared.options.optimize || finished.score.other_topology {
        return Ok(finished);
    }
    let mut best = finished;
    // Where the distance has a limit, it counts more than angles.
    let aims = if prepared.limit().is_none() { &[Aim::Sound, Aim::Angles][..] } else { &[Aim::Sound] };
    for &aim in aims {
        let mut tried = Tried::default();
        for _ in 0..MOST_ROUNDS {
            best = untangled(prepared, surface, best, aim, monitor)?;
            let before = aim.rank(&best);
            if !aim.triangles(&best).is_empty() {
                monitor.stage("mend");
            }
            for factor in FACTORS {
                let triangles = aim.triangles(&best);
                if triangles.is_empty() {
                    break;
                }
                let sizes = surface.domain.sizes();
                match resized(prepared, surface, &best, (aim, factor), &triangles, &mut tried, monitor)? {
                    Some(next) if aim.rank(&next) < aim.rank(&best) => best = next,
                    _ => surface.domain.grade(sizes),
                }
            }
            if aim.rank(&best) >= before {
                break;
            }
        }
    }
    Ok(best)
}

/// `best` with more, fewer or other edges where it is unsound, if that is better.
fn untangled(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    best: Finished,
    aim: Aim,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    let found = best.unsound_triangles().len();
    let most = MOST_TO_UNTANGLE * best.of_part.triangles.len() as f64;
    if !matches!(aim, Aim::Sound) || found == 0 || found as f64 > most {
        return Ok(best);
    }
    monitor.stage("untangle");
    let SizedSurface { domain, scale, .. } = surface;
    let mut manifold = best.manifold.clone();
    let wanted = manifold.connectivity.vertex_count();
    untangle(domain, &mut manifold, scale.spacing, monitor)?;
    balance_count(domain, &mut manifold, wanted, scale.spacing, monitor)?;
    let next = Finished::new(prepared, surface, manifold, best.tessellated_patches, best.run);
    let next = Finished { is_mended: true, ..next };
    Ok(if aim.rank(&next) < aim.rank(&best) { next } else { best })
}

/// The factors that did not help at a place, which is known by the triangles to mend there.
#[derive(Default)]
struct Tried(Vec<(f64, Vec<[DVec3; 3]>)>);

/// `best` with edges `factor` times as long around these `triangles`, where that is better; `None` if it is nowhere. Places where
/// it did not help before are left alone.
fn resized(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    best: &Finished,
    (aim, factor): (Aim, f64),
    triangles: &[u32],
    Tried(tried): &mut Tried,
    monitor: &dyn Monitor,
) -> Result<Option<Finished>> {
    let corners =
        |triangles: &[u32]| -> Vec<DVec3> { triangles.iter().flat_map(|&t| best.manifold.corners(t)).collect() };
    let sizes = surface.domain.sizes();
    if !surface.resize_at(&corners(triangles), factor) {
        return Ok(None);
    }
    let faces = Faces::new(&best.manifold);
    let pairs = faces.self_intersecting_pairs_of(triangles).into_iter().map(|(t, u)| [t, u]);
    let groups: Vec<[u32; 2]> = pairs.chain(triangles.iter().map(|&t| [t, t])).collect();
    let of_place = |place: &Neighborhood| {
        let inside = triangles.iter().filter(|&&t| place.has_triangle(t));
        (factor, inside.map(|&t| best.manifold.corners(t)).collect())
    };
    let mut places = Neighborhood::around_groups(&best.manifold, &groups, RINGS);
    places.retain(|place| !tried.contains(&of_place(place)));
    let wanted = best.manifold.connectivity.vertex_count();
    let (farthest, mut may_move) = aim.limits(wanted);
    let better = parallel::each(&places, |place| {
        let changed = changed(surface, place, prepared.limit(), monitor)?;
        let is_better = has_fewer_faults(surface, &changed, place, &faces);
        let stays = || is_near(&place.mesh, &changed.mesh, farthest * surface.scale.spacing);
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
        let [before, after] = [place, &better].map(|place| place.mesh.connectivity.vertex_count());
        let moved = before.abs_diff(after);
        if moved <= may_move && better.put_back(&mut manifold, &mut touched) {
            may_move -= moved;
            changed.extend(triangles.iter().copied().filter(|&t| place.has_triangle(t)));
        }
    }
    surface.domain.grade(sizes);
    if changed.is_empty() {
        return Ok(None);
    }
    surface.resize_at(&corners(&changed), factor);
    balance_count(&surface.domain, &mut manifold, wanted, surface.scale.spacing, monitor)?;
    let next = Finished::new(prepared, surface, manifold, best.tessellated_patches, best.run);
    Ok(Some(Finished { is_mended: true, ..next }))
}

/// `place` with edges of the lengths that are wanted now, on the surface.
fn changed(
    surface: &SizedSurface,
    place: &Neighborhood,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Neighborhood> {
    let SizedSurface { domain, scale, .. } = surface;
    let mut changed = place.clone();
    resize(domain, &mut changed.mesh, scale.spacing, monitor)?;
    // What was relaxed lies on the surface, of which its triangles are on the inner side.
    fit_to_surface(domain, &mut changed.mesh, Vec::new(), scale.spacing, limit, monitor)?;
    resolve_self_intersections(domain, &mut changed.mesh, monitor)?;
    Ok(changed)
}

/// Whether what `place` was `changed` to has fewer faults among these `faces`: faces that cross where the surface does not, and
/// slivers; small angles; all faces that cross.
fn has_fewer_faults(surface: &SizedSurface, changed: &Neighborhood, place: &Neighborhood, faces: &Faces) -> bool {
    let inherited = surface.domain.inherited();
    let count = |(crossing, place): (Vec<[DVec3; 3]>, &Neighborhood)| {
        let new = crossing.iter().filter(|&&corners| !inherited.is_near(corners)).count();
        let small = with_small_angles(&place.mesh, SMALL).len();
        (new + slivers(&place.mesh).len(), small, crossing.len())
    };
    let [before, after] = changed.self_intersections(faces);
    count((after, changed)) < count((before, place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifold::Manifold;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::pipeline::density::Density;
    use crate::pipeline::optimization::optimize;
    use crate::pipeline::options::Options;
    use crate::pipeline::resizing::Resizing;
    use crate::spectral::candidates::candidates;
    use crate::spectral::curve_samples::sample_curves;
    use crate::spectral::scan::linear_scan;
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

    /// What a mesh of 10,000 vertices becomes by mending after one of them was moved to a neighbour, up to this share of the way: that
    /// before, the place, and the mesh mended.
    fn mended_after_moving(share: f64) -> (Finished, DVec3, Finished) {
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
        assert_eq!(manifold.connectivity.vertex_count(), 10_000);
        let v = manifold
            .triangles()
            .map(|t| manifold.connectivity.triangle(3 * t)[0])
            .next()
            .expect("a mesh has triangles");
        let first = manifold.samples[v as usize];
        let neighbour = manifold.connectivity.ring(v).next().expect("a vertex has neighbours");
        manifold.samples[v as usize].position = manifold.position(neighbour).lerp(first.position, 1.0 - share);
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
        let smallest = |result: &Finished| with_small_angles(&result.manifold, SMALL).len();
        assert!(before.score == Score::SOUND && smallest(&before) > 0);
        assert!(made.score == Score::SOUND && made.is_mended && smallest(&made) == 0);
        assert_eq!(made.of_part.positions.len(), before.of_part.positions.len());
    }
}
