//! Places where a result gets longer or shorter edges than the previous one.
//!
//! Triangles intersect where sheets are closer together than the edges are long, and where narrow patches were joined with
//! others. Halving the edges usually helps; the rest of the surface gets longer edges, so that the number of vertices stays.
//! Where the surface has finer folds, edges that pass over them help.

use crate::base::parallel;
use crate::spatial::kdtree::Neighbors;
use crate::surface::domain::Domain;
use crate::surface::sizing::sizes_with_room;
use glam::DVec3;

/// Distance from a place within which the surface becomes finer, in edge lengths, and the factor of the edge length per
/// attempt.
const REACH: f64 = 1.0;
pub(in crate::pipeline) const FINER: f64 = 0.5;

/// Places where the edge lengths change, in the pipeline's unit.
#[derive(Default)]
pub(in crate::pipeline) struct Resizing {
    /// Places where attempts failed, one set per attempt: edges become shorter there.
    unsound: Vec<Neighbors>,
}

impl Resizing {
    /// Shortens edges at the places where an attempt failed.
    pub(in crate::pipeline) fn shorten_at(&mut self, places: &[DVec3]) {
        self.unsound.push(Neighbors::new(places));
    }

    /// Returns whether an attempt failed near `p`.
    pub(in crate::pipeline) fn is_near(&self, p: DVec3, spacing: f64) -> bool {
        self.times(p, spacing) > 0
    }

    /// Returns the lengths of `domain`, relative to `spacing`, shortened where attempts failed; `None` if there are no such
    /// places or there is no room.
    pub(in crate::pipeline) fn shorter(&self, domain: &Domain, spacing: f64) -> Option<Vec<f64>> {
        if self.unsound.is_empty() {
            return None;
        }
        shorter_by(domain, spacing, |p, length| self.share(p, length))
    }

    /// Returns the factor of the target length at `p`, which is `length`; infinite where the length is free.
    fn share(&self, p: DVec3, length: f64) -> f64 {
        match self.times(p, length) {
            0 => f64::INFINITY,
            times => (0..times).fold(1.0, |share, _| FINER * share),
        }
    }

    /// Returns the number of attempts that failed near `p`, where the target length is `length`.
    fn times(&self, p: DVec3, length: f64) -> usize {
        let is_near = |places: &&Neighbors| places.has_within(p, REACH * length);
        self.unsound.iter().filter(is_near).count()
    }
}

/// Returns the lengths of `domain`, relative to `spacing`, multiplied by `factor` around `places`; `None` if there is no
/// room for shorter ones.
pub(in crate::pipeline) fn sizes_at(places: &[DVec3], factor: f64, domain: &Domain, spacing: f64) -> Option<Vec<f64>> {
    let places = Neighbors::new(places);
    if factor > 1.0 {
        return Some(longer_at(&places, factor, domain, spacing));
    }
    let is_near = |p: DVec3, length: f64| places.has_within(p, REACH * length);
    shorter_by(domain, spacing, |p, length| if is_near(p, length) { factor } else { f64::INFINITY })
}

/// Returns the lengths of `domain`, multiplied by `factor` within one length of `places`, fading out up to two lengths.
fn longer_at(places: &Neighbors, factor: f64, domain: &Domain, spacing: f64) -> Vec<f64> {
    let longer = |size: f64, p: DVec3| {
        let length = size * spacing;
        let mut nearest = Vec::new();
        places.collect_nearest_within(p, 1, 2.0 * length, &mut nearest);
        let share = nearest.first().map_or(0.0, |n| (2.0 - n.distance_squared.sqrt() / length).min(1.0));
        size * (1.0 + (factor - 1.0) * share)
    };
    domain.sizes().into_iter().zip(&domain.mesh.positions).map(|(size, &p)| longer(size, p)).collect()
}

/// Returns the lengths of `domain` shortened by `share`, a function of position and target length; lengths elsewhere
/// compensate for the number of vertices.
fn shorter_by(domain: &Domain, spacing: f64, share: impl Fn(DVec3, f64) -> f64 + Sync) -> Option<Vec<f64>> {
    let sizes = domain.sizes();
    let at_vertex = |v: usize| sizes[v] * share(domain.mesh.positions[v], sizes[v] * spacing);
    let wanted = parallel::map(0..sizes.len(), at_vertex);
    sizes_with_room(domain, &sizes, &wanted, spacing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::sizing::mean_density;
    use crate::testing;

    #[test]
    fn edges_are_half_as_long_for_each_attempt_that_went_wrong_there() {
        let mut resizing = Resizing::default();
        assert!(!resizing.is_near(DVec3::ZERO, 1.0));
        resizing.shorten_at(&[DVec3::ZERO, 10.0 * DVec3::X]);
        resizing.shorten_at(&[DVec3::ZERO]);
        let share = |x: f64| resizing.share(x * DVec3::X, 1.0);
        assert_eq!([0.9, 1.1, 9.1].map(share), [0.25, f64::INFINITY, 0.5]);
        assert!(resizing.is_near(0.9 * DVec3::Y, 1.0));
    }

    #[test]
    fn lengths_are_half_as_long_around_a_place_and_longer_elsewhere_by_as_much_as_keeps_the_number() {
        let domain = Domain::new(testing::sphere().try_into().unwrap());
        let spacing = 0.1;
        let mut resizing = Resizing::default();
        resizing.shorten_at(&[domain.mesh.positions[0]]);
        let sizes = resizing.shorter(&domain, spacing).unwrap();
        assert!((sizes[0] - 0.5).abs() < 1e-9, "{}", sizes[0]);
        let longest = sizes.iter().copied().fold(0.0, f64::max);
        assert!((1.001..1.1).contains(&longest), "{longest}");
        assert!((mean_density(&domain.mesh, &sizes) - 1.0).abs() < 0.01);
    }

    #[test]
    fn lengths_are_longer_around_a_place_and_the_same_elsewhere() {
        let domain = Domain::new(testing::sphere().try_into().unwrap());
        let (spacing, place) = (0.1, domain.mesh.positions[0]);
        let sizes = sizes_at(&[place], 1.32, &domain, spacing).unwrap();
        assert!((sizes[0] - 1.32).abs() < 1e-12, "{}", sizes[0]);
        let is_far = |p: &DVec3| p.distance(place) > 2.0 * spacing;
        assert!(domain.mesh.positions.iter().zip(&sizes).all(|(p, &size)| !is_far(p) || size == 1.0));
    }
}
