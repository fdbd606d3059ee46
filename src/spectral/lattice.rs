//! The lattice of blocks by which the scan proceeds. It is anchored at the origin, so that points are in the same blocks
//! whether all of them are scanned or only a part.
//!
//! A block hears the blocks that touch it and have an earlier turn: its samples depend on theirs. These blocks hear others,
//! and so on. The turn is the three-bit number of the parities of x, y and z, so such a chain reaches as many blocks along
//! an axis as the axis's bit changes between the turns: at most seven along x, three along y, one along z. So a box of
//! blocks, scanned together with those it hears, gets the same samples as within any larger scan.

use glam::{DVec3, IVec3, ivec3};

/// The number of turns.
pub const TURNS: i32 = 8;

/// Returns the block, of blocks of this width, that contains `p`.
#[inline]
pub fn place_of(p: DVec3, width: f64) -> IVec3 {
    (p / width).floor().as_ivec3()
}

/// Returns the turn of a block. Blocks of the same turn do not touch each other.
pub fn turn_of(place: IVec3) -> i32 {
    (place.x & 1) | (place.y & 1) << 1 | (place.z & 1) << 2
}

/// A box of blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockBox {
    /// The lowest block.
    pub lo: IVec3,
    /// The block beyond the highest one.
    pub hi: IVec3,
}

impl BlockBox {
    /// Returns the box with `by` more blocks on each side.
    pub fn grown(self, by: IVec3) -> BlockBox {
        BlockBox { lo: self.lo - by, hi: self.hi + by }
    }

    /// Returns whether the box contains a block.
    pub fn contains(&self, place: IVec3) -> bool {
        place.cmpge(self.lo).all() && place.cmplt(self.hi).all()
    }

    /// Returns whether the two boxes have a block in common.
    pub fn touches(&self, other: BlockBox) -> bool {
        self.lo.cmplt(other.hi).all() && other.lo.cmplt(self.hi).all()
    }

    /// Returns whether the samples kept in the box can depend on those kept in this block.
    pub fn hears(&self, place: IVec3) -> bool {
        let turn = turn_of(place);
        self.grown(ivec3(TURNS - 1 - turn, 3 - turn / 2, 1 - turn / 4)).contains(place)
    }

    /// Returns the box around all blocks that it hears.
    pub fn heard(self) -> BlockBox {
        self.grown(ivec3(TURNS - 1, 3, 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_block_hears_what_chains_of_earlier_turns_lead_to() {
        // Starts with a box of one block of each turn and goes step by step to all touching blocks of earlier turns.
        let seed = BlockBox { lo: IVec3::ZERO, hi: IVec3::splat(2) };
        let mut open: Vec<IVec3> = (0..8).map(|i| ivec3(i & 1, i >> 1 & 1, i >> 2)).collect();
        let mut found = BTreeSet::new();
        while let Some(place) = open.pop() {
            if found.insert(place.to_array()) {
                let around = (0..27).map(|i| place + ivec3(i % 3, i / 3 % 3, i / 9) - 1);
                open.extend(around.filter(|other| turn_of(*other) < turn_of(place)));
            }
        }
        assert!(found.iter().all(|&place| seed.hears(place.into()) && seed.heard().contains(place.into())));
        let farthest = |axis: usize| found.iter().map(|place| -place[axis]).max().unwrap();
        assert_eq!([0, 1, 2].map(farthest), [6, 2, 0]);
    }
}
