//! A surface in ten dimensions that maps (u, v) to five circles, (cos kᵢ·(u, v), sin kᵢ·(u, v)) for five wave vectors kᵢ.
//!
//! Its metric Σ kᵢ kᵢᵗ is constant, so its area is known, and even samples have constant density in u and v.

use spectral_remesh::stages::base::rng::{Random, unit};
use spectral_remesh::stages::surface::submanifold::Submanifold;
use std::f64::consts::TAU;

/// The wave vectors.
const WAVES: [[f64; 2]; 5] = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0], [2.0, 1.0]];

/// The surface. Its points are (u, v).
pub struct FiveCircles;

impl FiveCircles {
    /// The entries uu, uv and vv of the metric.
    fn metric() -> [f64; 3] {
        let sum = |i: usize, j: usize| WAVES.iter().map(|k| k[i] * k[j]).sum();
        [sum(0, 0), sum(0, 1), sum(1, 1)]
    }

    /// The area of the surface in ten dimensions.
    pub fn area() -> f64 {
        let [uu, uv, vv] = Self::metric();
        TAU * TAU * (uu * vv - uv * uv).sqrt()
    }

    /// A random point.
    pub fn random(rng: &mut Random) -> [f64; 2] {
        [TAU * unit(rng), TAU * unit(rng)]
    }
}

impl Submanifold<10> for FiveCircles {
    type Point = [f64; 2];

    fn coordinates(&self, &[u, v]: &[f64; 2]) -> [f64; 10] {
        let mut x = [0.0; 10];
        for (pair, k) in x.chunks_exact_mut(2).zip(WAVES) {
            let (sin, cos) = (k[0] * u + k[1] * v).sin_cos();
            pair.copy_from_slice(&[cos, sin]);
        }
        x
    }

    /// The step in (u, v) whose image is closest to `way`: the inverse metric times the derivatives along `way`.
    fn step(&self, &[u, v]: &[f64; 2], way: &[f64; 10]) -> [f64; 2] {
        let mut along = [0.0; 2];
        for (pair, k) in way.chunks_exact(2).zip(WAVES) {
            let (sin, cos) = (k[0] * u + k[1] * v).sin_cos();
            let turned = cos * pair[1] - sin * pair[0];
            along = [along[0] + k[0] * turned, along[1] + k[1] * turned];
        }
        let [uu, uv, vv] = Self::metric();
        let determinant = uu * vv - uv * uv;
        let du = (vv * along[0] - uv * along[1]) / determinant;
        let dv = (uu * along[1] - uv * along[0]) / determinant;
        [(u + du).rem_euclid(TAU), (v + dv).rem_euclid(TAU)]
    }
}
