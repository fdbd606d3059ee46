//! The points around a point in its tangent plane, and its Voronoi cell among them.

use crate::spatial::kdtree::Neighbor;
use crate::triangulate::cell::Cell;
use crate::triangulate::unfold::PlacedNeighbor;
use glam::DVec2;

/// The neighbours of one point after the other; keeps its memory from one to the next.
#[derive(Default)]
pub(super) struct Neighborhood {
    ball: Vec<Neighbor>,
    /// The neighbours found, in the tangent plane of the point.
    pub found: Vec<PlacedNeighbor>,
    pub cell: Cell,
}

impl Neighborhood {
    /// Finds the points but `centre`, of those that `collect` finds, that `place` gives a place in the plane.
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

    /// Brings the neighbours into the order of their distance.
    pub fn sort(&mut self) {
        self.found.sort_unstable_by(|a, b| {
            a.place.length_squared().total_cmp(&b.place.length_squared()).then(a.sample.cmp(&b.sample))
        });
    }

    /// Cuts the cell among the neighbours, which are in order, out of the square of half width `extent`; the distance of
    /// its farthest corner.
    pub fn cut(&mut self, extent: f64) -> f64 {
        self.cell.cut(&self.found, extent)
    }
}
