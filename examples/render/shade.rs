//! Colours: flat shading with two lights, darker in hollows, with lines along the edges. All sums are of linear light; only
//! the final pixels are converted to sRGB.

use crate::camera::{Panel, View};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use spectral_remesh::stages::picture::raster::{Hits, NOTHING};
use std::f64::consts::TAU;

const PAPER: DVec3 = DVec3::new(0.955, 0.96, 0.97);
const OUTSIDE: DVec3 = DVec3::new(0.42, 0.60, 0.80);
const INSIDE: DVec3 = DVec3::new(0.84, 0.50, 0.27);
const INK: DVec3 = DVec3::new(0.012, 0.02, 0.05);

/// Opacity of the lines on the surface.
const LINE_OPACITY: f64 = 0.80;

/// Lights in the camera's frame (right, up, towards the camera): direction and colour.
const LIGHTS: [(DVec3, DVec3); 2] = [
    (DVec3::new(-0.42, 0.66, 0.62), DVec3::new(0.98, 0.93, 0.85)),
    (DVec3::new(0.80, -0.10, 0.45), DVec3::new(0.20, 0.25, 0.34)),
];

/// Ambient light from below and from above.
const GROUND: DVec3 = DVec3::new(0.13, 0.12, 0.12);
const SKY: DVec3 = DVec3::new(0.30, 0.33, 0.38);

/// Radius in which hollows are detected, as a fraction of the picture's width; strength of their darkening; number of sample
/// pairs.
const HOLLOW_REACH: f64 = 0.06;
const HOLLOW_STRENGTH: f64 = 0.9;
const HOLLOW_PAIRS: usize = 40;

/// Returns the pixels of a panel, row by row from the top.
pub fn resolve(view: &View, hits: &Hits, panel: &Panel, samples: usize, line: f64) -> Vec<[u8; 3]> {
    let lit: Vec<DVec3> = (0..view.triangles.len()).map(|t| light(view, t)).collect();
    let half_line = 0.5 * line * samples as f64;
    let lines: Vec<f64> = (0..lit.len()).map(|t| line_opacity(view, t, half_line)).collect();
    let pixel = |n: usize| {
        let (x, y) = (n % panel.width, n / panel.width);
        let open = 1.0 - HOLLOW_STRENGTH * hollow(view, hits, x, y, samples);
        let mut sum = DVec3::ZERO;
        for at in (0..samples * samples).map(|s| DVec2::new((s % samples) as f64, (s / samples) as f64)) {
            let at = DVec2::new((x * samples) as f64, (y * samples) as f64) + at;
            let t = hits.triangle[at.y as usize * hits.width + at.x as usize];
            sum += if t == NOTHING {
                PAPER
            } else {
                let ink = if on_line(view, t as usize, at + 0.5, half_line) { lines[t as usize] } else { 0.0 };
                (lit[t as usize] * open).lerp(INK, ink)
            };
        }
        srgb(sum / (samples * samples) as f64)
    };
    (0..panel.width * panel.height).into_par_iter().map(pixel).collect()
}

/// Returns the light that triangle `t` sends to the camera; the inside of an open surface has its own colour.
fn light(view: &View, t: usize) -> DVec3 {
    let [a, b, c] = view.triangles[t].map(|v| view.places[v as usize]);
    // The picture's y axis points down, so counter-clockwise triangles in space are clockwise in the picture.
    let (n, colour) =
        if (b - a).perp_dot(c - a) > 0.0 { (-view.normals[t], INSIDE) } else { (view.normals[t], OUTSIDE) };
    let around = GROUND.lerp(SKY, 0.5 + 0.5 * n.y);
    let direct: DVec3 = LIGHTS.iter().map(|&(from, colour)| colour * n.dot(from.normalize()).max(0.0)).sum();
    colour * (around + direct)
}

/// Returns the opacity of a triangle's lines, which fade where it is too small in the picture to show more than lines.
fn line_opacity(view: &View, t: usize, half_line: f64) -> f64 {
    if half_line <= 0.0 {
        return 0.0;
    }
    let [a, b, c] = view.triangles[t].map(|v| view.places[v as usize]);
    let perimeter = a.distance(b) + b.distance(c) + c.distance(a);
    let in_radius = (b - a).perp_dot(c - a).abs() / perimeter.max(1e-9);
    LINE_OPACITY * (in_radius / (3.0 * half_line)).clamp(0.35, 1.0)
}

/// Returns whether a sample of triangle `t` is within half a line width of one of its edges.
fn on_line(view: &View, t: usize, p: DVec2, half_line: f64) -> bool {
    let [a, b, c] = view.triangles[t].map(|v| view.places[v as usize]);
    let off = |from: DVec2, to: DVec2| (to - from).perp_dot(p - from).abs() <= half_line * (to - from).length();
    off(a, b) || off(b, c) || off(c, a)
}

/// Returns how deep a pixel lies in a hollow, from 0 to 1: how much nearer its surroundings are to the camera, averaged over
/// pairs of opposite positions, so that a mere slope does not count.
fn hollow(view: &View, hits: &Hits, x: usize, y: usize, samples: usize) -> f64 {
    let height = hits.nearness.len() / hits.width;
    let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * samples as f64;
    let distance = |p: DVec2| {
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < hits.width as f64 && p.y < height as f64;
        let near = if inside { hits.nearness[p.y as usize * hits.width + p.x as usize] } else { 0.0 };
        (near > 0.0).then(|| 1.0 / f64::from(near))
    };
    let Some(here) = distance(middle) else { return 0.0 };
    let reach = HOLLOW_REACH * hits.width as f64;
    let pair = |k: usize| {
        let share = ((k as f64 + 0.5) / HOLLOW_PAIRS as f64).sqrt();
        let offset = DVec2::from_angle(k as f64 * 0.381_966 * TAU) * (share * reach);
        let (Some(one), Some(other)) = (distance(middle + offset), distance(middle - offset)) else { return 0.0 };
        let rise = here - 0.5 * (one + other);
        let run = share * reach / samples as f64 * view.pixel;
        // Something far in front is another part of the surface and contributes little shade.
        let slope = rise / run;
        if slope > 2.5 { 2.5 / slope } else { slope.clamp(0.0, 1.0) }
    };
    (0..HOLLOW_PAIRS).map(pair).sum::<f64>() / HOLLOW_PAIRS as f64
}

/// Converts linear light to sRGB bytes.
fn srgb(light: DVec3) -> [u8; 3] {
    let encode = |x: f64| if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    light.to_array().map(|x| (255.0 * encode(x.clamp(0.0, 1.0))).round() as u8)
}
