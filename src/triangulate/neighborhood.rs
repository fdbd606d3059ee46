//! The neighbourhood of a point in its tangent plane, and its Voronoi cell there.

use crate::spatial::kdtree::Neighbor;
use crate::triangulate::cell::Cell;
use crate::triangulate::unfold::PlacedNeighbor;
use glam::DVec2;

/// Finds the neighbours of one point at a time, and reuses its memory for the next one.
#[derive(Default)]
pub(super) struct Neighborhood {
    ball: Vec<Neighbor>,
    /// The neighbours found, in the tangent plane of the point.
    pub found: Vec<PlacedNeighbor>,
    pub cell: Cell,
}

impl Neighborhood {
    /// Finds the points that `collect` finds, except `centre` and those to which `place` gives no place in the plane.
    pub fn find(
        &mut self,
        centre: u32,
        collect: impl FnOnce(&mut Vec<Neighbor>),
        mut place: impl FnMut(&Neighbor) -> Option<DVec2>,
    ) {
        collect(&mut self.ball);
        let others = self.ball.iter().filter(|n| n.point != centre);
        let placed = others.filter_map(|n| Some(PlacedNeighbor { sample: n.point, place: place(n)? }));
        self.found.clear();
        self.found.extend(placed);
    }

    /// Sorts the neighbours by distance.
    pub fn sort(&mut self) {
        self.found.sort_unstable_by(|a, b| {
            a.place.length_squared().total_cmp(&b.place.length_squared()).then(a.sample.cmp(&b.sample))
        });
    }

    /// Cuts the cell from the square of half width `extent` by the sorted neighbours; returns the distance of its farthest
    /// corner.
    pub fn cut(&mut self, extent: f64) -> f64 {
        self.cell.cut(&self.found, extent)
    }
}
