//! Other samples where a triangulation of the first ones intersects itself, and the same ones elsewhere.
//!
//! Chance decides, at each place separately, whether the samples of the two sides of a thin wall are joined. Drawing all of them
//! again would lose the good places along with the bad ones.
//!
//! Cost: that of the candidates, and of a scan of those around the places.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::geom::triangle::longest_side;
use crate::pipeline::scale::CANDIDATES_PER_POINT;
use crate::pipeline::sized::SizedSurface;
use crate::spectral::candidates::candidates;
use crate::spectral::scan::linear_scan;
use crate::surface::domain::Sample;
use glam::DVec3;

/// How far around a triangle that intersects another one samples are drawn anew, in lengths of its longest side.
const AROUND: f64 = 3.0;

/// `samples` with others around the triangles `crossing`, given by their corners; the first ones, those on curves and at
/// ends of spikes, are `fixed`.
pub(super) fn drawn_anew_around(
    crossing: &[[DVec3; 3]],
    samples: &[Sample],
    fixed: usize,
    surface: &SizedSurface,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Vec<Sample>> {
    let SizedSurface { domain, scale, .. } = surface;
    let mut anew = vec![false; domain.mesh.triangles.len()];
    for corners in crossing {
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let near = domain.triangles_near(middle, AROUND * longest_side(*corners));
        near.into_iter().for_each(|t| anew[t as usize] = true);
    }
    let mut candidates = candidates(domain, CANDIDATES_PER_POINT * scale.wanted, seed);
    candidates.retain(|candidate| anew[candidate.triangle as usize]);
    let (stay_all, others) = samples.split_at(fixed);
    let stay = others.iter().filter(|sample| !anew[sample.triangle as usize]);
    let fixed: Vec<Sample> = stay_all.iter().chain(stay).copied().collect();
    linear_scan(domain, &candidates, &fixed, scale.sigma(), seed, monitor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::density::Density;
    use crate::pipeline::options::Options;
    use crate::pipeline::prepared::PreparedInput;
    use crate::pipeline::resizing::Resizing;
    use crate::testing;

    #[test]
    fn samples_are_others_around_the_place_and_the_same_elsewhere() {
        let input = testing::sphere();
        let options = Options::default();
        let (prepared, repaired) = PreparedInput::new(&input, &options, &()).unwrap();
        let surface = SizedSurface::new(&prepared, repaired, Density::Points(500), &Resizing::default(), &()).unwrap();
        let SizedSurface { domain, scale, .. } = &surface;
        let first = linear_scan(domain, &candidates(domain, 20 * 500, 1), &[], scale.sigma(), 1, &()).unwrap();

        let place = first[7].position;
        let crossing = [[DVec3::ZERO, DVec3::X, DVec3::Y].map(|offset| place + scale.spacing * offset)];
        let second = drawn_anew_around(&crossing, &first, 10, &surface, 2, &()).unwrap();
        assert!(first[..10] == second[..10], "those on curves stay");
        let is_near = |sample: &&Sample| sample.position.distance(place) < 2.0 * scale.spacing;
        let is_far = |sample: &&Sample| sample.position.distance(place) > 8.0 * scale.spacing;
        let far = |samples: &[Sample]| samples[10..].iter().filter(is_far).count();
        assert!(far(&first) > 100 && far(&first) == far(&second));
        assert!(first.iter().filter(is_far).all(|sample| second.contains(sample)));
        let near = |samples: &[Sample]| samples[10..].iter().filter(is_near).count();
        assert!(near(&first) > 5 && near(&first).abs_diff(near(&second)) < 4);
        assert!(!first[10..].iter().filter(is_near).any(|sample| second.contains(sample)));
    }
}
