//! What the shapes are put together with.

use glam::DVec3;
use spectral_remesh::Mesh;
use spectral_remesh::stages::base::rng::{Random, unit};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Steps of the grid of coordinates, per unit. The grid keeps text files short, and it keeps them the same on every
/// machine: sine and logarithm may differ in the last bit from one machine to another.
const STEPS: f64 = 1e5;

/// `p` on the grid of coordinates, with no negative zero.
pub fn snap(p: DVec3) -> DVec3 {
    (p * STEPS).round() / STEPS + 0.0
}

/// A mesh under construction, in which a place is one vertex.
#[derive(Default)]
pub struct Builder {
    pub mesh: Mesh,
    at: BTreeMap<[i64; 3], u32>,
}

impl Builder {
    /// The vertex at `p`, which is new if nothing is there yet.
    pub fn vertex(&mut self, p: DVec3) -> u32 {
        let p = snap(p);
        let key = p.to_array().map(|x| (x * STEPS).round() as i64);
        *self.at.entry(key).or_insert_with(|| {
            self.mesh.positions.push(p);
            self.mesh.positions.len() as u32 - 1
        })
    }

    /// The triangle `a b c`, turned so that its normal points to the side of `outward`.
    pub fn triangle(&mut self, [a, b, c]: [DVec3; 3], outward: DVec3) {
        let [i, j, k] = [a, b, c].map(|p| self.vertex(p));
        let counter_clockwise = (b - a).cross(c - a).dot(outward) > 0.0;
        self.mesh.triangles.push(if counter_clockwise { [i, j, k] } else { [i, k, j] });
    }

    /// The quadrilateral `a b c d` as two triangles that share its diagonal from `a` to `c`.
    pub fn quad(&mut self, [a, b, c, d]: [DVec3; 4], outward: DVec3) {
        self.triangle([a, b, c], outward);
        self.triangle([a, c, d], outward);
    }
}

/// A normally distributed number of mean 0 and variance 1 (Box and Muller's transform of two uniform ones).
pub fn gauss(rng: &mut Random) -> f64 {
    let (u, v) = (1.0 - unit(rng), unit(rng));
    (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
}

/// A number in -1..1.
pub fn signed(rng: &mut Random) -> f64 {
    2.0 * unit(rng) - 1.0
}
