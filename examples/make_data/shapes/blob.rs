//! A soft frame of genus 3 made by marching cubes, with the slivers that this method leaves.

use super::isosurface::{Grid, isosurface};
use glam::{DVec3, UVec3};
use spectral_remesh::Mesh;

/// Four knots, each connected to all others: six struts around three independent holes.
const KNOTS: [DVec3; 4] = [
    DVec3::new(0.08, -0.05, 0.95),
    DVec3::new(1.32, 0.07, -0.36),
    DVec3::new(-0.70, 1.20, -0.27),
    DVec3::new(-0.60, -1.13, -0.31),
];

/// Radius at each knot.
const RADII: [f64; 4] = [0.27, 0.34, 0.29, 0.37];

/// Radius of a strut at its middle, as a fraction of the mean radius at its ends.
const WAIST: f64 = 0.5;

/// Sharpness of the creases between struts, per unit of length; higher means sharper.
const SHARPNESS: f64 = 13.0;

/// The model: about 7,000 vertices in a box of side length 3.
pub fn blob() -> Mesh {
    let grid = Grid { origin: DVec3::new(-1.2112, -1.7237, -0.8843), cell: 0.0587, cells: UVec3::new(52, 58, 41) };
    isosurface(&grid, distance)
}

/// The approximate signed distance from the frame: the soft minimum of the distances from its struts.
fn distance(p: DVec3) -> f64 {
    let struts = (0..4).flat_map(|i| (0..i).map(move |j| (i, j)));
    let sum: f64 = struts.map(|(i, j)| (-SHARPNESS * strut_distance(p, i, j)).exp()).sum();
    -sum.ln() / SHARPNESS
}

/// The approximate signed distance from the strut between two knots, which is thick at its ends and thin in the middle.
fn strut_distance(p: DVec3, i: usize, j: usize) -> f64 {
    let along = KNOTS[j] - KNOTS[i];
    let t = ((p - KNOTS[i]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let mean = RADII[i] + (RADII[j] - RADII[i]) * t;
    let towards_end = (2.0 * t - 1.0).powi(2);
    p.distance(KNOTS[i] + along * t) - mean * (WAIST + (1.0 - WAIST) * towards_end)
}
