//! The common segment of two crossing triangles, and the derivative of its length with respect to their corners.
//!
//! Each end of the segment is either a shared corner or the point where a side of one triangle meets the other triangle. If
//! the point of the side and the point of the triangle move apart by `d`, the end slides along the side until it is back in
//! the plane: relative to the triangle, it moves by d − (n·d)/(n·e) e, for the normal n and the direction e of the side.
//!
//! P. Volino, N. Magnenat-Thalmann, Resolving surface collisions through intersection contour minimization, 2006, DOI
//! 10.1145/1141911.1142007, use this to separate surfaces that have passed through each other. Departure: the derivative
//! here is that of the segment between two triangles, with respect to each of their corners.

use crate::geom::triangle::barycentric;
use glam::DVec3;

type Triangle = [DVec3; 3];

/// The common segment of two triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossingSegment {
    /// Its length.
    pub length: f64,
    /// The gradient of the length with respect to the position of each corner, first for the first triangle, then for the
    /// second.
    pub gradient: [[DVec3; 3]; 2],
}

/// An end of the segment: its position and its barycentric coordinates in both triangles. `along` holds the direction of the
/// side and the normal of the triangle that meet there; `None` at a shared corner.
struct End {
    place: DVec3,
    weights: [[f64; 3]; 2],
    along: Option<Along>,
}

struct Along {
    /// Which of the two triangles the side belongs to.
    of: usize,
    side: DVec3,
    normal: DVec3,
}

/// Returns the common segment of two crossing triangles; `None` if it has no length, as for coplanar triangles.
pub fn crossing_segment(a: Triangle, b: Triangle) -> Option<CrossingSegment> {
    let triangles = [a, b];
    let shared = (0..9).map(|i| (i / 3, i % 3)).find(|&(i, j)| a[i] == b[j]);
    let at_corner = shared.map(|(i, j)| End { place: a[i], weights: [unit(i), unit(j)], along: None });
    let pierced = [0, 1].into_iter().flat_map(|of| (0..3).filter_map(move |k| pierced(triangles, of, k)));
    let mut ends = at_corner.into_iter().chain(pierced);
    let (from, to) = (ends.next()?, ends.next()?);
    let way = to.place - from.place;
    let length = way.length();
    let direction = way.try_normalize()?;
    let [at_from, at_to] = [from.gradient(-direction), to.gradient(direction)];
    let gradient = [0, 1].map(|t| [0, 1, 2].map(|k| at_from[t][k] + at_to[t][k]));
    Some(CrossingSegment { length, gradient })
}

/// The barycentric coordinates of corner `i`.
fn unit(i: usize) -> [f64; 3] {
    [0, 1, 2].map(|k| if k == i { 1.0 } else { 0.0 })
}

/// Returns where side `k` of triangle `of` passes through the other triangle; `None` also if the triangles share a corner of
/// that side.
fn pierced(triangles: [Triangle; 2], of: usize, k: usize) -> Option<End> {
    let (own, other) = (triangles[of], triangles[1 - of]);
    let (p, q) = (own[k], own[(k + 1) % 3]);
    if other.contains(&p) || other.contains(&q) {
        return None;
    }
    let normal = (other[1] - other[0]).cross(other[2] - other[0]).try_normalize()?;
    let [above, below] = [p, q].map(|r| (r - other[0]).dot(normal));
    if above * below >= 0.0 {
        return None;
    }
    let share = above / (above - below);
    let place = p.lerp(q, share);
    let of_other = barycentric(place, other);
    if of_other.iter().any(|&w| w < 0.0) {
        return None;
    }
    let mut of_own = [0.0; 3];
    (of_own[k], of_own[(k + 1) % 3]) = (1.0 - share, share);
    let weights = if of == 0 { [of_own, of_other] } else { [of_other, of_own] };
    Some(End { place, weights, along: Some(Along { of, side: (q - p).normalize(), normal }) })
}

impl End {
    /// Returns the gradient of this end's movement in `direction`, with respect to the position of each corner.
    fn gradient(&self, direction: DVec3) -> [[DVec3; 3]; 2] {
        let Some(Along { of, side, normal }) = self.along else {
            return [self.weights[0].map(|w| w * direction), [DVec3::ZERO; 3]];
        };
        let of_side = direction - side.dot(direction) / side.dot(normal) * normal;
        let ways = if of == 0 { [of_side, direction - of_side] } else { [direction - of_side, of_side] };
        [0, 1].map(|t| self.weights[t].map(|w| w * ways[t]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};
    use crate::testing::random_point;
    use approx::assert_relative_eq;

    #[test]
    fn the_gradient_is_that_of_the_length() {
        let mut rng = stream(5, Stage::Distance);
        let mut found = 0;
        for i in 0..400 {
            let mut triangle = || [0; 3].map(|_| random_point(&mut rng));
            let (a, mut b) = (triangle(), triangle());
            if i % 2 == 0 {
                b[1] = a[2];
            }
            let Some(segment) = crossing_segment(a, b) else { continue };
            // If a side almost touches a corner, the next side may take over within this step.
            let step = 1e-6;
            for (corner, axis) in (0..18).map(|i| (i / 3, DVec3::AXES[i % 3])) {
                let shared = i % 2 == 0 && (corner == 2 || corner == 4);
                let moved = |way: f64| {
                    let (mut a, mut b) = (a, b);
                    if corner < 3 || shared {
                        a[if shared { 2 } else { corner }] += way * axis;
                    }
                    if corner >= 3 || shared {
                        b[if shared { 1 } else { corner - 3 }] += way * axis;
                    }
                    crossing_segment(a, b).map(|s| s.length)
                };
                let (Some(more), Some(less)) = (moved(step), moved(-step)) else { continue };
                let [of_a, of_b] = segment.gradient;
                let gradient = match (shared, corner) {
                    (true, _) => of_a[2] + of_b[1],
                    (_, 0..3) => of_a[corner],
                    _ => of_b[corner - 3],
                };
                assert_relative_eq!(
                    (more - less) / (2.0 * step),
                    gradient.dot(axis),
                    epsilon = 1e-2,
                    max_relative = 1e-2
                );
            }
            found += 1;
        }
        assert!(found > 40, "{found}");
    }

    #[test]
    fn what_only_touches_or_is_apart_has_no_segment() {
        let base = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let up = |z: f64| base.map(|p| p + z * DVec3::Z);
        assert_eq!(crossing_segment(base, up(1.0)), None);
        assert_eq!(crossing_segment(base, up(0.0).map(|p| 0.5 * p)), None);
        assert_eq!(crossing_segment(base, [DVec3::X, DVec3::ZERO, DVec3::Z]), None);
    }
}
