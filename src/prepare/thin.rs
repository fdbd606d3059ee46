//! Thins a cloud with more points than are useful while it is read: one point per cell of a lattice. Points outside of the
//! wanted box, if there is one, are left out before.
//!
//! A cell keeps the point nearest to its centre, and the first among equally near ones; where points face opposite ways, as
//! on the two sides of a thin wall, it keeps one per side. Cells are anchored at the origin. Their width is a power of two
//! and doubles whenever more than four times the wanted number of points are kept; so each cell is one of the eight parts of
//! a cell twice as wide, and what is kept depends only on the points and their order. At the end, a lattice of arbitrary
//! width reduces them to about the wanted number. Points are not averaged: each one kept is a point of the input, with its
//! number, normal and colour.
//!
//! A point is an opaque row of bytes, so a file can be thinned before it is parsed.
//!
//! Cost: one table look-up per point. Memory: four rows per wanted point, and twelve bytes for each of these rows.
//!
//! Limits: isolated points are alone in their cells and stay, so their share grows.

use crate::base::error::{Error, Result, Setting};
use crate::base::parallel;
use crate::geom::aabb::Aabb;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;
use std::ops::Range;

/// Factor by which the number of points kept during reading may exceed the wanted one.
const ROOM: usize = 4;

/// Share of that room that a wider lattice may fill.
const FILLED: f64 = 0.875;

/// A lattice that leaves at least this share of the wanted points is good enough.
const ENOUGH: f64 = 0.95;

/// Maximum number of lattices tried for the last one.
const TRIES: usize = 16;

/// Above this many points, only one in [`SHARE`] cells is counted.
const MANY: usize = 1 << 18;
const SHARE: u64 = 16;

/// Minimum cell width as a share of the first one, and the width used where the points have no extent.
const NARROWEST: f64 = 1.0 / (1 << 24) as f64;
const UNKNOWN: f64 = 1.0 / (1 << 30) as f64;

/// Number of points processed together.
const BATCH: usize = 32;

/// Marks an empty slot.
const EMPTY: u32 = u32::MAX;

/// Position and normal of a point, as its row gives them.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Its position, finite.
    pub position: DVec3,
    /// Its normal, of any length; zero where none is known.
    pub normal: DVec3,
}

/// Which points of a cloud are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wanted {
    /// Approximate maximum number of points; `None` for any number.
    pub points: Option<usize>,
    /// Only those inside this box or on its faces; `None` for those anywhere.
    pub within: Option<Aabb>,
}

impl Wanted {
    /// Returns whether all of `points` points are wanted, wherever they are.
    pub fn is_all_of(&self, points: usize) -> bool {
        self.within.is_none() && self.points.is_none_or(|most| points <= most)
    }

    /// Returns whether the place of a point is in the box.
    pub fn contains(&self, position: DVec3) -> bool {
        self.within.is_none_or(|within| within.contains(position))
    }
}

/// The points kept of a cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct Thinned {
    /// Number of points of the whole cloud.
    pub points: usize,
    /// Levels of detail by which the points were read, if the cloud has any.
    pub levels: Option<Levels>,
    /// Number of these points that are inside the wanted box; all of them if there is no box.
    pub inside: usize,
    /// Bounding box of the points that were read; `None` if there were none.
    pub bounds: Option<Aabb>,
    /// Width of the cells that keep one point each, in the units of the points; 0 if all points inside were kept.
    pub cell: f64,
    /// Numbers of the kept points, in ascending order.
    pub numbers: Vec<u32>,
}

/// Levels of detail of a cloud, of which each adds points between those of coarser ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Number of levels that were read, the coarsest ones.
    pub read: usize,
    /// Number of levels of the cloud.
    pub all: usize,
    /// Number of points that were read.
    pub points: usize,
}

impl Thinned {
    /// Returns the number of points that were read and are outside the wanted box.
    pub fn outside(&self) -> usize {
        self.levels.map_or(self.points, |levels| levels.points) - self.inside
    }

    /// Returns notes on the points that were left out.
    pub fn notes(&self) -> Vec<String> {
        let Thinned { points, levels, inside, cell, numbers, .. } = self;
        let kept = numbers.len();
        let levels = levels.filter(|levels| levels.read < levels.all);
        let of_levels = levels.map(|Levels { read, all, points: read_points }| {
            format!(
                "the {read} coarsest of {all} levels of the file were read: they have {read_points} of its {points} points"
            )
        });
        let read = levels.map_or(*points, |levels| levels.points);
        let of_box = (self.outside() > 0)
            .then(|| format!("{inside} of {read} points are inside the box; the others were left out"));
        let of_cells = (*cell > 0.0).then(|| {
            format!(
                "{inside} points are more than needed and were thinned to {kept}, one for each cell of width {cell:.4e}; each \
                 removed point is within {:.4e} of one that was kept",
                self.reach()
            )
        });
        [of_levels, of_box, of_cells].into_iter().flatten().collect()
    }

    /// Refuses a box that contains no points.
    ///
    /// # Errors
    /// [`Error::Option`] with the box and that of the points.
    pub fn refuse_empty(&self, wanted: &Wanted) -> Result<()> {
        let Some(within) = wanted.within.filter(|_| self.inside == 0 && self.points > 0) else { return Ok(()) };
        let theirs = self.bounds.map_or(String::new(), |bounds| format!(": those that were read are within {bounds}"));
        let cause = format!("none of the {} points is inside {within}{theirs}", self.points);
        Err(Error::Option { option: Setting::PartBox, cause, remedy: "give a larger box, or another one".into() })
    }

    /// Returns an upper bound on the distance from a dropped point to a kept one: two cell diagonals, one for the last
    /// lattice and one for those before it.
    pub fn reach(&self) -> f64 {
        2.0 * 3f64.sqrt() * self.cell
    }
}

/// Thins a cloud that arrives row by row.
pub struct Thinner<L> {
    /// Approximate maximum number of points.
    most: usize,
    wanted: Wanted,
    look: L,
    seen: usize,
    inside: usize,
    bounds: Aabb,
    kept: Rows,
    lattice: Option<Lattice>,
}

/// Rows of equal length in bytes, and the numbers of their points.
struct Rows {
    width: usize,
    bytes: Vec<u8>,
    numbers: Vec<u32>,
}

struct Lattice {
    width: f64,
    /// Number of its points: they are the first rows.
    count: usize,
    /// Hash table of the points of cells; its length is a power of two.
    slots: Vec<Slot>,
}

#[derive(Clone, Copy)]
struct Slot {
    /// Bits of the cell's hash, which tell it from most other cells.
    tag: u32,
    point: u32,
}

impl<L: Fn(&[u8]) -> Seen + Sync> Thinner<L> {
    /// Makes a thinner that keeps the wanted points of a cloud whose rows have `width` bytes; `look` reads a row.
    pub fn new(wanted: Wanted, width: usize, look: L) -> Self {
        let kept = Rows { width, bytes: Vec::new(), numbers: Vec::new() };
        // Numbers of points are below 2^32.
        let most = wanted.points.unwrap_or(usize::MAX / ROOM);
        Thinner { most, wanted, look, seen: 0, inside: 0, bounds: Aabb::EMPTY, kept, lattice: None }
    }

    /// Adds points as consecutive rows. The first one has the number `first`, which must be above all numbers before; all
    /// numbers must be below 2^32.
    pub fn push(&mut self, first: usize, rows: &[u8]) {
        let width = self.kept.width;
        let look = |i: usize| (self.look)(&rows[width * i..width * (i + 1)]);
        let all_seen = parallel::map(0..rows.len() / width, look);
        self.seen += all_seen.len();
        let batches = rows.chunks(BATCH * width).zip(all_seen.chunks(BATCH)).zip((first..).step_by(BATCH));
        for ((rows, all_seen), first) in batches {
            if let Some(lattice) = &self.lattice {
                lattice.warm(&self.kept, all_seen);
            }
            for ((row, &seen), number) in rows.chunks_exact(width).zip(all_seen).zip(first..) {
                self.bounds = self.bounds.join(&Aabb::at(seen.position));
                if self.wanted.contains(seen.position) {
                    self.inside += 1;
                    self.push_one(row, seen, number as u32);
                }
            }
        }
    }

    fn push_one(&mut self, row: &[u8], seen: Seen, number: u32) {
        match &mut self.lattice {
            None => self.kept.put(self.kept.numbers.len(), row, number),
            Some(lattice) => lattice.offer(&mut self.kept, row, seen, number, &self.look),
        }
        if self.kept.numbers.len() > ROOM * self.most {
            let width = self.wider();
            self.bin(width, ROOM * self.most);
        }
    }

    /// Returns the kept points and their rows, in input order.
    pub fn finish(mut self) -> (Thinned, Vec<u8>) {
        let mut cell = 0.0;
        if self.kept.numbers.len() > self.most {
            cell = self.last_width();
            let room = self.kept.numbers.len();
            self.bin(cell, room);
        }
        self.lattice = None;
        let (numbers, rows) = self.kept.in_order();
        let bounds = (self.seen > 0).then_some(self.bounds);
        (Thinned { points: self.seen, levels: None, inside: self.inside, bounds, cell, numbers }, rows)
    }

    /// Returns the width of the next lattice: the smallest one, by doubling, that leaves room for more points.
    fn wider(&self) -> f64 {
        let most = (FILLED * (ROOM * self.most) as f64) as usize;
        let mut width = match &self.lattice {
            Some(lattice) => 2.0 * lattice.width,
            None => {
                let mut width = self.first_width();
                let narrowest = width * NARROWEST;
                while width > narrowest && self.cells(0.5 * width) <= most {
                    width *= 0.5;
                }
                width
            }
        };
        while self.cells(width) > most {
            width *= 2.0;
        }
        width
    }

    /// Returns a power of two: about the cell width at which a surface as wide as the points has the wanted number of cells.
    fn first_width(&self) -> f64 {
        let places = (0..self.kept.numbers.len()).map(|i| (self.look)(self.kept.row(i)).position);
        let extent = Aabb::of(places).unwrap_or_default().size().max_element();
        if extent > 0.0 { power_of_two(extent / (self.most.max(1) as f64).sqrt()) } else { UNKNOWN }
    }

    /// Returns the cell width at which about the wanted number of cells, and hardly more, contain points.
    fn last_width(&self) -> f64 {
        let most = self.most;
        let mut width = self.lattice.as_ref().map_or_else(|| self.first_width(), |lattice| lattice.width);
        let (mut too_narrow, mut wide) = (0.0, f64::INFINITY);
        for _ in 0..TRIES {
            let cells = self.cells(width);
            if cells > most {
                too_narrow = width;
            } else {
                wide = width;
                if cells as f64 >= ENOUGH * most as f64 {
                    break;
                }
            }
            let by_area = width * (cells as f64 / (0.5 * (1.0 + ENOUGH) * most as f64)).sqrt();
            let is_between = too_narrow < by_area && by_area < wide;
            width = if is_between {
                by_area
            } else if wide.is_finite() {
                0.5 * (too_narrow + wide)
            } else {
                2.0 * width
            };
        }
        if wide.is_finite() { wide } else { width }
    }

    /// Returns approximately how many cells of this width contain points.
    fn cells(&self, width: f64) -> usize {
        let points = self.kept.numbers.len();
        let share = if points > MANY { SHARE } else { 1 };
        let cell = |i: usize| hash(cell_of((self.look)(self.kept.row(i)).position, width));
        let mut found = parallel::collect(0..points, |block| block.map(cell).filter(|hash| hash % share == 0));
        found.par_sort_unstable();
        found.dedup();
        share as usize * found.len()
    }

    /// Reduces the points kept so far to one per cell of this width, with room for `room` points.
    fn bin(&mut self, width: f64, room: usize) {
        // Free the slots of the previous lattice first.
        self.lattice = None;
        let mut lattice = Lattice::new(width, room);
        let all = self.kept.numbers.len();
        for first in (0..all).step_by(BATCH) {
            // Kept rows are written at or before the rows that are being read.
            let batch = self.kept.part(first..all.min(first + BATCH));
            let all_seen: Vec<Seen> = batch.iter().map(|(row, _)| (self.look)(row)).collect();
            lattice.warm(&self.kept, &all_seen);
            for ((row, number), seen) in batch.iter().zip(all_seen) {
                lattice.offer(&mut self.kept, row, seen, number, &self.look);
            }
        }
        self.kept.truncate(lattice.count);
        self.lattice = Some(lattice);
    }
}

impl Lattice {
    /// Makes an empty lattice with cells of this width and room for `room` points.
    fn new(width: f64, room: usize) -> Lattice {
        let slot = Slot { tag: 0, point: EMPTY };
        Lattice { width, count: 0, slots: vec![slot; (room + room / 2 + 2).next_power_of_two()] }
    }

    /// Prefetches the rows that points will be compared with, all at once instead of one after the other.
    fn warm(&self, kept: &Rows, all_seen: &[Seen]) {
        let mut points = [0; BATCH];
        for (point, seen) in points.iter_mut().zip(all_seen) {
            let hash = hash(cell_of(seen.position, self.width));
            *point = self.slots[hash as usize & (self.slots.len() - 1)].point;
        }
        let bytes = points.iter().map(|&p| u32::from(*kept.bytes.get(kept.width * p as usize).unwrap_or(&0)));
        std::hint::black_box(bytes.sum::<u32>());
    }

    /// Keeps a point if it is the first in its cell or nearer to the centre than the one there.
    fn offer(&mut self, kept: &mut Rows, row: &[u8], seen: Seen, number: u32, look: &impl Fn(&[u8]) -> Seen) {
        let cell = cell_of(seen.position, self.width);
        let hash = hash(cell);
        let (mask, tag) = (self.slots.len() - 1, (hash >> 32) as u32);
        let mut at = hash as usize & mask;
        loop {
            let slot = self.slots[at];
            if slot.point == EMPTY {
                self.slots[at] = Slot { tag, point: self.count as u32 };
                kept.put(self.count, row, number);
                self.count += 1;
                return;
            }
            if slot.tag == tag {
                let there = look(kept.row(slot.point as usize));
                if cell_of(there.position, self.width) == cell && there.normal.dot(seen.normal) >= 0.0 {
                    let off_centre = |p: DVec3| p.distance_squared(self.width * (cell + 0.5));
                    if off_centre(seen.position) < off_centre(there.position) {
                        kept.put(slot.point as usize, row, number);
                    }
                    return;
                }
            }
            at = (at + 1) & mask;
        }
    }
}

impl Rows {
    fn row(&self, i: usize) -> &[u8] {
        &self.bytes[self.width * i..self.width * (i + 1)]
    }

    /// Copies a range of rows.
    fn part(&self, rows: Range<usize>) -> Rows {
        let bytes = &self.bytes[self.width * rows.start..self.width * rows.end];
        Rows { width: self.width, bytes: bytes.to_vec(), numbers: self.numbers[rows].to_vec() }
    }

    /// Iterates over the rows and their numbers.
    fn iter(&self) -> impl Iterator<Item = (&[u8], u32)> {
        self.bytes.chunks_exact(self.width).zip(self.numbers.iter().copied())
    }

    /// Replaces row `i`, or appends the row if `i` is one past the last.
    fn put(&mut self, i: usize, row: &[u8], number: u32) {
        if i == self.numbers.len() {
            self.bytes.extend_from_slice(row);
            self.numbers.push(number);
        } else {
            self.bytes[self.width * i..self.width * (i + 1)].copy_from_slice(row);
            self.numbers[i] = number;
        }
    }

    fn truncate(&mut self, count: usize) {
        self.bytes.truncate(self.width * count);
        self.numbers.truncate(count);
    }

    /// Returns the numbers in ascending order, and the rows in the same order.
    fn in_order(self) -> (Vec<u32>, Vec<u8>) {
        let mut order: Vec<u32> = (0..self.numbers.len() as u32).collect();
        order.par_sort_unstable_by_key(|&i| self.numbers[i as usize]);
        let numbers = order.iter().map(|&i| self.numbers[i as usize]).collect();
        (numbers, order.iter().flat_map(|&i| self.row(i as usize)).copied().collect())
    }
}

/// Returns the cell that contains a point, in whole numbers as far as f64 can represent them.
fn cell_of(position: DVec3, width: f64) -> DVec3 {
    (position / width).floor()
}

/// Hashes a cell, spreading it over all bits.
fn hash(cell: DVec3) -> u64 {
    // Adding zero turns -0.0 into 0.0.
    let mixed =
        cell.to_array().iter().fold(0u64, |sum, x| (sum.rotate_left(21) ^ (x + 0.0).to_bits()).wrapping_mul(FACTOR));
    let folded = mixed ^ mixed >> 29;
    folded.wrapping_mul(FACTOR) ^ folded >> 32
}

/// 2^64 over the golden ratio, odd.
const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;

/// Returns the largest power of two that is not above `x`, which must be positive and normal.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & 0x7FF0_0000_0000_0000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};

    /// Makes a row of each point: three coordinates and the normal.
    fn rows(points: &[DVec3], normal: DVec3) -> Vec<u8> {
        points.iter().flat_map(|p| [p.to_array(), normal.to_array()]).flatten().flat_map(f64::to_ne_bytes).collect()
    }

    fn look(row: &[u8]) -> Seen {
        let x = |k: usize| f64::from_ne_bytes(row[8 * k..8 * k + 8].try_into().unwrap());
        Seen { position: DVec3::new(x(0), x(1), x(2)), normal: DVec3::new(x(3), x(4), x(5)) }
    }

    fn thinned(wanted: usize, rows: &[u8], block: usize) -> (Thinned, Vec<u8>) {
        let wanted = Wanted { points: Some(wanted), within: None };
        let mut thinner = Thinner::new(wanted, 48, look);
        rows.chunks(48 * block).zip((0..).step_by(block)).for_each(|(rows, first)| thinner.push(first, rows));
        thinner.finish()
    }

    /// Random points on a unit square lifted to a saddle, one in a thousand far above it.
    fn saddle(count: usize) -> Vec<DVec3> {
        let mut rng = stream(3, Stage::Candidates);
        let point = |i: usize| {
            let (x, y) = (unit(&mut rng), unit(&mut rng));
            DVec3::new(x, y, if i % 1000 == 7 { 3.0 + x } else { x * y })
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn no_more_points_than_wanted_stay_all() {
        let points = saddle(500);
        let (kept, rows) = thinned(500, &rows(&points, DVec3::Z), 7);
        assert_eq!((kept.points, kept.inside, kept.cell), (500, 500, 0.0));
        assert!(kept.numbers == (0..500).collect::<Vec<u32>>() && kept.bounds == Aabb::of(points.iter().copied()));
        assert!(rows == super::tests::rows(&points, DVec3::Z));
    }

    #[test]
    fn about_as_many_stay_as_are_wanted_and_each_other_one_is_near_one_of_them() {
        let points = saddle(60_000);
        let all = rows(&points, DVec3::ZERO);
        let (kept, rows) = thinned(2000, &all, 1000);
        assert!((1400..=2000).contains(&kept.numbers.len()) && kept.points == 60_000, "{}", kept.numbers.len());
        assert!(kept.numbers.is_sorted());
        assert!(kept.numbers.iter().zip(rows.chunks(48)).all(|(&p, row)| look(row).position == points[p as usize]));
        let near = crate::spatial::kdtree::Neighbors::new(
            &kept.numbers.iter().map(|&p| points[p as usize]).collect::<Vec<DVec3>>(),
        );
        assert!(points.iter().all(|&p| near.has_within(p, kept.reach())));
        // Cells are about as wide as the spacing of the points.
        assert!(kept.cell < 2.0 / (kept.numbers.len() as f64).sqrt(), "{}", kept.cell);
        assert!(thinned(2000, &all, 1).0 == kept && thinned(2000, &all, 60_000).0 == kept);
    }

    #[test]
    fn what_comes_first_does_not_decide_how_wide_cells_are() {
        // One corner of the cloud comes first, and before it many points at one place.
        let mut points = saddle(60_000);
        points.sort_by(|a, b| a.length().total_cmp(&b.length()));
        let first = vec![DVec3::ZERO; 10_000];
        let (kept, _) = thinned(2000, &rows(&[first, points].concat(), DVec3::ZERO), 512);
        assert!((1400..=2000).contains(&kept.numbers.len()), "{}", kept.numbers.len());
    }

    #[test]
    fn both_sides_of_a_thin_wall_stay() {
        let side = saddle(20_000);
        let other: Vec<DVec3> = side.iter().map(|p| *p - 1e-4 * DVec3::Z).collect();
        let (kept, _) = thinned(2000, &[rows(&side, DVec3::Z), rows(&other, DVec3::NEG_Z)].concat(), 512);
        let upper = kept.numbers.iter().filter(|&&p| p < 20_000).count();
        assert!(2 * upper > kept.numbers.len() - upper && 2 * (kept.numbers.len() - upper) > upper);
    }
}
