//! The points of a cloud in an order near to memory, without copies, and which of them are outliers.

use crate::geom::aabb::Aabb;
use crate::mesh::points::Points;
use crate::mesh::weld::first_at_place;
use crate::spatial::knn_graph::NeighborGraph;
use glam::DVec3;
use rayon::prelude::*;

/// The numbers of all positions along a curve through space, so that neighbours are mostly near each other in memory,
/// too: in the order of the bits of their coordinates, those of the three axes in turn (a Z-order curve).
///
/// Based on: G. M. Morton, A computer oriented geodetic data base and a new technique in file sequencing, 1966.
pub fn spatial_order(positions: &[DVec3]) -> Vec<u32> {
    let Some(bounds) = Aabb::of(positions.iter().copied()) else { return Vec::new() };
    let scale = f64::from(1 << BITS) / bounds.size().max_element().max(f64::MIN_POSITIVE);
    let key = |p: DVec3| {
        let cell = ((p - bounds.lo) * scale).to_array().map(|c| spread((c as u64).min((1 << BITS) - 1)));
        cell[0] | cell[1] << 1 | cell[2] << 2
    };
    let mut keyed: Vec<(u64, u32)> =
        positions.par_iter().zip(0..positions.len() as u32).map(|(p, i)| (key(*p), i)).collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|k| k.1).collect()
}

/// Bits of a coordinate that count: three coordinates fill 63.
const BITS: u32 = 21;

/// The lowest 21 bits of `x`, with two zeros after each.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// One point for each place, in a [`spatial_order`]: the number of the lowest point there, and the points with the sum of
/// the unit normals of all points at their places, so that one at a sharp edge that was given the normal of each of its
/// faces is of both.
pub fn merged(points: &Points) -> (Points, Vec<u32>) {
    let order = spatial_order(points.positions());
    let first = first_at_place(points.positions(), order.clone());
    let distinct: Vec<u32> = order.into_iter().filter(|&p| first[p as usize] == p).collect();
    let mut sums = vec![DVec3::ZERO; points.normals().len()];
    points.normals().iter().zip(&first).for_each(|(n, &p)| sums[p as usize] += n.normalize_or_zero());
    let normals = if sums.is_empty() { Vec::new() } else { distinct.iter().map(|&p| sums[p as usize]).collect() };
    (points.pick(&distinct).with_normals(normals), distinct)
}

/// For each point whether it is a neighbour of its neighbours, or of any other point: outliers are not.
pub fn wanted_by_others(graph: &NeighborGraph, points: usize) -> Vec<bool> {
    let mut wanted = vec![false; points];
    (0..points as u32).flat_map(|p| graph.of(p)).for_each(|&n| wanted[n as usize] = true);
    wanted
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
    fn neighbours_in_space_are_neighbours_in_order() {
        let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let points: Vec<DVec3> = (0..8).rev().flat_map(|i| [corner(i), corner(i) * 0.9 + 0.01]).collect();
        let order = spatial_order(&points);
        // Both points of a corner, then those of the next one along x, then y, then z.
        let corners: Vec<u32> = order.iter().map(|i| 7 - i / 2).collect();
        assert_eq!(corners, (0..8).flat_map(|i| [i, i]).collect::<Vec<u32>>());
        assert!(spatial_order(&[]).is_empty());
        assert_eq!(spatial_order(&[DVec3::X; 3]), [0, 1, 2]);
    }

    #[test]
    fn an_outlier_is_no_ones_neighbour() {
        let mut positions: Vec<DVec3> =
            (0..400).map(|i| DVec3::new(f64::from(i % 20), f64::from(i / 20), 0.0)).collect();
        positions.push(DVec3::new(10.0, 10.0, 4.0));
        let graph = NeighborGraph::new(&positions, &Neighbors::new(&positions), 8);
        let wanted = wanted_by_others(&graph, positions.len());
        assert_eq!(wanted.iter().position(|w| !w), Some(400));
    }
}
