//! Shapes of known topology, and checks that every result must pass.

use glam::{DMat3, DVec3, dvec3};
use spectral_remesh::Mesh;
use spectral_remesh::stages::base::rng::{Random, unit};
use spectral_remesh::stages::mesh::topology::{Topology, topology};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Checks everything that must hold for the arrays of a result, and returns its topology.
#[track_caller]
pub fn audit(mesh: &Mesh) -> Topology {
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "coordinates that are not finite");
    let count = mesh.positions.len();
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < count), "corners that are not there");
    assert!(mesh.triangles.iter().all(|&[a, b, c]| a != b && b != c && c != a), "a triangle with a corner twice");
    let t = topology(count, &mesh.triangles);
    assert_eq!(t.vertices, count, "vertices that no triangle uses");
    assert!(t.is_manifold() && t.is_oriented(), "{t:?}");
    t
}

/// Returns the volume enclosed by a closed mesh, negative if it is inside out.
pub fn volume(mesh: &Mesh) -> f64 {
    let centre = mesh.positions.iter().sum::<DVec3>() / mesh.positions.len().max(1) as f64;
    let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|p| p - centre));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Returns the mesh with `f` applied to all positions.
pub fn moved(mut mesh: Mesh, f: impl Fn(DVec3) -> DVec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = f(*p));
    mesh
}

pub fn rotated(mesh: Mesh, axis: DVec3, angle: f64) -> Mesh {
    let m = DMat3::from_axis_angle(axis.normalize(), angle);
    moved(mesh, |p| m * p)
}

/// Returns the mesh turned inside out.
pub fn inside_out(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// Returns several meshes as one.
pub fn together(parts: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for part in parts {
        let base = all.positions.len() as u32;
        all.positions.extend(&part.positions);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    all
}

/// Returns the mesh with separate corners for every triangle.
pub fn soup(mesh: &Mesh) -> Mesh {
    let positions: Vec<DVec3> = (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh { positions, triangles }
}

/// Returns the same surface with its vertices and triangles in random order, and the corners of triangles rotated.
pub fn shuffled(mesh: &Mesh, rng: &mut Random) -> Mesh {
    let mut permutation = |n: usize| {
        let mut order: Vec<(u64, u32)> = (0..n as u32).map(|i| ((unit(rng) * 1e15) as u64, i)).collect();
        order.sort_unstable();
        order.into_iter().map(|o| o.1).collect::<Vec<u32>>()
    };
    let (vertices, triangles) = (permutation(mesh.positions.len()), permutation(mesh.triangles.len()));
    let mut rank = vec![0; vertices.len()];
    vertices.iter().zip(0u32..).for_each(|(&v, i)| rank[v as usize] = i);
    let turned = |&t: &u32| {
        let mut corners = mesh.triangles[t as usize].map(|v| rank[v as usize]);
        corners.rotate_left(t as usize % 3);
        corners
    };
    Mesh {
        positions: vertices.iter().map(|&v| mesh.positions[v as usize]).collect(),
        triangles: triangles.iter().map(turned).collect(),
    }
}

/// Returns the mesh with every vertex moved randomly by up to `size` along each axis.
pub fn noisy(mesh: Mesh, size: f64, rng: &mut Random) -> Mesh {
    let mut mesh = mesh;
    for p in &mut mesh.positions {
        *p += size * dvec3(unit(rng) - 0.5, unit(rng) - 0.5, unit(rng) - 0.5) * 2.0;
    }
    mesh
}

/// How two opposite ends of a grid of squares are joined.
#[derive(Clone, Copy, PartialEq)]
pub enum Ends {
    Open,
    Joined,
    /// Joined with a half turn.
    Twisted,
}

/// Returns a grid of `n` by `m` squares over the unit square, mapped to a surface by `f`. `along` says how the ends of the
/// first direction are joined, `across` those of the second.
pub fn grid(n: u32, m: u32, along: Ends, across: Ends, f: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let rows = if along == Ends::Open { n + 1 } else { n };
    let columns = if across == Ends::Open { m + 1 } else { m };
    let at = |i: u32, j: u32| {
        let j = if i == n && along == Ends::Twisted { m - j } else { j };
        (i % rows) * columns + j % columns
    };
    let place = |i: u32, j: u32| f(f64::from(i) / f64::from(n), f64::from(j) / f64::from(m));
    let positions = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| place(i, j)).collect();
    let square = |i, j| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|i| (0..m).flat_map(move |j| square(i, j))).collect();
    Mesh { positions, triangles }
}

/// Returns a sphere around `centre`: an octahedron whose triangles are divided into four `level` times.
pub fn sphere(level: u32, centre: DVec3, radius: f64) -> Mesh {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let triangles = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let mut mesh = Mesh { positions: axes.to_vec(), triangles: triangles.to_vec() };
    for _ in 0..level {
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in std::mem::take(&mut mesh.triangles) {
            let [p, q, r] = [[a, b], [b, c], [c, a]].map(|[v, w]| {
                *middles.entry([v.min(w), v.max(w)]).or_insert_with(|| {
                    mesh.positions.push((mesh.positions[v as usize] + mesh.positions[w as usize]).normalize());
                    mesh.positions.len() as u32 - 1
                })
            });
            finer.extend([[a, p, r], [p, b, q], [r, q, c], [p, q, r]]);
        }
        mesh.triangles = finer;
    }
    moved(mesh, |p| centre + radius * p)
}

pub fn torus(n: u32, m: u32, large: f64, small: f64) -> Mesh {
    grid(n, m, Ends::Joined, Ends::Joined, |u, v| {
        let (a, b) = (TAU * u, TAU * v);
        let r = large + small * b.cos();
        dvec3(r * a.cos(), r * a.sin(), small * b.sin())
    })
}

/// Returns the surface of unit cells at integer places: two triangles for each face between a cell and empty space.
pub fn cells(places: &[[i32; 3]]) -> Mesh {
    let filled: BTreeSet<[i32; 3]> = places.iter().copied().collect();
    let mut mesh = Mesh::default();
    let mut number: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    for &cell in &filled {
        for axis in 0..3 {
            for side in 0..2 {
                let mut beyond = cell;
                beyond[axis] += 2 * side - 1;
                if filled.contains(&beyond) {
                    continue;
                }
                let corner = |i: i32, j: i32| {
                    let mut at = cell;
                    at[axis] += side;
                    at[(axis + 1) % 3] += i;
                    at[(axis + 2) % 3] += j;
                    at
                };
                let quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)].map(|at| {
                    *number.entry(at).or_insert_with(|| {
                        mesh.positions.push(dvec3(at[0].into(), at[1].into(), at[2].into()));
                        mesh.positions.len() as u32 - 1
                    })
                });
                let [a, b, c, d] = if side == 1 { quad } else { [quad[0], quad[3], quad[2], quad[1]] };
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh
}

/// Returns a box of 12 triangles.
pub fn cuboid(size: DVec3) -> Mesh {
    moved(cells(&[[0; 3]]), |p| p * size)
}

/// Returns a plate with `holes` holes in a row: a surface of that genus.
pub fn frame(holes: i32) -> Mesh {
    let inside = |x: i32, y: i32| y != 1 || x % 2 == 0;
    let all = (0..=2 * holes).flat_map(|x| (0..3).map(move |y| [x, y, 0]));
    cells(&all.filter(|c| inside(c[0], c[1])).collect::<Vec<_>>())
}

/// Returns the twelve edges of a cube as bars: a surface of genus 5.
pub fn cage() -> Mesh {
    let all = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
    cells(&all.filter(|c| c.iter().filter(|&&x| x == 1).count() <= 1).collect::<Vec<_>>())
}

/// Returns a cylinder of `n` sides around z, from 0 to `height`, with caps of `n` triangles around a centre. With a `top`
/// radius of zero, it is a cone.
pub fn cylinder(n: u32, radius: f64, top: f64, height: f64) -> Mesh {
    let ring = |r: f64, z: f64| (0..n).map(move |i| (TAU * f64::from(i) / f64::from(n), r, z));
    let place = |(a, r, z): (f64, f64, f64)| dvec3(r * a.cos(), r * a.sin(), z);
    let mut mesh = Mesh { positions: ring(radius, 0.0).map(place).collect(), triangles: vec![] };
    let (bottom, peak) = (n, n + 1);
    mesh.positions.extend([DVec3::ZERO, dvec3(0.0, 0.0, height)]);
    let next = |i: u32| (i + 1) % n;
    mesh.triangles.extend((0..n).map(|i| [next(i), i, bottom]));
    if top == 0.0 {
        mesh.triangles.extend((0..n).map(|i| [i, next(i), peak]));
        return mesh;
    }
    mesh.positions.extend(ring(top, height).map(place));
    let up = |i: u32| n + 2 + i;
    mesh.triangles.extend((0..n).flat_map(|i| [[i, next(i), up(next(i))], [i, up(next(i)), up(i)]]));
    mesh.triangles.extend((0..n).map(|i| [up(i), up(next(i)), peak]));
    mesh
}

/// Returns a plate over the unit square with `n` by `n` squares on each side.
pub fn plate(n: i32, thickness: f64) -> Mesh {
    let all: Vec<[i32; 3]> = (0..n * n).map(|i| [i % n, i / n, 0]).collect();
    moved(cells(&all), |p| p / f64::from(n) * dvec3(1.0, 1.0, thickness * f64::from(n)))
}

pub fn moebius(n: u32, m: u32) -> Mesh {
    grid(n, m, Ends::Twisted, Ends::Open, |u, v| {
        let (a, side) = (TAU * u, 2.0 * v - 1.0);
        let (r, z) = (3.0 + side * (a / 2.0).cos(), side * (a / 2.0).sin());
        dvec3(r * a.cos(), r * a.sin(), z)
    })
}

/// Returns a closed surface with only one side, which intersects itself.
pub fn klein_bottle(n: u32, m: u32) -> Mesh {
    grid(n, m, Ends::Twisted, Ends::Joined, |u, v| {
        let (a, b) = (TAU * u, TAU * v);
        let (s, t) = (b.sin(), (2.0 * b).sin());
        let (c, d) = ((a / 2.0).cos(), (a / 2.0).sin());
        let r = 3.0 + c * s - d * t;
        dvec3(r * a.cos(), r * a.sin(), d * s + c * t)
    })
}

/// Returns a wavy open sheet over the unit square.
pub fn sheet(n: u32, m: u32) -> Mesh {
    grid(n, m, Ends::Open, Ends::Open, |u, v| dvec3(u, v, 0.1 * (7.0 * u).sin() * (5.0 * v).cos()))
}

/// Returns a sheet with three by three square holes.
pub fn sieve(n: u32) -> Mesh {
    let mut mesh = sheet(n, n);
    let hole = |x: f64| (0.25..0.6).contains(&(3.0 * x).fract());
    let kept = mesh.triangles.chunks_exact(2).filter(|square| {
        let p = square[0].map(|v| mesh.positions[v as usize]);
        let middle = (p[0] + p[2].max(p[1])) / 2.0;
        !(hole(middle.x) && hole(middle.y))
    });
    mesh.triangles = kept.flatten().copied().collect();
    mesh.drop_unused();
    mesh
}

pub fn annulus(n: u32, m: u32, inner: f64) -> Mesh {
    grid(n, m, Ends::Joined, Ends::Open, |u, v| {
        let (a, r) = (-TAU * u, inner + (1.0 - inner) * v);
        dvec3(r * a.cos(), r * a.sin(), 0.0)
    })
}

/// Returns a rolled-up sheet of four turns whose layers are `gap` apart.
pub fn spiral(n: u32, m: u32, gap: f64) -> Mesh {
    grid(n, m, Ends::Open, Ends::Open, |u, v| {
        let a = 4.0 * TAU * u;
        let r = 0.5 + gap * a / TAU;
        dvec3(r * a.cos(), r * a.sin(), v)
    })
}

/// Returns ten spheres in a row, each half the size of the previous one.
pub fn ten_spheres() -> Mesh {
    let radius = |i: i32| 0.5f64.powi(i);
    let parts: Vec<Mesh> = (0..10).map(|i| sphere(3, dvec3(4.0 * (1.0 - radius(i)), 0.0, 0.0), radius(i))).collect();
    together(&parts)
}

/// Returns a random number generator for tests.
pub fn random(seed: u64) -> Random {
    spectral_remesh::stages::base::rng::stream(seed, spectral_remesh::stages::base::rng::Stage::Distance)
}
