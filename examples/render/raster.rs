//! Which triangle is in front at each sample of the picture.

use crate::camera::View;
use glam::DVec2;

/// No triangle at a sample.
pub const NOTHING: u32 = u32::MAX;

/// What is in front at each sample, row by row from the top.
pub struct Hits {
    pub width: usize,
    /// The triangle, or [`NOTHING`].
    pub triangle: Vec<u32>,
    /// One over the distance to it, 0 where there is nothing.
    pub nearness: Vec<f32>,
}

/// Draws all triangles of `view` on `width` times `height` samples.
pub fn draw(view: &View, width: usize, height: usize) -> Hits {
    let mut hits = Hits { width, triangle: vec![NOTHING; width * height], nearness: vec![0.0; width * height] };
    for t in 0..view.triangles.len() {
        draw_triangle(view, t, height, &mut hits);
    }
    hits
}

fn draw_triangle(view: &View, t: usize, height: usize, hits: &mut Hits) {
    let corners = view.triangles[t].map(|v| view.places[v as usize]);
    let nearness = view.triangles[t].map(|v| view.nearness[v as usize]);
    let [a, b, c] = corners;
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
