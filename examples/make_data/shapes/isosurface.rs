//! Marching cubes without a table: in each cell of a grid, the surface is traced around the six sides of the cell.
//!
//! The corners of a side are visited counter-clockwise, as seen from outside the cell. Each run of corners inside the
//! surface is cut off by one segment, from where the walk enters the run to where it leaves it. The two cells at a side
//! agree on these segments, so the surface has no gaps. Within a cell, the segments form closed loops, which become triangle
//! fans. Where the surface passes close to a grid point, the fans have slivers, as is usual for this method.

use super::build::snap;
use glam::{DVec3, UVec3};
use spectral_remesh::Mesh;
use std::collections::BTreeMap;

/// A box of cubic cells.
pub struct Grid {
    pub origin: DVec3,
    /// Edge length of a cell.
    pub cell: f64,
    /// Numbers of cells along x, y and z.
    pub cells: UVec3,
}

/// The sides of a cell, counter-clockwise seen from outside. Corners are numbered by bits: x + 2 y + 4 z.
const SIDES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// Minimum distance between a grid point and a crossing of the surface with a grid edge, in cells. Smaller values lead to
/// longer slivers; zero lets vertices coincide.
const MARGIN: f64 = 0.02;

/// An edge of the grid, given by the numbers of its two grid points, the lower first.
type Edge = [usize; 2];

/// Returns the surface on which `field` is zero; it is positive outside.
pub fn isosurface(grid: &Grid, field: impl Fn(DVec3) -> f64) -> Mesh {
    let nodes = grid.cells + 1;
    let [nx, ny, nz] = nodes.to_array().map(|n| n as usize);
    let point = |n: usize| {
        let at = DVec3::new((n % nx) as f64, (n / nx % ny) as f64, (n / nx / ny) as f64);
        grid.origin + grid.cell * at
    };
    let value: Vec<f64> = (0..nx * ny * nz).map(|n| field(point(n))).collect();
    let mut mesh = Mesh::default();
    let mut vertex_on: BTreeMap<Edge, u32> = BTreeMap::new();
    for n in 0..value.len() {
        if n % nx == nx - 1 || n / nx % ny == ny - 1 || n / nx / ny == nz - 1 {
            continue;
        }
        let corners: [usize; 8] = std::array::from_fn(|c| n + (c & 1) + (c >> 1 & 1) * nx + (c >> 2) * nx * ny);
        for edges in loops(&corners, &value) {
            let ids: Vec<u32> = edges
                .iter()
                .map(|&edge| {
                    *vertex_on.entry(edge).or_insert_with(|| {
                        let [a, b] = edge;
                        let t = (value[a] / (value[a] - value[b])).clamp(MARGIN, 1.0 - MARGIN);
                        mesh.positions.push(snap(point(a).lerp(point(b), t)));
                        mesh.positions.len() as u32 - 1
                    })
                })
                .collect();
            mesh.triangles.extend(ids[1..].windows(2).map(|w| [ids[0], w[0], w[1]]));
        }
    }
    mesh
}

/// Returns the loops in which the surface intersects a cell, each as the grid edges that it crosses.
fn loops(corners: &[usize; 8], value: &[f64]) -> Vec<Vec<Edge>> {
    let mut next: BTreeMap<Edge, Edge> = SIDES.iter().flat_map(|side| segments(side, corners, value)).collect();
    let mut found = Vec::new();
    while let Some((first, mut at)) = next.pop_first() {
        let mut edges = vec![first];
        while at != first {
            edges.push(at);
            at = next.remove(&at).expect("segments close to loops");
        }
        found.push(edges);
    }
    found
}

/// Returns the segments on one side of a cell, each from the edge where the walk enters the inside to the edge where it
/// leaves it.
fn segments(side: &[usize; 4], corners: &[usize; 8], value: &[f64]) -> Vec<(Edge, Edge)> {
    let inside = |k: usize| value[corners[side[k % 4]]] < 0.0;
    let edge = |k: usize| {
        let (a, b) = (corners[side[k % 4]], corners[side[(k + 1) % 4]]);
        [a.min(b), a.max(b)]
    };
    let entries = (0..4).filter(|&k| !inside(k) && inside(k + 1));
    entries
        .map(|entry| {
            let leave = (entry + 1..entry + 4).find(|&k| inside(k) && !inside(k + 1)).expect("a corner is outside");
            (edge(entry), edge(leave))
        })
        .collect()
}
