//! The planes of a mesh, which of them touch, and which bodies are mostly bounded by planes. CAD parts are; scans and
//! sculpts are not.
//!
//! A plane is a connected region of triangles with flat edges between them. Two triangles may be a square of a sculpt, so a
//! plane has at least three.
//!
//! Cost: linear in the triangles, plus a search for each triangle in a plane to find those that touch.

use crate::base::parallel;
use crate::base::union_find::UnionFind;
use crate::mesh::topology::{NONE, components};
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::spatial::self_intersections::depth_of_contact;
use crate::surface::dihedral_angles::dihedral_angles;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Largest dihedral angle within a plane, in degrees: rounding to single precision turns small triangles by less.
const FLAT: f64 = 0.1;

/// Minimum number of input triangles in a plane, and its minimum area in squared spacings: in a scan, a few triangles may be
/// coplanar by chance.
const FEWEST: usize = 3;
const LEAST_AREA: f64 = 4.0;

/// Minimum length of the sum of a plane's area vectors, relative to its area. A region that bends has less.
const STRAIGHT: f64 = 0.99;

/// Minimum cosine between the normals of planes that touch, regardless of sign.
const PARALLEL: f64 = 0.99;

/// Minimum share of a body's area that lies in planes.
const MOSTLY: f64 = 0.5;

/// The planes of a mesh.
pub struct Planes {
    /// The plane that each triangle lies in, identified by a representative triangle.
    of_triangle: Vec<Option<u32>>,
}

impl Planes {
    /// Finds the planes of `mesh`. `twin` is the result of [`twins`](crate::mesh::topology::twins), `spacing` that of the
    /// samples; `source` returns the input triangle that a triangle is a part of.
    pub fn new(mesh: &Mesh, twin: &[u32], spacing: f64, source: impl Fn(u32) -> u32) -> Planes {
        let dihedral_angles = dihedral_angles(mesh, twin, spacing, FLAT);
        let mut region = UnionFind::new(mesh.triangles.len());
        for side in (0..twin.len()).filter(|&s| twin[s] != NONE && dihedral_angles[s].abs() < FLAT) {
            region.join(side as u32 / 3, twin[side] / 3);
        }
        let mut regions = vec![Region::default(); mesh.triangles.len()];
        for t in 0..mesh.triangles.len() as u32 {
            regions[region.find(t) as usize].add(0.5 * mesh.area_vector(t as usize), source(t));
        }
        let plane = |t: u32| Some(region.find(t)).filter(|&r| regions[r as usize].is_plane(spacing));
        Planes { of_triangle: (0..mesh.triangles.len() as u32).map(plane).collect() }
    }

    /// Returns whether triangle `t` lies in a plane.
    pub fn contain(&self, t: u32) -> bool {
        self.of_triangle[t as usize].is_some()
    }

    /// Returns whether each triangle lies in a plane that touches another, as where parts stand on each other.
    pub fn in_contact(&self, mesh: &Mesh, bvh: &Bvh) -> Vec<bool> {
        let depth = depth_of_contact(mesh);
        let normal = |t: u32| mesh.area_vector(t as usize).normalize_or_zero();
        let touched = |t: u32| {
            let plane = self.of_triangle[t as usize]?;
            let other = |u: u32| self.of_triangle[u as usize].filter(|&other| other != plane);
            let lies_on = |u: u32| other(u).is_some() && normal(t).dot(normal(u)).abs() >= PARALLEL;
            let middle = mesh.corners(t as usize).into_iter().sum::<DVec3>() / 3.0;
            let hit = bvh.closest_where(mesh, middle, depth * depth, lies_on)?;
            Some([plane, other(hit.triangle)?])
        };
        let touching = parallel::collect(0..self.of_triangle.len() as u32, |block| block.filter_map(touched));
        let touching: BTreeSet<u32> = touching.into_iter().flatten().collect();
        self.of_triangle.iter().map(|plane| plane.is_some_and(|plane| touching.contains(&plane))).collect()
    }
}

/// Returns the sides of each body that lies mostly in `planes`.
pub fn planar_bodies(mesh: &Mesh, planes: &Planes) -> Vec<Vec<u32>> {
    let component = components(mesh.positions.len(), &mesh.triangles);
    let mut bodies: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (t, corners) in (0..).zip(&mesh.triangles) {
        bodies.entry(component[corners[0] as usize]).or_default().push(t);
    }
    let area = |t: u32| mesh.area_vector(t as usize).length();
    let is_planar = |body: &Vec<u32>| {
        let in_planes: f64 = body.iter().filter(|&&t| planes.contain(t)).map(|&t| area(t)).sum();
        in_planes >= MOSTLY * body.iter().map(|&t| area(t)).sum::<f64>()
    };
    let sides = |body: Vec<u32>| body.into_iter().flat_map(|t| 3 * t..3 * t + 3).collect();
    bodies.into_values().filter(is_planar).map(sides).collect()
}

/// Sums over the triangles of a connected region.
#[derive(Clone, Default)]
struct Region {
    /// Sum of the lengths of their area vectors, and of the vectors themselves.
    area: f64,
    vector: DVec3,
    /// The input triangles that they are parts of; no more than the minimum number of a plane.
    sources: Vec<u32>,
}

impl Region {
    fn add(&mut self, vector: DVec3, source: u32) {
        self.area += vector.length();
        self.vector += vector;
        if self.sources.len() < FEWEST && !self.sources.contains(&source) {
            self.sources.push(source);
        }
    }

    fn is_plane(&self, spacing: f64) -> bool {
        self.sources.len() == FEWEST
            && self.area >= LEAST_AREA * spacing * spacing
            && self.vector.length() >= STRAIGHT * self.area
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::twins;
    use crate::testing;

    fn planar(mesh: Mesh) -> (usize, usize) {
        let twin = twins(&mesh.triangles);
        let planes = Planes::new(&mesh, &twin, 0.1, |t| t);
        let count = (0..mesh.triangles.len() as u32).filter(|&t| planes.contain(t)).count();
        (count, planar_bodies(&mesh, &planes).len())
    }

    #[test]
    fn faces_of_more_than_two_triangles_are_planes_and_a_ball_has_none() {
        assert_eq!(planar(testing::sphere()), (0, 0));
        assert_eq!(planar(testing::cube()), (0, 0), "two triangles may be a square of a sculpt");
        let sheet = testing::grid(2, 2, |u, v| DVec3::new(u, v, 0.0));
        assert_eq!(planar(sheet), (8, 1));
        let bent = testing::grid(1000, 1, |u, v| DVec3::new(u.sin(), v, u.cos()));
        assert_eq!(planar(bent), (0, 0), "it turns by less than a tenth of a degree at each edge, but by 57 in all");
    }

    #[test]
    fn planes_that_lie_on_each_other_touch() {
        let sheet = |z: f64, x: f64, size: f64| testing::grid(4, 4, move |u, v| DVec3::new(x + size * u, size * v, z));
        let touching = |upper: Mesh| {
            let lower = sheet(0.0, 0.0, 1.0);
            let first = lower.positions.len() as u32;
            let positions = lower.positions.into_iter().chain(upper.positions).collect();
            let upper = upper.triangles.into_iter().map(|[a, b, c]| [first + c, first + b, first + a]);
            let mesh = Mesh { positions, triangles: lower.triangles.into_iter().chain(upper).collect() };
            let planes = Planes::new(&mesh, &twins(&mesh.triangles), 0.1, |t| t);
            planes.in_contact(&mesh, &Bvh::new(&mesh)).into_iter().filter(|c| *c).count()
        };
        assert_eq!(touching(sheet(0.0, 0.3, 0.5)), 64);
        assert_eq!(touching(sheet(1e-3, 0.3, 0.5)), 0, "a gap");
        assert_eq!(touching(sheet(0.0, 1.5, 0.5)), 0, "beside each other");
    }
}
