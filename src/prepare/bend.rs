//! Moves the vertices of a mesh onto their implicit surface to remove noise, and adds vertices where that surface bends
//! between them.
//!
//! Where points are farther apart than the vertices of the result, the surface between them is known only from the points
//! together with their normals. Triangles are split where it bends, and the new vertices are projected onto the implicit
//! surface. That surface misses the points by a little. This error is subtracted at the points and, interpolated, between
//! them, so that the points stay in place. Later projections use the split mesh, which is that surface up to a fraction of
//! the spacing.
//!
//! Cost: linear in the triangles; about ten microseconds for each new vertex and for each point next to one.
//!
//! Limits: sharp edges, the boundary, triangles over gaps, and places where the result would fold or intersect itself stay
//! flat.

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::refine::halve_edges;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::cloud_normals::{MANY_NEIGHBORS, Neighborhood, sphere_normals};
use crate::spatial::bvh::Bvh;
use crate::spatial::kdtree::Neighbors;
use crate::spatial::knn_graph::{DEGREE, NeighborGraph};
use crate::spatial::self_intersections::self_intersections;
use crate::surface::implicit::{Found, Rimls};
use glam::DVec3;

/// Maximum distance of triangles from the surface, and minimum length of an edge split for its sake, in mean spacings of the
/// result.
const TOLERANCE: f64 = 0.02;
const SHORTEST_SPLIT: f64 = 0.75;

/// Maximum length, in local point spacings, of an edge over which the surface is assumed to bend: longer edges span gaps.
const LONGEST_CHORD: f64 = 2.0;

/// Maximum rise of a new vertex above its triangle, as a share of the edge length between points there times the angle
/// between their normals, capped at one: an arc rises by one eighth.
const HIGHEST_RISE: f64 = 0.25;

/// Cosine of the largest angle by which a split triangle may turn.
const MOST_TURN: f64 = 0.5;

/// Number of rings around a new vertex that contain all points it depends on: the support radius of a point plus the
/// neighbours of its normal.
const RINGS: usize = 5;

/// Points with normals, and the data that their implicit surface needs.
struct Cloud {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    near: Neighbors,
    spacings: Vec<f64>,
}

impl Cloud {
    /// Makes a cloud of the vertices `of_mesh`, which face the same way as their triangles.
    fn new(mesh: &Mesh, of_mesh: &[u32]) -> Cloud {
        let normals: Vec<DVec3> = mesh.vertex_area_vectors().into_iter().map(DVec3::normalize_or_zero).collect();
        let pick = |list: &[DVec3]| of_mesh.iter().map(|&v| list[v as usize]).collect::<Vec<DVec3>>();
        let (positions, normals) = (pick(&mesh.positions), pick(&normals));
        let near = Neighbors::new(&positions);
        let graph = NeighborGraph::new(&positions, &near, DEGREE);
        let spacings = graph.spacings(&positions);
        let normals = sphere_normals(&positions, &normals, &Neighborhood::Nearest(&graph, MANY_NEIGHBORS));
        Cloud { positions, normals, near, spacings }
    }

    fn surface(&self, support: f64) -> Rimls<'_> {
        Rimls::new(&self.positions, &self.normals, &self.near, &self.spacings, support)
    }
}

/// Moves the vertices of `mesh` onto the implicit surface of their own positions and normals, with a support radius of
/// `support` times their spacing.
pub fn smooth(mesh: &mut OrientedManifold, support: f64) {
    let all: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let (positions, _) = Cloud::new(mesh, &all).surface(support).smoothed();
    mesh.positions_mut().copy_from_slice(&positions);
}

/// A mesh whose edges were split where its vertices indicate that the surface bends.
pub struct Split {
    /// For each new vertex, the ends of the edge whose midpoint it is. New vertices come after all others.
    ends: Vec<[u32; 2]>,
    /// Unit normals at all vertices; zero at sharp edges.
    normals: Vec<DVec3>,
}

impl Split {
    /// Splits the edges of `mesh` that are longer than `longest`, or from which the surface deviates by more than the
    /// tolerance, until there are `most` triangles. `sharp` says for each side `3 t + k` whether its edge is sharp;
    /// `spacing` is that of the result.
    pub fn new(mesh: &mut OrientedManifold, sharp: &[bool], longest: f64, spacing: f64, most: usize) -> Split {
        let mut split = Split { ends: Vec::new(), normals: steady_normals(mesh, sharp) };
        while mesh.triangles.len() < most {
            let is_long = |a: u32, b: u32, length: f64| {
                let bends = length * split.turn(a, b) > 8.0 * TOLERANCE * spacing;
                length > longest || bends && length > SHORTEST_SPLIT * spacing
            };
            let ends = halve_edges(mesh, is_long);
            if ends.is_empty() {
                break;
            }
            let middle =
                |&[a, b]: &[u32; 2]| (split.normals[a as usize] + split.normals[b as usize]).normalize_or_zero();
            let normals: Vec<DVec3> = ends.iter().map(middle).collect();
            split.normals.extend(normals);
            split.ends.extend(ends);
        }
        split
    }

    /// Returns whether no edge was split.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Returns approximately the angle between the normals at two vertices; zero at sharp edges.
    fn turn(&self, a: u32, b: u32) -> f64 {
        let [a, b] = [a, b].map(|v| self.normals[v as usize]);
        if a == DVec3::ZERO || b == DVec3::ZERO { 0.0 } else { a.distance(b) }
    }

    /// Moves the new vertices of `mesh` onto the implicit surface of the original ones, each of which reaches as far as
    /// `support` times its spacing. Vertices at a boundary stay, and so do those at a sharp edge, where points do not
    /// determine how the surface lies beside them. `twin` and `sharp` are as in [`Domain::with_sharp`].
    ///
    /// [`Domain::with_sharp`]: crate::surface::domain::Domain::with_sharp
    pub fn bend(&self, mesh: &mut OrientedManifold, twin: &[u32], sharp: &[bool], support: f64) {
        let count = mesh.positions.len() - self.ends.len();
        let at_sharp = corners_of_sides(mesh, |side| sharp[side]);
        let at_boundary = corners_of_sides(mesh, |side| twin[side] == NONE);
        let mut points = points_around(mesh, count);
        points.retain(|&v| !at_sharp[v as usize]);
        let cloud = Cloud::new(mesh, &points);
        let surface = cloud.surface(support);
        let (miss, highest) = self.at_ends(mesh, &surface, &at_sharp);
        let rise = |found: &mut Found, v: usize| {
            if at_sharp[v] || at_boundary[v] || highest[v] == 0.0 {
                return None;
            }
            let (projected, _) = surface.project(mesh.positions[v], found)?;
            let rise = projected - miss[v] - mesh.positions[v];
            Some(rise.clamp_length_max(highest[v]))
        };
        let rises = parallel::map_with(count..mesh.positions.len(), Found::default, rise);
        raise(mesh, count, rises);
    }

    /// Returns, for each vertex of `mesh`, by how much the surface misses it, and how far it may rise if it is new. Only
    /// points at which an edge was split count, and none `at_sharp` edges.
    fn at_ends(&self, mesh: &Mesh, surface: &Rimls, at_sharp: &[bool]) -> (Vec<DVec3>, Vec<f64>) {
        let count = mesh.positions.len() - self.ends.len();
        let mut is_end = vec![false; mesh.positions.len()];
        self.ends.iter().flatten().for_each(|&v| is_end[v as usize] = true);
        let at_point = |found: &mut Found, v: usize| {
            let here = mesh.positions[v];
            if !is_end[v] {
                return (DVec3::ZERO, 0.0);
            }
            let spacing = surface.nearest(here, found).map_or(0.0, |(nearest, _)| surface.spacing(nearest.point));
            let projected = if at_sharp[v] { None } else { surface.project(here, found) };
            (projected.map_or(DVec3::ZERO, |(there, _)| there - here), spacing)
        };
        let at_points = parallel::map_with(0..count, Found::default, at_point);
        let (mut miss, spacing): (Vec<DVec3>, Vec<f64>) = at_points.into_iter().unzip();
        let mut highest = vec![0.0f64; count];
        for &[v, w] in &self.ends {
            let [a, b] = [v, w].map(|v| v as usize);
            miss.push((miss[a] + miss[b]) / 2.0);
            let chord = mesh.positions[a].distance(mesh.positions[b]);
            highest.push(if a.max(b) >= count {
                highest[a].max(highest[b])
            } else if chord <= LONGEST_CHORD * spacing[a].max(spacing[b]) {
                HIGHEST_RISE * chord * self.turn(v, w).min(1.0)
            } else {
                0.0
            });
        }
        (miss, highest)
    }
}

/// Returns unit normals at the vertices, zero at sharp edges. They average over more triangles than those at the vertex, so
/// that noise is not taken for bending.
fn steady_normals(mesh: &Mesh, sharp: &[bool]) -> Vec<DVec3> {
    let at_sharp = corners_of_sides(mesh, |side| sharp[side]);
    let mut own = mesh.vertex_area_vectors();
    own.iter_mut().zip(&at_sharp).filter(|n| *n.1).for_each(|n| *n.0 = DVec3::ZERO);
    let mut around = own.clone();
    for corners in &mesh.triangles {
        let sum: DVec3 = corners.iter().map(|&v| own[v as usize]).sum();
        corners.iter().filter(|&&v| !at_sharp[v as usize]).for_each(|&v| around[v as usize] += sum);
    }
    around.into_iter().map(DVec3::normalize_or_zero).collect()
}

/// Returns the vertices among the first `count` of `mesh` on which the others depend.
fn points_around(mesh: &Mesh, count: usize) -> Vec<u32> {
    let mut is_near: Vec<bool> = (0..mesh.positions.len()).map(|v| v >= count).collect();
    mesh.grow(&mut is_near, RINGS);
    (0..count as u32).filter(|&v| is_near[v as usize]).collect()
}

/// Returns, for each vertex of `mesh`, whether a side for which `is_one` holds begins or ends there.
fn corners_of_sides(mesh: &Mesh, is_one: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut corners = vec![false; mesh.positions.len()];
    let sides = (0..3 * mesh.triangles.len() as u32).filter(|&side| is_one(side as usize));
    sides.flat_map(|side| mesh.ends(side)).for_each(|v| corners[v as usize] = true);
    corners
}

/// Moves the vertices from number `first` on, except those of triangles that would turn too far or intersect others.
fn raise(mesh: &mut OrientedManifold, first: usize, mut rises: Vec<Option<DVec3>>) {
    let flat = mesh.clone();
    loop {
        for (v, rise) in (first..).zip(&rises) {
            mesh.positions_mut()[v] = flat.positions[v] + rise.unwrap_or_default();
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

/// Returns those of `triangles` that intersect others of the mesh, and these others.
fn crossing_among(mesh: &Mesh, triangles: &[u32]) -> Vec<u32> {
    let soup = |of: &[u32]| Mesh::soup(of.iter().map(|&t| mesh.corners(t as usize)));
    let some = soup(triangles);
    let boxes = Bvh::new(&some);
    let meets = |&t: &u32| {
        let mut any = false;
        boxes.in_box(&some, &Aabb::of_triangle(mesh.corners(t as usize)), |_| any = true);
        any
    };
    let around = parallel::collect(0..mesh.triangles.len() as u32, |block| block.filter(meets));
    self_intersections(&soup(&around)).into_iter().map(|t| around[t as usize]).collect()
}
