//! The meshes of a page as its viewer takes them: JSON with arrays of bytes as base64.
//!
//! Positions are 16 bits for each coordinate, in the box of all meshes together, so that what coincides still does. Figures
//! are one byte each: 0 for good and 255 for bad, or the class of a valence.
//!
//! Limits: a position is off by at most 1/131,070 of the box.

use crate::geom::aabb::Aabb;
use crate::io::base64;
use crate::mesh::triangle_mesh::Mesh;
use crate::report::page::camera::first_rotation;
use crate::report::page::colours::{RAMP, VALENCES, valence_class};
use crate::report::page::places::Place;
use crate::report::page::shown::Shown;
use glam::DVec3;
use serde::Serialize;

/// All that the viewer needs.
#[derive(Serialize)]
pub(super) struct Scene {
    /// The extent of the box in units of half its diagonal, along each axis.
    extent: [f64; 3],
    /// The rotation to begin with, by rows: right, up, towards the eye.
    rotation: [[f64; 3]; 3],
    ramp: Vec<&'static str>,
    valences: Vec<&'static str>,
    meshes: Vec<Part>,
    places: Vec<View>,
}

/// A mesh; little-endian numbers as base64.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Part {
    vertices: usize,
    triangles: usize,
    /// Three `u16` a vertex.
    positions: String,
    /// Three corners a triangle: `u16`, or `u32` where there are more than 65,536 vertices.
    corners: String,
    /// A byte a triangle.
    angle: String,
    quality: String,
    /// A byte a vertex.
    valence: String,
    distance: Option<String>,
    /// Two positions an edge.
    sharp: String,
    left_out: String,
    /// Numbers of triangles.
    marked: Vec<u32>,
}

/// Where the camera turns for a place.
#[derive(Serialize)]
struct View {
    mesh: usize,
    /// In units of half the diagonal, from the middle of the box.
    point: [f64; 3],
    normal: [f64; 3],
    /// The length of the edges there, in the same units.
    size: f64,
}

impl Scene {
    /// The scene of `shown`; distances from `farthest` on, in percent, are worst.
    pub(super) fn new(shown: &[Shown], places: &[Place], farthest: f64) -> Scene {
        let frame = Frame::of(shown.iter().map(|s| s.mesh));
        let view = |place: &Place| View {
            mesh: place.mesh,
            point: rounded(frame.seen(place.point)),
            normal: rounded(place.normal),
            size: place.size / frame.half_diagonal,
        };
        Scene {
            extent: (frame.size / frame.half_diagonal).to_array(),
            rotation: first_rotation(frame.size),
            ramp: RAMP.to_vec(),
            valences: VALENCES.iter().map(|v| v.1).collect(),
            meshes: shown.iter().map(|s| Part::new(s, &frame, farthest)).collect(),
            places: places.iter().map(view).collect(),
        }
    }
}

fn rounded(v: DVec3) -> [f64; 3] {
    v.to_array().map(|x| (1e6 * x).round() / 1e6)
}

impl Part {
    fn new(shown: &Shown, frame: &Frame, farthest: f64) -> Part {
        let Shown { mesh, angles, qualities, valences, distances, sharp, left_out, marked, .. } = shown;
        let valence: Vec<u8> = valences.iter().map(|&v| valence_class(v)).collect();
        Part {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            positions: frame.encoded(&mesh.positions),
            corners: corners(mesh),
            angle: bytes(angles.iter().map(|angle| 1.0 - angle / 60.0)),
            quality: bytes(qualities.iter().map(|q| 1.0 - q)),
            valence: base64::encode(&valence),
            distance: distances.as_ref().map(|d| bytes(d.iter().map(|d| d / farthest))),
            sharp: frame.encoded(sharp.as_flattened()),
            left_out: frame.encoded(left_out.as_flattened()),
            marked: marked.clone(),
        }
    }
}

/// Numbers in 0..=1, a byte each.
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

/// The box that positions are told in.
struct Frame {
    lo: DVec3,
    size: DVec3,
    half_diagonal: f64,
}

impl Frame {
    fn of<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> Frame {
        let bounds = Aabb::of(meshes.flat_map(|m| m.positions.iter().copied())).unwrap_or_default();
        let half_diagonal = 0.5 * bounds.diagonal();
        let half_diagonal = if half_diagonal > 0.0 { half_diagonal } else { 1.0 };
        Frame { lo: bounds.lo, size: bounds.size(), half_diagonal }
    }

    /// A point in units of half the diagonal, from the middle.
    fn seen(&self, p: DVec3) -> DVec3 {
        (p - self.lo - 0.5 * self.size) / self.half_diagonal
    }

    fn encoded(&self, points: &[DVec3]) -> String {
        let share = |x: f64, size: f64| if size > 0.0 { x / size } else { 0.5 };
        let number = |x: f64, size: f64| (65535.0 * share(x, size).clamp(0.0, 1.0)).round() as u16;
        let coordinates = points.iter().flat_map(|&p| {
            let p = p - self.lo;
            [number(p.x, self.size.x), number(p.y, self.size.y), number(p.z, self.size.z)]
        });
        base64::encode(&coordinates.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_shares_of_the_box_of_all_meshes() {
        let mesh = |points: &[DVec3]| Mesh { positions: points.to_vec(), triangles: vec![] };
        let meshes = [mesh(&[DVec3::ZERO, DVec3::ONE]), mesh(&[DVec3::new(2.0, 1.0, 0.5)])];
        let frame = Frame::of(meshes.iter());
        let numbers = [32768u16, 65535, 32768];
        let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        assert_eq!(frame.encoded(&[DVec3::new(1.0, 1.0, 0.5)]), base64::encode(&bytes));
        assert_eq!(frame.seen(DVec3::new(1.0, 0.5, 0.5)), DVec3::ZERO);
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
