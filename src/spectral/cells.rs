//! A grid of cells to which points can be added, removed and searched for neighbours, in any dimension.
//!
//! Cells divide the first three coordinates, or as many as there are; further coordinates only make distances larger.
//!
//! Cost: a query looks up the cells that a box twice its radius wide touches.

use crate::geom::vector::distance_squared;
use rustc_hash::FxHashMap;

type Cell = [i64; 3];

/// Numbered points, each with its coordinates.
pub(super) struct Cells<const D: usize> {
    width: f64,
    /// Points in the order of insertion, so that the order of the map does not matter.
    lists: FxHashMap<Cell, Vec<(u32, [f64; D])>>,
}

impl<const D: usize> Cells<D> {
    /// Makes an empty grid with cells of `width`.
    pub fn new(width: f64) -> Self {
        Cells { width, lists: FxHashMap::default() }
    }

    fn cell(&self, x: &[f64; D], shift: f64) -> Cell {
        let along = |axis: usize| x.get(axis).map_or(0, |x| ((x + shift) / self.width).floor() as i64);
        [along(0), along(1), along(2)]
    }

    pub fn insert(&mut self, number: u32, x: [f64; D]) {
        self.lists.entry(self.cell(&x, 0.0)).or_default().push((number, x));
    }

    /// Removes a point; `x` is where it was inserted.
    pub fn remove(&mut self, number: u32, x: &[f64; D]) {
        if let Some(list) = self.lists.get_mut(&self.cell(x, 0.0)) {
            list.retain(|member| member.0 != number);
        }
    }

    /// Calls `visit` with the squared distance, the number and the coordinates of each point within `radius` of `x`.
    pub fn near(&self, x: &[f64; D], radius: f64, mut visit: impl FnMut(f64, u32, &[f64; D])) {
        let (lowest, highest) = (self.cell(x, -radius), self.cell(x, radius));
        for k in lowest[2]..=highest[2] {
            for j in lowest[1]..=highest[1] {
                for i in lowest[0]..=highest[0] {
                    for (number, y) in self.lists.get(&[i, j, k]).into_iter().flatten() {
                        let d = distance_squared(x, y);
                        if d <= radius * radius {
                            visit(d, *number, y);
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};

    fn all_that_are_near_are_found<const D: usize>() {
        let mut rng = stream(5, Stage::Scan);
        let points: Vec<[f64; D]> = (0..400).map(|_| [0.0; D].map(|_: f64| unit(&mut rng))).collect();
        let mut cells = Cells::new(0.3);
        points.iter().zip(0..).for_each(|(&x, i)| cells.insert(i, x));
        points.iter().zip(0..).step_by(3).for_each(|(x, i)| cells.remove(i, x));
        for x in &points {
            let mut found = Vec::new();
            cells.near(x, 0.4, |_, i, _| found.push(i));
            found.sort_unstable();
            let is_near = |&i: &u32| i % 3 != 0 && distance_squared(x, &points[i as usize]) <= 0.16;
            assert_eq!(found, (0..400).filter(is_near).collect::<Vec<u32>>());
        }
    }

    #[test]
    fn all_that_are_near_are_found_in_any_dimension() {
        all_that_are_near_are_found::<1>();
        all_that_are_near_are_found::<2>();
        all_that_are_near_are_found::<3>();
        all_that_are_near_are_found::<5>();
    }
}
