//! What heaps of numbered things are ordered by.

use std::cmp::Ordering;

/// A numbered thing: the greater has the higher rank, or at the same rank the lower number, so that a heap gives things
/// out in one order only.
#[derive(Debug, Clone, Copy)]
pub struct Ranked<T = ()> {
    /// What counts.
    pub rank: f64,
    /// The number of the thing.
    pub index: u32,
    /// What else is known of it; it does not count.
    pub item: T,
}

impl Ranked {
    /// Thing number `index` at a rank.
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BinaryHeap;

    #[test]
    fn a_heap_gives_the_highest_rank_first_and_of_equals_the_lowest_number() {
        let mut heap: BinaryHeap<Ranked> = [(1.0, 7), (2.0, 9), (2.0, 3)].map(|(r, i)| Ranked::new(r, i)).into();
        let order: Vec<u32> = std::iter::from_fn(|| heap.pop()).map(|ranked| ranked.index).collect();
        assert_eq!(order, [3, 9, 7]);
    }
}
