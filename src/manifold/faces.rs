//! A snapshot of the faces of a manifold, for searches among them.
//!
//! Faces have the numbers of their triangles in the manifold: half-edge `3 t` is the first one of face `t`.

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::geom::intersection::cross_deeper_than;
use crate::manifold::Manifold;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::{Bvh, Hit};
use crate::spatial::self_intersections::{depth_of_contact, self_intersecting_pairs};
use glam::DVec3;
use std::ops::Range;

/// The faces of a manifold at the time of [`Self::new`] or of the last [`Self::follow`].
pub struct Faces {
    mesh: Mesh,
    bvh: Bvh,
    /// For each triangle of the mesh, the number of its face, in ascending order.
    number: Vec<u32>,
    depth_of_contact: f64,
}

impl Faces {
    /// Takes a snapshot of the faces of `mesh`.
    pub fn new(mesh: &Manifold) -> Faces {
        let number: Vec<u32> = mesh.triangles().collect();
        let triangles = number.iter().map(|&t| mesh.connectivity.triangle(3 * t)).collect();
        let mesh = Mesh { positions: mesh.samples.iter().map(|s| s.position).collect(), triangles };
        Faces { bvh: Bvh::new(&mesh), depth_of_contact: depth_of_contact(&mesh), mesh, number }
    }

    /// Updates the positions and corners of the faces; returns those that have changed, in increasing order. `mesh` must
    /// have faces with the same numbers as before.
    pub fn follow(&mut self, mesh: &Manifold) -> Vec<u32> {
        let has_changed =
            |(t, number): (usize, &u32)| (self.mesh.corners(t) != mesh.corners(*number)).then_some(*number);
        let changed = self.number.iter().enumerate().filter_map(has_changed).collect();
        self.mesh.positions.iter_mut().zip(&mesh.samples).for_each(|(p, sample)| *p = sample.position);
        let triangles = self.mesh.triangles.iter_mut().zip(&self.number);
        triangles.for_each(|(corners, &t)| *corners = mesh.connectivity.triangle(3 * t));
        self.bvh.refit(&self.mesh);
        self.depth_of_contact = depth_of_contact(&self.mesh);
        changed
    }

    /// Returns the depth up to which faces count as touching.
    pub fn depth_of_contact(&self) -> f64 {
        self.depth_of_contact
    }

    /// Returns the corners of each face, in the order of the faces.
    pub fn iter(&self) -> impl Iterator<Item = [DVec3; 3]> {
        (0..self.number.len()).map(|t| self.mesh.corners(t))
    }

    /// Returns the corners of face `t`; `None` if no face has that number.
    pub fn corners(&self, t: u32) -> Option<[DVec3; 3]> {
        self.number.binary_search(&t).ok().map(|t| self.mesh.corners(t))
    }

    /// Returns the point closest to `p` on a face whose normal makes an acute angle with `normal`, with the number of that
    /// face, if the squared distance is below the end of `range`. If it is below the start, the point need not be the
    /// closest one.
    pub fn closest_facing(&self, p: DVec3, normal: DVec3, range: Range<f64>) -> Option<Hit> {
        let facing = |t: u32| self.mesh.area_vector(t as usize).dot(normal) > 0.0;
        let hit = self.bvh.closest_or_near(&self.mesh, p, range.start, range.end, facing)?;
        Some(Hit { triangle: self.number[hit.triangle as usize], ..hit })
    }

    /// Returns whether any face is within `distance` of `p`, whatever its normal.
    pub fn any_within(&self, p: DVec3, distance: f64) -> bool {
        let square = distance * distance;
        self.bvh.closest_or_near(&self.mesh, p, square, square, |_| true).is_some()
    }

    /// Calls `visit` with the number and the corners of each face whose bounding box meets the `wanted` one.
    pub fn in_box(&self, wanted: &Aabb, mut visit: impl FnMut(u32, [DVec3; 3])) {
        self.bvh.in_box(&self.mesh, wanted, |t| visit(self.number[t as usize], self.mesh.corners(t as usize)));
    }

    /// Returns the pairs of faces that intersect, the lower number first, in increasing order.
    pub fn self_intersecting_pairs(&self) -> Vec<(u32, u32)> {
        let numbered = |(t, u): (u32, u32)| (self.number[t as usize], self.number[u as usize]);
        self_intersecting_pairs(&self.mesh, &self.bvh).into_iter().map(numbered).collect()
    }

    /// Returns those of [`Self::self_intersecting_pairs`] that contain one of `faces`.
    pub fn self_intersecting_pairs_of(&self, faces: &[u32]) -> Vec<(u32, u32)> {
        let depth = self.depth_of_contact();
        let mut pairs = parallel::collect(faces, |faces| {
            let mut pairs = Vec::new();
            for &t in faces {
                let Some(own) = self.corners(t) else { continue };
                self.in_box(&Aabb::of_triangle(own), |u, other| {
                    let [a, b] = if t < u { [own, other] } else { [other, own] };
                    if t != u && cross_deeper_than(depth, a, b) {
                        pairs.push((t.min(u), t.max(u)));
                    }
                });
            }
            pairs
        });
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}
