//! Mends a result where it went wrong, in place: edges around faces that cross and around slivers become shorter, and those
//! elsewhere as much longer as keeps the number of vertices.
//!
//! Chance decides, at each place separately, whether samples at a thin wall are joined well. Drawing all of them again would lose
//! the good places along with the bad ones; here they stay.
//!
//! Cost: about a third of what the result took, for each round: most of it is the fit to the surface, which is that of the whole.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::optimize::resize::follow_shorter_lengths;
use crate::optimize::self_intersections::resolve_self_intersections;
use crate::pipeline::finished::Finished;
use crate::pipeline::optimization::fit_to_surface;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::sized::SizedSurface;

/// The most rounds, each of which halves the edges at places that are still unsound, and how many in a row may fail.
const MOST_ROUNDS: usize = 4;
const MOST_FAILURES: usize = 2;

/// The best of `finished` and what it becomes by mending, if it is unsound at single places. `surface` keeps the shorter lengths.
pub(super) fn mended(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    finished: Finished,
    monitor: &dyn Monitor,
) -> Result<Finished> {
    let mut best = finished;
    let mut failures = 0;
    for round in 0..MOST_ROUNDS {
        let is_mendable = !best.score.other_topology && best.score.is_of_places(best.mesh.triangles.len());
        if !prepared.options.optimize || !is_mendable || failures == MOST_FAILURES {
            break;
        }
        if round == 0 {
            monitor.stage("mend");
        }
        let Some(next) = finer(prepared, surface, &best, monitor)? else { break };
        if next.score < best.score {
            (best, failures) = (next, 0);
        } else {
            failures += 1;
        }
    }
    Ok(best)
}

/// `best` with shorter edges around its unsound places; `None` if there is no room for them.
fn finer(
    prepared: &PreparedInput,
    surface: &mut SizedSurface,
    best: &Finished,
    monitor: &dyn Monitor,
) -> Result<Option<Finished>> {
    if !surface.refine_at(&best.unsound_places()) {
        return Ok(None);
    }
    let scale = &surface.scale;
    let mut manifold = best.manifold.clone();
    let still = follow_shorter_lengths(&surface.domain, &mut manifold, scale.wanted, scale.spacing, monitor)?;
    // What was relaxed lies on the surface, of which its triangles are on the inner side.
    fit_to_surface(&surface.domain, &mut manifold, &still, scale.spacing, prepared.limit(), monitor)?;
    resolve_self_intersections(&surface.domain, &mut manifold, monitor)?;
    let next = Finished::new(prepared, surface, manifold, best.tessellated_patches, best.run);
    Ok(Some(Finished { is_mended: true, ..next }))
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
