//! Edges between the facets of a curved surface: a pillar of twenty sides is meant to be round.
//!
//! An edge is a facet edge if the next edges on both sides, straight across from its midpoint, turn the surface in the same
//! direction and by a similar angle; or if one of them is such an edge, and the curved part ends here. No facet edge has a
//! larger dihedral angle than a pillar of nine sides.
//!
//! The edges of a step between points on a lattice, no wider than their distance, are no edges of the surface either: the
//! surface turns back immediately by as much as it turned.
//!
//! Facets many samples wide are flat at the scale of the samples, and a surface that turns strongly from one sample to the
//! next is sharp at that scale. Both criteria apply to a whole chain of edges that continue straight, so that no chain is
//! sharp in parts.
//!
//! Cost: a walk over a few triangles for each edge that is not flat.

use crate::base::parallel;
use crate::base::union_find::UnionFind;
use crate::mesh::half_edge::{next, prev};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::dihedral_angles::{direction, length};
use glam::DVec3;
use std::collections::BTreeMap;

/// Smallest and largest dihedral angle of a facet edge, in degrees.
const LEAST: f64 = 5.0;
const MOST: f64 = 41.0;

/// Range of the dihedral angles of the next edges, relative to that of the edge itself.
const ALIKE: [f64; 2] = [0.45, 2.2];

/// Largest mean width of the facets along a curve, and largest width of a single one, in spacings of the samples.
const WIDE: f64 = 4.0;
const WIDEST: f64 = 8.0;

/// Largest mean turn of the surface from one sample to the next along a curve, in degrees.
const MOST_PER_SPACING: f64 = 20.0;

/// Cosine between two edges, both directed away from their common vertex, below which one continues the other.
pub const STRAIGHT: f64 = -0.8;

/// Largest dihedral angle that is ignored on the way across a facet, as a share of that of the edge where the walk begins.
const FLAT: f64 = 0.2;

/// Smallest dihedral angle, in degrees, that is ever taken into account.
pub const NOTICED: f64 = FLAT * LEAST;

/// Maximum number of triangles on the way across a facet.
const LONGEST_WALK: usize = 64;

/// Returns whether each side of `mesh` is on an edge between facets. `dihedral_angles` has the dihedral angle across each side in
/// degrees, negative where the surface is concave; it may be zero below [`NOTICED`]. `twin` is the result of
/// [`twins`](crate::mesh::topology::twins), `spacing` that of the samples.
pub fn between_facets(mesh: &Mesh, twin: &[u32], dihedral_angles: &[f64], spacing: f64) -> Vec<bool> {
    let facets = Facets { mesh, twin, dihedral_angles, widest: WIDEST * spacing };
    let edges = facets.edges();
    let mut curves = straight_curves(mesh, &edges);
    let mut sums: BTreeMap<u32, Sums> = BTreeMap::new();
    for (i, edge) in (0..).zip(&edges) {
        let sum = sums.entry(curves.find(i)).or_default();
        sum.add(length(mesh, edge.side), dihedral_angles[edge.side as usize].abs(), edge.width());
    }
    let mut result = vec![false; twin.len()];
    for (_, edge) in (0..).zip(&edges).filter(|(i, _)| sums[&curves.find(*i)].is_round(spacing)) {
        result[edge.side as usize] = true;
        result[twin[edge.side as usize] as usize] = true;
    }
    result
}

/// Returns whether each side of `mesh` is on an edge of a step no wider than `widest`. The other arguments are those of
/// [`between_facets`].
pub fn on_steps(mesh: &Mesh, twin: &[u32], dihedral_angles: &[f64], widest: f64) -> Vec<bool> {
    let facets = Facets { mesh, twin, dihedral_angles, widest };
    let turns_back = |side: u32| {
        let turn = dihedral_angles[side as usize];
        let beyond = |facet: Facet| dihedral_angles[facet.other as usize] / -turn;
        turn.abs() >= LEAST && facets.across(side).is_some_and(|f| (ALIKE[0]..=ALIKE[1]).contains(&beyond(f)))
    };
    let back = parallel::map(0..twin.len() as u32, turns_back);
    (0..twin.len()).map(|s| back[s] || twin[s] != NONE && back[twin[s] as usize]).collect()
}

/// Groups the indices of edges that continue each other straight.
fn straight_curves(mesh: &Mesh, edges: &[Edge]) -> UnionFind {
    let mut at: BTreeMap<u32, Vec<(u32, DVec3)>> = BTreeMap::new();
    for (i, edge) in (0..).zip(edges) {
        let [a, b] = mesh.ends(edge.side);
        let way = direction(mesh, edge.side);
        at.entry(a).or_default().push((i, way));
        at.entry(b).or_default().push((i, -way));
    }
    let mut curves = UnionFind::new(edges.len());
    for fan in at.values() {
        for (k, &(i, way)) in fan.iter().enumerate() {
            for &(j, other) in &fan[..k] {
                if way.dot(other) < STRAIGHT {
                    curves.join(i, j);
                }
            }
        }
    }
    curves
}

/// Sums over the edges of a curve, weighted by their length.
#[derive(Default)]
struct Sums {
    length: f64,
    turn: f64,
    width: f64,
}

impl Sums {
    fn add(&mut self, length: f64, turn: f64, width: f64) {
        self.length += length;
        self.turn += length * turn;
        self.width += length * width;
    }

    /// Returns whether the surface is round along the curve at the scale of samples with this spacing.
    fn is_round(&self, spacing: f64) -> bool {
        self.width <= WIDE * spacing * self.length && self.turn * spacing <= MOST_PER_SPACING * self.width
    }
}

/// A facet beside an edge: the edge on its far side, and its width.
#[derive(Clone, Copy)]
struct Facet {
    other: u32,
    width: f64,
}

/// An edge between facets, by one of its sides, and the facets beside it that continue its turn.
struct Edge {
    side: u32,
    beside: [Option<Facet>; 2],
}

impl Edge {
    /// Mean width of its facets.
    fn width(&self) -> f64 {
        let widths = || self.beside.iter().flatten().map(|facet| facet.width);
        widths().sum::<f64>() / widths().count() as f64
    }
}

struct Facets<'a> {
    mesh: &'a Mesh,
    twin: &'a [u32],
    dihedral_angles: &'a [f64],
    /// Width of the widest facet to walk across.
    widest: f64,
}

impl Facets<'_> {
    /// Returns the facet edges: those with a similar edge on both sides, or with such an edge on one side.
    fn edges(&self) -> Vec<Edge> {
        let Facets { twin, dihedral_angles, .. } = self;
        let mut edges: Vec<Edge> = parallel::collect(0..twin.len() as u32, |sides| {
            sides
                .filter(|&side| side < twin[side as usize] && twin[side as usize] != NONE)
                .filter(|&side| (LEAST..=MOST).contains(&dihedral_angles[side as usize].abs()))
                .map(|side| Edge { side, beside: [side, twin[side as usize]].map(|s| self.beside(s)) })
        });
        let mut inner = vec![false; twin.len()];
        for edge in edges.iter().filter(|edge| edge.beside.iter().all(Option::is_some)) {
            inner[edge.side as usize] = true;
            inner[twin[edge.side as usize] as usize] = true;
        }
        edges.retain(|edge| {
            inner[edge.side as usize] || edge.beside.iter().flatten().any(|facet| inner[facet.other as usize])
        });
        edges
    }

    /// Returns the facet that `side` bounds, if its far edge has a dihedral angle similar to that of `side`.
    fn beside(&self, side: u32) -> Option<Facet> {
        let facet = self.across(side)?;
        let [here, there] = [side, facet.other].map(|s| self.dihedral_angles[s as usize]);
        let is_alike = (ALIKE[0]..=ALIKE[1]).contains(&(there / here)) && there.abs() <= MOST;
        is_alike.then_some(facet)
    }

    /// Returns the facet that `side` bounds, up to the next edge straight across that is not flat.
    fn across(&self, side: u32) -> Option<Facet> {
        let flat = FLAT * self.dihedral_angles[side as usize].abs();
        let place = |s: u32| self.mesh.positions[self.mesh.origin(s) as usize];
        let normal = |s: u32| self.mesh.area_vector(s as usize / 3).try_normalize();
        let along = place(next(side)) - place(side);
        let mut way = normal(side)?.cross(along).try_normalize()?;
        let (mut entry, mut at, mut width) = (side, place(side) + 0.5 * along, 0.0);
        for _ in 0..LONGEST_WALK {
            let to_left = normal(entry)?.cross(way);
            let is_left = (place(prev(entry)) - at).dot(to_left) > 0.0;
            let exit = if is_left { next(entry) } else { prev(entry) };
            let [from, to] = [exit, next(exit)].map(|s| place(s) - at);
            let [a, b] = [from, to].map(|p| p.dot(to_left));
            let step = from.lerp(to, if a == b { 0.5 } else { (a / (a - b)).clamp(0.0, 1.0) });
            width += step.length();
            if width > self.widest || self.twin[exit as usize] == NONE {
                return None;
            }
            if self.dihedral_angles[exit as usize].abs() > flat {
                return Some(Facet { other: exit, width });
            }
            at += step;
            entry = self.twin[exit as usize];
            way = way.reject_from_normalized(normal(entry)?).try_normalize()?;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::twins;
    use crate::surface::dihedral_angles::dihedral_angles;
    use crate::testing::grid;
    use glam::{DVec2, dvec2, dvec3};

    /// Number of edges between facets of a roof over a profile, one row of faces wide.
    fn facets(profile: &[DVec2], spacing: f64) -> usize {
        let n = profile.len() as u32 - 1;
        let mesh = grid(n, 1, |u, v| {
            let p = profile[(f64::from(n) * u).round() as usize];
            dvec3(p.x, 10.0 * v, p.y)
        });
        let twin = twins(&mesh.triangles);
        let found = between_facets(&mesh, &twin, &dihedral_angles(&mesh, &twin, spacing, NOTICED), spacing);
        found.iter().filter(|f| **f).count() / 2
    }

    /// A profile of steps of `length`, each turned against the one before by the next angle, in degrees.
    fn bent(length: f64, dihedral_angles: &[f64]) -> Vec<DVec2> {
        let (mut way, mut profile) = (dvec2(length, 0.0), vec![DVec2::ZERO, dvec2(length, 0.0)]);
        for turn in dihedral_angles {
            way = DVec2::from_angle(-turn.to_radians()).rotate(way);
            profile.push(*profile.last().unwrap() + way);
        }
        profile
    }

    #[test]
    fn the_facets_of_a_round_part_are_found_up_to_its_ends() {
        assert_eq!(facets(&bent(1.0, &[20.0; 6]), 0.5), 6);
        assert_eq!(facets(&bent(1.0, &[10.0, 20.0, 20.0, 20.0, 10.0]), 0.5), 5);
    }

    #[test]
    fn edges_that_turn_much_or_both_ways_or_alone_are_no_facets() {
        assert_eq!(facets(&bent(1.0, &[60.0; 5]), 0.5), 0, "a nut");
        assert_eq!(facets(&bent(1.0, &[20.0, -20.0, 20.0, -20.0]), 0.5), 0, "folds");
        assert_eq!(facets(&bent(1.0, &[2.0, 20.0, 2.0]), 0.5), 0, "a ridge");
        assert_eq!(facets(&bent(1.0, &[30.0, 30.0]), 0.5), 0, "a chamfer");
    }

    #[test]
    fn steps_turn_back_within_their_width() {
        let steps = |widest: f64| {
            let profile = bent(1.0, &[-45.0, 45.0, 0.0, 0.0, 45.0, -45.0, 0.0, 0.0, 45.0]);
            let n = profile.len() as u32 - 1;
            let mesh = grid(n, 1, |u, v| {
                let p = profile[(f64::from(n) * u).round() as usize];
                dvec3(p.x, 10.0 * v, p.y)
            });
            let twin = twins(&mesh.triangles);
            on_steps(&mesh, &twin, &dihedral_angles(&mesh, &twin, 0.5, NOTICED), widest).iter().filter(|f| **f).count()
                / 2
        };
        assert_eq!(steps(1.2), 4, "one up and one down, but not the ridge");
        assert_eq!(steps(0.8), 0);
    }

    #[test]
    fn facets_are_neither_wide_nor_too_narrow_for_the_samples() {
        assert_eq!(facets(&bent(1.0, &[20.0; 6]), 0.2), 0);
        assert_eq!(facets(&bent(1.0, &[20.0; 6]), 2.0), 0);
    }
}
