//! The boundary loops between the stars of a cloud's points: holes of the scan stay open, all other loops are filled.
//!
//! A loop is no hole if the stars around it are complete and merely inconsistent, if it has only a few sides, or if it
//! bounds a flat face, which needs no points inside. Points with several fans of triangles keep the largest one, so every
//! loop is a simple polygon, which is triangulated. If that fails, the triangles around the loop are removed, and the larger
//! loop is tried.
//!
//! Cost: a few sorts of the sides of the triangles.

use crate::base::csr::Csr;
use crate::geom::aabb::Aabb;
use crate::geom::eigen::{eigen, scatter};
use crate::mesh::topology::components;
use crate::mesh::triangle_mesh::{Mesh, used_vertices};
use crate::spatial::self_intersections::self_intersections;
use crate::triangulate::agreement::agreed_by_most;
use crate::triangulate::hole_filling::{boundary_loops, closed_fans, closed_stars, fill_holes};
use crate::triangulate::star::INTERIOR;
use crate::triangulate::surroundings::Surroundings;
use glam::DVec3;
use std::collections::HashSet;

/// Criteria for which boundary loops are holes.
#[derive(Debug, Clone, Copy)]
pub struct HoleCriteria {
    /// Triangles with a larger circumradius, in spacings of their corners, span a hole.
    pub largest_circumradius: f64,
    /// Loops with at most this many sides, each about a spacing long, are no holes.
    pub most_sides: usize,
    /// Largest distance of points from the plane that they lie in, in spacings.
    pub noise: f64,
    /// Loops whose bounding box has at most this diagonal are no holes.
    pub smallest_diagonal: f64,
    /// Whether flat faces need no points inside, which makes loops around them no holes.
    pub flat_are_closed: bool,
}

/// Triangles with at most one fan at each point.
pub struct Filled {
    /// The triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Number of holes left open.
    pub holes: usize,
    /// Number of components dropped because they have too few points for a surface.
    pub shreds: usize,
    /// Number of points that had triangles in them.
    pub in_shreds: usize,
}

/// Largest circumradius, in spacings, of a triangle that is accepted although it is in the stars of only two of its corners:
/// larger ones lie beside a hole.
const DOUBTFUL: f64 = 0.65;

/// Minimum cosine between a triangle that fills a loop and the mean normal of its corners, where that is possible.
const LEAST_COSINE: f64 = 0.2;

/// Number of rounds of filling loops and widening those that cannot be filled.
const ROUNDS: usize = 6;

/// Components with fewer points than this are no surface; those with a boundary need more.
const FEWEST_POINTS: usize = 8;
const FEWEST_POINTS_OF_OPEN: usize = 64;

/// At least one in this many points around a hole has a star that is not closed.
const ENDS: usize = 2;

/// Minimum share of the points around a flat place that lie in its plane, and the largest distance from it, as a share of
/// its width; [`HoleCriteria::noise`] may allow more.
const IN_PLANE: f64 = 0.8;
const THICKNESS: f64 = 0.03;

/// Minimum share of the points around a flat place whose normals clearly differ from its own; the cosines from which normals
/// agree, and up to which they clearly differ.
const MANY_APART: f64 = 0.05;
const ALIKE: f64 = 0.98;
const APART: f64 = 0.94;

/// Minimum share of the points with differing normals that lean the same way, outwards or inwards: all around a face there
/// are walls, while around a hole in a slightly curved surface normals lean either way.
const ONE_WAY: f64 = 0.8;

/// Mean cosine between the normals around a loop and its own, below which the loop is the outer boundary of a surface.
const OUTSIDE: f64 = -0.5;

/// Returns the triangles on which stars agree, and those that fill the boundary loops which are no holes.
pub fn fill_boundary_loops(points: Surroundings<'_>, stars: &[[u32; 3]], criteria: HoleCriteria) -> Filled {
    let stars: Vec<[u32; 3]> =
        stars.iter().copied().filter(|t| points.relative_circumradius(*t) <= criteria.largest_circumradius).collect();
    let ends = ends(&stars, points.positions.len());
    let successor = vec![INTERIOR; points.positions.len()];
    let mut triangles = agreed_by_most(&stars, DOUBTFUL, |t| points.relative_circumradius(t));
    drop(stars);
    let pieces = Pieces::of(&triangles, points.positions.len());
    let is_hole = |polygon: &[u32]| is_hole(points, &ends, criteria, polygon);
    let mut is_filled = vec![false; points.positions.len()];
    for _ in 0..ROUNDS {
        keep_largest_fans(&mut triangles, points.positions.len());
        drop_islands(&mut triangles, &[], points.positions.len());
        let before = triangles.len();
        fill_holes(points.positions, points.normals, &successor, |p| !is_hole(p), LEAST_COSINE, &mut triangles);
        triangles[before..].iter().flatten().for_each(|&p| is_filled[p as usize] = true);
        keep_largest_fans(&mut triangles, points.positions.len());
        let mut left = boundary_loops(points.positions, points.normals, &successor, &triangles);
        left.retain(|polygon| !is_hole(polygon));
        let mut is_bad = vec![false; points.positions.len()];
        left.iter().flatten().for_each(|&p| is_bad[p as usize] = true);
        let crossing = if left.is_empty() { self_intersecting(points, &triangles, &is_filled) } else { HashSet::new() };
        if left.is_empty() && crossing.is_empty() {
            break;
        }
        triangles.retain(|t| !crossing.contains(t) && !t.iter().any(|&p| is_bad[p as usize]));
    }
    keep_largest_fans(&mut triangles, points.positions.len());
    let holes = boundary_loops(points.positions, points.normals, &successor, &triangles);
    drop_islands(&mut triangles, &holes, points.positions.len());
    let left = boundary_loops(points.positions, points.normals, &successor, &triangles);
    let holes = left.iter().filter(|polygon| is_hole(polygon)).count();
    let (shreds, in_shreds) = pieces.dropped(&triangles);
    Filled { triangles, holes, shreds, in_shreds }
}

/// The components of the triangles on which stars agree.
struct Pieces {
    /// Component of each point.
    number: Vec<u32>,
    has_triangle: Vec<bool>,
}

impl Pieces {
    fn of(triangles: &[[u32; 3]], points: usize) -> Pieces {
        Pieces { number: components(points, triangles), has_triangle: used_vertices(triangles, points) }
    }

    /// Returns how many of them have no point in `triangles`, and how many points those have.
    fn dropped(&self, triangles: &[[u32; 3]]) -> (usize, usize) {
        let points = self.number.len();
        let (mut stays, mut sizes) = (vec![false; points], vec![0; points]);
        for (piece, is_used) in self.number.iter().zip(used_vertices(triangles, points)) {
            stays[*piece as usize] |= is_used;
        }
        let lost = |p: &usize| self.has_triangle[*p] && !stays[self.number[*p] as usize];
        (0..points).filter(lost).for_each(|p| sizes[self.number[p] as usize] += 1);
        (sizes.iter().filter(|size| **size > 0).count(), sizes.iter().sum())
    }
}

/// Returns the self-intersecting triangles around points where a loop was filled.
fn self_intersecting(points: Surroundings<'_>, triangles: &[[u32; 3]], is_filled: &[bool]) -> HashSet<[u32; 3]> {
    let is_near = |t: &&[u32; 3]| t.iter().any(|&p| is_filled[p as usize]);
    let near: Vec<[u32; 3]> = triangles.iter().filter(is_near).copied().collect();
    let mut mesh = Mesh { positions: points.positions.to_vec(), triangles: near.clone() };
    mesh.drop_unused();
    self_intersections(&mesh).into_iter().map(|t| near[t as usize]).collect()
}

/// Returns whether each point has no star, or one that is not closed.
fn ends(stars: &[[u32; 3]], points: usize) -> Vec<bool> {
    let mut ends = vec![true; points];
    let closed = closed_stars(points, stars.iter().copied());
    stars.iter().for_each(|&[centre, ..]| ends[centre as usize] = !closed[centre as usize]);
    ends
}

fn is_hole(points: Surroundings<'_>, ends: &[bool], criteria: HoleCriteria, polygon: &[u32]) -> bool {
    let open = polygon.iter().filter(|&&p| ends[p as usize]).count();
    if ENDS * open < polygon.len() {
        return false;
    }
    let rim: Vec<DVec3> = polygon.iter().map(|&p| points.positions[p as usize]).collect();
    let normal = area_vector(&rim).normalize_or_zero();
    let facing = polygon.iter().map(|&p| points.normals[p as usize].dot(normal)).sum::<f64>() / rim.len() as f64;
    let is_flat = criteria.flat_are_closed && is_flat_place(points, criteria, polygon);
    let sides = polygon.iter().zip(&rim).zip(rim.iter().cycle().skip(1));
    let length: f64 = sides.map(|((&p, a), b)| a.distance(*b) / points.spacings[p as usize]).sum();
    let has_few_sides = polygon.len() <= criteria.most_sides && length <= criteria.most_sides as f64;
    let is_small = has_few_sides
        || Aabb::of(rim.iter().copied()).is_none_or(|bounds| bounds.diagonal() <= criteria.smallest_diagonal);
    facing < OUTSIDE || !is_flat && !is_small
}

/// Area vector of a polygon: twice its area times its normal, if it is flat.
fn area_vector(rim: &[DVec3]) -> DVec3 {
    let origin = rim[0];
    rim.windows(2).map(|side| (side[0] - origin).cross(side[1] - origin)).sum()
}

/// Returns whether a loop bounds a flat face, as of a machine part, with points on its sharp rim only: most points of the
/// loop lie in one plane, some have its normal, and the others lean the same way.
fn is_flat_place(points: Surroundings<'_>, criteria: HoleCriteria, polygon: &[u32]) -> bool {
    let mut rim: Vec<DVec3> = polygon.iter().map(|&p| points.positions[p as usize]).collect();
    let (mut mean, mut normal, width) = plane(&rim);
    let height = |p: &DVec3, mean: DVec3, normal: DVec3| (p - mean).dot(normal).abs();
    rim.sort_by(|a, b| height(a, mean, normal).total_cmp(&height(b, mean, normal)));
    let core = (IN_PLANE * rim.len() as f64).ceil() as usize;
    (mean, normal, _) = plane(&rim[..core]);
    let spacing = polygon.iter().map(|&p| points.spacings[p as usize]).sum::<f64>() / rim.len() as f64;
    let thickness = (THICKNESS * width).max(criteria.noise * spacing);
    let in_plane = rim.iter().filter(|p| height(p, mean, normal) < thickness).count();
    let cosine = |p: u32| points.normals[p as usize].dot(normal).abs();
    let apart = polygon.iter().filter(|&&p| cosine(p) <= APART).count();
    let turned: Vec<u32> = polygon.iter().copied().filter(|&p| cosine(p) <= ALIKE).collect();
    let lean = |p: u32| points.normals[p as usize].dot((points.positions[p as usize] - mean).reject_from(normal));
    let outward = turned.iter().filter(|&&p| lean(p) > 0.0).count();
    let one_way = outward.max(turned.len() - outward);
    in_plane >= core
        && turned.len() < polygon.len()
        && apart as f64 >= MANY_APART * polygon.len() as f64
        && one_way as f64 >= ONE_WAY * turned.len() as f64
}

/// Returns the mean of points, the normal of their best-fit plane, and their standard deviation in the direction of the
/// second largest extent.
fn plane(points: &[DVec3]) -> (DVec3, DVec3, f64) {
    let (mean, scatter) = scatter(points.iter().copied());
    let (values, vectors) = eigen(scatter);
    (mean, vectors[0], (values[1] / points.len() as f64).max(0.0).sqrt())
}

/// Removes triangles until every point has a single fan of them, its largest.
fn keep_largest_fans(triangles: &mut Vec<[u32; 3]>, points: usize) {
    let corners = Csr::new(points, || triangles.iter().flatten().copied().zip(0u32..));
    let mut gone = vec![false; triangles.len()];
    let closed = closed_fans(points, triangles);
    for p in (0..points as u32).filter(|&p| !closed[p as usize] || corners.row(p).len() > 5) {
        beside_largest_fan(triangles, corners.row(p), |t| gone[t] = true);
    }
    let mut gone = gone.into_iter();
    triangles.retain(|_| !gone.next().unwrap_or(false));
}

/// Calls `remove` with the triangles outside the largest fan among those with `corners` at one point.
fn beside_largest_fan(triangles: &[[u32; 3]], corners: &[u32], mut remove: impl FnMut(usize)) {
    let from = |c: u32| triangles[c as usize / 3][(c as usize + 1) % 3];
    let to = |c: u32| triangles[c as usize / 3][(c as usize + 2) % 3];
    let follows = |c: u32| corners.iter().position(|&d| from(d) == to(c));
    let mut fan = vec![usize::MAX; corners.len()];
    let mut sizes: Vec<usize> = Vec::new();
    let begins = |i: &usize| !corners.iter().any(|&d| to(d) == from(corners[*i]));
    // Open fans first, then closed ones.
    for first in (0..corners.len()).filter(begins).chain(0..corners.len()) {
        let mut at = Some(first);
        let mut size = 0;
        while let Some(i) = at.filter(|&i| fan[i] == usize::MAX) {
            fan[i] = sizes.len();
            size += 1;
            at = follows(corners[i]);
        }
        if size > 0 {
            sizes.push(size);
        }
    }
    if sizes.len() > 1 {
        let largest = (0..sizes.len()).max_by_key(|&f| (sizes[f], usize::MAX - f)).unwrap_or(0);
        (0..corners.len()).filter(|&i| fan[i] != largest).for_each(|i| remove(corners[i] as usize / 3));
    }
}

/// Removes the triangles of patches with few points; patches with `holes` need more points to stay.
fn drop_islands(triangles: &mut Vec<[u32; 3]>, holes: &[Vec<u32>], points: usize) {
    let patch = components(points, triangles);
    let mut sizes = vec![0usize; points];
    patch.iter().for_each(|&p| sizes[p as usize] += 1);
    let mut fewest = vec![FEWEST_POINTS; points];
    holes.iter().for_each(|hole| fewest[patch[hole[0] as usize] as usize] = FEWEST_POINTS_OF_OPEN);
    triangles.retain(|t| {
        let patch = patch[t[0] as usize] as usize;
        sizes[patch] >= fewest[patch]
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_keeps_its_largest_fan() {
        // Point 0 has a fan of two and a fan of one; point 9 has a closed one.
        let mut triangles = vec![[0, 1, 2], [0, 2, 3], [0, 4, 5], [9, 6, 7], [9, 7, 8], [9, 8, 6]];
        keep_largest_fans(&mut triangles, 10);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [9, 6, 7], [9, 7, 8], [9, 8, 6]]);
    }

    #[test]
    fn stars_end_where_they_are_not_closed() {
        let stars = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 2, 0], [1, 0, 3]];
        assert_eq!(ends(&stars, 3), [false, true, true]);
    }
}
