//! A single triangle in space: closest point, barycentric coordinates, angles, area.
//!
//! With b' = b - a, c' = c - a and p' = p - a, the foot of p in the plane is a + v b' + w c' where
//!
//! ```text
//! | b'·b'  b'·c' | | v |   | b'·p' |
//! | b'·c'  c'·c' | | w | = | c'·p' |
//! ```
//!
//! and the signs of v, w, 1 - v - w and of the right-hand sides determine in which of the seven regions of the plane
//! (inside, three sides, three corners) the foot lies.
//!
//! Based on: Christer Ericson, *Real-Time Collision Detection*, section 5.1.5, 2005, ISBN 978-1558607323. Departures: the
//! region tests use the entries of the system above, whose error grows with the distance of p rather than with its square;
//! triangles whose first angle is below a ten-thousandth of a radian (or as close to 180 degrees) are solved as three
//! segments and an interior; the result never leaves the triangle's bounding box.
//!
//! Cost: constant. Limits: coordinates whose fourth powers overflow or vanish in f64 are not supported.

use crate::base::math;
use glam::DVec3;

/// Below this squared sine of the angle at the first corner, the system above has lost half of its digits, and the region
/// tests could select the wrong region.
const SLIVER_SINE_SQUARED: f64 = 1e-8;

/// Returns the point of triangle `[a, b, c]` closest to `p`, within the triangle's bounding box to the last bit.
///
/// A degenerate triangle counts as a segment or a point.
pub fn closest_point(p: DVec3, triangle: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = triangle;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (bb, bc, cc) = (ab.length_squared(), ab.dot(ac), ac.length_squared());
    let determinant = bb * cc - bc * bc;
    let point = if determinant > SLIVER_SINE_SQUARED * bb * cc {
        let [_, v, w] = clamped_foot([bb, bc, cc], determinant, ab.dot(ap), ac.dot(ap));
        a + v * ab + w * ac
    } else {
        closest_point_of_sliver(p, triangle)
    };
    point.max(a.min(b).min(c)).min(a.max(b).max(c))
}

/// Returns the barycentric coordinates of the point of `triangle` closest to `p`. If that point is on a side or at a corner,
/// the coordinates of the other corners are exactly zero. `None` for a triangle so flat that it must be solved as segments.
#[inline]
pub fn closest_weights(p: DVec3, [a, b, c]: [DVec3; 3]) -> Option<[f64; 3]> {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (bb, bc, cc) = (ab.length_squared(), ab.dot(ac), ac.length_squared());
    let determinant = bb * cc - bc * bc;
    (determinant > SLIVER_SINE_SQUARED * bb * cc)
        .then(|| clamped_foot([bb, bc, cc], determinant, ab.dot(ap), ac.dot(ap)))
}

/// Returns the barycentric coordinates of the closest point, given the entries of the system, its determinant and its
/// right-hand sides.
#[inline]
fn clamped_foot([bb, bc, cc]: [f64; 3], determinant: f64, pb: f64, pc: f64) -> [f64; 3] {
    if pb <= 0.0 && pc <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    // The same two right-hand sides relative to b and to c.
    let (pb_at_b, pc_at_b) = (pb - bb, pc - bc);
    if pb_at_b >= 0.0 && pc_at_b <= pb_at_b {
        return [0.0, 1.0, 0.0];
    }
    let (pb_at_c, pc_at_c) = (pb - bc, pc - cc);
    if pc_at_c >= 0.0 && pb_at_c <= pc_at_c {
        return [0.0, 0.0, 1.0];
    }
    let (v, w) = (cc * pb - bc * pc, bb * pc - bc * pb);
    if w <= 0.0 && pb >= 0.0 && pb_at_b <= 0.0 {
        return [1.0 - pb / bb, pb / bb, 0.0];
    }
    if v <= 0.0 && pc >= 0.0 && pc_at_c <= 0.0 {
        return [1.0 - pc / cc, 0.0, pc / cc];
    }
    let (from_b, from_c) = (pc_at_b - pb_at_b, pb_at_c - pc_at_c);
    if determinant - v - w <= 0.0 && from_b >= 0.0 && from_c >= 0.0 {
        let w = from_b / (from_b + from_c);
        return [0.0, 1.0 - w, w];
    }
    [1.0 - (v + w) / determinant, v / determinant, w / determinant]
}

/// Returns the best of the closest points of the three sides and, if it can be determined, the foot in the interior.
#[cold]
fn closest_point_of_sliver(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    if b == c {
        return closest_point_of_segment(p, a, b);
    }
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| closest_point_of_segment(p, from, to));
    let weights = barycentric(p, [a, b, c]);
    let inside = weights.iter().all(|&w| w >= 0.0).then(|| weights[0] * a + weights[1] * b + weights[2] * c);
    let nearer = |x: DVec3, y: DVec3| if p.distance_squared(y) < p.distance_squared(x) { y } else { x };
    sides.into_iter().skip(1).chain(inside).fold(sides[0], nearer)
}

/// Returns the point of the segment `from`..`to` closest to `p`.
pub fn closest_point_of_segment(p: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    from + share_along(p, from, to) * (to - from)
}

/// Returns the parameter of the point of the segment closest to `p`: 0 at `from`, 1 at `to`, 0 for a segment without length.
fn share_along(p: DVec3, from: DVec3, to: DVec3) -> f64 {
    let along = to - from;
    let length_squared = along.length_squared();
    if length_squared > 0.0 { ((p - from).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 }
}

/// Returns the barycentric coordinates of the foot of `p` in the plane of `triangle`. They sum to one and are negative
/// beyond a side.
///
/// A triangle without area has no plane: its coordinates are those of the closest point on its longest side.
pub fn barycentric(p: DVec3, triangle: [DVec3; 3]) -> [f64; 3] {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(c - a);
    let squared = normal.length_squared();
    let (v, w) = (normal.dot((p - a).cross(c - a)) / squared, normal.dot((b - a).cross(p - a)) / squared);
    if v.is_finite() && w.is_finite() { [1.0 - v - w, v, w] } else { barycentric_on_longest_side(p, triangle) }
}

fn barycentric_on_longest_side(p: DVec3, triangle: [DVec3; 3]) -> [f64; 3] {
    let length = |k: usize| triangle[k].distance_squared(triangle[(k + 1) % 3]);
    let k = (1..3).fold(0, |best, k| if length(k) > length(best) { k } else { best });
    let share = share_along(p, triangle[k], triangle[(k + 1) % 3]);
    let mut weights = [0.0; 3];
    weights[k] = 1.0 - share;
    weights[(k + 1) % 3] = share;
    weights
}

/// Tolerance in barycentric coordinates by which a ray may miss a triangle's side and still meet the triangle, so that no
/// ray slips between two triangles.
const SIDE_WIDTH: f64 = 1e-9;

/// Returns the distance from `origin` along the unit vector `direction` to the triangle, if the ray meets it; never
/// negative.
///
/// Based on: T. Möller, B. Trumbore, Fast, minimum storage ray-triangle intersection, 1997,
/// DOI 10.1080/10867651.1997.10487468.
pub fn along_ray(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (to_b, to_c, from_a) = (b - a, c - a, origin - a);
    let (p, q) = (direction.cross(to_c), from_a.cross(to_b));
    let scale = to_b.dot(p).recip();
    let (v, w) = (scale * from_a.dot(p), scale * direction.dot(q));
    let distance = scale * to_c.dot(q);
    let inside = v.min(w).min(1.0 - v - w) >= -SIDE_WIDTH;
    (inside && distance >= 0.0 && distance.is_finite()).then_some(distance)
}

/// The area.
pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// The lengths of the sides opposite the three corners.
pub fn side_lengths([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    [b.distance(c), c.distance(a), a.distance(b)]
}

/// The length of the longest side.
pub fn longest_side(triangle: [DVec3; 3]) -> f64 {
    side_lengths(triangle).into_iter().fold(0.0, f64::max)
}

/// The angles at the three corners, in degrees. Without area, they are 0, 0 and 180 in the order of the corners on their
/// line; if all corners coincide, all angles are 0.
pub fn angles([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let twice_area = (b - a).cross(c - a).length();
    let at = |u: DVec3, w: DVec3| math::atan2(twice_area, u.dot(w)).to_degrees();
    [at(b - a, c - a), at(c - b, a - b), at(a - c, b - c)]
}

/// The first of the [`angles`].
pub fn first_angle([a, b, c]: [DVec3; 3]) -> f64 {
    math::atan2((b - a).cross(c - a).length(), (b - a).dot(c - a)).to_degrees()
}

/// The smallest and the largest of the [`angles`].
pub fn extreme_angles([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let twice_area = (b - a).cross(c - a).length();
    let dots = [(b - a).dot(c - a), (c - b).dot(a - b), (a - c).dot(b - c)];
    // The sine times the lengths of the adjacent sides is the same for all angles, so an angle decreases as its dot product
    // grows.
    let angle = |dot: f64| math::atan2(twice_area, dot).to_degrees();
    (angle(dots[0].max(dots[1]).max(dots[2])), angle(dots[0].min(dots[1]).min(dots[2])))
}

/// The smallest of the [`angles`].
pub fn smallest_angle(corners: [DVec3; 3]) -> f64 {
    let (sine, cosine) = smallest_sine_cosine(corners);
    math::atan2(sine, cosine).to_degrees()
}

/// Sine and cosine of the smallest angle, times the lengths of its adjacent sides.
#[inline]
pub fn smallest_sine_cosine([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let twice_area = (b - a).cross(c - a).length();
    // The sine times the lengths of the adjacent sides is the same for all angles, so an angle decreases as its dot product
    // grows.
    let dot = (b - a).dot(c - a).max((c - b).dot(a - b)).max((a - c).dot(b - c));
    (twice_area, dot)
}

/// The mean ratio 4 √3 S / (a² + b² + c²): 1 for an equilateral triangle, 0 for a flat one. Cheap to compute.
pub fn mean_ratio([a, b, c]: [DVec3; 3]) -> f64 {
    let squares = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    let ratio = 2.0 * 3f64.sqrt() * (b - a).cross(c - a).length() / squares;
    if ratio.is_finite() { ratio } else { 0.0 }
}

/// The quality 6 S / (√3 p h), with the half perimeter p and the longest side h: 1 for an equilateral triangle, 0 for a flat
/// one.
pub fn quality(corners: [DVec3; 3]) -> f64 {
    quality_of(side_lengths(corners), area(corners))
}

fn quality_of(sides: [f64; 3], area: f64) -> f64 {
    let longest = sides[0].max(sides[1]).max(sides[2]);
    let half_perimeter = 0.5 * (sides[0] + sides[1] + sides[2]);
    let q = 6.0 * area / (3f64.sqrt() * half_perimeter * longest);
    if q.is_finite() { q } else { 0.0 }
}

/// [`quality`] and [`smallest_sine_cosine`] at little more than the cost of one of them.
#[inline]
pub fn quality_and_sine_cosine(corners: [DVec3; 3]) -> (f64, f64, f64) {
    let (twice_area, dot) = smallest_sine_cosine(corners);
    (quality_of(side_lengths(corners), 0.5 * twice_area), twice_area, dot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn a_ray_meets_a_triangle_in_front_of_it() {
        let triangle = [DVec3::ZERO, 2.0 * DVec3::X, 2.0 * DVec3::Y];
        let from = |x: f64, y: f64, z: f64| along_ray(DVec3::new(x, y, z), DVec3::NEG_Z, triangle);
        assert_eq!((from(0.5, 0.5, 3.0), from(0.5, 0.5, -3.0), from(1.5, 1.5, 3.0)), (Some(3.0), None, None));
        assert_eq!(along_ray(DVec3::new(-1.0, 0.5, 0.0), DVec3::X, triangle), None);
    }
    use crate::base::rng::{Random, Stage, stream};
    use approx::assert_relative_eq;

    fn random_point(rng: &mut Random) -> DVec3 {
        testing::random_point(rng) * 2.0 - DVec3::ONE
    }

    /// The smallest distance to a grid of the triangle's points.
    fn by_grid(p: DVec3, [a, b, c]: [DVec3; 3], n: usize) -> f64 {
        let point = |i: usize, j: usize| a + (b - a) * (i as f64 / n as f64) + (c - a) * (j as f64 / n as f64);
        (0..=n)
            .flat_map(|i| (0..=n - i).map(move |j| (i, j)))
            .map(|(i, j)| p.distance(point(i, j)))
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_closest_point_is_as_near_as_the_best_of_a_fine_grid() {
        let mut rng = stream(1, Stage::Distance);
        for _ in 0..300 {
            let triangle = [0; 3].map(|_| random_point(&mut rng));
            let p = 2.0 * random_point(&mut rng);
            let found = p.distance(closest_point(p, triangle));
            let grid = by_grid(p, triangle, 60);
            assert!(found <= grid + 1e-12 && found >= grid - 0.06, "{found} {grid}");
        }
    }

    #[test]
    fn every_region_of_the_plane_has_its_answer() {
        let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let cases = [
            ([0.2, 0.2, 5.0], [0.2, 0.2, 0.0]),
            ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]),
            ([3.0, 0.5, 0.0], [1.0, 0.0, 0.0]),
            ([0.5, 3.0, 0.0], [0.0, 1.0, 0.0]),
            ([0.5, -1.0, 2.0], [0.5, 0.0, 0.0]),
            ([-1.0, 0.5, 2.0], [0.0, 0.5, 0.0]),
            ([1.0, 1.0, 2.0], [0.5, 0.5, 0.0]),
        ];
        for (p, expected) in cases {
            assert!(closest_point(p.into(), t).distance(expected.into()) < 1e-15);
            let weights = closest_weights(p.into(), t).unwrap();
            let away = barycentric(expected.into(), t).map(|w| w.abs() < 1e-15);
            assert_eq!(weights.map(|w| w == 0.0), away, "{p:?}: {weights:?}");
        }
    }

    #[test]
    fn degenerate_triangles_are_segments_and_points() {
        let (o, x, far) = (DVec3::ZERO, DVec3::X, 3.0 * DVec3::X);
        let p = DVec3::new(2.0, 1.0, 0.0);
        let foot = DVec3::new(2.0, 0.0, 0.0);
        for triangle in [[o, x, far], [far, o, x], [o, o, far], [o, far, far], [far, o, far], [x, far, o]] {
            assert!(closest_point(p, triangle).distance(foot) < 1e-12);
        }
        assert_eq!(closest_point(p, [x, x, x]), x);
        assert_eq!(closest_point(x, [x, x, x]), x);
    }

    #[test]
    fn slivers_are_exact_at_any_thickness() {
        let mut rng = stream(2, Stage::Distance);
        for exponent in 1..30 {
            let height = 10f64.powi(-exponent);
            let triangle = [DVec3::ZERO, DVec3::X, DVec3::new(0.4, height, 0.0)];
            let p = random_point(&mut rng);
            let found = p.distance(closest_point(p, triangle));
            let truth = (0..3)
                .map(|k| p.distance(closest_point_of_segment(p, triangle[k], triangle[(k + 1) % 3])))
                .fold(f64::INFINITY, f64::min);
            assert!((truth - found).abs() <= height + 1e-12, "{height}: {found} {truth}");
            let over = DVec3::new(0.4, height / 2.0, 1.0);
            assert_relative_eq!(over.distance(closest_point(over, triangle)), 1.0, epsilon = 1e-12);
        }
    }

    #[test]
    fn the_result_stays_in_the_bounding_box() {
        let mut rng = stream(3, Stage::Distance);
        for _ in 0..1000 {
            let t = [0; 3].map(|_| random_point(&mut rng) * DVec3::new(1.0, 1.0, 0.0) + DVec3::Z / 3.0);
            let q = closest_point(5.0 * random_point(&mut rng), t);
            assert_eq!(q.z, 1.0 / 3.0);
        }
    }

    #[test]
    fn barycentric_coordinates_give_the_foot_back() {
        let mut rng = stream(4, Stage::Distance);
        for _ in 0..100 {
            let [a, b, c] = [0; 3].map(|_| random_point(&mut rng));
            let foot = 0.7 * a + 0.5 * b - 0.2 * c;
            let p = foot + (b - a).cross(c - a);
            let found = barycentric(p, [a, b, c]);
            for (found, expected) in found.into_iter().zip([0.7, 0.5, -0.2]) {
                assert_relative_eq!(found, expected, epsilon = 1e-9);
            }
        }
        assert_eq!(barycentric(DVec3::X, [DVec3::ZERO, DVec3::ZERO, 4.0 * DVec3::X]), [0.0, 0.75, 0.25]);
        assert_eq!(barycentric(DVec3::X, [DVec3::ONE; 3]), [1.0, 0.0, 0.0]);
    }

    #[test]
    fn angles_area_and_sides_of_known_triangles() {
        let right = [DVec3::ZERO, 3.0 * DVec3::X, 4.0 * DVec3::Y];
        assert_eq!(area(right), 6.0);
        assert_eq!(side_lengths(right), [5.0, 4.0, 3.0]);
        let found = angles(right);
        assert_relative_eq!(found[0], 90.0, epsilon = 1e-12);
        assert_relative_eq!(found[1], (4f64 / 3.0).atan().to_degrees(), epsilon = 1e-12);
        assert_relative_eq!(found.iter().sum::<f64>(), 180.0, epsilon = 1e-12);
        assert_eq!(angles([DVec3::ZERO, DVec3::X, 2.0 * DVec3::X]), [0.0, 180.0, 0.0]);
        assert_eq!(smallest_angle(right), found[1].min(found[2]));
    }
}
