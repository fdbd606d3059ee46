//! The meshes of a page in the format of its viewer: JSON with byte arrays as base64.
//!
//! Positions have 16 bits per coordinate, relative to the common box of all meshes, so that coincident points still
//! coincide. Figures are one byte each: 0 for good and 255 for bad, or the class of a valence.
//!
//! Limits: a position is off by at most 1/131,070 of the box.

use crate::io::base64;
use crate::mesh::triangle_mesh::Mesh;
use crate::report::page::camera::FirstView;
use crate::report::page::colours::{KEPT, LEFT_OUT, MARKED, RAMP, UNKNOWN, VALENCES, valence_class};
use crate::report::page::places::Place;
use crate::report::page::shown::Shown;
use glam::DVec3;
use serde::Serialize;

/// All data that the viewer needs.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Scene {
    /// The extent of the box in units of half its diagonal, along each axis.
    extent: [f64; 3],
    /// The initial view: magnification, target, and a rotation whose rows are right, up and towards the eye.
    zoom: f64,
    target: [f64; 3],
    rotation: [[f64; 3]; 3],
    /// Colours of figures, and of other things that are drawn.
    ramp: Vec<&'static str>,
    valences: Vec<&'static str>,
    kept: &'static str,
    left_out: &'static str,
    marked: &'static str,
    unknown: &'static str,
    meshes: Vec<Part>,
    places: Vec<View>,
}

/// A mesh; numbers are little-endian, in base64.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Part {
    vertices: usize,
    triangles: usize,
    /// Three `u16` per vertex.
    positions: String,
    /// Three corners per triangle: `u16`, or `u32` if there are more than 65,536 vertices.
    corners: String,
    /// One byte per triangle.
    angle: String,
    quality: String,
    /// One byte per vertex.
    valence: String,
    distance: Option<String>,
    /// Two positions per edge.
    sharp: String,
    left_out: String,
    /// Triangle numbers.
    marked: Vec<u32>,
}

/// The camera target for a place.
#[derive(Serialize)]
struct View {
    mesh: usize,
    /// In units of half the diagonal, relative to the middle of the box.
    point: [f64; 3],
    normal: [f64; 3],
    /// The mean edge length, in the same units.
    size: f64,
}

impl Scene {
    /// The scene of `shown`; distances of `farthest` percent or more get the worst colour.
    pub(super) fn new(shown: &[Shown], places: &[Place], view: &FirstView, farthest: f64) -> Scene {
        let place = |place: &Place| View {
            mesh: place.mesh,
            point: rounded(view.off_middle(place.point)),
            normal: rounded(place.normal),
            size: place.size / view.half_diagonal,
        };
        Scene {
            extent: (view.size / view.half_diagonal).to_array(),
            zoom: view.zoom,
            target: view.target.to_array(),
            rotation: view.rotation.map(|row| row.to_array()),
            ramp: RAMP.to_vec(),
            valences: VALENCES.iter().map(|v| v.1).collect(),
            kept: KEPT,
            left_out: LEFT_OUT,
            marked: MARKED,
            unknown: UNKNOWN,
            meshes: shown.iter().map(|s| Part::new(s, view, farthest)).collect(),
            places: places.iter().map(place).collect(),
        }
    }
}

fn rounded(v: DVec3) -> [f64; 3] {
    v.to_array().map(|x| (1e6 * x).round() / 1e6)
}

impl Part {
    fn new(shown: &Shown, view: &FirstView, farthest: f64) -> Part {
        let Shown { mesh, angles, qualities, valences, distances, sharp, left_out, marked, .. } = shown;
        let valence: Vec<u8> = valences.iter().map(|&v| valence_class(v)).collect();
        Part {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            positions: encoded(&mesh.positions, view),
            corners: corners(mesh),
            angle: bytes(angles.iter().map(|angle| 1.0 - angle / 60.0)),
            quality: bytes(qualities.iter().map(|q| 1.0 - q)),
            valence: base64::encode(&valence),
            distance: distances.as_ref().map(|d| bytes(d.iter().map(|d| d / farthest))),
            sharp: encoded(sharp.as_flattened(), view),
            left_out: encoded(left_out.as_flattened(), view),
            marked: marked.clone(),
        }
    }
}

/// Encodes numbers in 0..=1 as one byte each.
fn bytes(values: impl Iterator<Item = f64>) -> String {
    let bytes: Vec<u8> = values.map(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8).collect();
    base64::encode(&bytes)
}

fn corners(mesh: &Mesh) -> String {
    let all = mesh.triangles.as_flattened();
    let bytes: Vec<u8> = match u16::try_from(mesh.positions.len().saturating_sub(1)) {
        Ok(_) => all.iter().flat_map(|&v| (v as u16).to_le_bytes()).collect(),
        Err(_) => all.iter().flat_map(|v| v.to_le_bytes()).collect(),
    };
    base64::encode(&bytes)
}

/// Encodes positions as fractions of the box of all meshes.
fn encoded(points: &[DVec3], view: &FirstView) -> String {
    let share = |x: f64, size: f64| if size > 0.0 { x / size } else { 0.5 };
    let number = |x: f64, size: f64| (65535.0 * share(x, size).clamp(0.0, 1.0)).round() as u16;
    let coordinates = points.iter().flat_map(|&p| {
        let p = p - view.lo;
        [number(p.x, view.size.x), number(p.y, view.size.y), number(p.z, view.size.z)]
    });
    base64::encode(&coordinates.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_shares_of_the_box_of_all_meshes() {
        let mesh = |points: &[DVec3]| Mesh { positions: points.to_vec(), triangles: vec![] };
        let meshes = [mesh(&[DVec3::ZERO, DVec3::ONE]), mesh(&[DVec3::new(2.0, 1.0, 0.5)])];
        let view = FirstView::of(meshes.iter());
        let numbers = [32768u16, 65535, 32768];
        let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        assert_eq!(encoded(&[DVec3::new(1.0, 1.0, 0.5)], &view), base64::encode(&bytes));
        assert_eq!(view.off_middle(DVec3::new(1.0, 0.5, 0.5)), DVec3::ZERO);
    }

    #[test]
    fn corners_are_as_wide_as_they_must_be() {
        let with = |n: usize| Mesh { positions: vec![DVec3::ZERO; n], triangles: vec![[0, 1, 2]] };
        assert_eq!((corners(&with(65_536)).len(), corners(&with(65_537)).len()), (8, 16));
    }

    #[test]
    fn figures_are_bytes_and_stay_in_range() {
        assert_eq!(bytes([-1.0, 0.5, 7.0, f64::NAN].into_iter()), base64::encode(&[0, 128, 255, 0]));
    }
}
