//! Nearest neighbours among points. This is the only file that depends on the k-d tree's implementation.
//!
//! Results are in a total order, by distance and then by number, so they do not depend on how the tree was built.
//!
//! Cost: n log n to build; a query is logarithmic in n and linear in the number of results.
//!
//! Limits: coordinates and their squares must be finite.

use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZeroUsize;

/// A set of points in which neighbours are searched. Any points are allowed: coplanar ones, coincident ones, none.
pub struct Neighbors {
    /// `None` without points.
    tree: Option<ImmutableKdTree<f64, 3>>,
}

/// A point of the set in relation to the query point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbor {
    /// Its number: the index in the slice from which the set was made.
    pub point: u32,
    /// The squared distance to it, in squared units of the points.
    pub distance_squared: f64,
}

impl Neighbors {
    /// Builds the set of `points`, which must be fewer than 2^32.
    ///
    /// # Panics
    /// If there are more points than 32-bit numbers can distinguish.
    pub fn new(points: &[DVec3]) -> Self {
        let coordinates: Vec<[f64; 3]> = points.iter().map(DVec3::to_array).collect();
        let build = || ImmutableKdTree::new_from_slice(&coordinates).expect("fewer than 2^32 points");
        Neighbors { tree: (!points.is_empty()).then(build) }
    }

    /// Collects all points within `radius` of `p`, `radius` included, in no particular order.
    pub fn collect_within(&self, p: DVec3, radius: f64, found: &mut Vec<Neighbor>) {
        found.clear();
        let Some(tree) = &self.tree else { return };
        let centre = p.to_array();
        let all = tree.query(&centre).within::<SquaredEuclidean<f64>>(radius * radius).unsorted().execute();
        found.extend(all.into_iter().map(|f| Neighbor { point: f.item, distance_squared: f.distance }));
    }

    /// Collects the `count` points nearest to `p`, or all if there are fewer, the nearest first. Among equally near points,
    /// the lower number comes first, but which of the farthest are included depends on the tree.
    pub fn collect_nearest(&self, p: DVec3, count: usize, found: &mut Vec<Neighbor>) {
        found.clear();
        let (Some(tree), Some(count)) = (&self.tree, NonZeroUsize::new(count)) else { return };
        let centre = p.to_array();
        let all = tree.query(&centre).nearest_n::<SquaredEuclidean<f64>>(count).execute();
        found.extend(all.into_iter().map(|f| Neighbor { point: f.item, distance_squared: f.distance }));
        sort(found);
    }

    /// Collects the `count` points nearest to `p` within `radius`, the nearest first; among equally near points, those with
    /// the lower numbers. So points of the set that are farther away have no influence.
    pub fn collect_nearest_within(&self, p: DVec3, count: usize, radius: f64, found: &mut Vec<Neighbor>) {
        self.collect_nearest(p, count + 1, found);
        if let [.., last, next] = found[..]
            && found.len() > count
            && last.distance_squared == next.distance_squared
        {
            // The square root may be rounded down.
            self.collect_within(p, last.distance_squared.sqrt() * (1.0 + f64::EPSILON), found);
            sort(found);
        }
        found.truncate(count);
        found.retain(|n| n.distance_squared <= radius * radius);
    }

    /// Returns the point nearest to `p`; which of several equally near ones depends on the tree.
    pub fn nearest(&self, p: DVec3) -> Option<Neighbor> {
        let mut nearest = Vec::new();
        self.collect_nearest(p, 1, &mut nearest);
        nearest.pop()
    }

    /// Returns whether any point is within `radius` of `p`, `radius` included.
    pub fn has_within(&self, p: DVec3, radius: f64) -> bool {
        self.nearest(p).is_some_and(|n| n.distance_squared <= radius * radius)
    }

    /// Returns all points within `radius` of `p`, `radius` included, the nearest first; among equally near points, the lower
    /// number comes first.
    pub fn within(&self, p: DVec3, radius: f64) -> Vec<Neighbor> {
        let mut found = Vec::new();
        self.collect_within(p, radius, &mut found);
        sort(&mut found);
        found
    }
}

fn sort(found: &mut [Neighbor]) {
    found.sort_unstable_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.point.cmp(&b.point)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use proptest::prelude::*;

    /// The result that [`Neighbors::within`] promises, by testing all points.
    fn by_hand(points: &[DVec3], p: DVec3, radius: f64) -> Vec<u32> {
        let mut all: Vec<(f64, u32)> = points.iter().map(|q| q.distance_squared(p)).zip(0..).collect();
        all.retain(|f| f.0 <= radius * radius);
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.into_iter().map(|f| f.1).collect()
    }

    fn numbers(found: &[Neighbor]) -> Vec<u32> {
        found.iter().map(|n| n.point).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        /// Random points that share the same coordinate along some axes: boxes, planes, lines, a single position.
        #[test]
        fn all_within_the_radius_and_in_order(seed in any::<u64>(), flat in 0u32..8, count in 0usize..500) {
            let mut rng = stream(seed, Stage::Scan);
            let mut coordinate = |axis: u32| {
                let x = unit(&mut rng);
                if flat >> axis & 1 == 1 { 0.25 } else { x }
            };
            let points: Vec<DVec3> =
                (0..count).map(|_| DVec3::new(coordinate(0), coordinate(1), coordinate(2))).collect();
            let set = Neighbors::new(&points);
            for p in points.iter().step_by(7).copied().chain([DVec3::ONE]) {
                let found = set.within(p, 0.3);
                prop_assert_eq!(numbers(&found), by_hand(&points, p, 0.3));
                prop_assert!(found.iter().all(|n| n.distance_squared == points[n.point as usize].distance_squared(p)));
                let mut nearest = Vec::new();
                set.collect_nearest(p, found.len(), &mut nearest);
                let distances = |found: &[Neighbor]| found.iter().map(|n| n.distance_squared).collect::<Vec<f64>>();
                prop_assert_eq!(distances(&nearest), distances(&found));
            }
        }
    }

    #[test]
    fn planar_grids_and_coincident_points_are_points_like_others() {
        let grid: Vec<DVec3> = (0..2500).map(|i| DVec3::new(f64::from(i % 50), f64::from(i / 50), 3.0)).collect();
        let found = Neighbors::new(&grid).within(grid[51], 1.0);
        assert_eq!(numbers(&found), [51, 1, 50, 52, 101]);
        let heap = vec![DVec3::new(0.1, 0.2, 0.3); 3000];
        let found = Neighbors::new(&heap).within(heap[0], 0.0);
        assert_eq!(numbers(&found), (0..3000).collect::<Vec<u32>>());
    }

    #[test]
    fn of_equally_near_points_the_first_are_taken_whatever_else_there_is() {
        let grid: Vec<DVec3> = (0..2500).map(|i| DVec3::new(f64::from(i % 50), f64::from(i / 50), 3.0)).collect();
        let (all, part) = (Neighbors::new(&grid), Neighbors::new(&grid[..400]));
        let nearest = |set: &Neighbors, count: usize, radius: f64| {
            let mut found = Vec::new();
            set.collect_nearest_within(grid[151], count, radius, &mut found);
            numbers(&found)
        };
        for count in 1..20 {
            assert_eq!(nearest(&all, count, 9.0), by_hand(&grid, grid[151], 9.0)[..count]);
            assert_eq!(nearest(&all, count, 9.0), nearest(&part, count, 9.0));
        }
        assert_eq!(nearest(&all, 9, 1.0), [151, 101, 150, 152, 201]);
    }

    #[test]
    fn few_points_or_none() {
        assert_eq!(Neighbors::new(&[]).within(DVec3::ZERO, 1.0), []);
        let one = Neighbors::new(&[DVec3::X]);
        assert_eq!(one.within(DVec3::ZERO, 1.0), [Neighbor { point: 0, distance_squared: 1.0 }]);
        assert_eq!(one.within(DVec3::ZERO, 0.99), []);
        assert!(one.has_within(DVec3::ZERO, 1.0) && !one.has_within(DVec3::ZERO, 0.99));
    }
}
