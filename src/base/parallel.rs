//! Loops on all threads, over ranges and slices in blocks.
//!
//! What is done with a block is an ordinary loop or iterator. The loop over blocks is compiled once: rayon's own iterators are
//! compiled anew for each use, and were half of the whole program's code.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// What can be cut into blocks: ranges, slices, and two of the same length side by side.
pub(crate) trait Split: Sized + Send {
    /// The number of items.
    fn len(&self) -> usize;

    /// The first `at` items, and the others.
    fn split_at(self, at: usize) -> (Self, Self);
}

impl Split for Range<usize> {
    fn len(&self) -> usize {
        ExactSizeIterator::len(self)
    }

    fn split_at(self, at: usize) -> (Self, Self) {
        (self.start..self.start + at, self.start + at..self.end)
    }
}

impl Split for Range<u32> {
    fn len(&self) -> usize {
        ExactSizeIterator::len(self)
    }

    fn split_at(self, at: usize) -> (Self, Self) {
        (self.start..self.start + at as u32, self.start + at as u32..self.end)
    }
}

impl<T: Sync> Split for &[T] {
    fn len(&self) -> usize {
        (**self).len()
    }

    fn split_at(self, at: usize) -> (Self, Self) {
        <[T]>::split_at(self, at)
    }
}

impl<T: Send> Split for &mut [T] {
    fn len(&self) -> usize {
        (**self).len()
    }

    fn split_at(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

impl<A: Split, B: Split> Split for (A, B) {
    fn len(&self) -> usize {
        debug_assert_eq!(self.0.len(), self.1.len());
        self.0.len()
    }

    fn split_at(self, at: usize) -> (Self, Self) {
        let (a, other_a) = self.0.split_at(at);
        let (b, other_b) = self.1.split_at(at);
        ((a, b), (other_a, other_b))
    }
}

/// What `of_item` gives for each item, in their order. One item is little work; [`each`] is for those that take long.
pub(crate) fn map<S, T>(items: S, of_item: impl Fn(S::Item) -> T + Sync) -> Vec<T>
where
    S: Split + IntoIterator,
    T: Send,
{
    collect(items, |block| block.into_iter().map(&of_item))
}

/// All that `of_block` gives for blocks of `items`, in their order. How large blocks are depends on the number of threads, so
/// what is given for an item must not depend on the others of its block.
pub(crate) fn collect<S, I>(items: S, of_block: impl Fn(S) -> I + Sync) -> Vec<I::Item>
where
    S: Split,
    I: IntoIterator<Item: Send>,
{
    let size = block_size(items.len());
    let mut parts = blocks(items, size, |block| of_block(block).into_iter().collect::<Vec<_>>()).into_iter();
    if parts.len() == 1 {
        return parts.next().unwrap_or_default();
    }
    let mut all = Vec::with_capacity(parts.as_slice().iter().map(Vec::len).sum());
    parts.for_each(|part| all.extend(part));
    all
}

/// Whether each number below `count` `fits`. Blocks do not hear of each other, so all are looked at even if one does not fit.
pub(crate) fn all(count: usize, fits: impl Fn(usize) -> bool + Sync) -> bool {
    collect(0..count, |mut block| [block.all(&fits)]).into_iter().all(|fits| fits)
}

/// Does `work` with blocks of `items`, of a size that depends on the number of threads.
pub(crate) fn for_each<S: Split>(items: S, work: impl Fn(S) + Sync) {
    let size = block_size(items.len());
    blocks(items, size, work);
}

/// What `of_block` gives for each block of `size` items, in their order; the last one may have fewer. Sums over such blocks
/// do not depend on the number of threads.
pub(crate) fn blocks<S: Split, T: Send>(items: S, size: usize, of_block: impl Fn(S) -> T + Sync) -> Vec<T> {
    let mut rest = items;
    let mut all = Vec::with_capacity(rest.len().div_ceil(size));
    while rest.len() > size {
        let (block, others) = rest.split_at(size);
        all.push(block);
        rest = others;
    }
    if rest.len() > 0 {
        all.push(rest);
    }
    each(all, of_block)
}

/// What `of_item` gives for each of the items, one of which is enough work for a thread, in their order.
pub(crate) fn each<S: Send, T: Send>(items: impl IntoIterator<Item = S>, of_item: impl Fn(S) -> T + Sync) -> Vec<T> {
    let slots: Vec<Mutex<Slot<S, T>>> = items.into_iter().map(|item| Mutex::new(Slot::Before(item))).collect();
    run(slots.len(), &|i| {
        let mut slot = slots[i].lock().unwrap_or_else(PoisonError::into_inner);
        if let Slot::Before(item) = std::mem::replace(&mut *slot, Slot::Empty) {
            *slot = Slot::After(of_item(item));
        }
    });
    let result = |slot: Mutex<Slot<S, T>>| match slot.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Slot::After(result) => Some(result),
        Slot::Before(_) | Slot::Empty => None,
    };
    slots.into_iter().filter_map(result).collect()
}

/// An item before its turn, or what came of it.
enum Slot<S, T> {
    Before(S),
    Empty,
    After(T),
}

/// Calls `work` with each number below `count`.
fn run(count: usize, work: &(dyn Fn(usize) + Sync)) {
    match count {
        1 => work(0),
        _ => (0..count).into_par_iter().for_each(work),
    }
}

/// So many blocks of `count` items that threads whose blocks take long leave others to those that wait.
fn block_size(count: usize) -> usize {
    count.div_ceil(BLOCKS * rayon::current_num_threads()).max(LEAST)
}

/// Blocks for each thread, and items of a block at least.
const BLOCKS: usize = 32;
const LEAST: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_items_are_taken_once_and_in_order_whatever_the_number_of_threads() {
        for threads in [1, 2, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                for count in [0, 1, 2, 63, 64, 65, 1000] {
                    let items: Vec<usize> = (0..count).collect();
                    assert_eq!(map(0..count, |i| i), items);
                    assert_eq!(map(&items[..], |&i| i), items);
                    let odd: Vec<usize> = items.iter().copied().filter(|i| i % 2 == 1).collect();
                    assert_eq!(collect(0..count as u32, |block| block.map(|i| i as usize).filter(|i| i % 2 == 1)), odd);
                    let mut doubled = items.clone();
                    for_each((&mut doubled[..], 0..count), |(own, block)| {
                        own.iter_mut().zip(block).for_each(|(own, i)| *own += i);
                    });
                    assert_eq!(doubled, items.iter().map(|i| 2 * i).collect::<Vec<_>>());
                }
            });
        }
    }

    #[test]
    fn blocks_have_the_size_that_is_asked_for() {
        assert_eq!(blocks(3..13u32, 4, |block| block), [3..7, 7..11, 11..13]);
        assert_eq!(blocks(0..8usize, 4, |block| block.sum::<usize>()), [6, 22]);
        assert!(blocks(0..0usize, 4, |_| ()).is_empty());
    }

    #[test]
    fn a_panic_in_a_block_reaches_the_caller() {
        let result = std::panic::catch_unwind(|| map(0..100usize, |i| assert_ne!(i, 77)));
        assert!(result.is_err());
    }
}
