//! Rasterises triangles: determines which triangle is in front at each sample of a picture.
//!
//! Cost: linear in the triangles and in the samples that they cover.

use glam::DVec2;

/// No triangle at a sample.
pub const NOTHING: u32 = u32::MAX;

/// The visible triangle at each sample, row by row from the top.
pub struct Hits {
    /// Number of samples per row.
    pub width: usize,
    /// The triangle, or [`NOTHING`].
    pub triangle: Vec<u32>,
    /// The reciprocal of the distance to it; 0 where there is no triangle.
    pub nearness: Vec<f32>,
}

/// Triangles projected by a camera.
#[derive(Clone, Copy)]
pub struct Projected<'a> {
    /// The corners of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// The position of each vertex in the picture, in samples: x to the right, y down.
    pub places: &'a [DVec2],
    /// The reciprocal of the distance to each vertex along the line of sight, which is linear over a triangle in the
    /// picture.
    pub nearness: &'a [f64],
}

/// Draws all triangles on `width` × `height` samples.
pub fn draw(seen: Projected, width: usize, height: usize) -> Hits {
    let mut hits = Hits { width, triangle: vec![NOTHING; width * height], nearness: vec![0.0; width * height] };
    for t in 0..seen.triangles.len() {
        draw_triangle(seen, t, height, &mut hits);
    }
    hits
}

fn draw_triangle(seen: Projected, t: usize, height: usize, hits: &mut Hits) {
    let nearness = seen.triangles[t].map(|v| seen.nearness[v as usize]);
    let [a, b, c] = seen.triangles[t].map(|v| seen.places[v as usize]);
    let area = (b - a).perp_dot(c - a);
    if area == 0.0 {
        return;
    }
    let low = a.min(b).min(c).max(DVec2::ZERO);
    let high = a.max(b).max(c).min(DVec2::new(hits.width as f64, height as f64) - 1.0);
    if low.x > high.x || low.y > high.y {
        return;
    }
    for y in low.y as usize..=high.y as usize {
        for x in low.x as usize..=high.x as usize {
            let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let share = [(b, c), (c, a), (a, b)].map(|(from, to)| (to - from).perp_dot(p - from) / area);
            if share.iter().any(|&s| s < 0.0) {
                continue;
            }
            let near = (0..3).map(|k| share[k] * nearness[k]).sum::<f64>() as f32;
            let at = y * hits.width + x;
            if near > hits.nearness[at] {
                hits.nearness[at] = near;
                hits.triangle[at] = t as u32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_nearer_hides_what_is_behind() {
        let places = [[0.0, 0.0], [8.0, 0.0], [0.0, 8.0], [0.0, 0.0], [4.0, 0.0], [0.0, 4.0]].map(DVec2::from);
        let nearness = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
        let triangles = [[3, 4, 5], [0, 1, 2]];
        let hits = draw(Projected { triangles: &triangles, places: &places, nearness: &nearness }, 8, 8);
        assert_eq!([hits.triangle[0], hits.triangle[5], hits.triangle[63]], [0, 1, NOTHING]);
        assert_eq!([hits.nearness[0], hits.nearness[5], hits.nearness[63]], [2.0, 1.0, 0.0]);
        assert_eq!(hits.triangle.iter().filter(|t| **t != NOTHING).count(), 36);
    }
}
