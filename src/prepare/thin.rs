//! A cloud with more points than are of use, thinned while it comes in: one point for each cell of a lattice.
//!
//! A cell keeps the point that is nearest to its centre, the first of equally near ones; of points that face apart, as on
//! the two sides of a thin wall, one for each side. Cells are anchored at the origin, and their width is a power of two,
//! doubled when more than four times the wanted points are kept; so each cell is one of eight of a cell twice as wide,
//! and what is kept depends on the points and their order alone. At the end a lattice of any width leaves about as many as
//! are wanted. Points are not averaged: each one kept is a point of the input, with its number, its normal and its colour.
//!
//! A point is a row of bytes, whatever is in it, so a file can be thinned before it is understood.
//!
//! Cost: a look into a table for each point. Memory: four rows, twelve bytes each beside, for each point wanted.
//!
//! Limits: isolated points are alone in their cells and stay, so their share grows.

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;
use std::ops::Range;

/// This many times more points than wanted are kept while points come in.
const ROOM: usize = 4;

/// The share of the room that a wider lattice may fill.
const FILLED: f64 = 0.875;

/// A lattice that leaves this share of what is wanted is good enough.
const ENOUGH: f64 = 0.95;

/// Lattices that are tried at most for the last one.
const TRIES: usize = 16;

/// Above this many points, cells are counted from one point in [`SHARE`].
const MANY: usize = 1 << 18;
const SHARE: u64 = 16;

/// The narrowest cells, as a share of the extent of the points, and their width where these have none.
const NARROWEST: f64 = 1.0 / (1 << 24) as f64;
const UNKNOWN: f64 = 1.0 / (1 << 30) as f64;

/// Points that are looked at together.
const BATCH: usize = 32;

/// No point in a slot.
const EMPTY: u32 = u32::MAX;

/// What a row says of its point.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Where it is: finite.
    pub position: DVec3,
    /// Its normal, of any length; zero where none is known.
    pub normal: DVec3,
}

/// What was kept of a cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct Thinned {
    /// How many points there were.
    pub points: usize,
    /// The width of the cells, one point of each of which is kept, in the units of the points; 0 if all were kept.
    pub cell: f64,
    /// The numbers of the points that were kept, in ascending order.
    pub numbers: Vec<u32>,
}

impl Thinned {
    /// How far a point that was not kept may be from one that was, at most: a diagonal of a cell, and where cells became
    /// wider in the end half of one more.
    pub fn reach(&self) -> f64 {
        2.0 * 3f64.sqrt() * self.cell
    }
}

/// A cloud that comes in row by row.
pub struct Thinner<L> {
    wanted: usize,
    look: L,
    seen: usize,
    kept: Rows,
    lattice: Option<Lattice>,
}

/// Rows of equally many bytes, and their numbers.
struct Rows {
    width: usize,
    bytes: Vec<u8>,
    numbers: Vec<u32>,
}

struct Lattice {
    width: f64,
    /// The points that it has: the first so many rows.
    count: usize,
    /// Where the points of cells are, in a power of two of slots.
    slots: Vec<Slot>,
}

#[derive(Clone, Copy)]
struct Slot {
    /// Bits of the cell that tell it from most others.
    tag: u32,
    point: u32,
}

impl<L: Fn(&[u8]) -> Seen + Sync> Thinner<L> {
    /// About `wanted` points at most are to be kept of a cloud whose rows have `width` bytes; `look` understands them.
    pub fn new(wanted: usize, width: usize, look: L) -> Self {
        let kept = Rows { width, bytes: Vec::new(), numbers: Vec::new() };
        Thinner { wanted, look, seen: 0, kept, lattice: None }
    }

    /// Takes the next points, whose rows follow each other. There may be fewer than 2^32.
    pub fn push(&mut self, rows: &[u8]) {
        let width = self.kept.width;
        let look = |i: usize| (self.look)(&rows[width * i..width * (i + 1)]);
        let all_seen = parallel::map(0..rows.len() / width, look);
        for (rows, all_seen) in rows.chunks(BATCH * width).zip(all_seen.chunks(BATCH)) {
            if let Some(lattice) = &self.lattice {
                lattice.warm(&self.kept, all_seen);
            }
            rows.chunks_exact(width).zip(all_seen).for_each(|(row, &seen)| self.push_one(row, seen));
        }
    }

    fn push_one(&mut self, row: &[u8], seen: Seen) {
        let number = self.seen as u32;
        self.seen += 1;
        match &mut self.lattice {
            None => self.kept.put(self.kept.numbers.len(), row, number),
            Some(lattice) => lattice.offer(&mut self.kept, row, seen, number, &self.look),
        }
        if self.kept.numbers.len() > ROOM * self.wanted {
            let width = self.wider();
            self.bin(width, ROOM * self.wanted);
        }
    }

    /// The points that are kept, and their rows, in the order in which they came.
    pub fn finish(mut self) -> (Thinned, Vec<u8>) {
        let mut cell = 0.0;
        if self.kept.numbers.len() > self.wanted {
            cell = self.last_width();
            let room = self.kept.numbers.len();
            self.bin(cell, room);
        }
        self.lattice = None;
        let (numbers, rows) = self.kept.in_order();
        (Thinned { points: self.seen, cell, numbers }, rows)
    }

    /// The width of the next lattice: the least, doubled, that leaves room for more points.
    fn wider(&self) -> f64 {
        let most = (FILLED * (ROOM * self.wanted) as f64) as usize;
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

    /// A power of two, about the width of cells that a surface as wide as the points has as many of as are wanted.
    fn first_width(&self) -> f64 {
        let places = (0..self.kept.numbers.len()).map(|i| (self.look)(self.kept.row(i)).position);
        let extent = Aabb::of(places).unwrap_or_default().size().max_element();
        if extent > 0.0 { power_of_two(extent / (self.wanted.max(1) as f64).sqrt()) } else { UNKNOWN }
    }

    /// The width of cells of which about as many as are wanted have points, hardly more.
    fn last_width(&self) -> f64 {
        let most = self.wanted;
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

    /// About how many cells of this width have points.
    fn cells(&self, width: f64) -> usize {
        let points = self.kept.numbers.len();
        let share = if points > MANY { SHARE } else { 1 };
        let cell = |i: usize| hash(cell_of((self.look)(self.kept.row(i)).position, width));
        let mut found = parallel::collect(0..points, |block| block.map(cell).filter(|hash| hash % share == 0));
        found.par_sort_unstable();
        found.dedup();
        share as usize * found.len()
    }

    /// Keeps one of the points that are kept so far for each cell of this width, with room for so many.
    fn bin(&mut self, width: f64, room: usize) {
        // The slots of the lattice before go first.
        self.lattice = None;
        let mut lattice = Lattice::new(width, room);
        let all = self.kept.numbers.len();
        for first in (0..all).step_by(BATCH) {
            // What is kept is written at or before the rows that are read.
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
    /// Cells of this width, without points, with room for so many.
    fn new(width: f64, room: usize) -> Lattice {
        let slot = Slot { tag: 0, point: EMPTY };
        Lattice { width, count: 0, slots: vec![slot; (room + room / 2 + 2).next_power_of_two()] }
    }

    /// Prefetches what points will be compared with, all at once instead of one after the other.
    fn warm(&self, kept: &Rows, all_seen: &[Seen]) {
        let mut points = [0; BATCH];
        for (point, seen) in points.iter_mut().zip(all_seen) {
            let hash = hash(cell_of(seen.position, self.width));
            *point = self.slots[hash as usize & (self.slots.len() - 1)].point;
        }
        let bytes = points.iter().map(|&p| u32::from(*kept.bytes.get(kept.width * p as usize).unwrap_or(&0)));
        std::hint::black_box(bytes.sum::<u32>());
    }

    /// Keeps a point if it is the first of its cell or nearer to the centre than the one there.
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

    /// A copy of these.
    fn part(&self, rows: Range<usize>) -> Rows {
        let bytes = &self.bytes[self.width * rows.start..self.width * rows.end];
        Rows { width: self.width, bytes: bytes.to_vec(), numbers: self.numbers[rows].to_vec() }
    }

    /// Each row and its number.
    fn iter(&self) -> impl Iterator<Item = (&[u8], u32)> {
        self.bytes.chunks_exact(self.width).zip(self.numbers.iter().copied())
    }

    /// A row in place of the one at `i`, or behind the last.
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

    /// The numbers in ascending order, and the rows of them.
    fn in_order(self) -> (Vec<u32>, Vec<u8>) {
        let mut order: Vec<u32> = (0..self.numbers.len() as u32).collect();
        order.par_sort_unstable_by_key(|&i| self.numbers[i as usize]);
        let numbers = order.iter().map(|&i| self.numbers[i as usize]).collect();
        (numbers, order.iter().flat_map(|&i| self.row(i as usize)).copied().collect())
    }
}

/// The cell that a point is in: whole numbers, as far as there are some so large.
fn cell_of(position: DVec3, width: f64) -> DVec3 {
    (position / width).floor()
}

/// A number for a cell that spreads over all bits.
fn hash(cell: DVec3) -> u64 {
    // Minus zero is zero.
    let mixed =
        cell.to_array().iter().fold(0u64, |sum, x| (sum.rotate_left(21) ^ (x + 0.0).to_bits()).wrapping_mul(FACTOR));
    let folded = mixed ^ mixed >> 29;
    folded.wrapping_mul(FACTOR) ^ folded >> 32
}

/// 2^64 over the golden ratio, odd.
const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;

/// The power of two at or below `x`, which is positive and normal.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & 0x7FF0_0000_0000_0000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};

    /// Three coordinates and a normal along one axis.
    fn rows(points: &[DVec3], normal: DVec3) -> Vec<u8> {
        points.iter().flat_map(|p| [p.to_array(), normal.to_array()]).flatten().flat_map(f64::to_ne_bytes).collect()
    }

    fn look(row: &[u8]) -> Seen {
        let x = |k: usize| f64::from_ne_bytes(row[8 * k..8 * k + 8].try_into().unwrap());
        Seen { position: DVec3::new(x(0), x(1), x(2)), normal: DVec3::new(x(3), x(4), x(5)) }
    }

    fn thinned(wanted: usize, rows: &[u8], block: usize) -> (Thinned, Vec<u8>) {
        let mut thinner = Thinner::new(wanted, 48, look);
        rows.chunks(48 * block).for_each(|rows| thinner.push(rows));
        thinner.finish()
    }

    /// Random points of a unit square that is lifted to a saddle, a thousandth of them far above it.
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
        assert!(kept == Thinned { points: 500, cell: 0.0, numbers: (0..500).collect() });
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
        let mut found = Vec::new();
        for p in &points {
            near.collect_nearest(*p, 1, &mut found);
            assert!(found[0].distance_squared.sqrt() <= kept.reach());
        }
        // Cells are about as wide as points are apart.
        assert!(kept.cell < 2.0 / (kept.numbers.len() as f64).sqrt(), "{}", kept.cell);
        assert!(thinned(2000, &all, 1).0 == kept && thinned(2000, &all, 60_000).0 == kept);
    }

    #[test]
    fn what_comes_first_does_not_decide_how_wide_cells_are() {
        // A corner of the whole comes first, and many points at one place before it.
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
