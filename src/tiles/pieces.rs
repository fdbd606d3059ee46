//! The pieces that a mesh is made in: cubes of space, the same for any number of tiles.
//!
//! A triangle belongs to the lowest of the cubes that its corners lie in. First each piece is made within its rim, which stays.
//! Then what is along the rims is made anew, in cubes of a second lattice, and what is around the vertices on rims that are left
//! even so, where rims of both meet, in cubes of a third one.

use crate::spectral::lattice::{BlockBox, place_of};
use crate::tiles::folder::Counts;
use crate::tiles::plan::{BUCKET, Plan};
use crate::tiles::points::blocks_of;
use glam::{DVec3, IVec3};
use std::collections::BTreeMap;
use std::ops::Range;

/// Blocks of a piece along each axis, about 240 spacings: with fewer more of the surface lies along rims, and with more a piece takes
/// more memory, 300 MB so if the surface goes through it once.
const SIDE: i32 = 4 * BUCKET;

/// How far samples may move out of the bucket where they were drawn, in blocks.
pub(super) const MOVED: i32 = 1;

/// Rounds in which pieces are made: those of the second and the third make anew what the ones before have left along rims.
const ROUNDS: i32 = 3;

/// A piece of the mesh.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Cube {
    /// The round in which it is made, from 0.
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
pub(super) fn pieces(plan: &Plan) -> Vec<Cube> {
    (0..ROUNDS).flat_map(|round| cubes(plan, round)).collect()
}

/// The numbers of the pieces of a plan's mesh in each round; those of a round need the ones before.
pub fn rounds(plan: &Plan) -> Vec<Range<usize>> {
    let all = pieces(plan);
    let ranges = all.chunk_by(|a, b| a.round == b.round).scan(0, |end, round| {
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

/// How many samples at these positions there are in each cube of the first round.
pub(super) fn counts(positions: impl Iterator<Item = DVec3>, block: f64) -> Counts {
    let mut counts = BTreeMap::new();
    positions.for_each(|p| *counts.entry(cube_of(0, place_of(p, block)).to_array()).or_insert(0) += 1);
    counts.into_iter().collect()
}

/// How many samples the piece of `cube` leaves out, or has more if that is negative, so that all of `counts`, those of all tiles, are
/// `wanted`. They are shared by the fullest cubes, since others may have no triangles of their own.
pub(super) fn spare(cube: Cube, counts: impl Iterator<Item = Counts>, wanted: u64) -> i64 {
    let mut of_cubes: BTreeMap<[i32; 3], u64> = BTreeMap::new();
    counts.flatten().for_each(|(place, count)| *of_cubes.entry(place).or_insert(0) += count);
    let most = of_cubes.values().copied().max().unwrap_or(0);
    let surplus = i128::from(of_cubes.values().sum::<u64>()) - i128::from(wanted);
    of_cubes.retain(|_, count| 2 * *count >= most);
    let all = i128::from(of_cubes.values().sum::<u64>().max(1));
    let share = |below: i128| (surplus * below).div_euclid(all);
    let below: i128 = of_cubes.range(..cube.place.to_array()).map(|(_, count)| i128::from(*count)).sum();
    let own = of_cubes.get(&cube.place.to_array()).map_or(0, |count| i128::from(*count));
    (share(below + own) - share(below)) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fullest_cubes_share_the_surplus_or_what_is_missing() {
        let counts = || [vec![([0, 0, 0], 500), ([1, 0, 0], 3)], vec![([0, 0, 0], 300), ([1, 1, 0], 700)]].into_iter();
        let spare =
            |x: i32, y: i32, wanted: u64| super::spare(Cube { round: 0, place: IVec3::new(x, y, 0) }, counts(), wanted);
        let all = |wanted: u64| [spare(0, 0, wanted), spare(1, 0, wanted), spare(1, 1, wanted), spare(5, 5, wanted)];
        assert_eq!(all(1500), [1, 0, 2, 0]);
        assert_eq!(all(1510), [-4, 0, -3, 0]);
        assert_eq!(all(1503), [0; 4]);
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
