//! The nearest neighbours of every point of a cloud, and the spacing of its points.
//!
//! Cost: one k-d tree query per point, in parallel; four bytes per neighbour.

use crate::base::parallel;
use crate::spatial::kdtree::Neighbors;
use glam::DVec3;

/// Number of neighbours from which the spacing at a point is derived: as many as surround a point of an even sampling.
const RING: usize = 6;

/// Number of neighbours of each point that are found first: those of a star, and some to spare.
pub const DEGREE: usize = 16;

/// The nearest neighbours of points, the same number for each point.
pub struct NeighborGraph {
    degree: usize,
    /// The neighbours of the first point, the nearest first, then those of the second, and so on.
    neighbors: Vec<u32>,
}

/// Number of points whose neighbours one task finds.
const CHUNK: usize = 256;

impl NeighborGraph {
    /// Finds the `degree` nearest neighbours of each of `points`, which are the points of `near`; fewer if there are not
    /// enough points.
    pub fn new(points: &[DVec3], near: &Neighbors, degree: usize) -> Self {
        let degree = degree.min(points.len().saturating_sub(1));
        let mut neighbors = vec![0; degree * points.len()];
        let rows_of_chunks = neighbors.chunks_mut(CHUNK * degree.max(1)).zip((0u32..).step_by(CHUNK));
        parallel::each(rows_of_chunks, |(rows, first)| {
            let mut found = Vec::new();
            for (own, p) in rows.chunks_mut(degree).zip(first..) {
                near.collect_nearest(points[p as usize], degree + 1, &mut found);
                // If many points coincide, the point itself may not be among the nearest.
                let others = found.iter().map(|n| n.point).filter(|&n| n != p);
                own.iter_mut().zip(others).for_each(|(own, n)| *own = n);
            }
        });
        NeighborGraph { degree, neighbors }
    }

    /// The number of neighbours of each point.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The neighbours of point `p`, the nearest first.
    pub fn of(&self, p: u32) -> &[u32] {
        &self.neighbors[self.degree * p as usize..self.degree * (p as usize + 1)]
    }

    /// Returns the spacing around each of `points`: the distance to the sixth neighbour, estimated from the distance to the
    /// last one under the assumption of constant point density.
    pub fn spacings(&self, points: &[DVec3]) -> Vec<f64> {
        let spacing = |p: usize| {
            self.of(p as u32).last().map_or(0.0, |&n| spacing_of(self.degree, points[p].distance(points[n as usize])))
        };
        parallel::map(0..points.len(), spacing)
    }
}

/// The spacing around a point with this number of neighbours, the farthest at distance `last`.
pub fn spacing_of(neighbors: usize, last: f64) -> f64 {
    (RING as f64 / neighbors.max(RING) as f64).sqrt() * last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_a_line() {
        let points: Vec<DVec3> = (0..10).map(|i| f64::from(i * i) * DVec3::X).collect();
        let graph = NeighborGraph::new(&points, &Neighbors::new(&points), 2);
        assert_eq!(graph.of(0), [1, 2]);
        assert_eq!(graph.of(9), [8, 7]);
        assert_eq!(graph.spacings(&points)[9], 32.0);
    }

    #[test]
    fn fewer_points_than_neighbours_wanted() {
        let points = [DVec3::ZERO, DVec3::X];
        let graph = NeighborGraph::new(&points, &Neighbors::new(&points), 5);
        assert_eq!((graph.degree(), graph.of(0), graph.of(1)), (1, &[1][..], &[0][..]));
        assert!(NeighborGraph::new(&[], &Neighbors::new(&[]), 5).spacings(&[]).is_empty());
    }
}
