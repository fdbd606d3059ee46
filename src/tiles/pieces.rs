//! What a mesh is made of, piece by piece: a base mesh, the nodes at which vertices begin, and the triangles, in cubes of space, the
//! same for any number of tiles.
//!
//! A triangle belongs to the lowest of the cubes that its corners lie in. First each cube's triangles are made within their rim, which
//! stays. Then what is along the rims is made anew, in cubes of a second lattice, and what is around the vertices on rims that are
//! left even so, where rims of both meet, in cubes of a third one.

use crate::spectral::lattice::{BlockBox, place_of};
use crate::tiles::plan::{BUCKET, Plan};
use crate::tiles::points::blocks_of;
use glam::{DVec3, IVec3};
use std::iter::once;
use std::ops::Range;

/// Blocks of a piece along each axis, about 240 spacings: with fewer more of the surface lies along rims, and with more a piece takes
/// more memory, 300 MB so if the surface goes through it once.
const SIDE: i32 = 4 * BUCKET;

/// How far samples may move out of the bucket where they were drawn, in blocks.
pub(super) const MOVED: i32 = 1;

/// Rounds in which triangles are made: those of the second and the third make anew what the ones before have left along rims.
const ROUNDS: i32 = 3;

/// What is made in one go.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    /// The base mesh.
    Base,
    /// The vertices that the triangles of a cube begin with.
    Nodes(Cube),
    /// Triangles.
    Triangles(Cube),
}

impl Piece {
    /// The round in which it is made.
    fn round(self) -> i32 {
        match self {
            Piece::Base => 0,
            Piece::Nodes(_) => 1,
            Piece::Triangles(cube) => 2 + cube.round,
        }
    }
}

/// A part of space.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Cube {
    /// The round in which its triangles are made, from 0.
    pub round: i32,
    place: IVec3,
}

/// How far the cubes of a round begin below the multiples of their width, in blocks.
fn shift(round: i32) -> i32 {
    [0, SIDE / 2, SIDE / 4][round as usize]
}

/// The place of the cube of a round that a block lies in.
fn cube_of(round: i32, block: IVec3) -> IVec3 {
    (block + shift(round)).div_euclid(IVec3::splat(SIDE))
}

/// All pieces of a plan's mesh, those of each round after the ones before.
pub(super) fn pieces(plan: &Plan) -> Vec<Piece> {
    let triangles = (0..ROUNDS).flat_map(|round| cubes(plan, round)).map(Piece::Triangles);
    once(Piece::Base).chain(cubes(plan, 0).map(Piece::Nodes)).chain(triangles).collect()
}

/// The numbers of the pieces of a plan's mesh in each round; those of a round need the ones before.
pub fn rounds(plan: &Plan) -> Vec<Range<usize>> {
    let all = pieces(plan);
    let ranges = all.chunk_by(|a, b| a.round() == b.round()).scan(0, |end, round| {
        *end += round.len();
        Some(*end - round.len()..*end)
    });
    ranges.collect()
}

/// The cubes of a round in which samples of the plan can be, in increasing order.
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
    /// The cube of the first round that a block lies in.
    pub fn first_around(block: IVec3) -> Cube {
        Cube { round: 0, place: cube_of(0, block) }
    }

    /// Its blocks.
    pub fn blocks(self) -> BlockBox {
        let lo = SIDE * self.place - shift(self.round);
        BlockBox { lo, hi: lo + SIDE }
    }

    /// Whether the triangle of these corners belongs to it, where blocks have this width.
    pub fn owns(self, corners: [DVec3; 3], block: f64) -> bool {
        let lowest = corners.map(|p| cube_of(self.round, place_of(p, block)).to_array()).into_iter().min();
        lowest == Some(self.place.to_array())
    }
}

/// How many vertices the triangles of cube `own` leave out, or have more if that is negative, so that all of `counts`, the nodes of
/// all cubes, are `wanted`. They are shared by the fullest cubes, since others may have no triangles of their own.
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
