//! From stars to triangles: what the stars of all three corners contain is taken.
//!
//! Such triangles fit together by themselves. In the star of a vertex every directed edge has one triangle, so no edge
//! gets a third face, and what is taken at a vertex is part of one fan.

use rayon::slice::ParallelSliceMut;

/// The triangles that occur three times in `stars`, once from each corner, in increasing order of corners; the corner
/// of the lowest number first.
pub fn agreed(stars: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut stars = stars.to_vec();
    for t in &mut stars {
        let lowest = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        t.rotate_left(lowest);
    }
    stars.par_sort_unstable();
    stars.chunk_by(|a, b| a == b).filter(|same| same.len() == 3).map(|same| same[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_all_three_corners_say_is_taken() {
        let stars = vec![[1, 2, 3], [2, 3, 1], [3, 1, 2], [1, 3, 4], [3, 4, 1], [4, 3, 1]];
        assert_eq!(agreed(&stars), vec![[1, 2, 3]]);
    }
}
