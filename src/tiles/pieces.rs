//! The pieces of a mesh: a base mesh, the nodes at which vertices begin, and the triangles. Nodes and triangles are made in
//! cubes of space that are the same for any number of tiles.
//!
//! A triangle belongs to the lowest of the cubes that contain its corners. First, the triangles of each cube are made within
//! their rim, which stays. Then the mesh along the rims is made anew, in cubes of a second lattice. Finally, where rims of
//! both lattices meet, some vertices are still on a rim; the mesh around these is made anew in cubes of a third lattice.

use crate::spectral::lattice::{BlockBox, place_of};
use crate::tiles::plan::{BUCKET, Plan};
use crate::tiles::points::blocks_of;
use glam::{DVec3, IVec3};
use std::iter::once;
use std::ops::Range;

/// Number of blocks of a piece along each axis, about 240 spacings. With fewer, more of the surface lies along rims; with
/// more, a piece takes more memory: 300 MB at this size if the surface passes through it once.
const SIDE: i32 = 4 * BUCKET;

/// Maximum distance, in blocks, that samples may move out of the bucket in which they were drawn.
pub(super) const MOVED: i32 = 1;

/// Number of rounds in which triangles are made: the second and the third make anew what earlier rounds left along rims.
const ROUNDS: i32 = 3;

/// What is made at once.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    /// The base mesh.
    Base,
    /// The initial vertices of the triangles of a cube.
    Nodes(Cube),
    /// Triangles.
    Triangles(Cube),
}

impl Piece {
    /// Returns the round in which it is made.
    fn round(self) -> i32 {
        match self {
            Piece::Base => 0,
            Piece::Nodes(_) => 1,
            Piece::Triangles(cube) => 2 + cube.round,
        }
    }
}

/// A cube of space.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Cube {
    /// The round in which its triangles are made, from 0.
    pub round: i32,
    place: IVec3,
}

/// Returns how far, in blocks, the cubes of a round begin below the multiples of their width.
fn shift(round: i32) -> i32 {
    [0, SIDE / 2, SIDE / 4][round as usize]
}

/// Returns the place of the cube of a round that contains a block.
fn cube_of(round: i32, block: IVec3) -> IVec3 {
    (block + shift(round)).div_euclid(IVec3::splat(SIDE))
}

/// Returns all pieces of a plan's mesh, round by round.
pub(super) fn pieces(plan: &Plan) -> Vec<Piece> {
    let triangles = (0..ROUNDS).flat_map(|round| cubes(plan, round)).map(Piece::Triangles);
    once(Piece::Base).chain(cubes(plan, 0).map(Piece::Nodes)).chain(triangles).collect()
}

/// Returns the numbers of the pieces of a plan's mesh in each round; the pieces of a round need those of earlier rounds.
pub fn rounds(plan: &Plan) -> Vec<Range<usize>> {
    let all = pieces(plan);
    let ranges = all.chunk_by(|a, b| a.round() == b.round()).scan(0, |end, round| {
        *end += round.len();
        Some(*end - round.len()..*end)
    });
    ranges.collect()
}

/// Returns the cubes of a round that may contain samples of the plan, in increasing order.
fn cubes(plan: &Plan, round: i32) -> impl Iterator<Item = Cube> {
    let around = plan.buckets().flat_map(|chunks| {
        let BlockBox { lo, hi } = blocks_of(chunks[0].place.into()).grown(IVec3::splat(MOVED));
        let (lo, hi) = (cube_of(round, lo), cube_of(round, hi - 1));
        (lo.x..=hi.x).flat_map(move |x| (lo.y..=hi.y).flat_map(move |y| (lo.z..=hi.z).map(move |z| [x, y, z])))
    });
    let mut places: Vec<[i32; 3]> = around.collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(move |place| Cube { round, place: place.into() })
}

impl Cube {
    /// Returns the cube of the first round that contains a block.
    pub fn first_around(block: IVec3) -> Cube {
        Cube { round: 0, place: cube_of(0, block) }
    }

    /// Returns its blocks.
    pub fn blocks(self) -> BlockBox {
        let lo = SIDE * self.place - shift(self.round);
        BlockBox { lo, hi: lo + SIDE }
    }

    /// Returns whether the triangle with these corners belongs to it; `block` is the width of a block.
    pub fn owns(self, corners: [DVec3; 3], block: f64) -> bool {
        let lowest = corners.map(|p| cube_of(self.round, place_of(p, block)).to_array()).into_iter().min();
        lowest == Some(self.place.to_array())
    }
}

/// Returns how many vertices cube `own` leaves out, or adds if negative, so that the mesh has `wanted` vertices; `counts`
/// are the numbers of nodes of all cubes. Only the fullest cubes share the difference, since others may have no triangles of
/// their own.
pub(super) fn spare(own: usize, counts: &[u64], wanted: u64) -> i64 {
    let most = counts.iter().copied().max().unwrap_or(0);
    let surplus = i128::from(counts.iter().sum::<u64>()) - i128::from(wanted);
    let full: Vec<i128> = counts.iter().map(|&count| if 2 * count >= most { i128::from(count) } else { 0 }).collect();
    let all = full.iter().sum::<i128>().max(1);
    let share = |below: i128| (surplus * below).div_euclid(all);
    let below: i128 = full[..own].iter().sum();
    (share(below + full[own]) - share(below)) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fullest_cubes_share_the_surplus_or_what_is_missing() {
        let all = |wanted: u64| [0, 1, 2].map(|own| spare(own, &[800, 3, 700], wanted));
        assert_eq!(all(1500), [1, 0, 2]);
        assert_eq!(all(1510), [-4, 0, -3]);
        assert_eq!(all(1503), [0; 3]);
    }

    #[test]
    fn a_triangle_belongs_to_one_cube_of_each_round() {
        let corners = [DVec3::new(31.9, 0.0, 0.0), DVec3::new(32.1, 0.0, 0.0), DVec3::new(32.0, -0.1, 0.5)];
        for round in 0..ROUNDS {
            let cubes = (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| IVec3::new(x, y, z))));
            let owners = cubes.filter(|&place| Cube { round, place }.owns(corners, 1.0));
            assert_eq!(owners.count(), 1);
        }
    }
}
