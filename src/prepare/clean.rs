//! Sorts the points of a cloud for memory locality, removes copies, and finds outliers.

use crate::mesh::points::Points;
use crate::mesh::weld::first_at_place;
use crate::spatial::knn_graph::NeighborGraph;
use crate::spatial::order::spatial_order;
use glam::DVec3;

/// Merges points at the same place and sorts the rest by [`spatial_order`]. Returns the points and, for each, the number of
/// the lowest point at its place. The normal of a point is the sum of the unit normals of all points there, so a point on a
/// sharp edge that was given with the normal of each adjacent face counts for both.
pub fn merged(points: &Points) -> (Points, Vec<u32>) {
    let order = spatial_order(points.positions());
    let first = first_at_place(points.positions(), order.clone());
    let distinct: Vec<u32> = order.into_iter().filter(|&p| first[p as usize] == p).collect();
    let mut sums = vec![DVec3::ZERO; points.normals().len()];
    points.normals().iter().zip(&first).for_each(|(n, &p)| sums[p as usize] += n.normalize_or_zero());
    let normals = if sums.is_empty() { Vec::new() } else { distinct.iter().map(|&p| sums[p as usize]).collect() };
    (points.pick(&distinct).with_normals(normals), distinct)
}

/// Returns, for each point, whether it is a neighbour of any other point: outliers are not.
pub fn are_neighbors(graph: &NeighborGraph, points: usize) -> Vec<bool> {
    let mut are_neighbors = vec![false; points];
    (0..points as u32).flat_map(|p| graph.of(p)).for_each(|&n| are_neighbors[n as usize] = true);
    are_neighbors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::kdtree::Neighbors;

    #[test]
    fn points_at_one_place_become_one_with_the_normals_of_all() {
        let points = Points::from_pairs([
            (DVec3::X, 2.0 * DVec3::X),
            (DVec3::ZERO, DVec3::Y),
            (DVec3::X, DVec3::Z),
            (DVec3::new(-0.0, 0.0, 0.0), DVec3::NEG_Y),
        ]);
        let (merged, numbers) = merged(&points);
        assert_eq!(numbers, [1, 0]);
        assert_eq!(merged.positions(), [DVec3::ZERO, DVec3::X]);
        assert_eq!(merged.normals(), [DVec3::ZERO, DVec3::X + DVec3::Z]);
        let bare = Points::without_normals(points.positions().to_vec());
        assert!(super::merged(&bare).0.normals().is_empty());
    }

    #[test]
    fn an_outlier_is_no_ones_neighbour() {
        let mut positions: Vec<DVec3> =
            (0..400).map(|i| DVec3::new(f64::from(i % 20), f64::from(i / 20), 0.0)).collect();
        positions.push(DVec3::new(10.0, 10.0, 4.0));
        let graph = NeighborGraph::new(&positions, &Neighbors::new(&positions), 8);
        assert_eq!(are_neighbors(&graph, positions.len()).iter().position(|is| !is), Some(400));
    }
}
