//! Keeps the nearest points, which a gradient takes into account, sorted as they are found.

use crate::spectral::measure::GRADIENT_NEIGHBOURS;

/// Points sorted by distance, then by number.
#[derive(Default)]
pub struct Nearest {
    list: [(f64, u32); GRADIENT_NEIGHBOURS],
    count: usize,
}

impl Nearest {
    /// Adds point `v` at this squared distance if it is near enough and not listed yet.
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

    /// Returns squared distances and numbers, nearest first.
    pub fn list(&self) -> &[(f64, u32)] {
        &self.list[..self.count]
    }
}
