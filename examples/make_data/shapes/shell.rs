//! A fluted bowl whose wall is far thinner than typical target edge lengths.

use super::build::Builder;
use glam::DVec3;
use spectral_remesh::Mesh;
use std::f64::consts::TAU;

/// Thickness of the wall. The radius of the bowl is about 1, and 3,000 points on both of its sides are about 0.07 apart.
const WALL: f64 = 0.012;
const FLUTES: f64 = 9.0;
const AROUND: usize = 84;
const UP: usize = 30;

/// The model: the outer side, the inner side, and a narrow band along the rim between them.
pub fn shell() -> Mesh {
    let mut b = Builder::default();
    side(&mut b, 0.0, 1.0);
    side(&mut b, WALL, -1.0);
    for k in 0..AROUND {
        let [p, q] = [k, k + 1].map(|k| at(UP, k, 0.0));
        let [r, s] = [k + 1, k].map(|k| at(UP, k, WALL));
        b.quad([p, q, r, s], DVec3::Z);
    }
    b.mesh
}

/// One side of the wall, as rings of quadrilaterals around a pole; `facing` is 1 for outwards and -1 for inwards.
fn side(b: &mut Builder, inset: f64, facing: f64) {
    let centre = DVec3::Z;
    for k in 0..AROUND {
        let [p, q] = [k, k + 1].map(|k| at(1, k, inset));
        b.triangle([at(0, 0, inset), p, q], facing * -DVec3::Z);
        for ring in 1..UP {
            let corners =
                [at(ring, k, inset), at(ring, k + 1, inset), at(ring + 1, k + 1, inset), at(ring + 1, k, inset)];
            b.quad(corners, facing * (corners[0] - centre));
        }
    }
}

/// A point of the wall at ring `ring` of `UP` and step `step` of `AROUND`, `inset` below the outer side.
fn at(ring: usize, step: usize, inset: f64) -> DVec3 {
    let up = ring as f64 / UP as f64;
    let angle = TAU * (step % AROUND) as f64 / AROUND as f64;
    let flute = 1.0 + 0.07 * up * up * (FLUTES * angle).cos();
    let (sin, cos) = (1.62 * up).sin_cos();
    let radius = flute - inset;
    // The polar angle slightly exceeds a quarter turn, so that the rim leans inwards.
    let lift = 0.08 * up.powi(3) * (FLUTES * angle).cos();
    DVec3::new(radius * sin * angle.cos(), radius * sin * angle.sin(), 1.0 - radius * cos + lift)
}
