//! An angle bracket as a CAD program would export it, with sharp edges, a fillet and two through holes. Its triangles are as
//! large, long and thin as flat and singly curved faces allow.

use super::build::Builder;
use glam::{DVec2, DVec3};
use spectral_remesh::Mesh;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Thickness and width of the plates and radius of the fillet, in millimetres.
const THICKNESS: f64 = 6.0;
const WIDTH: f64 = 40.0;
const FILLET: f64 = 8.0;
const FILLET_STEPS: usize = 8;

/// One of the two plates. It starts at the corner of the bracket and ends in a semicircle around its hole.
struct Plate {
    /// Distance from the corner to the centre of the hole, in millimetres.
    reach: f64,
    hole_radius: f64,
    /// Numbers of segments of the semicircle at the end and of the hole.
    end_steps: usize,
    hole_steps: usize,
    /// Maps coordinates along the plate, across it, and upwards from its outer face to space.
    place: fn(f64, f64, f64) -> DVec3,
}

/// The horizontal plate, finely tessellated.
const BASE: Plate =
    Plate { reach: 48.0, hole_radius: 11.0, end_steps: 40, hole_steps: 64, place: |u, v, w| DVec3::new(u, v, w) };

/// The upright plate, coarsely tessellated.
const UPRIGHT: Plate =
    Plate { reach: 62.0, hole_radius: 7.0, end_steps: 10, hole_steps: 14, place: |u, v, w| DVec3::new(w, v, u) };

/// The model.
pub fn bracket() -> Mesh {
    let mut b = Builder::default();
    for plate in [BASE, UPRIGHT] {
        faces(&mut b, &plate);
        end(&mut b, &plate);
        hole(&mut b, &plate);
    }
    fillet(&mut b);
    flanks(&mut b);
    b.mesh
}

/// The outer and the inner face of a plate, each with its hole.
fn faces(b: &mut Builder, plate: &Plate) {
    let outward = (plate.place)(0.0, 0.0, 1.0);
    for (start, height, normal) in [(0.0, 0.0, -outward), (THICKNESS + FILLET, THICKNESS, outward)] {
        let mut outline = end_arc(plate);
        outline.extend([DVec2::new(start, WIDTH), DVec2::new(start, 0.0)]);
        for triangle in ring(&outline, &rim(plate), middle(plate)) {
            b.triangle(triangle.map(|p| (plate.place)(p.x, p.y, height)), normal);
        }
    }
}

/// The round wall at the end of a plate.
fn end(b: &mut Builder, plate: &Plate) {
    wall(b, plate, &end_arc(plate), 1.0);
}

/// The wall of a plate's hole.
fn hole(b: &mut Builder, plate: &Plate) {
    let mut rim = rim(plate);
    rim.push(rim[0]);
    wall(b, plate, &rim, -1.0);
}

/// The wall along a curve around the centre of a hole; it faces away from the centre (`side` 1) or towards it (-1).
fn wall(b: &mut Builder, plate: &Plate, curve: &[DVec2], side: f64) {
    for w in curve.windows(2) {
        let at = |p: DVec2, height| (plate.place)(p.x, p.y, height);
        let away = (w[0] + w[1]) * 0.5 - middle(plate);
        let corners = [at(w[0], 0.0), at(w[1], 0.0), at(w[1], THICKNESS), at(w[0], THICKNESS)];
        b.quad(corners, at(away * side, 0.0));
    }
}

/// The concave quarter cylinder between the plates.
fn fillet(b: &mut Builder) {
    let across = DVec3::Y * WIDTH;
    for w in fillet_arc().windows(2) {
        b.quad([w[0], w[1], w[1] + across, w[0] + across], DVec3::new(1.0, 0.0, 1.0));
    }
}

/// The two flat L-shaped sides, as triangle fans around the outer corner.
fn flanks(b: &mut Builder) {
    let mut outline = vec![DVec3::new(BASE.reach, 0.0, 0.0), DVec3::new(BASE.reach, 0.0, THICKNESS)];
    outline.extend(fillet_arc());
    outline.extend([DVec3::new(THICKNESS, 0.0, UPRIGHT.reach), DVec3::new(0.0, 0.0, UPRIGHT.reach)]);
    for w in outline.windows(2) {
        b.triangle([DVec3::ZERO, w[0], w[1]], -DVec3::Y);
        let across = DVec3::Y * WIDTH;
        b.triangle([across, w[0] + across, w[1] + across], DVec3::Y);
    }
}

/// The common centre of a plate's hole and of its round end.
fn middle(plate: &Plate) -> DVec2 {
    DVec2::new(plate.reach, 0.5 * WIDTH)
}

/// The semicircle at the end of a plate, from one flank to the other.
fn end_arc(plate: &Plate) -> Vec<DVec2> {
    let angle = |k| PI * k as f64 / plate.end_steps as f64 - FRAC_PI_2;
    (0..=plate.end_steps).map(|k| middle(plate) + 0.5 * WIDTH * DVec2::from_angle(angle(k))).collect()
}

/// The circle of a plate's hole.
fn rim(plate: &Plate) -> Vec<DVec2> {
    let angle = |k| TAU * k as f64 / plate.hole_steps as f64 - FRAC_PI_2;
    (0..plate.hole_steps).map(|k| middle(plate) + plate.hole_radius * DVec2::from_angle(angle(k))).collect()
}

/// The fillet on the flank at y = 0, from the base to the upright.
fn fillet_arc() -> Vec<DVec3> {
    let centre = DVec3::new(THICKNESS + FILLET, 0.0, THICKNESS + FILLET);
    let at = |angle: f64| centre - FILLET * DVec3::new(angle.sin(), 0.0, angle.cos());
    (0..=FILLET_STEPS).map(|k| at(FRAC_PI_2 * k as f64 / FILLET_STEPS as f64)).collect()
}

/// Triangulates between two closed curves that run counter-clockwise around `centre`, start in about the same direction, and
/// are completely visible from it. Each step advances on the curve whose next segment comes first.
fn ring(outer: &[DVec2], inner: &[DVec2], centre: DVec2) -> Vec<[DVec2; 3]> {
    let start = (outer[0] - centre).to_angle();
    let mean_angle = |curve: &[DVec2], k: usize| {
        let turn = |k: usize| {
            let angle = (curve[k % curve.len()] - centre).to_angle() - start;
            (angle + 1e-6).rem_euclid(TAU) + TAU * (k / curve.len()) as f64
        };
        0.5 * (turn(k) + turn(k + 1))
    };
    let (mut i, mut j) = (0, 0);
    let mut triangles = Vec::new();
    while i < outer.len() || j < inner.len() {
        let (o, n) = (outer[i % outer.len()], inner[j % inner.len()]);
        let outer_goes = j == inner.len() || i < outer.len() && mean_angle(outer, i) <= mean_angle(inner, j) - 1e-6;
        if outer_goes {
            i += 1;
            triangles.push([o, outer[i % outer.len()], n]);
        } else {
            j += 1;
            triangles.push([o, inner[j % inner.len()], n]);
        }
    }
    triangles
}
