//! A bounding-volume hierarchy over a mesh's triangles, for exact closest points and rays.
//!
//! The tree is a complete binary tree in heap order: the children of node i are 2i + 1 and 2i + 2. With n triangles, node j
//! of level l holds the triangles from ⌊j n / 2^l⌋ up to ⌊(j + 1) n / 2^l⌋ of an order determined by the build. So a node
//! consists only of its box, and the shape of the tree depends on n alone: coincident triangles cannot unbalance it. The
//! order results from splitting at the median of the centroids along the axis of their largest spread.
//!
//! Based on: the median split of Jon Louis Bentley, *Multidimensional binary search trees used for associative searching*,
//! 1975, doi:10.1145/361002.361007, applied to boxes; the search visits the nearer child first and skips boxes that are
//! farther away than the best point so far.
//!
//! Cost: n log n to build, in parallel; 48 bytes per node and about 0.7 nodes per triangle. A query near the surface is
//! logarithmic in practice; a query from a point equally far from everything (the centre of a sphere) visits everything.
//!
//! Limits: medians ignore areas, so triangles of very different sizes lead to more overlap than with a surface-area
//! heuristic.

mod tree;

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::geom::triangle;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::tree::{Item, Tree, box_of};
use crate::spatial::order::spatial_order_in;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of levels below the root of a block.
const LEVELS_OF_BLOCK: u32 = 6;

/// Maximum number of nodes that a search sets aside, one per level: a tree over 2^32 triangles has no more levels.
const DEEPEST: usize = 33;

/// A bounding-volume hierarchy. It stores no positions: queries take the mesh that it was built for, unchanged.
#[derive(Debug, Clone, Default)]
pub struct Bvh {
    /// Boxes of all nodes, in heap order.
    boxes: Vec<Aabb>,
    /// All triangles in leaf order.
    order: Vec<u32>,
    /// Level of the leaves; the root's is zero.
    depth: u32,
}

/// The point of a mesh closest to a query point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The triangle on which the point lies.
    pub triangle: u32,
    /// The closest point.
    pub point: DVec3,
    /// Its squared distance to the query point.
    pub distance_squared: f64,
}

impl Hit {
    /// No hit yet; hits must be within this squared distance of `p`.
    pub(super) fn none(p: DVec3, max_distance_squared: f64) -> Hit {
        Hit { triangle: u32::MAX, point: p, distance_squared: max_distance_squared }
    }

    /// The hit, if there is one.
    pub(super) fn found(self) -> Option<Hit> {
        (self.triangle != u32::MAX).then_some(self)
    }

    /// Replaces this by the hit on triangle `t` if that is nearer to `p` or, at equal distance, has the lower triangle
    /// index.
    #[inline]
    pub(super) fn or_nearer(&mut self, mesh: &Mesh, t: u32, p: DVec3) {
        let point = triangle::closest_point(p, mesh.corners(t as usize));
        let distance_squared = p.distance_squared(point);
        if distance_squared < self.distance_squared || (distance_squared == self.distance_squared && t < self.triangle)
        {
            *self = Hit { triangle: t, point, distance_squared };
        }
    }
}

/// Once there are this many pairs of nodes, the pairs below them are searched in parallel.
const PAIRS_IN_PARALLEL: usize = 1024;

impl Bvh {
    /// Builds the hierarchy over all triangles of `mesh`. The same mesh gives the same hierarchy with any number of threads.
    pub fn new(mesh: &Mesh) -> Bvh {
        let n = mesh.triangles.len();
        let item = |t: usize| Item { place: mesh.corners(t).into_iter().sum(), triangle: t as u32 };
        let mut items = parallel::map(0..n, item);
        Tree::new(n).arrange(&mut items, 0, 0);
        Bvh::of_order(mesh, items.into_iter().map(|item| item.triangle).collect())
    }

    /// Builds a hierarchy over all triangles of `mesh` in their existing order, in which triangles near in space should be
    /// near each other. Building takes a fraction of the time of [`Self::new`]. Queries give the same answers, but take
    /// longer, since boxes overlap more.
    pub fn in_order_of(mesh: &Mesh) -> Bvh {
        Bvh::of_order(mesh, (0..mesh.triangles.len() as u32).collect())
    }

    /// [`Self::in_order_of`] with the triangles in spatial order; for few queries over many triangles.
    pub fn for_few_questions(mesh: &Mesh) -> Bvh {
        let bounds = mesh.bounds().unwrap_or_default();
        Bvh::of_order(
            mesh,
            spatial_order_in(bounds, mesh.triangles.len(), |t| mesh.corners(t).into_iter().sum::<DVec3>() / 3.0),
        )
    }

    fn of_order(mesh: &Mesh, order: Vec<u32>) -> Bvh {
        let tree = Tree::new(order.len());
        Bvh { boxes: tree.boxes(mesh, &order), order, depth: tree.depth }
    }

    /// Updates the boxes to the current positions of the triangles of `mesh`, whose number must be unchanged. The order is
    /// kept, so queries get slower the farther the triangles have moved.
    pub fn refit(&mut self, mesh: &Mesh) {
        self.boxes = Tree { count: self.order.len(), depth: self.depth }.boxes(mesh, &self.order);
    }

    /// Returns the closest point to `p` on all triangles; among equally close triangles, the one with the lower index wins.
    ///
    /// `None` without triangles, or if `p` is not finite.
    pub fn closest(&self, mesh: &Mesh, p: DVec3) -> Option<Hit> {
        self.closest_where(mesh, p, f64::INFINITY, |_| true)
    }

    /// Returns the closest point to `p` on the triangles for which `accept` holds, if its squared distance is at most
    /// `max_distance_squared`; among equally close triangles, the one with the lower index wins.
    pub fn closest_where(
        &self,
        mesh: &Mesh,
        p: DVec3,
        max_distance_squared: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        self.closest_or_near(mesh, p, 0.0, max_distance_squared, accept)
    }

    /// All triangles, such that those near in space are together.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// [`Self::closest_where`], but the search ends at any triangle whose squared distance is below `near`.
    pub fn closest_or_near(
        &self,
        mesh: &Mesh,
        p: DVec3,
        near: f64,
        max_distance_squared: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let mut best = Hit::none(p, max_distance_squared);
        let mut aside = [(0u32, 0.0f64); DEEPEST];
        let mut waiting = 1;
        aside[0].1 = self.boxes[0].distance_squared(p);
        while waiting > 0 {
            waiting -= 1;
            let (mut node, distance) = aside[waiting];
            if distance > best.distance_squared {
                continue;
            }
            while let Some((near, far)) = self.children(node, p) {
                if far.1 <= best.distance_squared {
                    aside[waiting] = far;
                    waiting += 1;
                }
                node = near.0;
                if near.1 > best.distance_squared {
                    break;
                }
            }
            if self.is_leaf(node) {
                self.search_leaf(node, mesh, p, &accept, &mut best);
                if best.distance_squared < near {
                    break;
                }
            }
        }
        best.found()
    }

    /// Returns the distance from `origin` along the unit vector `direction` to the nearest triangle for which `accept`
    /// holds; `None` if there is none nearer than `longest`.
    pub fn along_ray(
        &self,
        mesh: &Mesh,
        origin: DVec3,
        direction: DVec3,
        longest: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Option<f64> {
        let mut nearest = longest;
        let mut aside = [0u32; DEEPEST];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = aside[waiting];
            if !self.boxes[node as usize].meets_ray(origin, direction.recip(), nearest) {
                continue;
            }
            if self.is_leaf(node) {
                let accepted = self.leaf(node).iter().filter(|&&t| accept(t));
                let hits = accepted.filter_map(|&t| triangle::along_ray(origin, direction, mesh.corners(t as usize)));
                nearest = hits.fold(nearest, f64::min);
            } else {
                aside[waiting] = 2 * node + 2;
                aside[waiting + 1] = 2 * node + 1;
                waiting += 2;
            }
        }
        (nearest < longest).then_some(nearest)
    }

    /// Calls `visit` with every triangle whose bounding box meets the box `wanted`; touching counts.
    pub fn in_box(&self, mesh: &Mesh, wanted: &Aabb, mut visit: impl FnMut(u32)) {
        self.any_in_box(mesh, wanted, |t| {
            visit(t);
            false
        });
    }

    /// Returns whether `accept` holds for any triangle whose bounding box meets the box `wanted`; touching counts.
    pub fn any_in_box(&self, mesh: &Mesh, wanted: &Aabb, mut accept: impl FnMut(u32) -> bool) -> bool {
        self.any_node_in_box(self.depth, wanted, |leaf| {
            self.node(self.depth, leaf).iter().any(|&t| box_of(mesh, t).meets(wanted) && accept(t))
        })
    }

    /// Number of blocks: groups of a few hundred triangles, or all of fewer.
    pub fn blocks(&self) -> usize {
        1 << self.level_of_blocks()
    }

    /// Triangles of a block.
    pub fn block(&self, block: usize) -> &[u32] {
        self.node(self.level_of_blocks(), block)
    }

    /// Returns whether `accept` holds for any block whose bounding box meets the box `wanted`; touching counts.
    pub fn any_block_in_box(&self, wanted: &Aabb, accept: impl FnMut(usize) -> bool) -> bool {
        self.any_node_in_box(self.level_of_blocks(), wanted, accept)
    }

    fn level_of_blocks(&self) -> u32 {
        self.depth.saturating_sub(LEVELS_OF_BLOCK)
    }

    /// Returns whether `accept` holds for the place of any node of `level` whose box meets the box `wanted`.
    fn any_node_in_box(&self, level: u32, wanted: &Aabb, mut accept: impl FnMut(usize) -> bool) -> bool {
        let first = (1u32 << level) - 1;
        let mut aside = [0u32; DEEPEST];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let node = aside[waiting];
            if !self.boxes[node as usize].meets(wanted) {
                continue;
            }
            if node >= first {
                if accept((node - first) as usize) {
                    return true;
                }
            } else {
                aside[waiting] = 2 * node + 2;
                aside[waiting + 1] = 2 * node + 1;
                waiting += 2;
            }
        }
        false
    }

    /// Returns the pairs of triangles whose bounding boxes meet and for which `accept` holds, in increasing order and with
    /// the lower index first. Runs in parallel; the pairs are the same with any number of threads.
    pub fn pairs_that_meet(&self, mesh: &Mesh, accept: impl Fn(u32, u32) -> bool + Sync) -> Vec<(u32, u32)> {
        let mut pairs = self.of_pairs(mesh, |t, u| accept(t, u).then_some((t, u)));
        pairs.par_sort_unstable();
        pairs
    }

    /// Returns the triangles of the pairs of [`Self::pairs_that_meet`], in increasing order. Pairs whose triangles are both
    /// known already are skipped, which bounds time and memory if very many triangles are at the same position.
    pub fn triangles_that_meet(&self, mesh: &Mesh, accept: impl Fn(u32, u32) -> bool + Sync) -> Vec<u32> {
        let known: Vec<AtomicBool> = mesh.triangles.iter().map(|_| AtomicBool::new(false)).collect();
        let is_known = |t: u32| known[t as usize].load(Ordering::Relaxed);
        self.of_pairs(mesh, |t, u| -> Option<()> {
            if !(is_known(t) && is_known(u)) && accept(t, u) {
                [t, u].iter().for_each(|&t| known[t as usize].store(true, Ordering::Relaxed));
            }
            None
        });
        (0..mesh.triangles.len() as u32).filter(|&t| is_known(t)).collect()
    }

    /// Returns the results of `of` for the pairs of triangles whose bounding boxes meet, the lower index first; in no
    /// particular order.
    fn of_pairs<T: Send>(&self, mesh: &Mesh, of: impl Fn(u32, u32) -> Option<T> + Sync) -> Vec<T> {
        let meet = |&(a, b): &(u32, u32)| self.boxes[a as usize].meets(&self.boxes[b as usize]);
        let mut nodes = vec![(0, 0)];
        let mut level = 0;
        while level < self.depth && nodes.len() < PAIRS_IN_PARALLEL {
            nodes = nodes.into_iter().flat_map(|pair| pairs_below(pair).into_iter().flatten().filter(meet)).collect();
            level += 1;
        }
        let below = |pair: (u32, u32)| {
            let (mut made, mut waiting) = (Vec::new(), vec![(pair, level)]);
            while let Some((pair, level)) = waiting.pop() {
                if level == self.depth {
                    self.of_leaves(mesh, pair, &of, &mut made);
                } else {
                    let next = pairs_below(pair).into_iter().flatten().filter(meet);
                    waiting.extend(next.map(|pair| (pair, level + 1)));
                }
            }
            made
        };
        parallel::each(nodes, below).into_iter().flatten().collect()
    }

    /// [`Self::of_pairs`] for pairs of a triangle of leaf `a` and a triangle of leaf `b`.
    fn of_leaves<T>(&self, mesh: &Mesh, (a, b): (u32, u32), of: impl Fn(u32, u32) -> Option<T>, made: &mut Vec<T>) {
        for &t in self.leaf(a) {
            let around = box_of(mesh, t);
            let others = self.leaf(b).iter().filter(|&&u| a != b || t < u);
            let meeting = others.filter(|&&u| around.meets(&box_of(mesh, u)));
            made.extend(meeting.filter_map(|&u| of(t.min(u), t.max(u))));
        }
    }

    /// Returns the children of `node` and their squared distances to `p`, the nearer first; `None` for a leaf.
    #[inline]
    fn children(&self, node: u32, p: DVec3) -> Option<((u32, f64), (u32, f64))> {
        if self.is_leaf(node) {
            return None;
        }
        let at = 2 * node as usize + 1;
        let pair = &self.boxes[at..at + 2];
        let left = (at as u32, pair[0].distance_squared(p));
        let right = (at as u32 + 1, pair[1].distance_squared(p));
        Some(if right.1 < left.1 { (right, left) } else { (left, right) })
    }

    #[inline]
    fn search_leaf(&self, node: u32, mesh: &Mesh, p: DVec3, accept: &impl Fn(u32) -> bool, best: &mut Hit) {
        self.leaf(node).iter().filter(|&&t| accept(t)).for_each(|&t| best.or_nearer(mesh, t, p));
    }

    #[inline]
    fn is_leaf(&self, node: u32) -> bool {
        node as usize + 1 >= 1 << self.depth
    }

    #[inline]
    fn leaf(&self, node: u32) -> &[u32] {
        self.node(self.depth, node as usize + 1 - (1 << self.depth))
    }

    /// Returns the triangles of the node at `place` of `level`.
    #[inline]
    fn node(&self, level: u32, place: usize) -> &[u32] {
        let tree = Tree { count: self.order.len(), depth: self.depth };
        &self.order[tree.range(level, place)]
    }
}

/// Returns the pairs of children of two nodes, or of one node and itself, each pair once.
fn pairs_below((a, b): (u32, u32)) -> [Option<(u32, u32)>; 4] {
    let [(k, l), (m, n)] = [a, b].map(|node| (2 * node + 1, 2 * node + 2));
    [Some((k, m)), Some((k, n)), (a != b).then_some((l, m)), Some((l, n))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::testing::{random_point, sheet};

    /// `n` triangles without common corners, of approximately this `size`.
    fn soup(n: usize, size: f64, seed: u64) -> Mesh {
        let mut rng = stream(seed, Stage::Candidates);
        let mut mesh = Mesh::default();
        for t in 0..n as u32 {
            let at = random_point(&mut rng);
            mesh.positions.extend([0; 3].map(|_| at + size * random_point(&mut rng)));
            mesh.triangles.push([3 * t, 3 * t + 1, 3 * t + 2]);
        }
        mesh
    }

    /// A wavy sheet of `n` by `n` squares.
    fn wavy(n: u32) -> Mesh {
        sheet(n, |x, y| 0.1 * (9.0 * x).sin() * (7.0 * y).cos())
    }

    fn agrees_with_all_pairs(mesh: &Mesh) {
        let boxes: Vec<Aabb> = (0..mesh.triangles.len() as u32).map(|t| box_of(mesh, t)).collect();
        let all = (0..boxes.len()).flat_map(|t| (t + 1..boxes.len()).map(move |u| (t, u)));
        let expected: Vec<(u32, u32)> = all
            .filter(|&(t, u)| boxes[t].meets(&boxes[u]) && (t + u) % 3 > 0)
            .map(|(t, u)| (t as u32, u as u32))
            .collect();
        assert_eq!(Bvh::new(mesh).pairs_that_meet(mesh, |t, u| (t + u) % 3 > 0), expected);
        let mut triangles: Vec<u32> = expected.into_iter().flat_map(|(t, u)| [t, u]).collect();
        triangles.sort_unstable();
        triangles.dedup();
        assert_eq!(Bvh::new(mesh).triangles_that_meet(mesh, |t, u| (t + u) % 3 > 0), triangles);
    }

    #[test]
    fn a_search_for_what_is_near_ends_at_some_of_it_or_at_the_closest() {
        let (mesh, mut rng) = (soup(500, 0.1, 5), stream(6, Stage::Distance));
        let bvh = Bvh::new(&mesh);
        for _ in 0..200 {
            let (p, near) = (random_point(&mut rng), 0.01 * unit(&mut rng));
            let (closest, found) = (bvh.closest(&mesh, p).unwrap(), bvh.closest_or_near(&mesh, p, near, 1.0, |_| true));
            let found = found.unwrap();
            assert!(found == closest || closest.distance_squared <= found.distance_squared);
            assert!(found == closest || found.distance_squared < near, "{found:?} {closest:?}");
        }
    }

    #[test]
    fn all_pairs_of_boxes_that_meet_are_found() {
        for n in [1, 2, 4, 5, 31, 32, 33, 500] {
            agrees_with_all_pairs(&soup(n, 0.2, n as u64));
        }
        agrees_with_all_pairs(&wavy(15));
        assert!(Bvh::new(&Mesh::default()).pairs_that_meet(&Mesh::default(), |_, _| true).is_empty());
    }

    fn brute_force(mesh: &Mesh, p: DVec3, limit: f64, accept: impl Fn(u32) -> bool) -> Option<Hit> {
        let hits = (0..mesh.triangles.len() as u32).filter(|&t| accept(t)).map(|t| {
            let point = triangle::closest_point(p, mesh.corners(t as usize));
            Hit { triangle: t, point, distance_squared: p.distance_squared(point) }
        });
        let nearest = hits.reduce(|a, b| if b.distance_squared < a.distance_squared { b } else { a });
        nearest.filter(|hit| hit.distance_squared <= limit)
    }

    /// Compares `closest`, `closest_where` and `in_box` with a search over all triangles.
    fn agrees_with_brute_force(mesh: &Mesh, queries: usize) {
        let mut rng = stream(9, Stage::Scan);
        for q in 0..queries {
            let bvh = [Bvh::new, Bvh::in_order_of, Bvh::for_few_questions][q % 3](mesh);
            let p = 1.5 * random_point(&mut rng) - DVec3::splat(0.25);
            assert_eq!(bvh.closest(mesh, p), brute_force(mesh, p, f64::INFINITY, |_| true));
            let accept = |t: u32| !(t as usize + q).is_multiple_of(3);
            assert_eq!(bvh.closest_where(mesh, p, 0.01, accept), brute_force(mesh, p, 0.01, accept));
            let way = (random_point(&mut rng) - DVec3::splat(0.5)).normalize();
            let all = (0..mesh.triangles.len()).filter(|&t| accept(t as u32));
            let hits = all.filter_map(|t| triangle::along_ray(p, way, mesh.corners(t))).filter(|&t| t < 2.0);
            assert_eq!(bvh.along_ray(mesh, p, way, 2.0, accept), hits.reduce(f64::min));
            let wanted = Aabb { lo: p, hi: p + 0.2 * random_point(&mut rng) };
            let mut found = Vec::new();
            bvh.in_box(mesh, &wanted, |t| found.push(t));
            found.sort_unstable();
            let all = 0..mesh.triangles.len() as u32;
            let expected: Vec<u32> = all.filter(|&t| box_of(mesh, t).meets(&wanted)).collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn random_soups_of_any_count() {
        for n in [1, 2, 3, 4, 5, 7, 8, 9, 31, 32, 33, 100, 1000] {
            agrees_with_brute_force(&soup(n, 0.2, n as u64), 30);
        }
        agrees_with_brute_force(&soup(300, 2.0, 5), 30);
    }

    #[test]
    fn a_sheet_whose_vertices_are_shared_breaks_ties_by_index() {
        let mesh = wavy(20);
        agrees_with_brute_force(&mesh, 100);
        let bvh = Bvh::new(&mesh);
        for &p in &mesh.positions {
            let hit = bvh.closest(&mesh, p).unwrap();
            assert_eq!(hit.distance_squared, 0.0);
            assert_eq!(Some(hit), brute_force(&mesh, p, 0.0, |_| true));
        }
    }

    #[test]
    fn degenerate_and_coincident_triangles() {
        let mut mesh = soup(50, 0.3, 3);
        mesh.triangles = mesh.triangles.iter().flat_map(|&t| [t; 20]).collect();
        mesh.triangles.extend((0..100).map(|_| [0, 0, 0]));
        mesh.triangles.extend((0..100).map(|v| [v, v, v + 1]));
        agrees_with_brute_force(&mesh, 50);
        let flat = Mesh { positions: vec![DVec3::ONE; 3], triangles: vec![[0, 1, 2]; 5000] };
        let hit = Bvh::new(&flat).closest(&flat, DVec3::ZERO).unwrap();
        assert_eq!((hit.triangle, hit.distance_squared), (0, 3.0));
    }

    #[test]
    fn an_empty_mesh_and_a_point_that_is_none_have_no_answer() {
        let empty = Mesh::default();
        assert_eq!(Bvh::new(&empty).closest(&empty, DVec3::ZERO), None);
        let mut visited = 0;
        Bvh::new(&empty).in_box(&empty, &Aabb { lo: DVec3::ZERO, hi: DVec3::ONE }, |_| visited += 1);
        assert_eq!(visited, 0);
        let mesh = soup(10, 0.1, 1);
        assert_eq!(Bvh::new(&mesh).closest(&mesh, DVec3::NAN), None);
    }

    #[test]
    fn the_number_of_threads_does_not_change_the_tree() {
        let mesh = soup(20_000, 0.05, 8);
        let with = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| Bvh::new(&mesh));
        assert_eq!(with(1).order, with(8).order);
    }
}
