//! An open sheet of hills with one ragged boundary and triangles of many sizes.

use super::build::{signed, snap};
use glam::{DVec2, DVec3};
use spectral_remesh::Mesh;
use spectral_remesh::stages::base::rng::{Random, Stage, stream, unit};

/// Number of vertices along a side.
const SIDE: usize = 72;

/// Maximum displacement of a vertex from its grid position along each axis, in cells. Below 0.25, no triangle can turn over.
const STRAY: f64 = 0.24;

/// Number of octaves of the relief, each with half the height and half the width of the previous one.
const OCTAVES: i32 = 4;

/// The model: a distorted square of side length 10, with hills of height 2.
pub fn terrain() -> Mesh {
    let mut rng = stream(20, Stage::Candidates);
    let relief: Vec<Lattice> = (0..OCTAVES).map(|_| Lattice::new(&mut rng)).collect();
    let mut mesh = Mesh::default();
    for n in 0..SIDE * SIDE {
        let outlier = DVec2::new(signed(&mut rng), signed(&mut rng)) * STRAY;
        let cell = DVec2::new((n % SIDE) as f64, (n / SIDE) as f64) + outlier;
        let p = warp(cell * (2.0 / (SIDE - 1) as f64) - 1.0);
        mesh.positions.push(snap(DVec3::new(5.0 * p.x, 5.0 * p.y, height(p, &relief))));
    }
    for n in (0..SIDE * (SIDE - 1)).filter(|n| n % SIDE < SIDE - 1) {
        let [a, b, c, d] = [n, n + 1, n + 1 + SIDE, n + SIDE].map(|v| v as u32);
        let halves = if unit(&mut rng) < 0.5 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        mesh.triangles.extend(halves);
    }
    mesh
}

/// Contracts the middle of the square -1..1 and bends its sides.
fn warp(p: DVec2) -> DVec2 {
    let tighter = p * (0.55 + 0.45 * (0.5 * p.length_squared()).min(1.0));
    tighter + 0.09 * DVec2::new((3.1 * p.y).sin(), (2.6 * p.x + 0.7).cos())
}

/// The height over a point of the square.
fn height(p: DVec2, relief: &[Lattice]) -> f64 {
    let octave = |(k, lattice): (usize, &Lattice)| {
        let scale = f64::from(1 << k);
        lattice.value(p * (1.6 * scale)) / scale
    };
    1.3 * relief.iter().enumerate().map(octave).sum::<f64>()
}

/// Random values at integer coordinates, smoothly interpolated, with period `Lattice::PERIOD`.
struct Lattice(Vec<f64>);

impl Lattice {
    const PERIOD: i64 = 32;

    fn new(rng: &mut Random) -> Self {
        Lattice((0..Self::PERIOD * Self::PERIOD).map(|_| signed(rng)).collect())
    }

    fn value(&self, p: DVec2) -> f64 {
        let corner = p.floor();
        let t = (p - corner) * (p - corner) * (DVec2::splat(3.0) - 2.0 * (p - corner));
        let at = |dx: i64, dy: i64| {
            let (x, y) = (corner.x as i64 + dx, corner.y as i64 + dy);
            self.0[(x.rem_euclid(Self::PERIOD) + Self::PERIOD * y.rem_euclid(Self::PERIOD)) as usize]
        };
        let row = |dy| at(0, dy) + (at(1, dy) - at(0, dy)) * t.x;
        row(0) + (row(1) - row(0)) * t.y
    }
}
