//! The nearest points that count for a gradient, kept in order while they are found.

use crate::spectral::measure::GRADIENT_NEIGHBOURS;

/// Points in the order of their distance, then their number.
#[derive(Default)]
pub struct Nearest {
    list: [(f64, u32); GRADIENT_NEIGHBOURS],
    count: usize,
}

impl Nearest {
    /// Inserts point `v` at that squared distance if it is near enough and new.
    #[inline]
    pub fn add(&mut self, distance: f64, v: u32) {
        if self.count == GRADIENT_NEIGHBOURS && distance > self.list[GRADIENT_NEIGHBOURS - 1].0 {
            return;
        }
        let mut place = self.count;
        while place > 0 && (distance, v) < self.list[place - 1] {
            place -= 1;
        }
        let is_known = place > 0 && self.list[place - 1].1 == v;
        if place < GRADIENT_NEIGHBOURS && !is_known {
            self.count = (self.count + 1).min(GRADIENT_NEIGHBOURS);
            self.list.copy_within(place..self.count - 1, place + 1);
            self.list[place] = (distance, v);
        }
    }

    /// Squared distances and numbers, the nearest first.
    pub fn list(&self) -> &[(f64, u32)] {
        &self.list[..self.count]
    }
}
