//! Makes room for places that need shorter edges than the rest: lengths grow from there with a bounded gradient, and the
//! lengths elsewhere grow so that the number of vertices stays the same. Where the vertices do not suffice, no length is
//! less than a certain share of that elsewhere: the smallest share for which they suffice.
//!
//! Cost: a few passes of Dijkstra's algorithm.

use crate::surface::domain::Domain;
use crate::surface::sizing::field::mean_density;
use crate::surface::sizing::gradation::limited;
use crate::surface::sizing::graph::Graph;

/// Largest gradient of the length. For nine CAD parts, 0.2 gives worse triangles, and 0.1 needs too many vertices.
pub(super) const GRADIENT: f64 = 0.12;

/// Shortest length, as a share of that elsewhere, if `MOST_DENSE` allows it; and number of bisection steps to find the
/// shortest length above it that is allowed.
const SHORTEST: f64 = 0.125;
const HALVINGS: usize = 6;

/// Largest such share that is an improvement.
const LARGEST_SHARE: f64 = 0.8;

/// Largest mean of 1 / h², relative to the length elsewhere: nearly a quarter of the vertices may go to such places. On
/// sixty files of the kind that people have, more vertices cost the rest more than such places gain.
const MOST_DENSE: f64 = 1.3;

/// The same limit for the narrowest places. Beyond it, they are left out.
const MOST_DENSE_OF_NARROWEST: f64 = 1.5;

/// Maximum number of alternations between limiting and scaling, and the error of the mean length at which they stop.
const MOST_TURNS: usize = 20;
const MEAN_TOLERANCE: f64 = 1e-3;

/// Returns whether there is room for the `wanted` lengths, relative to `spacing`, or for `shortest` where that is longer.
pub(super) fn has_room(domain: &Domain, wanted: &[f64], shortest: f64, spacing: f64) -> bool {
    let even = vec![1.0; wanted.len()];
    if wanted.iter().all(|&wanted| wanted >= 1.0) {
        return true;
    }
    let lengths = Lengths::new(domain, &even, wanted, spacing);
    lengths.density(&lengths.graded(shortest, 1.0)) <= MOST_DENSE_OF_NARROWEST
}

/// Returns `sizes`, relative to `spacing`, reduced to the `wanted` ones where these are smaller, and increased elsewhere so
/// that the number of vertices stays the same. `None` if no wanted size is smaller, or there is no room.
pub fn sizes_with_room(domain: &Domain, sizes: &[f64], wanted: &[f64], spacing: f64) -> Option<Vec<f64>> {
    if wanted.iter().zip(sizes).all(|(wanted, size)| wanted >= size) {
        return None;
    }
    let lengths = Lengths::new(domain, sizes, wanted, spacing);
    let shortest = lengths.shortest()?;
    let mut factor = 1.0;
    let mut made = lengths.graded(shortest, factor);
    for _ in 0..MOST_TURNS {
        let excess = lengths.density(&made).sqrt();
        if (excess - 1.0).abs() <= MEAN_TOLERANCE {
            break;
        }
        factor *= excess;
        made = lengths.graded(shortest, factor);
    }
    Some(made)
}

/// The current and the wanted lengths on a domain.
struct Lengths<'a> {
    domain: &'a Domain,
    graph: Graph,
    sizes: &'a [f64],
    wanted: &'a [f64],
    /// Mean of 1 / h² over the domain.
    density: f64,
    spacing: f64,
}

impl<'a> Lengths<'a> {
    fn new(domain: &'a Domain, sizes: &'a [f64], wanted: &'a [f64], spacing: f64) -> Self {
        let density = mean_density(&domain.mesh, sizes);
        Lengths { domain, graph: Graph::whole(domain), sizes, wanted, density, spacing }
    }

    /// Shortest length with room, as a share of the current ones; `None` if it is no improvement.
    fn shortest(&self) -> Option<f64> {
        let has_room = |shortest: f64| self.density(&self.graded(shortest, 1.0)) <= MOST_DENSE;
        if has_room(SHORTEST) {
            return Some(SHORTEST);
        }
        let (mut below, mut above) = (SHORTEST, 1.0);
        for _ in 0..HALVINGS {
            let middle = (below * above).sqrt();
            if has_room(middle) {
                above = middle;
            } else {
                below = middle;
            }
        }
        (above <= LARGEST_SHARE).then_some(above)
    }

    /// The current lengths times `factor`, or the wanted ones if shorter, but at least the share `shortest` of the former.
    fn graded(&self, shortest: f64, factor: f64) -> Vec<f64> {
        let at = |(&size, &wanted): (&f64, &f64)| (factor * size).min(wanted.max(shortest * factor * size));
        let lengths = self.sizes.iter().zip(self.wanted).map(at).collect();
        limited(self.domain, &self.graph, lengths, GRADIENT / self.spacing)
    }

    /// Mean of 1 / h² of these lengths, relative to that of the current ones.
    fn density(&self, graded: &[f64]) -> f64 {
        mean_density(&self.domain.mesh, graded) / self.density
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn lengths_are_as_short_as_there_is_room_for() {
        let domain = Domain::new(testing::sphere().try_into().unwrap());
        let spacing = 0.1;
        let sizes = domain.sizes();
        assert_eq!(sizes_with_room(&domain, &sizes, &vec![1.0; sizes.len()], spacing), None);
        assert_eq!(sizes_with_room(&domain, &sizes, &vec![0.1; sizes.len()], spacing), None);
        let at_pole = |p: &glam::DVec3| if p.z > 0.8 { 0.1 } else { f64::INFINITY };
        let wanted: Vec<f64> = domain.mesh.positions.iter().map(at_pole).collect();
        let lengths = Lengths::new(&domain, &sizes, &wanted, spacing);
        let shortest = lengths.shortest().unwrap();
        let [density, of_shorter] = [1.0, 0.95].map(|share| lengths.density(&lengths.graded(share * shortest, 1.0)));
        assert!(density <= MOST_DENSE && of_shorter > MOST_DENSE, "{shortest}: {density} {of_shorter}");
        let mut at_one = vec![f64::INFINITY; sizes.len()];
        at_one[0] = 0.3;
        let made = sizes_with_room(&domain, &sizes, &at_one, spacing).unwrap();
        assert!((made[0] - 0.3).abs() < 1e-9 && (mean_density(&domain.mesh, &made) - 1.0).abs() < 0.01, "{}", made[0]);
    }
}
