//! Edges between the facets of a curved surface: a pillar of twenty sides is meant round.
//!
//! An edge is one between facets if the surface goes on turning, the same way and about as much, at the next edges on both
//! sides, straight across from its middle; or if such an edge is on one side, and the curved part ends here. Facets that are
//! many samples wide are flat at their scale, and a surface that turns by much from one sample to the next is sharp at their
//! scale: the edges there are none between facets. Nor is one that turns by more than a pillar of nine sides.
//!
//! Cost: a walk over some triangles for each edge that turns.

use crate::mesh::half_edge::{next, prev};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::turns::ends;
use rayon::prelude::*;

/// Turns in degrees between which an edge may be one between facets.
const LEAST: f64 = 5.0;
const MOST: f64 = 41.0;

/// Between which multiples of the turn at an edge those at the next ones are.
const ALIKE: [f64; 2] = [0.45, 2.2];

/// Widest facet, in spacings of the samples.
const WIDEST: f64 = 4.0;

/// Most that the surface turns by from one sample to the next, in degrees.
const MOST_PER_SPACING: f64 = 25.0;

/// The share of an edge's turn up to which others are not noticed on the way across a facet.
const FLAT: f64 = 0.2;

/// Most triangles on the way across a facet.
const LONGEST_WALK: usize = 64;

/// For each side of `mesh` whether it is on an edge between facets. `turns` are those across the sides in degrees, negative
/// where the surface is concave; `twin` is as [`twins`](crate::mesh::topology::twins) says, `spacing` that of the samples.
pub fn between_facets(mesh: &Mesh, twin: &[u32], turns: &[f64], spacing: f64) -> Vec<bool> {
    let facets = Facets { mesh, twin, turns, spacing };
    let edges: Vec<(u32, [Option<u32>; 2])> = (0..twin.len() as u32)
        .into_par_iter()
        .filter(|&s| s < twin[s as usize] && twin[s as usize] != NONE)
        .filter(|&s| (LEAST..=MOST).contains(&turns[s as usize].abs()))
        .map(|s| (s, [s, twin[s as usize]].map(|s| facets.next_alike(s))))
        .collect();
    let mark = |marks: &mut [bool], s: u32| {
        marks[s as usize] = true;
        marks[twin[s as usize] as usize] = true;
    };
    let mut inner = vec![false; twin.len()];
    edges.iter().filter(|(_, next)| next.iter().all(Option::is_some)).for_each(|&(s, _)| mark(&mut inner, s));
    let mut result = inner.clone();
    let ends_there = |next: &[Option<u32>; 2]| next.iter().flatten().any(|&s| inner[s as usize]);
    edges.iter().filter(|(_, next)| ends_there(next)).for_each(|&(s, _)| mark(&mut result, s));
    result
}

struct Facets<'a> {
    mesh: &'a Mesh,
    twin: &'a [u32],
    turns: &'a [f64],
    spacing: f64,
}

impl Facets<'_> {
    /// The next edge across the facet that `side` bounds, if the surface turns there as at `side`, and not too fast for the
    /// samples.
    fn next_alike(&self, side: u32) -> Option<u32> {
        let (other, width) = self.across(side)?;
        let [here, there] = [side, other].map(|s| self.turns[s as usize]);
        let is_alike = (ALIKE[0]..=ALIKE[1]).contains(&(there / here)) && there.abs() <= MOST;
        (is_alike && here.abs() * self.spacing <= MOST_PER_SPACING * width).then_some(other)
    }

    /// The next side that the surface turns at, straight across the facet that `side` bounds, and how wide that is.
    fn across(&self, side: u32) -> Option<(u32, f64)> {
        let flat = FLAT * self.turns[side as usize].abs();
        let place = |s: u32| self.mesh.positions[ends(self.mesh, s)[0] as usize];
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
            if width > WIDEST * self.spacing || self.twin[exit as usize] == NONE {
                return None;
            }
            if self.turns[exit as usize].abs() > flat {
                return Some((exit, width));
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
    use crate::surface::turns::turns;
    use crate::testing::grid;
    use glam::{DVec2, dvec2, dvec3};

    /// How many edges along it, of one row, a roof over a profile has between facets.
    fn facets(profile: &[DVec2], spacing: f64) -> usize {
        let n = profile.len() as u32 - 1;
        let mesh = grid(n, 1, |u, v| {
            let p = profile[(f64::from(n) * u).round() as usize];
            dvec3(p.x, 10.0 * v, p.y)
        });
        let twin = twins(&mesh.triangles);
        let found = between_facets(&mesh, &twin, &turns(&mesh, &twin, spacing), spacing);
        found.iter().filter(|f| **f).count() / 2
    }

    /// A profile of steps of `length`, each turned by the next angle in degrees.
    fn bent(length: f64, turns: &[f64]) -> Vec<DVec2> {
        let (mut way, mut profile) = (dvec2(length, 0.0), vec![DVec2::ZERO, dvec2(length, 0.0)]);
        for turn in turns {
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
    fn facets_are_neither_wide_nor_too_narrow_for_the_samples() {
        assert_eq!(facets(&bent(1.0, &[20.0; 6]), 0.2), 0);
        assert_eq!(facets(&bent(1.0, &[20.0; 6]), 2.0), 0);
    }
}
