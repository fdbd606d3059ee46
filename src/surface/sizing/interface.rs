//! Edge lengths that change gradually from those of an interface to the target edge lengths.
//!
//! A part cut out of a mesh keeps the edges of its interface. Where their length l(s) at a vertex s differs from the target
//! edge length h, the length at a vertex v at a distance d(s) from s is
//!
//! ```text
//! min( min over s of l(s) + g d(s),  max( h(v),  max over s of l(s) - g d(s) ) )
//! ```
//!
//! so lengths change by at most g per unit of distance until they reach their targets. If a number of vertices is given, h
//! is scaled to meet it; 2 / (√3 h²) integrates to it. If no scale of h meets it, g is doubled. Without a given number, g is
//! doubled if the target lengths are too short to be reached on more than a small part of the surface.
//!
//! Based on: P.-O. Persson, Mesh size functions for implicit geometries and PDE-based gradient limiting, 2006,
//! DOI 10.1007/s00366-006-0014-1. Departure: it also limits from below.
//!
//! Cost: two passes of Dijkstra's algorithm for each gradient tried, and a few sums over the triangles.

use crate::surface::domain::Domain;
use crate::surface::sizing::field::{FIELD_GRADIENT, mean_density};
use crate::surface::sizing::gradation::limited;
use crate::surface::sizing::graph::Graph;

/// Steepest gradient to try: a steeper one leaves no transition. Given lengths are used with it; a number of vertices that
/// it does not allow either is met without a transition.
const STEEPEST: f64 = 4.0;

/// Minimum share of the vertices implied by the target lengths that must remain beside an interface of longer edges.
const LEAST_LEFT: f64 = 0.5;

/// Largest factor by which the target lengths are scaled, up or down, and number of steps of the search for the right one.
const LARGEST_FACTOR: f64 = 1e3;
const STEPS: usize = 50;

/// Returns the length at each vertex of `domain`, in its units: that of `wanted` away from the interface, scaled to `count`
/// vertices if that is given.
pub fn lengths_from_interface(domain: &Domain, wanted: &[f64], count: Option<f64>) -> Vec<f64> {
    let own = interface_lengths(domain);
    let graph = Graph::whole(domain);
    let mut gradient = FIELD_GRADIENT;
    while gradient <= STEEPEST {
        let bounds = Bounds::new(domain, &graph, &own, gradient);
        let meant = |factor: f64| vertices(domain, &bounds.lengths(wanted, factor));
        match count {
            Some(count) if meant(LARGEST_FACTOR) <= count && count <= meant(1.0 / LARGEST_FACTOR) => {
                return scaled_to(count, domain, |factor| bounds.lengths(wanted, factor));
            }
            None if meant(1.0) >= LEAST_LEFT * vertices(domain, wanted) || 2.0 * gradient > STEEPEST => {
                return bounds.lengths(wanted, 1.0);
            }
            _ => gradient *= 2.0,
        }
    }
    let even = |factor: f64| wanted.iter().map(|length| factor * length).collect();
    count.map_or_else(|| even(1.0), |count| scaled_to(count, domain, even))
}

/// Number of vertices that edges of these lengths imply.
pub fn vertices(domain: &Domain, lengths: &[f64]) -> f64 {
    2.0 / 3f64.sqrt() * domain.mesh.area() * mean_density(&domain.mesh, lengths)
}

/// Returns the lengths for the factor with which they imply `count` vertices.
fn scaled_to(count: f64, domain: &Domain, lengths: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let (mut least, mut most) = (1.0 / LARGEST_FACTOR, LARGEST_FACTOR);
    for _ in 0..STEPS {
        let middle = f64::sqrt(least * most);
        if vertices(domain, &lengths(middle)) > count { least = middle } else { most = middle }
    }
    lengths(most)
}

/// For each vertex on the interface, the mean length of the interface edges there.
fn interface_lengths(domain: &Domain) -> Vec<Option<f64>> {
    let mut sums = vec![(0.0, 0); domain.mesh.positions.len()];
    for curve in domain.curves.list.iter().filter(|curve| curve.interface) {
        let length: f64 = curve.sides.iter().map(|&s| domain.mesh.segment(s)).map(|[p, q]| p.distance(q)).sum();
        for v in curve.sides.iter().flat_map(|&s| domain.mesh.ends(s)) {
            let (sum, count) = &mut sums[domain.original[v as usize] as usize];
            *sum += length;
            *count += 1;
        }
    }
    sums.into_iter().map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect()
}

/// Bounds on the length at each vertex, due to the interface.
struct Bounds {
    least: Vec<f64>,
    most: Vec<f64>,
}

impl Bounds {
    fn new(domain: &Domain, graph: &Graph, own: &[Option<f64>], gradient: f64) -> Bounds {
        let longest = own.iter().flatten().copied().fold(0.0, f64::max);
        let limited = |of_length: &dyn Fn(f64) -> f64| {
            limited(domain, graph, own.iter().map(|l| l.map_or(f64::INFINITY, of_length)).collect(), gradient)
        };
        let most = limited(&|length| length);
        let least = limited(&|length| longest - length).into_iter().map(|below| longest - below).collect();
        Bounds { least, most }
    }

    /// Returns the `wanted` lengths times `factor`, clamped to the bounds.
    fn lengths(&self, wanted: &[f64], factor: f64) -> Vec<f64> {
        let bounds = self.least.iter().zip(&self.most);
        wanted.iter().zip(bounds).map(|(length, (&least, &most))| (factor * length).max(least).min(most)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::features::Features;
    use crate::testing::grid;
    use glam::DVec3;

    /// A band of 200 by 4 squares of side 0.01, cut out along its left end.
    fn band() -> Domain {
        let mesh = grid(200, 4, |u, v| DVec3::new(2.0 * u, 0.04 * v, 0.0));
        Domain::with_interface(mesh.try_into().unwrap(), Features::Smooth, 0.1, vec![[1, 0], [2, 1], [3, 2], [4, 3]])
    }

    #[test]
    fn lengths_change_from_those_of_the_interface_to_the_wanted_ones() {
        let domain = band();
        assert_eq!(domain.curves.list.iter().filter(|curve| curve.interface).count(), 4);
        for wanted in [0.1, 0.001] {
            let lengths = lengths_from_interface(&domain, &vec![wanted; domain.mesh.positions.len()], None);
            for (p, length) in domain.mesh.positions.iter().zip(&lengths) {
                let should_be = if wanted > 0.01 {
                    (0.01 + FIELD_GRADIENT * p.x).min(wanted)
                } else {
                    (0.01 - FIELD_GRADIENT * p.x).max(wanted)
                };
                assert!((length - should_be).abs() < 2e-3, "{p}: {length}, not {should_be}");
            }
            assert_eq!(lengths[1], 0.01);
            assert_eq!(lengths[1003], wanted);
        }
    }

    #[test]
    fn a_seam_of_long_edges_does_not_have_it_all() {
        let mut domain = band();
        domain.mesh.positions.iter_mut().for_each(|p| p.y *= 40.0);
        let wanted = vec![0.01; domain.mesh.positions.len()];
        let lengths = lengths_from_interface(&domain, &wanted, None);
        assert!(lengths[1] > 0.39, "{}", lengths[1]);
        assert!(vertices(&domain, &lengths) > 0.5 * vertices(&domain, &wanted));
    }

    #[test]
    fn as_many_vertices_as_wanted_are_meant() {
        let domain = band();
        for count in [10.0, 200.0, 5000.0, 1e5] {
            let lengths = lengths_from_interface(&domain, &vec![0.03; domain.mesh.positions.len()], Some(count));
            assert!((vertices(&domain, &lengths) / count - 1.0).abs() < 1e-6);
        }
    }
}
