//! Bodies that are mostly bounded by planes, as parts from CAD systems are, and scans and sculpts are not.
//!
//! A plane is a connected region of triangles across whose edges the surface does not turn. Two triangles may be a
//! square of a sculpt, so a plane has at least three.
//!
//! Cost: linear in the triangles.

use crate::base::union_find::UnionFind;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::topology::NONE;
use crate::surface::turns::turns;
use glam::DVec3;
use std::collections::BTreeMap;

/// Largest turn in degrees across an edge within a plane: rounding to single precision turns small triangles by less.
const FLAT: f64 = 0.1;

/// Fewest triangles of the input in a plane.
const FEWEST: usize = 3;

/// Least share of the area of a plane's triangles that its area vectors sum up to: one that bends is none.
const STRAIGHT: f64 = 0.99;

/// Least share of the area of a body that lies in planes.
const MOSTLY: f64 = 0.5;

/// For each triangle whether it lies in a plane. `twin` is as [`twins`](crate::mesh::topology::twins) says, `spacing` that of
/// the samples.
pub(super) fn in_planes(mesh: &OrientedManifold, twin: &[u32], spacing: f64) -> Vec<bool> {
    let turns = turns(mesh, twin, spacing, FLAT);
    let mut region = UnionFind::new(mesh.triangles.len());
    for side in (0..twin.len()).filter(|&s| twin[s] != NONE && turns[s].abs() < FLAT) {
        region.join(side as u32 / 3, twin[side] / 3);
    }
    let mut regions = vec![Region::default(); mesh.triangles.len()];
    for t in 0..mesh.triangles.len() as u32 {
        regions[region.find(t) as usize].add(mesh.area_vector(t as usize), mesh.provenance().triangle(t));
    }
    (0..mesh.triangles.len() as u32).map(|t| regions[region.find(t) as usize].is_plane()).collect()
}

/// The sides of each body of which most lies in planes; `in_plane` tells for each triangle whether it does.
pub(super) fn planar_bodies(mesh: &OrientedManifold, twin: &[u32], in_plane: &[bool]) -> Vec<Vec<u32>> {
    let mut body = UnionFind::new(mesh.triangles.len());
    for side in (0..twin.len() as u32).filter(|&s| twin[s as usize] != NONE) {
        body.join(side / 3, twin[side as usize] / 3);
    }
    let mut bodies: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for t in 0..mesh.triangles.len() as u32 {
        bodies.entry(body.find(t)).or_default().push(t);
    }
    let area = |t: u32| mesh.area_vector(t as usize).length();
    let is_planar = |body: &Vec<u32>| {
        let in_planes: f64 = body.iter().filter(|&&t| in_plane[t as usize]).map(|&t| area(t)).sum();
        in_planes >= MOSTLY * body.iter().map(|&t| area(t)).sum::<f64>()
    };
    let sides = |body: Vec<u32>| body.into_iter().flat_map(|t| 3 * t..3 * t + 3).collect();
    bodies.into_values().filter(is_planar).map(sides).collect()
}

/// What the triangles of a connected region are together.
#[derive(Clone, Default)]
struct Region {
    area: f64,
    vector: DVec3,
    /// The triangles of the input that they are parts of, up to the fewest of a plane.
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

    fn is_plane(&self) -> bool {
        self.sources.len() == FEWEST && self.vector.length() >= STRAIGHT * self.area
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::twins;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing;

    fn planar(mesh: Mesh) -> (usize, usize) {
        let mesh: OrientedManifold = mesh.try_into().unwrap();
        let twin = twins(&mesh.triangles);
        let in_plane = in_planes(&mesh, &twin, 0.1);
        (in_plane.iter().filter(|p| **p).count(), planar_bodies(&mesh, &twin, &in_plane).len())
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
}
