//! Priority queues of numbered items: the highest rank comes first, and ties are ordered, too.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};

/// A numbered item. It is greater if its rank is higher or, at equal rank, if its number is lower, so that the order of a
/// heap is unique.
#[derive(Debug, Clone, Copy)]
pub struct Ranked<T = ()> {
    /// Sort key.
    pub rank: f64,
    /// Number of the item.
    pub index: u32,
    /// Additional data, which does not affect the order.
    pub item: T,
}

impl Ranked {
    /// Item number `index` with a rank.
    pub fn new(rank: f64, index: u32) -> Ranked {
        Ranked { rank, index, item: () }
    }
}

impl<T> PartialEq for Ranked<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T> Eq for Ranked<T> {}

impl<T> PartialOrd for Ranked<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Ranked<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank.total_cmp(&other.rank).then(other.index.cmp(&self.index))
    }
}

/// A priority queue for hundreds of thousands of items, with the order of a heap. Only the items of about the highest rank
/// are in a heap, which fits into the caches of a core; the others wait unsorted in buckets, one per range of ranks.
///
/// Based on: R. Brown, Calendar queues, 1988, DOI 10.1145/63039.63045. Departure: the ranges follow from the binary digits
/// of a rank.
#[derive(Default)]
pub struct RankedQueue {
    first: BinaryHeap<Ranked>,
    /// The lowest bucket whose items are in the heap; `None` before the first.
    lowest: Option<i64>,
    waiting: BTreeMap<i64, Vec<Ranked>>,
}

/// Number of low bits of a rank that do not affect its bucket: the ranks of a bucket differ by less than a 128th.
const DIGITS_WITHIN: u32 = 45;

/// Returns the bucket of a rank: higher buckets have higher ranks.
fn bucket(rank: f64) -> i64 {
    let bits = rank.to_bits() as i64;
    // The bits of negative numbers increase with the absolute value.
    let rising = bits ^ (((bits >> 63) as u64) >> 1) as i64;
    rising >> DIGITS_WITHIN
}

impl RankedQueue {
    /// Adds an item.
    pub fn push(&mut self, ranked: Ranked) {
        let bucket = bucket(ranked.rank);
        if self.lowest.is_some_and(|lowest| bucket >= lowest) {
            self.first.push(ranked);
        } else {
            self.waiting.entry(bucket).or_default().push(ranked);
        }
    }

    /// Removes and returns the greatest item.
    pub fn pop(&mut self) -> Option<Ranked> {
        if self.first.is_empty()
            && let Some((bucket, things)) = self.waiting.pop_last()
        {
            self.lowest = Some(bucket);
            self.first = things.into();
        }
        self.first.pop()
    }
}

impl Extend<Ranked> for RankedQueue {
    fn extend<I: IntoIterator<Item = Ranked>>(&mut self, things: I) {
        things.into_iter().for_each(|ranked| self.push(ranked));
    }
}

impl FromIterator<Ranked> for RankedQueue {
    fn from_iter<I: IntoIterator<Item = Ranked>>(things: I) -> RankedQueue {
        let mut queue = RankedQueue::default();
        queue.extend(things);
        queue
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};

    #[test]
    fn a_heap_gives_the_highest_rank_first_and_of_equals_the_lowest_number() {
        let mut heap: BinaryHeap<Ranked> = [(1.0, 7), (2.0, 9), (2.0, 3)].map(|(r, i)| Ranked::new(r, i)).into();
        let order: Vec<u32> = std::iter::from_fn(|| heap.pop()).map(|ranked| ranked.index).collect();
        assert_eq!(order, [3, 9, 7]);
    }

    #[test]
    fn a_queue_gives_things_out_as_a_heap_does_also_those_that_come_later() {
        let mut rng = stream(1, Stage::Scan);
        let mut ranked = |index: u32| Ranked::new((20.0 * (unit(&mut rng) - 0.7)).round() * unit(&mut rng), index);
        let mut heap: BinaryHeap<Ranked> = [0.0, -0.0, 1e-300, -1e300].map(|rank| Ranked::new(rank, 9)).into();
        heap.extend((0..500).map(&mut ranked));
        let mut queue: RankedQueue = heap.iter().copied().collect();
        for index in 500..2000 {
            assert!(heap.pop() == queue.pop());
            let more = ranked(index);
            heap.push(more);
            queue.push(more);
        }
        while let Some(top) = heap.pop() {
            assert!(queue.pop() == Some(top));
        }
        assert!(queue.pop().is_none());
    }
}
