//! The sides of all triangles, sorted such that the sides of the same edge are adjacent.
//!
//! The sort has two steps: blocks of triangles distribute their sides to vertex ranges, and each range sorts its own sides
//! by counting. Both steps run in parallel, and the data of a task fits into the caches of a core.
//!
//! Cost: linear for meshes of bounded valence; twelve bytes per side, and four more during sorting.

use crate::base::csr::Csr;
use crate::base::parallel;
use std::sync::atomic::{AtomicU32, Ordering};

/// No neighbour across an edge, that is, a boundary.
pub const NONE: u32 = u32::MAX;

/// Returns the ends of an edge, the lower first, so that they identify the edge in either direction.
#[inline]
pub(crate) fn lower_first([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// One side of a triangle, in the direction of the triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Side {
    from: u32,
    to: u32,
    /// `3 t + k`: the side from corner `k` to corner `k + 1` of triangle `t`.
    pub side: u32,
}

impl Side {
    /// The end vertices, the lower first.
    #[inline]
    pub fn ends(&self) -> [u32; 2] {
        lower_first([self.from, self.to])
    }

    /// Returns whether the triangle runs from the lower end to the higher one.
    #[inline]
    pub fn forward(&self) -> bool {
        self.from < self.to
    }

    /// The index of the corner at `v`, an end of this side.
    pub fn corner_at(&self, v: u32) -> u32 {
        let (t, k) = (self.side / 3, self.side % 3);
        if self.from == v { self.side } else { 3 * t + (k + 1) % 3 }
    }
}

/// Number of triangles whose sides one thread distributes at a time.
const BLOCK: usize = 1 << 16;

/// Number of vertices whose sides one thread sorts at a time.
const RANGE: usize = 1 << 13;

/// Returns all sides of all triangles between two different vertices, sorted by their ends, then by their numbers.
pub(crate) fn sorted_sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let largest = parallel::blocks(triangles, BLOCK, |block| block.iter().flatten().max());
    let vertices = largest.into_iter().flatten().max().map_or(0, |&v| v as usize + 1);
    let ranges = vertices.div_ceil(RANGE);
    let numbered = (0..triangles.len() as u32, triangles);
    let blocks: Vec<Csr<u32>> = parallel::blocks(numbered, BLOCK, |(numbers, block)| {
        Csr::new(ranges, || sides(block, 3 * numbers.start).map(|s| (s.ends()[0] / RANGE as u32, s.side)))
    });
    let mut sorted = vec![Side { from: 0, to: 0, side: 0 }; blocks.iter().map(Csr::len).sum()];
    let mut of_ranges = Vec::with_capacity(ranges);
    let mut rest = &mut sorted[..];
    for range in 0..ranges as u32 {
        let (own, others) = rest.split_at_mut(blocks.iter().map(|block| block.row(range).len()).sum());
        of_ranges.push(own);
        rest = others;
    }
    parallel::each((0u32..).zip(of_ranges), |(range, own)| {
        let of_range = blocks.iter().flat_map(|block| block.row(range));
        let first = range * RANGE as u32;
        let count = RANGE.min(vertices - first as usize);
        sort_range(first, count, of_range.map(|&side| Side::new(triangles, side)).collect(), own);
    });
    sorted
}

/// Groups the sides by edge.
pub(crate) fn edges(sides: &[Side]) -> impl Iterator<Item = &[Side]> + Clone {
    sides.chunk_by(|a, b| a.ends() == b.ends())
}

/// Returns for each of `count` sides the other side of its edge if the edge has exactly two sides and `fit` holds for them,
/// else [`NONE`].
pub(crate) fn pairs_of_sides(sides: &[Side], count: usize, fit: impl Fn(&Side, &Side) -> bool + Sync) -> Vec<u32> {
    let partner: Vec<AtomicU32> = (0..count).map(|_| AtomicU32::new(NONE)).collect();
    let put = |side: &Side, other: &Side| partner[side.side as usize].store(other.side, Ordering::Relaxed);
    let begins_edge = |&i: &usize| i == 0 || sides[i - 1].ends() != sides[i].ends();
    parallel::blocks(0..sides.len(), BLOCK, |block| {
        for first in block.filter(begins_edge) {
            if let Some([a, b]) = edges(&sides[first..]).next()
                && fit(a, b)
            {
                put(a, b);
                put(b, a);
            }
        }
    });
    partner.into_iter().map(AtomicU32::into_inner).collect()
}

impl Side {
    fn new(triangles: &[[u32; 3]], side: u32) -> Side {
        let (t, k) = (side as usize / 3, side as usize % 3);
        Side { from: triangles[t][k], to: triangles[t][(k + 1) % 3], side }
    }
}

/// The sides of `triangles` between two different vertices; `first` is the number of the first side.
fn sides(triangles: &[[u32; 3]], first: u32) -> impl Iterator<Item = Side> {
    let of_triangle = move |(&[a, b, c], t): (&[u32; 3], u32)| {
        let numbered = [(a, b), (b, c), (c, a)].into_iter().zip(first + 3 * t..);
        numbered.map(|((from, to), side)| Side { from, to, side })
    };
    triangles.iter().zip(0..).flat_map(of_triangle).filter(|side| side.from != side.to)
}

/// Sorts `sides`, given in the order of their numbers, whose lower ends are among the `count` vertices starting at `first`.
fn sort_range(first: u32, count: usize, sides: Vec<Side>, sorted: &mut [Side]) {
    let mut place = vec![0u32; count + 1];
    sides.iter().for_each(|s| place[(s.ends()[0] - first) as usize + 1] += 1);
    (0..count).for_each(|v| place[v + 1] += place[v]);
    for side in sides {
        let at = &mut place[(side.ends()[0] - first) as usize];
        sorted[*at as usize] = side;
        *at += 1;
    }
    // Now each entry is the position where the sides of the next vertex begin.
    let mut start = 0;
    for &end in &place[..count] {
        sorted[start..end as usize].sort_unstable_by_key(|s| (s.ends()[1], s.side));
        start = end as usize;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};
    use rand_chacha::rand_core::Rng;

    #[test]
    fn sides_are_in_the_order_of_their_ends_and_numbers() {
        let mut rng = stream(1, Stage::Scan);
        let bound = 3 * RANGE as u32;
        // More triangles than fit into a block, around a small number of scattered vertices.
        let triangles: Vec<[u32; 3]> =
            (0..BLOCK + 100).map(|_| [0; 3].map(|_| rng.next_u32() % bound / 7 * 7 % bound)).collect();
        let mut expected: Vec<Side> = sides(&triangles, 0).collect();
        expected.sort_by_key(|s| (s.ends(), s.side));
        assert!(expected.len() < 3 * triangles.len());
        assert_eq!(sorted_sides(&triangles), expected);
        assert!(edges(&expected).all(|edge| edge.iter().all(|s| s.ends() == edge[0].ends())));
        assert_eq!(edges(&expected).map(<[Side]>::len).sum::<usize>(), expected.len());
    }

    #[test]
    fn a_side_knows_its_corners() {
        let sides = sorted_sides(&[[4, 2, 9], [2, 4, 4]]);
        let found: Vec<_> = sides.iter().map(|s| (s.ends(), s.forward(), s.side, s.corner_at(4))).collect();
        assert_eq!(
            found[..2],
            [([2, 4], false, 0, 0), ([2, 4], true, 3, 4)],
            "one edge, once in each direction, and none between equal corners"
        );
        assert!(sorted_sides(&[]).is_empty());
    }
}
