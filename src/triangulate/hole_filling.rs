//! Fills the holes between the agreed triangles: mostly quadrilaterals of cocircular samples, in which either diagonal is
//! right, and occasionally a place that the samples do not resolve.
//!
//! The sides that still need a triangle are chained into polygons, each side followed by the next one around its end. Each
//! polygon is triangulated so that the smallest angle is maximal and, if possible, no triangle faces away from the surface.
//! No existing edge is created again. Polygons that cannot be filled stay open, which the subsequent verification detects.
//!
//! Cost: cubic in the sides of a polygon, of which there are nearly always four or five.

use crate::base::math;
use crate::geom::triangle::angles;
use crate::mesh::sides::lower_first;
use crate::triangulate::star::INTERIOR;
use glam::DVec3;
use std::collections::HashSet;

/// Polygons with more sides stay open: they would take a second each.
const MOST_SIDES: usize = 200;

/// Appends to `triangles` those that fill the boundary loops `to_fill`, which are polygons with the hole on their left.
/// `successor` has the next sample on a boundary. Triangles should have at least the cosine `least_facing` with the mean
/// normal of their corners.
pub fn fill_holes(
    positions: &[DVec3],
    normals: &[DVec3],
    successor: &[u32],
    to_fill: impl Fn(&[u32]) -> bool,
    least_facing: f64,
    triangles: &mut Vec<[u32; 3]>,
) {
    let open = open_sides(successor, triangles);
    let polygons = chain(positions, normals, &open);
    if polygons.is_empty() {
        return;
    }
    let ends: HashSet<u32> = open.iter().flatten().copied().collect();
    let near = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: HashSet<[u32; 2]> =
        near.filter(|e| ends.contains(&e[0]) && ends.contains(&e[1])).map(lower_first).collect();
    edges.extend(open.iter().map(|&e| lower_first(e)));
    for polygon in polygons.into_iter().filter(|p| to_fill(p)) {
        if let Some(filling) = triangulate_polygon(positions, normals, &polygon, &edges, least_facing) {
            edges.extend(filling.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(lower_first));
            triangles.extend(filling);
        }
    }
}

/// Returns the boundary loops of `triangles`, as polygons with the hole on their left.
pub fn boundary_loops(
    positions: &[DVec3],
    normals: &[DVec3],
    successor: &[u32],
    triangles: &[[u32; 3]],
) -> Vec<Vec<u32>> {
    chain(positions, normals, &open_sides(successor, triangles))
}

/// Returns the directed sides without a triangle on their left, sorted: those with one on their right, and those of the
/// boundary.
fn open_sides(successor: &[u32], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let closed = closed_fans(successor.len(), triangles);
    let is_open = |v: u32| !closed[v as usize] || successor[v as usize] != INTERIOR;
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<[u32; 2]> = sides.filter(|s| is_open(s[0]) && is_open(s[1])).collect();
    sides.sort_unstable();
    let taken = |side: &[u32; 2]| sides.binary_search(side).is_ok();
    let along = (0..successor.len() as u32).map(|v| [v, successor[v as usize]]).filter(|s| s[1] != INTERIOR);
    let across = sides.iter().filter(|s| successor[s[0] as usize] != s[1]).map(|&[a, b]| [b, a]);
    let mut open: Vec<[u32; 2]> = along.chain(across).filter(|s| !taken(s)).collect();
    open.sort_unstable();
    open.dedup();
    open
}

/// Returns whether each vertex has triangles all around it.
pub(super) fn closed_fans(vertices: usize, triangles: &[[u32; 3]]) -> Vec<bool> {
    closed_stars(vertices, triangles.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]))
}

/// Returns whether the triangles with each vertex as their first corner go all around it; also true without any. Around a
/// closed star, every neighbour is once the second and once the third corner, so any numbers assigned to them have the same
/// sum over both.
pub(super) fn closed_stars(vertices: usize, triangles: impl Iterator<Item = [u32; 3]>) -> Vec<bool> {
    let mut sums_of_fans = vec![0u64; vertices];
    for [v, from, to] in triangles {
        let sum = &mut sums_of_fans[v as usize];
        *sum = sum.wrapping_add(scrambled(to)).wrapping_sub(scrambled(from));
    }
    sums_of_fans.into_iter().map(|sum| sum == 0).collect()
}

/// A 64-bit number that looks random (the mixing of SplitMix64), so that no two open fans cancel each other.
fn scrambled(v: u32) -> u64 {
    let mut x = u64::from(v).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Chains open sides into closed polygons.
fn chain(positions: &[DVec3], normals: &[DVec3], open: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut used = vec![false; open.len()];
    let mut polygons = Vec::new();
    for first in 0..open.len() {
        let mut polygon = Vec::new();
        let mut side = first;
        while !used[side] {
            used[side] = true;
            polygon.push(open[side][0]);
            match following(positions, normals, open, &used, open[side], first) {
                Some(next) => side = next,
                None => break,
            }
        }
        if side == first && polygon.len() >= 3 {
            polygons.push(polygon);
        }
    }
    polygons
}

/// Returns the open side that continues from the end of `from`: the first one clockwise around it, seen from outside.
fn following(
    positions: &[DVec3],
    normals: &[DVec3],
    open: &[[u32; 2]],
    used: &[bool],
    from: [u32; 2],
    first: usize,
) -> Option<usize> {
    let [back, at] = from;
    let begin = open.partition_point(|s| s[0] < at);
    let out = (begin..open.len()).take_while(|&i| open[i][0] == at).filter(|&i| !used[i] || i == first);
    let normal = normals[at as usize];
    let flat = |v: u32| (positions[v as usize] - positions[at as usize]).reject_from(normal);
    let reference = flat(back);
    let clockwise = |i: usize| {
        let d = flat(open[i][1]);
        let angle = -math::atan2(normal.dot(reference.cross(d)), reference.dot(d));
        if angle <= 0.0 { angle + std::f64::consts::TAU } else { angle }
    };
    out.min_by(|&i, &j| clockwise(i).total_cmp(&clockwise(j)).then(i.cmp(&j)))
}

/// Returns the triangulation of a polygon with the largest minimum angle, without diagonals that are edges already; `None`
/// if there is none, or if the polygon touches itself or is too large.
fn triangulate_polygon(
    positions: &[DVec3],
    normals: &[DVec3],
    polygon: &[u32],
    edges: &HashSet<[u32; 2]>,
    least_facing: f64,
) -> Option<Vec<[u32; 3]>> {
    let n = polygon.len();
    let distinct: HashSet<u32> = polygon.iter().copied().collect();
    if n > MOST_SIDES || distinct.len() < n {
        return None;
    }
    let usable = |i: usize, j: usize| {
        j == i + 1 || (i == 0 && j == n - 1) || !edges.contains(&lower_first([polygon[i], polygon[j]]))
    };
    // For diagonal i j, the goodness of the best triangulation of the part from i to j, and the apex of its triangle on the
    // diagonal.
    let mut best: Vec<Option<(f64, usize)>> = vec![None; n * n];
    for length in 1..n {
        for i in 0..n - length {
            let j = i + length;
            if length == 1 {
                best[n * i + j] = Some((f64::INFINITY, i));
            } else if usable(i, j) {
                let choice = (i + 1..j).filter_map(|k| {
                    let (left, right) = (best[n * i + k]?.0, best[n * k + j]?.0);
                    let own = goodness([i, k, j].map(|c| polygon[c] as usize), positions, normals, least_facing);
                    Some((own.min(left).min(right), k))
                });
                best[n * i + j] = choice.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
            }
        }
    }
    let mut filling = Vec::with_capacity(n - 2);
    let mut parts = vec![(0, n - 1)];
    while let Some((i, j)) = parts.pop() {
        if j > i + 1 {
            let k = best[n * i + j]?.1;
            filling.push([polygon[i], polygon[k], polygon[j]]);
            parts.extend([(i, k), (k, j)]);
        }
    }
    Some(filling)
}

/// Smallest angle of a triangle; negative for a triangle that faces away from the surface.
fn goodness(triangle: [usize; 3], positions: &[DVec3], normals: &[DVec3], least_facing: f64) -> f64 {
    let corners = triangle.map(|v| positions[v]);
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let facing = triangle.into_iter().map(|v| normals[v]).sum::<DVec3>().normalize_or_zero().dot(normal);
    let smallest_angle = angles(corners).into_iter().fold(f64::INFINITY, f64::min);
    if facing > least_facing { smallest_angle } else { facing - 1.0 }
}
