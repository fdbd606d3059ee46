//! Triangulates a polygon in space without adding vertices.
//!
//! A quadrilateral is split along the diagonal whose worse triangle has the better shape. Polygons with more corners are
//! projected along the dominant axis of Newell's normal, n = Σ pᵢ × pᵢ₊₁, which drops one coordinate and changes no sign.
//! Ears are clipped, the one with the shortest cut first, until three corners are left. An ear is a convex corner whose
//! triangle has no reflex or flat corner inside or on it. A blocked corner is tested again when the corner that blocks it
//! becomes convex.
//!
//! First, the corners are relisted from the smallest corner towards its smaller neighbour, by coordinates. So the polygon
//! gets the same triangles wherever its list starts and whichever way it runs, as is necessary for a face between two cells.
//!
//! Based on: G. H. Meisters, Polygons have ears, 1975, DOI 10.2307/2319703. Departures: the order; corners at the same
//! position as a corner of the ear do not block it (slits that join a hole to the outline); if no ear is left, as in
//! polygons that intersect themselves or have no area, the shortest cut is made anyway.
//!
//! Cost: n log n for n convex corners, n r with r reflex ones, at most `BUDGET` tests. Limits: a polygon that exhausts the
//! budget has overlapping triangles, and one whose smallest side occurs twice may depend on where its list starts. Even
//! then, every polygon of n corners gets n - 2 triangles whose boundary is its outline.

use glam::DVec3;
use robust::{Coord, orient2d};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Limit on the point-in-ear tests for one polygon, about half a second: enough for some 20,000 corners of which half are
/// reflex. Without this limit, a malicious file of a few megabytes would take hours.
const BUDGET: usize = 100_000_000;

/// The second diagonal must be better than the first by this much (shapes range from -1 to 1), so that rounding does not
/// decide between the diagonals of a rectangle.
const CLEARLY_BETTER: f64 = 1e-9;

/// Returns triangles as indices into `corners`, oriented like the polygon and in increasing order: `corners.len() - 2` of
/// them, none for fewer than three corners. Every side of the polygon is a side of exactly one triangle.
pub fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    if corners.len() <= 3 {
        return if corners.len() == 3 { vec![[0, 1, 2]] } else { Vec::new() };
    }
    let Listing { first, reversed } = Listing::of(corners);
    let n = corners.len();
    let place = |i: usize| if reversed { (first + n - i) % n } else { (first + i) % n };
    let listed: Vec<DVec3> = (0..n).map(|i| corners[place(i)]).collect();
    let triangles = match listed[..] {
        [a, b, c, d] => split_quad([a, b, c, d]).to_vec(),
        _ => Clipper::new(&listed).run(),
    };
    let placed = |t: [usize; 3]| from_least(if reversed { [t[0], t[2], t[1]] } else { t }.map(place));
    let mut triangles: Vec<[usize; 3]> = triangles.into_iter().map(placed).collect();
    triangles.sort_unstable();
    triangles
}

/// An order of a polygon's corners that does not depend on how they are listed.
struct Listing {
    first: usize,
    reversed: bool,
}

impl Listing {
    /// Starts at the smallest corner and runs towards the smaller of its neighbours.
    fn of(corners: &[DVec3]) -> Listing {
        let n = corners.len();
        let coordinates = |side: (usize, usize)| [corners[side.0].to_array(), corners[side.1].to_array()];
        let sides = (0..n).flat_map(|i| [(i, (i + 1) % n), (i, (i + n - 1) % n)]);
        let smaller = |a, b| if coordinates(b) < coordinates(a) { b } else { a };
        let (first, second) = sides.reduce(smaller).unwrap_or_default();
        Listing { first, reversed: second != (first + 1) % n }
    }
}

/// Returns the same triangle with its smallest corner first.
fn from_least([a, b, c]: [usize; 3]) -> [usize; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn split_quad(corners: [DVec3; 4]) -> [[usize; 3]; 2] {
    let [a, b, c, d] = corners;
    let normal = (c - a).cross(d - b).normalize_or_zero();
    let worse = |split: [[usize; 3]; 2]| {
        let [one, two] = split.map(|t| shape(t.map(|i| corners[i]), normal));
        one.min(two)
    };
    let (first, second) = ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]);
    if worse(second) > worse(first) + CLEARLY_BETTER { second } else { first }
}

/// Twice the area as seen along `normal`, divided by the mean squared side length: 0 without area, negative if turned over.
fn shape([a, b, c]: [DVec3; 3], normal: DVec3) -> f64 {
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    let shape = 3.0 * (b - a).cross(c - a).dot(normal) / sides;
    if shape.is_nan() { 0.0 } else { shape }
}

/// A possible ear, ordered by the squared length of its cut, then by corner. The squared length is stored as bits, which
/// sort like the non-negative numbers that they represent. The candidate is stale if the corner's `stamp` has changed.
type Candidate = Reverse<(u64, usize, u32)>;

struct Clipper<'a> {
    corners: &'a [DVec3],
    flat: Vec<Coord<f64>>,
    next: Vec<usize>,
    previous: Vec<usize>,
    stamp: Vec<u32>,
    alive: Vec<bool>,
    /// Corners that are reflex or flat.
    blockers: Vec<usize>,
    /// The corners whose ears each corner blocks.
    blocked: Vec<Vec<usize>>,
    candidates: BinaryHeap<Candidate>,
    budget: usize,
    triangles: Vec<[usize; 3]>,
}

impl<'a> Clipper<'a> {
    fn new(corners: &'a [DVec3]) -> Self {
        let n = corners.len();
        let mut clipper = Clipper {
            corners,
            flat: flatten(corners),
            next: (1..n).chain([0]).collect(),
            previous: [n - 1].into_iter().chain(0..n - 1).collect(),
            stamp: vec![0; n],
            alive: vec![true; n],
            blockers: Vec::new(),
            blocked: vec![Vec::new(); n],
            candidates: BinaryHeap::new(),
            budget: BUDGET,
            triangles: Vec::with_capacity(n - 2),
        };
        clipper.blockers = (0..n).filter(|&i| !clipper.is_convex(i)).collect();
        (0..n).for_each(|i| clipper.consider(i));
        clipper
    }

    fn run(mut self) -> Vec<[usize; 3]> {
        let wanted = self.corners.len() - 2;
        while self.triangles.len() < wanted {
            match self.pop_ear().or_else(|| self.shortest_cut()) {
                Some(i) => self.clip(i),
                None => break,
            }
        }
        self.triangles
    }

    /// The corner between its two neighbours, in the order of the polygon.
    fn ear(&self, i: usize) -> [usize; 3] {
        [self.previous[i], i, self.next[i]]
    }

    fn is_convex(&self, i: usize) -> bool {
        let [a, b, c] = self.ear(i).map(|i| self.flat[i]);
        orient2d(a, b, c) > 0.0
    }

    fn cut(&self, i: usize) -> u64 {
        self.corners[self.previous[i]].distance_squared(self.corners[self.next[i]]).abs().to_bits()
    }

    fn consider(&mut self, i: usize) {
        self.stamp[i] += 1;
        self.candidates.push(Reverse((self.cut(i), i, self.stamp[i])));
    }

    /// Returns the candidate with the shortest cut that is an ear, or any candidate once the budget is exhausted.
    fn pop_ear(&mut self) -> Option<usize> {
        while let Some(Reverse((_, i, stamp))) = self.candidates.pop() {
            if !self.alive[i] || self.stamp[i] != stamp {
                continue;
            }
            if self.budget == 0 {
                return Some(i);
            }
            if !self.is_convex(i) {
                continue;
            }
            match self.blocker_of(i) {
                None => return Some(i),
                Some(blocker) => self.blocked[blocker].push(i),
            }
        }
        None
    }

    fn blocker_of(&mut self, i: usize) -> Option<usize> {
        self.budget = self.budget.saturating_sub(self.blockers.len());
        let ear = self.ear(i).map(|i| self.flat[i]);
        self.blockers.iter().copied().find(|&b| blocks(self.flat[b], ear))
    }

    /// For polygons without ears: returns the corner to clip anyway.
    fn shortest_cut(&mut self) -> Option<usize> {
        self.budget = self.budget.saturating_sub(self.corners.len());
        let alive: Vec<usize> = (0..self.corners.len()).filter(|&i| self.alive[i]).collect();
        if self.budget == 0 {
            alive.iter().for_each(|&i| self.consider(i));
        }
        alive.into_iter().min_by_key(|&i| (self.cut(i), i))
    }

    fn clip(&mut self, i: usize) {
        let [before, _, after] = self.ear(i);
        self.triangles.push([before, i, after]);
        self.alive[i] = false;
        self.next[before] = after;
        self.previous[after] = before;
        self.release(i);
        for neighbor in [before, after] {
            if self.is_convex(neighbor) {
                self.release(neighbor);
            }
            self.consider(neighbor);
        }
    }

    /// Marks corner `i` as no longer blocking any ear.
    fn release(&mut self, i: usize) {
        if let Some(place) = self.blockers.iter().position(|&b| b == i) {
            self.blockers.swap_remove(place);
        }
        for waiting in std::mem::take(&mut self.blocked[i]) {
            if self.alive[waiting] {
                self.consider(waiting);
            }
        }
    }
}

/// Projects the corners along the axis in which Newell's normal is largest, so that they are counter-clockwise.
fn flatten(corners: &[DVec3]) -> Vec<Coord<f64>> {
    let normal = newell_normal(corners);
    let size = normal.abs();
    let dropped = if size.z >= size.x && size.z >= size.y { 2 } else { usize::from(size.y > size.x) };
    let (mut x, mut y) = ((dropped + 1) % 3, (dropped + 2) % 3);
    if normal[dropped] < 0.0 {
        (x, y) = (y, x);
    }
    corners.iter().map(|p| Coord { x: p[x], y: p[y] }).collect()
}

/// Twice the polygon's area vector. Computed relative to the first corner, so that it is accurate far from the origin.
fn newell_normal(corners: &[DVec3]) -> DVec3 {
    corners.windows(2).map(|side| (side[0] - corners[0]).cross(side[1] - corners[0])).sum()
}

/// Returns whether `p` lies in or on the ear, other than at its corners.
fn blocks(p: Coord<f64>, [a, b, c]: [Coord<f64>; 3]) -> bool {
    let outside = |lo: f64, hi: f64, at: f64| at < lo || at > hi;
    if outside(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), p.x)
        || outside(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), p.y)
        || [a, b, c].contains(&p)
    {
        return false;
    }
    orient2d(a, b, p) >= 0.0 && orient2d(b, c, p) >= 0.0 && orient2d(c, a, p) >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::{BTreeMap, BTreeSet};

    fn flat(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
    }

    fn area(corners: &[DVec3], [a, b, c]: [usize; 3]) -> DVec3 {
        0.5 * (corners[b] - corners[a]).cross(corners[c] - corners[a])
    }

    /// Checks for n - 2 triangles in which each side of the outline occurs once, and all other sides twice, in both
    /// directions.
    fn audit(corners: &[DVec3]) -> Vec<[usize; 3]> {
        let triangles = triangulate(corners);
        let n = corners.len();
        assert_eq!(triangles.len(), n - 2);
        let mut sides: BTreeMap<(usize, usize), i32> = BTreeMap::new();
        for &[a, b, c] in &triangles {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                *sides.entry((p, q)).or_default() += 1;
                *sides.entry((q, p)).or_default() -= 1;
            }
        }
        (0..n).for_each(|i| *sides.entry((i, (i + 1) % n)).or_default() -= 1);
        (0..n).for_each(|i| *sides.entry(((i + 1) % n, i)).or_default() += 1);
        assert!(sides.values().all(|&open| open == 0), "{triangles:?}");
        triangles
    }

    /// Like `audit`, and checks that no triangle is turned over: together, the triangles cover the polygon once.
    fn audit_simple(corners: &[DVec3]) {
        let normal = newell_normal(corners).normalize();
        for t in audit(corners) {
            assert!(area(corners, t).dot(normal) > 0.0, "{t:?}");
        }
    }

    #[test]
    fn few_corners() {
        assert!(triangulate(&[]).is_empty());
        assert!(triangulate(&[DVec3::ZERO; 2]).is_empty());
        assert_eq!(triangulate(&[DVec3::ZERO; 3]), [[0, 1, 2]]);
    }

    /// The triangles as positions of their corners, in the direction of `corners` or against it.
    fn places(corners: &[DVec3], against: bool) -> BTreeSet<[[u64; 3]; 3]> {
        let oriented = |[a, b, c]: [usize; 3]| if against { [a, c, b] } else { [a, b, c] };
        let bits = |t: [usize; 3]| t.map(|i| corners[i].to_array().map(f64::to_bits));
        let from_least_place = |mut t: [[u64; 3]; 3]| {
            let least = (0..3).min_by_key(|&k| t[k]).unwrap();
            t.rotate_left(least);
            t
        };
        triangulate(corners).into_iter().map(oriented).map(bits).map(from_least_place).collect()
    }

    #[test]
    fn triangles_do_not_depend_on_how_the_corners_are_listed() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let dart = [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)];
        let hexagon = [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0), (0.0, 1.0)];
        let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 2.1);
        for shape in [&square[..], &dart, &hexagon] {
            for corners in [flat(shape), flat(shape).iter().map(|&p| turn * p).collect()] {
                let wanted = places(&corners, false);
                for start in 0..corners.len() {
                    let mut listed = corners.clone();
                    listed.rotate_left(start);
                    assert_eq!(places(&listed, false), wanted);
                    listed.reverse();
                    assert_eq!(places(&listed, true), wanted);
                }
            }
        }
    }

    #[test]
    fn rectangles_are_split_at_their_smallest_corner_wherever_they_lie() {
        for shift in [DVec3::ZERO, DVec3::new(0.1, 1e3, -7.0)] {
            let corners: Vec<_> =
                flat(&[(3.0, 0.0), (3.0, 1.0), (0.0, 1.0), (0.0, 0.0)]).iter().map(|p| p + shift).collect();
            assert_eq!(triangulate(&corners), [[0, 1, 3], [1, 2, 3]]);
        }
    }

    #[test]
    fn concave_quads_are_split_at_the_reflex_corner() {
        let dart = [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)];
        for turn in 0..4 {
            let mut points = dart;
            points.rotate_left(turn);
            audit_simple(&flat(&points));
        }
    }

    #[test]
    fn a_quad_with_a_flat_corner_has_no_empty_triangle() {
        let points = [(0.0, 0.0), (0.3, 0.1), (0.6, 0.2), (0.0, 1.0)];
        for turn in 0..4 {
            let mut points = points;
            points.rotate_left(turn);
            let corners = flat(&points);
            assert!(triangulate(&corners).iter().all(|&t| area(&corners, t).z > 0.01));
        }
    }

    #[test]
    fn convex_and_flat_corners() {
        let circle: Vec<_> = (0..40).map(|i| (0.1 * f64::from(i)).sin_cos()).collect();
        audit_simple(&flat(&circle));
        audit_simple(&flat(&[
            (0.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.0),
            (2.0, 1.0),
            (2.0, 2.0),
            (1.0, 2.0),
            (0.0, 2.0),
            (0.0, 1.0),
        ]));
    }

    #[test]
    fn combs_and_spirals_in_any_plane() {
        let comb: Vec<(f64, f64)> = (0..30)
            .flat_map(|i| {
                let x = f64::from(i);
                [(x, f64::from(i * i % 7)), (x + 0.4, 10.0), (x + 0.6, 10.0)]
            })
            .chain([(30.0, 0.0), (30.0, -1.0), (0.0, -1.0)])
            .collect();
        let spiral: Vec<(f64, f64)> = (0..100)
            .map(|i| (f64::from(i) * 0.2, 1.0 + f64::from(i) * 0.1))
            .chain((0..100).rev().map(|i| (f64::from(i) * 0.2, 1.3 + f64::from(i) * 0.1)))
            .map(|(angle, r)| (r * angle.cos(), r * angle.sin()))
            .collect();
        let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 2.1);
        for points in [comb, spiral] {
            let corners = flat(&points);
            let reversed: Vec<_> = corners.iter().rev().copied().collect();
            let turned: Vec<_> = corners.iter().map(|&p| turn * p + DVec3::new(5.0, 1.0, 9.0)).collect();
            [corners, reversed, turned].iter().for_each(|c| audit_simple(c));
        }
    }

    #[test]
    fn a_hole_joined_by_a_slit() {
        let corners = flat(&[
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 4.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (3.0, 3.0),
            (3.0, 1.0),
            (1.0, 1.0),
        ]);
        let triangles = audit(&corners);
        assert!(triangles.iter().all(|&t| area(&corners, t).z >= 0.0));
        let total: f64 = triangles.iter().map(|&t| area(&corners, t).z).sum();
        assert_eq!(total, 12.0);
    }

    #[test]
    fn polygons_without_area_stay_connected() {
        audit(&[DVec3::ONE; 6]);
        audit(&(0..9).map(|i| DVec3::splat(f64::from(i) / 3.0)).collect::<Vec<_>>());
        audit(&flat(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.5)]));
        audit(&[DVec3::MAX, DVec3::MIN, DVec3::ZERO, DVec3::X, DVec3::MAX, DVec3::Y]);
    }

    #[test]
    fn many_corners_end_in_time() {
        let line: Vec<_> = (0..60_000).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        assert_eq!(triangulate(&line).len(), 59_998);
        assert_eq!(triangulate(&vec![DVec3::ZERO; 60_000]).len(), 59_998);
    }

    proptest! {
        #[test]
        fn stars_are_covered_once(radii in prop::collection::vec(0.2f64..1.0, 5..60), tilt in -1.0f64..1.0) {
            let step = std::f64::consts::TAU / radii.len() as f64;
            let corners: Vec<_> = radii.iter().enumerate().map(|(i, r)| {
                let (sin, cos) = (i as f64 * step).sin_cos();
                DVec3::new(r * cos, r * sin, tilt * r * cos)
            }).collect();
            audit_simple(&corners);
        }

        #[test]
        fn any_corners_stay_connected(points in prop::collection::vec((0i8..4, 0i8..4, 0i8..2), 3..14)) {
            audit(&points.iter().map(|&(x, y, z)| DVec3::new(x.into(), y.into(), z.into())).collect::<Vec<_>>());
        }
    }
}
