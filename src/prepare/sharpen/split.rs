//! Splits triangles at points on their sides.

use glam::DVec3;

/// Splits a triangle at points on one or two of its sides: `at[k]` is on the side from corner `k` to the next one. Of the two
/// ways to split what two points leave, the one with the shorter edge is chosen.
pub(super) fn split(corners: [u32; 3], at: [Option<u32>; 3], positions: &[DVec3], into: &mut Vec<[u32; 3]>) {
    let length = |v: u32, w: u32| positions[v as usize].distance_squared(positions[w as usize]);
    let turned = |k: usize| ([0, 1, 2].map(|i| corners[(k + i) % 3]), [0, 1, 2].map(|i| at[(k + i) % 3]));
    for ([a, b, c], at) in (0..3).map(turned) {
        match at {
            [Some(p), None, None] => return into.extend([[a, p, c], [p, b, c]]),
            [None, Some(q), Some(r)] => {
                let rest = if length(a, q) < length(b, r) { [[a, b, q], [a, q, r]] } else { [[a, b, r], [b, q, r]] };
                return into.extend([[q, c, r], rest[0], rest[1]]);
            }
            _ => {}
        }
    }
    into.push(corners);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_split_at_the_points_on_its_sides() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X / 2.0, DVec3::new(0.5, 0.5, 0.0), DVec3::Y / 4.0];
        let area = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|v| positions[v as usize]);
            0.5 * (b - a).cross(c - a).z
        };
        for (at, count) in [
            ([None, None, None], 1),
            ([Some(3), None, None], 2),
            ([None, Some(4), None], 2),
            ([Some(3), Some(4), None], 3),
            ([Some(3), None, Some(5)], 3),
            ([None, Some(4), Some(5)], 3),
        ] {
            let mut found = Vec::new();
            split([0, 1, 2], at, &positions, &mut found);
            assert_eq!(found.len(), count);
            assert!(found.iter().map(area).all(|area| area > 0.0), "{found:?}");
            assert!((found.iter().map(area).sum::<f64>() - 0.5).abs() < 1e-12, "{found:?}");
        }
    }
}
