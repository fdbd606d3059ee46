//! Turns stars into triangles: those in the stars of all three of their corners.
//!
//! Such triangles fit together automatically. In the star of a vertex, every directed edge has one triangle. So no edge gets
//! a third face, and the triangles taken at a vertex are part of one fan.

use rayon::slice::ParallelSliceMut;
use std::collections::HashSet;

/// Returns the triangles that occur three times in `stars`, once from each corner, sorted by their corners, the lowest one
/// first.
pub fn agreed(stars: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let stars = sorted(stars);
    with_votes(&stars, 3).collect()
}

/// Returns the triangles in the stars of all three corners and, among those with two votes and then those with one, the ones
/// that fit between them: all their directed edges are free, and their `rank` is at most `highest`. Of two triangles that do
/// not fit together, the one of lower rank is taken, then the first in the order of corners. `stars` are sorted by their
/// centres, which come first in each triangle.
///
/// If four points are cocircular, as on a slightly curved lattice, each of them may see the diagonal that does not end at
/// it. Each of the four triangles then has one vote, and counts. No other triangle with one vote does.
pub fn agreed_by_most(stars: &[[u32; 3]], highest: f64, rank: impl Fn([u32; 3]) -> f64) -> Vec<[u32; 3]> {
    let by_corners = sorted(stars);
    let mut triangles: Vec<[u32; 3]> = with_votes(&by_corners, 3).collect();
    let ranked = |t| Some((rank(t), t)).filter(|d| d.0 <= highest);
    let in_order = |mut doubtful: Vec<(f64, [u32; 3])>| {
        doubtful.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        doubtful
    };
    let mut doubtful = in_order(with_votes(&by_corners, 2).filter_map(ranked).collect());
    let alone = with_votes(&by_corners, 1).filter(|t| is_of_four(stars, *t));
    doubtful.extend(in_order(alone.filter_map(ranked).collect()));
    let edges = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let near: HashSet<u32> = doubtful.iter().flat_map(|d| d.1).collect();
    let mut taken: HashSet<[u32; 2]> =
        triangles.iter().copied().flat_map(edges).filter(|e| near.contains(&e[0]) && near.contains(&e[1])).collect();
    for (_, t) in doubtful {
        if edges(t).iter().all(|e| !taken.contains(e)) {
            taken.extend(edges(t));
            triangles.push(t);
        }
    }
    triangles
}

/// Returns whether `triangle` and a fourth point form a quad whose corners each see the diagonal that does not end there.
fn is_of_four(stars: &[[u32; 3]], triangle: [u32; 3]) -> bool {
    let star = |p: u32| {
        let begin = stars.partition_point(|t| t[0] < p);
        stars[begin..].iter().take_while(move |t| t[0] == p)
    };
    let says = |t: [u32; 3]| star(t[0]).any(|s| *s == t);
    let [a, b, c] = triangle;
    let Some([p, q, r]) = [[a, b, c], [b, c, a], [c, a, b]].into_iter().find(|t| says(*t)) else { return false };
    let mut across = star(q).filter(|t| t[2] == p).map(|t| t[1]);
    across.any(|s| says([s, r, q]) && says([r, p, s]))
}

/// Returns all triangles, sorted by their corners, the lowest one first.
fn sorted(stars: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut stars = stars.to_vec();
    for t in &mut stars {
        let lowest = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        t.rotate_left(lowest);
    }
    stars.par_sort_unstable();
    stars
}

/// Returns the triangles that occur exactly `votes` times.
fn with_votes(sorted: &[[u32; 3]], votes: usize) -> impl Iterator<Item = [u32; 3]> {
    sorted.chunk_by(|a, b| a == b).filter(move |same| same.len() == votes).map(|same| same[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_all_three_corners_say_is_taken() {
        let stars = vec![[1, 2, 3], [2, 3, 1], [3, 1, 2], [1, 3, 4], [3, 4, 1], [4, 3, 1]];
        assert_eq!(agreed(&stars), vec![[1, 2, 3]]);
    }

    #[test]
    fn what_two_corners_say_is_taken_where_it_fits() {
        let two = |t: [u32; 3]| [t, [t[1], t[2], t[0]]];
        let mut stars =
            [&[[1, 2, 3], [2, 3, 1], [3, 1, 2]][..], &two([2, 1, 4]), &two([1, 2, 5]), &two([2, 1, 6])].concat();
        stars.sort();
        let triangles = agreed_by_most(&stars, 5.0, |t| f64::from(t[2]));
        assert_eq!(triangles, vec![[1, 2, 3], [1, 4, 2]]);
    }

    #[test]
    fn of_four_points_that_each_see_the_other_diagonal_two_triangles_are_taken() {
        let stars = [[0, 1, 3], [1, 2, 0], [2, 3, 1], [3, 0, 2]];
        assert_eq!(agreed_by_most(&stars, 1.0, |_| 1.0), vec![[0, 1, 2], [0, 2, 3]]);
        assert!(agreed_by_most(&stars[..3], 1.0, |_| 1.0).is_empty(), "point 3 sees none of the others");
    }
}
