//! A lumpy ball as a cheap scanner would see it: vertices are displaced by a quarter of the mean edge length.

use super::build::{Builder, gauss, signed, snap};
use glam::DVec3;
use spectral_remesh::Mesh;
use spectral_remesh::stages::base::rng::{Stage, stream};

/// Number of segments into which each edge of the icosahedron is split.
const FREQUENCY: usize = 24;

/// Standard deviation of the noise, in mean edge lengths.
const NOISE: f64 = 0.25;

/// Number of lumps and dents on the ball.
const LUMPS: usize = 14;

/// The model: 5,762 vertices, with a radius of about 1.
pub fn noisy() -> Mesh {
    let mut mesh = lumpy_ball();
    let sigma = NOISE * mean_edge(&mesh);
    let mut rng = stream(22, Stage::Candidates);
    let normals = normals(&mesh);
    for (p, n) in mesh.positions.iter_mut().zip(normals) {
        *p = snap(*p + n * (sigma * gauss(&mut rng)));
    }
    mesh
}

/// The ball without noise.
fn lumpy_ball() -> Mesh {
    let mut rng = stream(21, Stage::Candidates);
    let lumps: Vec<(DVec3, f64)> = (0..LUMPS)
        .map(|_| {
            let towards = DVec3::new(gauss(&mut rng), gauss(&mut rng), gauss(&mut rng)).normalize();
            (towards, 0.38 * signed(&mut rng))
        })
        .collect();
    let mut mesh = ball();
    for p in &mut mesh.positions {
        let direction = p.normalize();
        let radius: f64 = 1.0 + lumps.iter().map(|(c, h)| h * (9.0 * (direction.dot(*c) - 1.0)).exp()).sum::<f64>();
        *p = direction * radius;
    }
    mesh
}

/// The unit sphere: an icosahedron with subdivided faces.
fn ball() -> Mesh {
    let mut b = Builder::default();
    let corners = icosahedron();
    for (i, j, k) in faces(&corners) {
        let at = |a: usize, c: usize| {
            let weight = [FREQUENCY - a - c, a, c].map(|n| n as f64 / FREQUENCY as f64);
            // Corners are in the order of their numbers, so that both faces at an edge get the same bits.
            (corners[i] * weight[0] + corners[j] * weight[1] + corners[k] * weight[2]).normalize()
        };
        let outward = corners[i] + corners[j] + corners[k];
        for a in 0..FREQUENCY {
            for c in 0..FREQUENCY - a {
                b.triangle([at(a, c), at(a + 1, c), at(a, c + 1)], outward);
                if a + c + 1 < FREQUENCY {
                    b.triangle([at(a + 1, c), at(a + 1, c + 1), at(a, c + 1)], outward);
                }
            }
        }
    }
    b.mesh
}

/// The twelve vertices of an icosahedron with edge length 2.
fn icosahedron() -> Vec<DVec3> {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let cyclic = |(s, t): (f64, f64)| {
        let (a, b) = (s, t * golden);
        [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]
    };
    signs.into_iter().flat_map(cyclic).collect()
}

/// The twenty faces: triples of vertices that are pairwise neighbours.
fn faces(corners: &[DVec3]) -> Vec<(usize, usize, usize)> {
    let near = |i: usize, j: usize| corners[i].distance(corners[j]) < 2.5;
    let n = corners.len();
    let triples = (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| (i, j, k))));
    triples.filter(|&(i, j, k)| near(i, j) && near(j, k) && near(i, k)).collect()
}

/// The mean side length of the triangles.
fn mean_edge(mesh: &Mesh) -> f64 {
    let perimeter = |t| {
        let [a, b, c] = mesh.corners(t);
        a.distance(b) + b.distance(c) + c.distance(a)
    };
    (0..mesh.triangles.len()).map(perimeter).sum::<f64>() / (3 * mesh.triangles.len()) as f64
}

/// Area-weighted unit normals of the vertices.
fn normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        for &v in corners {
            sums[v as usize] += mesh.area_vector(t);
        }
    }
    sums.into_iter().map(DVec3::normalize).collect()
}
