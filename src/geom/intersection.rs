//! An exact test whether two triangles in space intersect anywhere other than at shared corners and sides, for any
//! coordinates.
//!
//! Corners at exactly the same position are shared. Any other common point is a crossing, unless it is on the side between
//! two shared corners. Touching counts. All tests reduce to whether a segment meets a triangle:
//!
//! - Triangles without shared corners cross if a side of one meets the other.
//! - Triangles with one shared corner cross if the opposite side of either meets the other triangle: every ray that starts
//!   at the corner and runs inside both triangles leaves the first of them through that side.
//! - Triangles with two shared corners cross if they are coplanar and lie on the same side of their shared side.
//! - Triangles with three shared corners are the same.
//!
//! Bodies that stand on each other touch, but rounding puts some corners above the contact and some below.
//! [`cross_deeper_than`] distinguishes crossing from contact: it requires that neither triangle lies on one side of the
//! other's plane, and that their intersection is more than a point, both up to a depth.
//!
//! A segment that is not in the triangle's plane meets the triangle if its ends are not on the same side of the plane and
//! its line passes the three sides of the triangle in the same sense. Coplanar figures meet in space if their projections
//! along all three axes meet: at least one of the projections is one-to-one.
//!
//! Based on: P. Guigue, O. Devillers, Fast and robust triangle-triangle overlap test using orientation predicates, 2003, DOI
//! 10.1080/10867651.2003.10487580, for the signs; and J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast
//! robust geometric predicates, 1997, DOI 10.1007/PL00009321, for their exact evaluation. Departures: shared corners,
//! triangles without area, and no permutation of corners.
//!
//! Cost: constant, about ten determinants. Limits: exact as long as products of three coordinates neither overflow nor
//! underflow.

use glam::DVec3;
use robust::{Coord, Coord3D};

type Triangle = [DVec3; 3];

/// Returns whether the triangles have points in common other than shared corners and the side between two shared corners.
pub fn cross(a: Triangle, b: Triangle) -> bool {
    let mut shared = shared_corners(a, b);
    let Some((i, j)) = shared.next() else { return cross_apart(a, b) };
    let Some((k, l)) = shared.next() else {
        return meets(opposite(a, i), b) || meets(opposite(b, j), a);
    };
    shared.next().is_some() || i == k || j == l || folded([a[i], a[k]], a[3 - i - k], b[3 - j - l])
}

/// Returns whether the triangles [`cross`] rather than touch: each has corners deeper than `depth` on both sides of the
/// other, and their common segment is longer than `depth`. Coplanar triangles without a shared corner only touch. Sheets
/// that are folded over at a shared corner or side cross.
pub fn cross_deeper_than(depth: f64, a: Triangle, b: Triangle) -> bool {
    let shared = shared_corners(a, b).count();
    let is_in_plane = |sides: Option<[i32; 3]>| sides == Some([0; 3]);
    let passes = |sides: Option<[i32; 3]>| sides.is_none_or(|s| s.contains(&1) && s.contains(&-1));
    // The first plane already separates most triangles.
    let of_b = sides_of(a, b, depth);
    if shared < 3 && is_in_plane(of_b) && is_in_plane(sides_of(b, a, depth)) {
        return cross_in_plane(a, b);
    }
    if shared > 1 {
        return cross(a, b);
    }
    passes(of_b)
        && passes(sides_of(b, a, depth))
        && cross(a, b)
        && length_in_common(a, b).is_none_or(|length| length > depth)
}

/// [`cross`] for triangles that share one or two corners and are coplanar up to rounding.
fn cross_in_plane(a: Triangle, b: Triangle) -> bool {
    let normal = (a[1] - a[0]).cross(a[2] - a[0]).abs();
    let axis = (0..3).max_by(|&i, &j| normal[i].total_cmp(&normal[j])).expect("space has three axes");
    let mut shared = shared_corners(a, b);
    match (shared.next(), shared.next()) {
        (Some((i, j)), Some((k, l))) => folded_along([a[i], a[k]], a[3 - i - k], b[3 - j - l], axis),
        (Some((i, j)), None) => shadows_meet(opposite(a, i), b, axis) || shadows_meet(opposite(b, j), a, axis),
        (None, _) => false,
    }
}

/// Returns the pairs of corners of `a` and `b` at the same position.
fn shared_corners(a: Triangle, b: Triangle) -> impl Iterator<Item = (usize, usize)> {
    (0..9).map(|i| (i / 3, i % 3)).filter(move |&(i, j)| a[i] == b[j])
}

/// The side of a triangle opposite a corner.
fn opposite(t: Triangle, corner: usize) -> [DVec3; 2] {
    [t[(corner + 1) % 3], t[(corner + 2) % 3]]
}

/// Returns the length of the common segment of two triangles that are not coplanar, where neither lies on one side of the
/// other's plane; `None` if one has no area. If the triangles are apart, the length is negative: minus the gap along the
/// common line of their planes.
fn length_in_common(a: Triangle, b: Triangle) -> Option<f64> {
    let normal = |[p, q, r]: Triangle| (q - p).cross(r - p).try_normalize();
    let [of_a, of_b] = [normal(a)?, normal(b)?];
    let line = of_a.cross(of_b).try_normalize()?;
    // The interval on the line where a triangle meets the plane of the other.
    let range = |own: Triangle, [origin, ..]: Triangle, normal: DVec3| {
        let at = own.map(|p| ((p - origin).dot(normal), (p - origin).dot(line)));
        let ends = (0..3).filter_map(|k| {
            let ((h, s), (g, t)) = (at[k], at[(k + 1) % 3]);
            (h * g <= 0.0 && h != g).then(|| s + (t - s) * (h / (h - g)))
        });
        ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], s| [from.min(s), to.max(s)])
    };
    let ([a_from, a_to], [b_from, b_to]) = (range(a, b, of_b), range(b, a, of_a));
    // Each interval is measured from a corner of the other triangle.
    let shift = (a[0] - b[0]).dot(line);
    Some(a_to.min(b_to + shift) - a_from.max(b_from + shift))
}

/// Returns the sides of the plane of `triangle` on which the corners of `other` lie, 0 within `depth` of it; `None` if the
/// triangle has no area.
fn sides_of(triangle: Triangle, other: Triangle, depth: f64) -> Option<[i32; 3]> {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(c - a).try_normalize()?;
    Some(other.map(|p| (p - a).dot(normal)).map(|height| if height.abs() <= depth { 0 } else { sign(height) }))
}

/// Returns whether triangles without shared corners meet.
fn cross_apart(a: Triangle, b: Triangle) -> bool {
    let beside = |t: Triangle, other: Triangle| {
        let [p, q, r] = other.map(|p| side_of_plane(t, p));
        p != 0 && p == q && q == r
    };
    let sides = |t: Triangle| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    !beside(a, b)
        && !beside(b, a)
        && (sides(a).into_iter().any(|s| meets(s, b)) || sides(b).into_iter().any(|s| meets(s, a)))
}

/// Returns whether two triangles that share a side, with opposite corners `p` and `q`, lie on top of each other.
fn folded([from, to]: [DVec3; 2], p: DVec3, q: DVec3) -> bool {
    side_of_plane([from, to, p], q) == 0 && (0..3).any(|axis| folded_along([from, to], p, q, axis))
}

/// Returns whether the projections of two such triangles do.
fn folded_along(side: [DVec3; 2], p: DVec3, q: DVec3, axis: usize) -> bool {
    let turn = |r: DVec3| side_of_line(side.map(|p| shadow(p, axis)), shadow(r, axis));
    turn(p) * turn(q) > 0
}

/// Returns whether a segment and a triangle, ends and border included, have a point in common.
fn meets(segment: [DVec3; 2], triangle: Triangle) -> bool {
    let [p, q] = segment;
    let ends = segment.map(|p| side_of_plane(triangle, p));
    if ends[0] * ends[1] > 0 {
        return false;
    }
    let [a, b, c] = triangle;
    let around = [[a, b], [b, c], [c, a]].map(|[from, to]| side_of_plane([p, q, from], to));
    if ends == [0, 0] {
        return around == [0; 3] && (0..3).all(|axis| shadows_meet(segment, triangle, axis));
    }
    around.iter().all(|&s| s >= 0) || around.iter().all(|&s| s <= 0)
}

/// [`meets`] for the projections along `axis`.
fn shadows_meet(segment: [DVec3; 2], triangle: Triangle, axis: usize) -> bool {
    let segment = segment.map(|p| shadow(p, axis));
    let [a, b, c] = triangle.map(|p| shadow(p, axis));
    let sides = [[a, b], [b, c], [c, a]];
    let turns = sides.map(|side| side_of_line(side, segment[0]));
    turns.iter().all(|&t| t > 0)
        || turns.iter().all(|&t| t < 0)
        || sides.into_iter().any(|side| segments_meet(segment, side))
}

/// Returns whether two segments in the plane, ends included, have a point in common.
fn segments_meet(a: [Coord<f64>; 2], b: [Coord<f64>; 2]) -> bool {
    let overlap = |from: fn(&Coord<f64>) -> f64| {
        let ([p, q], [r, s]) = (a.map(|p| from(&p)), b.map(|p| from(&p)));
        p.min(q) <= r.max(s) && r.min(s) <= p.max(q)
    };
    let astride = |a: [Coord<f64>; 2], b: [Coord<f64>; 2]| side_of_line(a, b[0]) * side_of_line(a, b[1]) <= 0;
    overlap(|p| p.x) && overlap(|p| p.y) && astride(a, b) && astride(b, a)
}

/// `p` without its coordinate along `axis`.
fn shadow(p: DVec3, axis: usize) -> Coord<f64> {
    Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] }
}

/// The sign of the turn from a line to `p`.
fn side_of_line([from, to]: [Coord<f64>; 2], p: Coord<f64>) -> i32 {
    sign(robust::orient2d(from, to, p))
}

/// The side of a triangle's plane on which `p` lies; 0 on the plane, and for a triangle without area.
fn side_of_plane(triangle: Triangle, p: DVec3) -> i32 {
    let [a, b, c, p] = [triangle[0], triangle[1], triangle[2], p].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    sign(robust::orient3d(a, b, c, p))
}

fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};
    use crate::testing::random_point;
    use glam::DMat3;

    fn triangle(corners: [[f64; 3]; 3]) -> Triangle {
        corners.map(DVec3::from)
    }

    const BASE: [[f64; 3]; 3] = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]];

    /// The answer for all orders of the corners and both orders of the triangles, which must agree.
    #[track_caller]
    fn all_orders(a: Triangle, b: Triangle) -> bool {
        let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
        let answer = cross(a, b);
        for (i, j) in (0..36).map(|i| (orders[i / 6], orders[i % 6])) {
            let (x, y) = (i.map(|k| a[k]), j.map(|k| b[k]));
            assert!(cross(x, y) == answer && cross(y, x) == answer, "{a:?} {b:?}");
        }
        answer
    }

    /// The answer for the base triangle and another one, in all orders and with the axes permuted.
    #[track_caller]
    fn crosses(other: [[f64; 3]; 3]) -> bool {
        let (a, b) = (triangle(BASE), triangle(other));
        let answer = all_orders(a, b);
        for turn in [DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X), DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y)] {
            assert_eq!(all_orders(a.map(|p| turn * p), b.map(|p| turn * p)), answer);
        }
        answer
    }

    #[test]
    fn apart() {
        assert!(crosses([[1., 1., -1.], [1., 1., 1.], [5., 5., 1.]]), "pierced");
        assert!(crosses([[1., 1., -1.], [1., 9., -1.], [1., 1., 9.]]), "a side of each is pierced");
        assert!(!crosses([[5., 5., -1.], [5., 5., 1.], [9., 9., 1.]]), "astride of the plane, but beside");
        assert!(!crosses([[1., 1., 1e-300], [2., 1., 1.], [1., 2., 1.]]), "above by next to nothing");
        assert!(!crosses([[0., 0., 1.], [4., 0., 1.], [0., 4., 1.]]), "parallel");
    }

    #[test]
    fn touching_counts() {
        assert!(crosses([[1., 1., 0.], [2., 1., 1.], [1., 2., 1.]]), "a corner inside");
        assert!(crosses([[2., 0., 0.], [2., -1., 1.], [2., -1., -1.]]), "a corner on a side");
        assert!(crosses([[2., 2., 1.], [2., 2., -1.], [9., 9., 1.]]), "a side against a side");
        assert!(crosses([[1., 1., 0.], [2., 1., 0.], [1., 1., 1.]]), "a side inside");
        assert!(crosses([[1., 0., 0.], [3., 0., 0.], [1., -1., 1.]]), "a side on a part of a side");
        let eps = f64::EPSILON;
        assert!(!crosses([[2. + 2. * eps, 2. + 2. * eps, 0.], [9., 9., 1.], [9., 9., -1.]]), "all but touching");
    }

    #[test]
    fn touching_is_told_from_crossing() {
        let deeper = |other: [[f64; 3]; 3]| {
            let (a, b) = (triangle(BASE), triangle(other));
            assert_eq!(cross_deeper_than(0.01, a, b), cross_deeper_than(0.01, b, a));
            cross_deeper_than(0.01, a, b)
        };
        assert!(!deeper([[1., 1., -0.009], [2., 1., 1.], [1., 2., 1.]]), "a corner inside, by rounding below");
        assert!(deeper([[1., 1., -0.011], [2., 1., 1.], [1., 2., 1.]]), "a corner below");
        assert!(!deeper([[1., 1., 0.009], [9., 1., -0.009], [9., 9., 0.]]), "one on the other");
        assert!(deeper([[0., 0., 0.], [1., 1., 0.], [1., 2., 0.]]), "folded over at a corner");
        assert!(deeper([[0., 0., 0.], [4., 0., 0.], [1., 1., 0.]]), "folded over at a side");
        assert!(deeper([[0., 0., 0.], [1., 1., 0.], [1., 2., 1e-17]]), "folded over at a corner, but for rounding");
        assert!(deeper([[0., 0., 0.], [4., 0., 0.], [1., 1., 1e-17]]), "folded over at a side, but for rounding");
        assert!(!deeper([[0., 0., 0.], [4., 0., 0.], [1., -1., 1e-17]]), "flat neighbours");
        assert!(!deeper([[0., 0., 0.], [4., 0., 0.], [1., 1., 0.5]]), "a sharp fold");
        assert!(deeper([[1., 1., -1.], [1., 1., 0.5], [1., 1., 2.]]), "a pin without area");
        assert!(
            !deeper([[2., -0.005, -1.], [2., -0.005, 1.], [2., -1., 0.]].map(|[x, y, z]| [x, y + 0.01, z])),
            "edges that touch"
        );
        assert!(deeper([[2., 0.02, -1.], [2., 0.02, 1.], [2., -1., 0.]]), "edges that pass");
        assert!(deeper([[0., 0., 0.], [1., 1., 1.], [1., 1., -1.]]), "pierced from a shared corner");
    }

    #[test]
    fn coplanar() {
        assert!(crosses([[1., 1., 0.], [9., 1., 0.], [9., 9., 0.]]), "overlapping");
        assert!(crosses([[1., 1., 0.], [1.5, 1., 0.], [1., 1.5, 0.]]), "inside");
        assert!(crosses([[-9., -9., 0.], [20., -9., 0.], [-9., 20., 0.]]), "around");
        assert!(crosses([[2., 2., 0.], [9., 2., 0.], [2., 9., 0.]]), "touching at a corner");
        assert!(!crosses([[3., 3., 0.], [9., 2., 0.], [2., 9., 0.]]), "beside");
        assert!(crosses([[0., 3., 0.], [4., 3., 0.], [2., -1., 0.]]), "a star of David");
    }

    #[test]
    fn one_shared_corner() {
        assert!(!crosses([[0., 0., 0.], [1., 1., 1.], [-1., 1., 1.]]), "above");
        assert!(!crosses([[0., 0., 0.], [-1., -1., 0.], [-1., -2., 0.]]), "coplanar and beside");
        assert!(crosses([[0., 0., 0.], [1., 1., 1.], [1., 1., -1.]]), "pierced on the far side");
        assert!(crosses([[0., 0., 0.], [9., 9., 9.], [9., 9., -9.]]), "pierces with the far side");
        assert!(crosses([[0., 0., 0.], [1., 1., 0.], [1., 2., 0.]]), "coplanar and inside");
        assert!(crosses([[0., 0., 0.], [9., 1., 0.], [1., 9., 0.]]), "coplanar and around");
        assert!(crosses([[0., 0., 0.], [2., 0., 0.], [2., -1., 1.]]), "along a part of a side");
        assert!(crosses([[0., 0., 0.], [9., 0., 0.], [2., -1., 1.]]), "along a side and on");
        assert!(!crosses([[0., 0., 0.], [-1., 0., 0.], [2., -1., 1.]]), "along the side backwards");
    }

    #[test]
    fn shared_sides() {
        assert!(!crosses([[0., 0., 0.], [4., 0., 0.], [0., -4., 0.]]), "flat neighbours");
        assert!(!crosses([[0., 0., 0.], [4., 0., 0.], [1., 1., 1e-300]]), "a sharp fold");
        assert!(crosses([[0., 0., 0.], [4., 0., 0.], [1., 1., 0.]]), "folded over and inside");
        assert!(crosses([[0., 0., 0.], [4., 0., 0.], [-9., 1., 0.]]), "folded over and beyond");
        assert!(crosses(BASE), "the same");
    }

    #[test]
    fn triangles_without_area_are_segments_and_points() {
        assert!(crosses([[1., 1., -1.], [1., 1., 0.5], [1., 1., 2.]]), "a pin");
        assert!(!crosses([[5., 5., -1.], [5., 5., 0.5], [5., 5., 2.]]), "a pin beside");
        assert!(crosses([[1., 1., 0.], [2., 1., 0.], [9., 1., 0.]]), "a pin in the plane");
        assert!(!crosses([[5., 1., 0.], [6., 1., 0.], [9., 1., 0.]]), "a pin in the plane and beside");
        assert!(crosses([[1., 1., 0.]; 3]) && !crosses([[1., 1., 1.]; 3]) && !crosses([[5., 0., 0.]; 3]), "a point");
        let segments = |b: [[f64; 3]; 3]| all_orders(triangle([[0., 0., 0.], [1., 1., 1.], [4., 4., 4.]]), triangle(b));
        assert!(segments([[2., 2., 0.], [2., 2., 1.], [2., 2., 3.]]), "two segments");
        assert!(!segments([[2., 2.5, 0.], [2., 2.5, 1.], [2., 2.5, 3.]]), "two segments that miss each other");
        assert!(!segments([[5., 5., 5.], [6., 6., 6.], [7., 7., 7.]]), "two segments on one line");
    }

    /// The smallest distance between points of a segment and a triangle, by ternary search: both are convex.
    fn distance([p, q]: [DVec3; 2], t: Triangle) -> f64 {
        let at = |s: f64| {
            let r = p.lerp(q, s);
            r.distance(crate::geom::triangle::closest_point(r, t))
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..100 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if at(a) < at(b) { high = b } else { low = a }
        }
        at(low)
    }

    #[test]
    fn random_triangles_cross_where_they_are_at_no_distance() {
        let mut rng = stream(5, Stage::Distance);
        let mut count = [0; 2];
        for _ in 0..2000 {
            let [a, b] = [0; 2].map(|_| [0; 3].map(|_| random_point(&mut rng)));
            let sides = |t: Triangle| (0..3).map(move |k| [t[k], t[(k + 1) % 3]]);
            let apart = sides(a).map(|s| distance(s, b)).chain(sides(b).map(|s| distance(s, a)));
            let apart = apart.fold(f64::INFINITY, f64::min);
            let found = all_orders(a, b);
            assert!(found == (apart < 1e-9) || (1e-12..1e-6).contains(&apart), "{a:?} {b:?} {apart}");
            count[usize::from(found)] += 1;
        }
        assert!(count[0] > 300 && count[1] > 300, "{count:?}");
    }
}
