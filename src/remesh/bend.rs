//! The implicit surface of a mesh's vertices: where they are without their noise, and what lies between them.
//!
//! Points that are farther apart than the vertices of the result say where the surface goes between them only together
//! with their normals. The triangles between them are split where it bends, and the new vertices projected on the implicit
//! surface. That misses the points by a little; by how much is given back, between them as at them, so that they stay where
//! they are. What is projected on later is the split mesh, which is that surface but for a share of the spacing.
//!
//! Cost: linear in the triangles; some fifty microseconds for each new vertex and each point around one.
//!
//! Limits: sharp edges, the boundary, triangles over gaps, and places where the result would fold or cross itself stay
//! flat.

use crate::project::rimls::Rimls;
use crate::surface::bvh::Bvh;
use crate::surface::crossings::crossing_faces;
use crate::surface::graph::{DEGREE, NeighborGraph};
use crate::surface::mesh::Mesh;
use crate::surface::neighbors::{Neighbor, Neighbors};
use crate::surface::normals::{MANY_NEIGHBORS, Neighborhood, sphere_normals};
use crate::surface::points::Points;
use crate::surface::refine::halve_edges;
use glam::DVec3;
use rayon::prelude::*;

/// How far from the surface its triangles may be, and the shortest edge that is split for it, in mean spacings of the
/// result.
const TOLERANCE: f64 = 0.02;
const SHORTEST_SPLIT: f64 = 0.75;

/// Longest edge over which the surface is taken to bend, in distances of the points there: longer ones are over gaps.
const LONGEST_CHORD: f64 = 2.0;

/// Highest that a new vertex rises over the triangle that it was on, as a share of the edge between points there: an arc
/// of a quarter of a circle rises by a fifth of its chord.
const HIGHEST_RISE: f64 = 0.25;

/// Cosine of the most that a split triangle is turned by.
const MOST_TURN: f64 = 0.5;

/// Rings around a new vertex with all the points that it depends on: as far as one reaches, and its normal's neighbours.
const RINGS: usize = 5;

/// Points with normals, and what their implicit surface takes.
struct Cloud {
    points: Points,
    near: Neighbors,
    spacings: Vec<f64>,
}

impl Cloud {
    /// The vertices `of_mesh`, which look as the triangles there do.
    fn new(mesh: &Mesh, of_mesh: &[u32]) -> Cloud {
        let normals = mesh.vertex_area_vectors().into_iter().map(DVec3::normalize_or_zero).collect();
        let Points { positions, normals } = Points { positions: mesh.positions.clone(), normals }.pick(of_mesh);
        let near = Neighbors::new(&positions);
        let graph = NeighborGraph::new(&positions, &near, DEGREE);
        let spacings = graph.spacings(&positions);
        let normals = sphere_normals(&positions, &normals, &Neighborhood::Nearest(&graph, MANY_NEIGHBORS));
        Cloud { points: Points { positions, normals }, near, spacings }
    }

    fn surface(&self, reach: f64) -> Rimls<'_> {
        Rimls::new(&self.points.positions, &self.points.normals, &self.near, &self.spacings, reach)
    }
}

/// `mesh` with its vertices on the implicit surface of their own places and normals, each reaching as far as `reach`
/// times how far apart they are.
pub(super) fn smoothed(mesh: &Mesh, reach: f64) -> Mesh {
    let all: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let (positions, _) = Cloud::new(mesh, &all).surface(reach).smoothed();
    Mesh { positions, triangles: mesh.triangles.clone() }
}

/// Splits the edges of `mesh` that are longer than `longest` or that the surface bends away from by more than the
/// tolerance, at most to `most` triangles. `spacing` is that of the result. Gives for each new vertex the two that it is in
/// the middle of; they come after all others.
pub(super) fn split_bent(mesh: &mut Mesh, longest: f64, spacing: f64, most: usize) -> Vec<[u32; 2]> {
    let mut normals: Vec<DVec3> = mesh.vertex_area_vectors().into_iter().map(DVec3::normalize_or_zero).collect();
    let mut all_ends = Vec::new();
    while mesh.triangles.len() < most {
        let is_bent = |a: u32, b: u32, length: f64| {
            let turn = normals[a as usize].distance(normals[b as usize]);
            length > SHORTEST_SPLIT * spacing && length * turn > 8.0 * TOLERANCE * spacing
        };
        let ends = halve_edges(mesh, |a, b, length| length > longest || is_bent(a, b, length));
        if ends.is_empty() {
            break;
        }
        let middle = |&[a, b]: &[u32; 2]| (normals[a as usize] + normals[b as usize]).normalize_or_zero();
        normals.extend(ends.iter().map(middle).collect::<Vec<DVec3>>());
        all_ends.extend(ends);
    }
    all_ends
}

/// Puts the last vertices of `mesh`, those between two `ends` each, on the implicit surface of those before them, each of
/// which reaches as far as `reach` times how far apart they are. Vertices at sides `3 t + k` that `stays` says stay.
pub(super) fn bend(mesh: &mut Mesh, ends: &[[u32; 2]], stays: impl Fn(usize) -> bool, reach: f64) {
    let count = mesh.positions.len() - ends.len();
    let cloud = Cloud::new(mesh, &points_around(mesh, count));
    let surface = cloud.surface(reach);
    let stays = corners_of_sides(mesh, stays);
    let (miss, highest) = at_ends(mesh, ends, &surface);
    let rise = |found: &mut Vec<Neighbor>, v: usize| {
        if stays[v] || highest[v] == 0.0 {
            return None;
        }
        let (projected, _) = surface.project(mesh.positions[v], found)?;
        let rise = projected - miss[v] - mesh.positions[v];
        (rise.length() <= highest[v]).then_some(rise)
    };
    let rises = (count..mesh.positions.len()).into_par_iter().map_init(Vec::new, rise).collect();
    raise(mesh, count, rises);
}

/// The first `count` vertices of `mesh` that the others have to do with.
fn points_around(mesh: &Mesh, count: usize) -> Vec<u32> {
    let mut is_near: Vec<bool> = (0..mesh.positions.len()).map(|v| v >= count).collect();
    for _ in 0..RINGS {
        let around: Vec<[u32; 3]> =
            mesh.triangles.iter().filter(|t| t.iter().any(|&v| is_near[v as usize])).copied().collect();
        around.iter().flatten().for_each(|&v| is_near[v as usize] = true);
    }
    (0..count as u32).filter(|&v| is_near[v as usize]).collect()
}

/// For each vertex of `mesh` by how much the surface misses it, zero at those that no edge between points was split at, and
/// how high it may rise if it is between two `ends`.
fn at_ends(mesh: &Mesh, ends: &[[u32; 2]], surface: &Rimls) -> (Vec<DVec3>, Vec<f64>) {
    let count = mesh.positions.len() - ends.len();
    let mut is_end = vec![false; mesh.positions.len()];
    ends.iter().flatten().for_each(|&v| is_end[v as usize] = true);
    let at_point = |found: &mut Vec<Neighbor>, v: usize| {
        let here = mesh.positions[v];
        if !is_end[v] {
            return (DVec3::ZERO, 0.0);
        }
        let spacing = surface.nearest(here, found).map_or(0.0, |(nearest, _)| surface.spacing(nearest.point));
        (surface.project(here, found).map_or(DVec3::ZERO, |(there, _)| there - here), spacing)
    };
    let (mut miss, spacing): (Vec<DVec3>, Vec<f64>) =
        (0..count).into_par_iter().map_init(Vec::new, at_point).unzip();
    let mut highest = vec![0.0f64; count];
    for [a, b] in ends.iter().map(|ends| ends.map(|v| v as usize)) {
        miss.push((miss[a] + miss[b]) / 2.0);
        let chord = mesh.positions[a].distance(mesh.positions[b]);
        highest.push(if a.max(b) >= count {
            highest[a].max(highest[b])
        } else if chord <= LONGEST_CHORD * spacing[a].max(spacing[b]) {
            HIGHEST_RISE * chord
        } else {
            0.0
        });
    }
    (miss, highest)
}

/// For each vertex of `mesh` whether one of these sides begins or ends there.
fn corners_of_sides(mesh: &Mesh, is_one: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut corners = vec![false; mesh.positions.len()];
    for side in (0..3 * mesh.triangles.len()).filter(|&side| is_one(side)) {
        for k in [side % 3, (side + 1) % 3] {
            corners[mesh.triangles[side / 3][k] as usize] = true;
        }
    }
    corners
}

/// Moves the vertices from number `first` on, but for those of triangles that would turn over or cross others.
fn raise(mesh: &mut Mesh, first: usize, mut rises: Vec<Option<DVec3>>) {
    let flat = mesh.clone();
    loop {
        for (v, rise) in (first..).zip(&rises) {
            mesh.positions[v] = flat.positions[v] + rise.unwrap_or_default();
        }
        let has_risen = |t: &u32| {
            let corners = mesh.triangles[*t as usize];
            corners.iter().any(|&v| (v as usize).checked_sub(first).is_some_and(|v| rises[v].is_some()))
        };
        let risen: Vec<u32> = (0..mesh.triangles.len() as u32).filter(has_risen).collect();
        let turns = |&t: &u32| {
            let (before, after) = (flat.area_vector(t as usize), mesh.area_vector(t as usize));
            before.dot(after) < MOST_TURN * before.length() * after.length()
        };
        let turned: Vec<u32> = risen.iter().copied().filter(turns).collect();
        let bad = if turned.is_empty() { crossing_among(mesh, &risen) } else { turned };
        let corners = bad.into_iter().flat_map(|t| mesh.triangles[t as usize]);
        let lowered = corners.filter_map(|v| rises[(v as usize).checked_sub(first)?].take()).count();
        if lowered == 0 {
            return;
        }
    }
}

/// Of `triangles` those that cross others of the mesh, and those.
fn crossing_among(mesh: &Mesh, triangles: &[u32]) -> Vec<u32> {
    let soup = |of: &[u32]| Mesh::soup(of.iter().map(|&t| mesh.corners(t as usize)));
    let some = soup(triangles);
    let boxes = Bvh::new(&some);
    let meets = |&t: &u32| {
        let [a, b, c] = mesh.corners(t as usize);
        let mut any = false;
        boxes.in_box(&some, a.min(b).min(c), a.max(b).max(c), |_| any = true);
        any
    };
    let around: Vec<u32> = (0..mesh.triangles.len() as u32).into_par_iter().filter(meets).collect();
    crossing_faces(&soup(&around)).into_iter().map(|t| around[t as usize]).collect()
}
