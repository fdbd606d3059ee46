//! Pictures of meshes that are too large for the viewer, in its initial view, one per colouring.
//!
//! Cost: linear in the triangles and the pixels.

use crate::base::parallel;
use crate::geom::triangle::area;
use crate::io::base64;
use crate::picture::png;
use crate::picture::raster::{Hits, NOTHING, Projected, draw};
use crate::report::page::camera::{EYE, FirstView, HEIGHT, WIDTH};
use crate::report::page::colours::{Colouring, KEPT, LEFT_OUT, MARKED, UNKNOWN, VALENCES, on_ramp, rgb, valence_class};
use crate::report::page::shown::Shown;
use glam::{DVec2, DVec3};

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;

/// Half the width of lines along sharp edges, in samples.
const HALF_LINE: i64 = 2;

/// Factor by which these lines are nearer than the surface.
const LIFT: f64 = 1.004;

/// Lights like those of the viewer, each with its direction and brightness; and the ambient light.
const LIGHTS: [(DVec3, f64); 2] = [(DVec3::new(-0.4, 0.6, 0.7), 0.32), (DVec3::new(0.8, -0.2, 0.5), 0.12)];
const AROUND: f64 = 0.70;

/// Colour of the inside of a surface: dull and dark.
const INSIDE: DVec3 = DVec3::new(0.32, 0.3, 0.36);

/// A mesh as seen in the initial view.
pub(super) struct Snapshot<'a> {
    shown: &'a Shown<'a>,
    places: Vec<DVec2>,
    hits: Hits,
    /// The light on each triangle, and whether its inside is visible.
    light: Vec<(f64, bool)>,
    marked: Vec<bool>,
    /// The colour of the line at each sample, if there is one.
    lines: Vec<Option<DVec3>>,
}

impl<'a> Snapshot<'a> {
    /// Renders `shown` in the initial view.
    pub(super) fn new(shown: &'a Shown<'a>, view: &FirstView) -> Snapshot<'a> {
        let mesh = shown.mesh;
        let points: Vec<DVec3> = mesh.positions.iter().map(|&p| view.seen(p)).collect();
        let (places, nearness): (Vec<DVec2>, Vec<f64>) = points.iter().map(|&p| place(p, view)).unzip();
        let projected = Projected { triangles: &mesh.triangles, places: &places, nearness: &nearness };
        let hits = draw(projected, SAMPLES * WIDTH, SAMPLES * HEIGHT);
        let mut marked = vec![false; mesh.triangles.len()];
        shown.marked.iter().for_each(|&t| marked[t as usize] = true);
        let light = mesh.triangles.iter().map(|corners| light(corners.map(|v| points[v as usize]))).collect();
        let mut lines = vec![None; hits.triangle.len()];
        for (edges, colour) in [(&shown.sharp, KEPT), (&shown.left_out, LEFT_OUT)] {
            for ends in edges {
                draw_line(ends.map(|p| place(view.seen(p), view)), rgb(colour), &hits, &mut lines);
            }
        }
        Snapshot { shown, places, hits, light, marked, lines }
    }

    /// Returns the data URL of a picture with this colouring; `farthest` is the distance at the end of the ramp.
    pub(super) fn address(&self, colouring: Colouring, farthest: f64) -> String {
        let pixel = |i: usize| self.pixel(i % WIDTH, i / WIDTH, colouring, farthest);
        let pixels: Vec<[u8; 4]> = parallel::map(0..WIDTH * HEIGHT, pixel);
        format!("data:image/png;base64,{}", base64::encode(&png::encode(&pixels, WIDTH)))
    }

    /// Returns the mean colour of the samples that hit something; their fraction is the opacity.
    fn pixel(&self, x: usize, y: usize, colouring: Colouring, farthest: f64) -> [u8; 4] {
        let mut sum = DVec3::ZERO;
        let mut count = 0;
        for (i, j) in (0..SAMPLES * SAMPLES).map(|k| (k % SAMPLES, k / SAMPLES)) {
            let (x, y) = (SAMPLES * x + i, SAMPLES * y + j);
            if let Some(colour) = self.sample(x, y, colouring, farthest) {
                sum += colour;
                count += 1;
            }
        }
        let [r, g, b] = (sum / f64::from(count.max(1))).to_array().map(|c| (255.0 * c.min(1.0)).round() as u8);
        [r, g, b, (255 * count as usize / (SAMPLES * SAMPLES)) as u8]
    }

    fn sample(&self, x: usize, y: usize, colouring: Colouring, farthest: f64) -> Option<DVec3> {
        let at = y * self.hits.width + x;
        if self.lines[at].is_some() {
            return self.lines[at];
        }
        let t = Some(self.hits.triangle[at]).filter(|t| *t != NOTHING)? as usize;
        let (light, is_inside) = self.light[t];
        let outside = if self.marked[t] {
            rgb(MARKED)
        } else {
            self.colour(t, DVec2::new(x as f64, y as f64) + 0.5, colouring, farthest)
        };
        Some(light * if is_inside { outside.lerp(INSIDE, 0.7) } else { outside })
    }

    fn colour(&self, t: usize, at: DVec2, colouring: Colouring, farthest: f64) -> DVec3 {
        let Shown { mesh, angles, qualities, valences, distances, .. } = self.shown;
        let corners = mesh.triangles[t].map(|v| v as usize);
        match colouring {
            Colouring::Angle => on_ramp(1.0 - angles[t] / 60.0),
            Colouring::Quality => on_ramp(1.0 - qualities[t]),
            Colouring::Valence => {
                let away = |v: &usize| self.places[*v].distance_squared(at);
                let nearest = corners.into_iter().min_by(|v, w| away(v).total_cmp(&away(w)));
                rgb(VALENCES[usize::from(valence_class(nearest.and_then(|v| valences[v])))].1)
            }
            Colouring::Distance => match distances {
                Some(distances) => on_ramp(corners.map(|v| distances[v]).iter().sum::<f64>() / (3.0 * farthest)),
                None => rgb(UNKNOWN),
            },
        }
    }
}

/// Returns the position of a point in the picture, in samples, and the reciprocal of its distance to the eye.
fn place(p: DVec3, view: &FirstView) -> (DVec2, f64) {
    let nearness = 1.0 / (EYE - p.z);
    let half = 0.5 * (SAMPLES * HEIGHT) as f64;
    let on_plane = p.truncate() * (view.zoom * EYE * nearness) * half;
    let middle = 0.5 * SAMPLES as f64 * DVec2::new(WIDTH as f64, HEIGHT as f64);
    (middle + DVec2::new(on_plane.x, -on_plane.y), nearness)
}

/// Returns the light on a triangle, given the positions of its corners in the view, and whether its inside is visible.
fn light(corners: [DVec3; 3]) -> (f64, bool) {
    let [a, b, c] = corners;
    let to_eye = DVec3::new(0.0, 0.0, EYE) - a;
    let normal = if area(corners) > 0.0 { (b - a).cross(c - a).normalize() } else { DVec3::Z };
    let is_inside = normal.dot(to_eye) < 0.0;
    let normal = if is_inside { -normal } else { normal };
    let direct: f64 = LIGHTS.iter().map(|(from, bright)| bright * normal.dot(from.normalize()).max(0.0)).sum();
    (AROUND + direct, is_inside)
}

/// Draws a line where it is not hidden by the surface.
fn draw_line(ends: [(DVec2, f64); 2], colour: DVec3, hits: &Hits, lines: &mut [Option<DVec3>]) {
    let [(a, near_a), (b, near_b)] = ends;
    let height = hits.triangle.len() / hits.width;
    let steps = a.distance(b).ceil().clamp(1.0, 1e4) as usize;
    for k in 0..=steps {
        let share = k as f64 / steps as f64;
        let (p, nearness) = (a.lerp(b, share), near_a + share * (near_b - near_a));
        for (i, j) in (-HALF_LINE..=HALF_LINE).flat_map(|i| (-HALF_LINE..=HALF_LINE).map(move |j| (i, j))) {
            let (x, y) = (p.x as i64 + i, p.y as i64 + j);
            let is_round = i * i + j * j <= HALF_LINE * HALF_LINE;
            if !is_round || x < 0 || y < 0 || x as usize >= hits.width || y as usize >= height {
                continue;
            }
            let at = y as usize * hits.width + x as usize;
            if LIFT * nearness > f64::from(hits.nearness[at]) {
                lines[at] = Some(colour);
            }
        }
    }
}
