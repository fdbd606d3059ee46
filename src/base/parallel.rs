//! Parallel loops over ranges and slices, in blocks.
//!
//! Within a block, the work is an ordinary loop or iterator. The code that distributes blocks is compiled once for each
//! result type: rayon's own iterators are compiled anew for each use, and made up a third of the code of the whole program.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Sequences that can be split into blocks: ranges, slices, and pairs of them with the same length.
pub(crate) trait Items: Sync {
    /// The number of items.
    fn len(&self) -> usize;

    /// Returns the items with these numbers, counted from 0.
    fn block(&self, numbers: Range<usize>) -> Self;
}

impl Items for Range<usize> {
    fn len(&self) -> usize {
        ExactSizeIterator::len(self)
    }

    fn block(&self, numbers: Range<usize>) -> Self {
        self.start + numbers.start..self.start + numbers.end
    }
}

impl Items for Range<u32> {
    fn len(&self) -> usize {
        ExactSizeIterator::len(self)
    }

    fn block(&self, numbers: Range<usize>) -> Self {
        self.start + numbers.start as u32..self.start + numbers.end as u32
    }
}

impl<T: Sync> Items for &[T] {
    fn len(&self) -> usize {
        (**self).len()
    }

    fn block(&self, numbers: Range<usize>) -> Self {
        &self[numbers]
    }
}

impl<A: Items, B: Items> Items for (A, B) {
    fn len(&self) -> usize {
        debug_assert_eq!(self.0.len(), self.1.len());
        self.0.len()
    }

    fn block(&self, numbers: Range<usize>) -> Self {
        (self.0.block(numbers.clone()), self.1.block(numbers))
    }
}

/// Returns the result of `of_item` for each item, in order. For items that each take little time; use [`each`] for long
/// ones.
pub(crate) fn map<I, T>(items: I, of_item: impl Fn(I::Item) -> T + Sync) -> Vec<T>
where
    I: Items + IntoIterator,
    T: Send,
{
    collect(items, |block| block.into_iter().map(&of_item))
}

/// Like [`map`], with memory from `scratch` that `of_item` reuses from one item to the next.
pub(crate) fn map_with<I, S, T>(
    items: I,
    scratch: impl Fn() -> S + Sync,
    of_item: impl Fn(&mut S, I::Item) -> T + Sync,
) -> Vec<T>
where
    I: Items + IntoIterator,
    T: Send,
{
    let of_item = &of_item;
    collect(items, |block| {
        let mut scratch = scratch();
        block.into_iter().map(move |item| of_item(&mut scratch, item))
    })
}

/// Concatenates the results of `of_block` for blocks of `items`, in order. The block size depends on the number of threads,
/// so the result for an item must not depend on the other items of its block.
pub(crate) fn collect<I, R>(items: I, of_block: impl Fn(I) -> R + Sync) -> Vec<R::Item>
where
    I: Items,
    R: IntoIterator<Item: Send>,
{
    let size = block_size(items.len());
    joined(in_blocks(items.len(), size, &|numbers| of_block(items.block(numbers)).into_iter().collect()))
}

/// Concatenates the parts.
fn joined<T>(mut parts: Vec<Vec<T>>) -> Vec<T> {
    if parts.len() == 1 {
        return parts.swap_remove(0);
    }
    let mut all = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    for mut part in parts {
        all.append(&mut part);
    }
    all
}

/// Returns whether `fits` holds for all numbers below `count`. Blocks do not communicate, so all of them are visited even if
/// a number does not fit.
pub(crate) fn all(count: usize, fits: impl Fn(usize) -> bool + Sync) -> bool {
    let of_blocks = in_blocks(count, block_size(count), &|mut block| block.all(&fits));
    of_blocks.into_iter().all(|fits| fits)
}

/// Returns the result of `of_block` for each block of `size` items, in order; the last block may be smaller. Sums over such
/// blocks do not depend on the number of threads.
pub(crate) fn blocks<I: Items, T: Send>(items: I, size: usize, of_block: impl Fn(I) -> T + Sync) -> Vec<T> {
    in_blocks(items.len(), size, &|numbers| of_block(items.block(numbers)))
}

/// Calls `work` with each item and its number.
pub(crate) fn for_each_mut<T: Send>(items: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    let size = block_size(items.len());
    each(items.chunks_mut(size).enumerate(), |(block, items)| {
        items.iter_mut().zip(block * size..).for_each(|(item, number)| work(number, item));
    });
}

/// Returns the result of `of_item` for each item, in order. For items that are each enough work for a thread.
pub(crate) fn each<I: Send, T: Send>(items: impl IntoIterator<Item = I>, of_item: impl Fn(I) -> T + Sync) -> Vec<T> {
    let items: Vec<Mutex<Option<I>>> = items.into_iter().map(|item| Mutex::new(Some(item))).collect();
    in_blocks(items.len(), 1, &|number| of_item(lock(&items[number.start]).take().expect("each item has one turn")))
}

/// Returns the result of `of_block` for each block of `size` numbers below `count`, in order.
fn in_blocks<T: Send>(count: usize, size: usize, of_block: &(dyn Fn(Range<usize>) -> T + Sync)) -> Vec<T> {
    let mut results = Vec::new();
    results.resize_with(count.div_ceil(size), || Mutex::new(None));
    run(results.len(), &|block| {
        let result = of_block(block * size..count.min((block + 1) * size));
        *lock(&results[block]) = Some(result);
    });
    let mut all = Vec::with_capacity(results.len());
    for result in &results {
        all.extend(lock(result).take());
    }
    all
}

/// Returns the content of `slot`, which no other thread uses at the same time.
fn lock<T>(slot: &Mutex<T>) -> MutexGuard<'_, T> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls `work` with each number below `count`.
fn run(count: usize, work: &(dyn Fn(usize) + Sync)) {
    match count {
        1 => work(0),
        _ => (0..count).into_par_iter().for_each(work),
    }
}

/// Returns a block size small enough for idle threads to take blocks over from threads whose own take long.
fn block_size(count: usize) -> usize {
    count.div_ceil(BLOCKS * rayon::current_num_threads()).max(LEAST)
}

/// Number of blocks per thread, and minimum number of items per block.
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
                    let keep = |last: &mut usize, i| std::mem::replace(last, i).max(i);
                    assert_eq!(map_with(0..count, || 0, keep), items);
                    let odd: Vec<usize> = items.iter().copied().filter(|i| i % 2 == 1).collect();
                    assert_eq!(collect(0..count as u32, |block| block.map(|i| i as usize).filter(|i| i % 2 == 1)), odd);
                    let mut doubled = items.clone();
                    for_each_mut(&mut doubled, |i, own| *own += i);
                    assert_eq!(doubled, items.iter().map(|i| 2 * i).collect::<Vec<_>>());
                }
            });
        }
    }

    #[test]
    fn blocks_have_the_size_that_is_asked_for() {
        assert_eq!(blocks(3..13u32, 4, |block| block), [3..7, 7..11, 11..13]);
        assert_eq!(blocks(0..8usize, 4, |block| block.sum::<usize>()), [6, 22]);
        assert_eq!(blocks((0..3u32, &[5, 6, 7][..]), 2, |(i, _)| i), [0..2, 2..3]);
        assert!(blocks(0..0usize, 4, |_| ()).is_empty());
    }

    #[test]
    fn a_panic_in_a_block_reaches_the_caller() {
        let result = std::panic::catch_unwind(|| map(0..100usize, |i| assert_ne!(i, 77)));
        assert!(result.is_err());
    }
}
