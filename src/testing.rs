//! Shapes for unit tests.

use crate::base::rng::{Random, unit};
use crate::mesh::triangle_mesh::Mesh;
use glam::{DVec3, dvec3};

/// `n` by `m` squares of two triangles each, laid by `place` from the unit square; squares along v follow each other.
pub fn grid(n: u32, m: u32, place: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let at = |i: u32, j: u32| i * (m + 1) + j;
    let corners =
        (0..=n).flat_map(|i| (0..=m).map(move |j| (f64::from(i) / f64::from(n), f64::from(j) / f64::from(m))));
    let squares = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let halves = |(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    Mesh { positions: corners.map(|(u, v)| place(u, v)).collect(), triangles: squares.flat_map(halves).collect() }
}

/// `n` by `n` squares over the unit square at the height that `f` gives.
pub fn sheet(n: u32, f: impl Fn(f64, f64) -> f64) -> Mesh {
    grid(n, n, |x, y| dvec3(x, y, f(x, y)))
}

/// All these meshes as one, none of whose vertices they share.
pub fn joined(parts: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut all = Mesh::default();
    for part in parts {
        let first = all.positions.len() as u32;
        all.positions.extend(part.positions);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

/// The mesh at another place.
pub fn moved(mut mesh: Mesh, by: DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p += by);
    mesh
}

/// The unit cube, each face two triangles.
pub fn cube() -> Mesh {
    let positions = (0..8).map(|v| dvec3(f64::from(v & 1), f64::from(v >> 1 & 1), f64::from(v >> 2)));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions: positions.collect(), triangles }
}

/// The corner of the unit cube at the origin.
pub fn tetrahedron() -> Mesh {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    Mesh { positions, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] }
}

/// The closed surface of revolution of a profile, given by radius and height between the poles, which are the first
/// two heights asked for.
pub fn revolved(poles: [f64; 2], profile: &[(f64, f64)], around: u32) -> Mesh {
    let mut positions: Vec<DVec3> = poles.iter().map(|&z| dvec3(0.0, 0.0, z)).collect();
    for &(radius, z) in profile {
        positions.extend((0..around).map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(around)).sin_cos();
            dvec3(radius * cos, radius * sin, z)
        }));
    }
    let at = |ring: u32, i: u32| 2 + ring * around + i % around;
    let last = profile.len() as u32 - 1;
    let mut triangles = Vec::new();
    for i in 0..around {
        triangles.extend([[0, at(0, i + 1), at(0, i)], [1, at(last, i), at(last, i + 1)]]);
        for ring in 0..last {
            let [a, b, c, d] = [at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh { positions, triangles }
}

/// The unit sphere, of 39 circles of 60 vertices and two poles.
pub fn sphere() -> Mesh {
    let angle = |i: i32| std::f64::consts::PI * f64::from(i) / 40.0;
    let profile: Vec<(f64, f64)> = (1..40).map(|i| (angle(i).sin(), -angle(i).cos())).collect();
    revolved([-1.0, 1.0], &profile, 60)
}

/// A random point of the unit cube.
pub fn random_point(rng: &mut Random) -> DVec3 {
    dvec3(unit(rng), unit(rng), unit(rng))
}
