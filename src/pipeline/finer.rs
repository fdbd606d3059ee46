//! Where a result is made finer: around the places where it went wrong.
//!
//! Sheets that are nearer to each other than the edges are long, and narrow patches that were joined with others, are what
//! triangles intersect at. With edges half as long they mostly do not; the rest of the surface has as much longer edges as
//! keeps the number of vertices.

use crate::spatial::kdtree::Neighbors;
use crate::surface::domain::Domain;
use crate::surface::sizing::sizes_with_room;
use glam::DVec3;

/// How far around a place the surface is finer, in lengths of the edges there, and the share of the length that is left there
/// after each attempt.
const REACH: f64 = 1.0;
const FINER: f64 = 0.5;

/// Places where attempts went wrong, in the pipeline's unit.
#[derive(Default)]
pub(super) struct Finer {
    /// Those of each attempt.
    of_attempts: Vec<Neighbors>,
}

impl Finer {
    /// Adds the places of an attempt.
    pub(super) fn add(&mut self, places: &[DVec3]) {
        self.of_attempts.push(Neighbors::new(places));
    }

    /// Whether something went wrong near `p`.
    pub(super) fn is_near(&self, p: DVec3, spacing: f64) -> bool {
        self.times(p, spacing) > 0
    }

    /// The lengths of `domain`, relative to `spacing`, that are shorter where something went wrong; `None` if nothing did.
    pub(super) fn sizes(&self, domain: &Domain, spacing: f64) -> Option<Vec<f64>> {
        if self.of_attempts.is_empty() {
            return None;
        }
        let sizes = domain.sizes();
        let places = sizes.iter().zip(&domain.mesh.positions);
        let wanted: Vec<f64> = places.map(|(size, &p)| size * self.share(p, size * spacing)).collect();
        sizes_with_room(domain, &sizes, &wanted, spacing)
    }

    /// The share of that length, the one wanted at `p`, which is left there; elsewhere lengths may be anything.
    fn share(&self, p: DVec3, length: f64) -> f64 {
        match self.times(p, length) {
            0 => f64::INFINITY,
            times => (0..times).fold(1.0, |share, _| FINER * share),
        }
    }

    /// In how many attempts something went wrong near `p`, where edges are to have that length.
    fn times(&self, p: DVec3, length: f64) -> usize {
        let is_near = |places: &&Neighbors| !places.within(p, REACH * length).is_empty();
        self.of_attempts.iter().filter(is_near).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::sizing::mean_density;
    use crate::testing;

    #[test]
    fn edges_are_half_as_long_for_each_attempt_that_went_wrong_there() {
        let mut finer = Finer::default();
        assert!(!finer.is_near(DVec3::ZERO, 1.0));
        finer.add(&[DVec3::ZERO, 10.0 * DVec3::X]);
        finer.add(&[DVec3::ZERO]);
        let share = |x: f64| finer.share(x * DVec3::X, 1.0);
        assert_eq!([0.9, 1.1, 9.1].map(share), [0.25, f64::INFINITY, 0.5]);
        assert!(finer.is_near(0.9 * DVec3::Y, 1.0));
    }

    #[test]
    fn lengths_are_half_as_long_around_a_place_and_longer_elsewhere_by_as_much_as_keeps_the_number() {
        let domain = Domain::new(testing::sphere().try_into().unwrap());
        let spacing = 0.1;
        let mut finer = Finer::default();
        finer.add(&[domain.mesh.positions[0]]);
        let sizes = finer.sizes(&domain, spacing).unwrap();
        assert!((sizes[0] - 0.5).abs() < 1e-9, "{}", sizes[0]);
        let longest = sizes.iter().copied().fold(0.0, f64::max);
        assert!((1.001..1.1).contains(&longest), "{longest}");
        assert!((mean_density(&domain.mesh, &sizes) - 1.0).abs() < 0.01);
    }
}
