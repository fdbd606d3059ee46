//! Building blocks of the shapes.

use glam::DVec3;
use spectral_remesh::Mesh;
use spectral_remesh::stages::base::rng::{Random, unit};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Grid steps of coordinates per unit. The grid keeps text files short and makes them the same on every machine: sine and
/// logarithm may differ in the last bit between machines.
const STEPS: f64 = 1e5;

/// Rounds `p` to the grid of coordinates, without negative zeros.
pub fn snap(p: DVec3) -> DVec3 {
    (p * STEPS).round() / STEPS + 0.0
}

/// A mesh under construction that has a single vertex at each position.
#[derive(Default)]
pub struct Builder {
    pub mesh: Mesh,
    at: BTreeMap<[i64; 3], u32>,
}

impl Builder {
    /// Returns the vertex at `p`, which is added if there is none yet.
    pub fn vertex(&mut self, p: DVec3) -> u32 {
        let p = snap(p);
        let key = p.to_array().map(|x| (x * STEPS).round() as i64);
        *self.at.entry(key).or_insert_with(|| {
            self.mesh.positions.push(p);
            self.mesh.positions.len() as u32 - 1
        })
    }

    /// Adds the triangle `a b c`, oriented such that its normal points to the side of `outward`.
    pub fn triangle(&mut self, [a, b, c]: [DVec3; 3], outward: DVec3) {
        let [i, j, k] = [a, b, c].map(|p| self.vertex(p));
        let counter_clockwise = (b - a).cross(c - a).dot(outward) > 0.0;
        self.mesh.triangles.push(if counter_clockwise { [i, j, k] } else { [i, k, j] });
    }

    /// Adds the quadrilateral `a b c d` as two triangles that share the diagonal from `a` to `c`.
    pub fn quad(&mut self, [a, b, c, d]: [DVec3; 4], outward: DVec3) {
        self.triangle([a, b, c], outward);
        self.triangle([a, c, d], outward);
    }
}

/// A normally distributed number with mean 0 and variance 1 (Box-Muller transform of two uniform numbers).
pub fn gauss(rng: &mut Random) -> f64 {
    let (u, v) = (1.0 - unit(rng), unit(rng));
    (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
}

/// A number in -1..1.
pub fn signed(rng: &mut Random) -> f64 {
    2.0 * unit(rng) - 1.0
}
