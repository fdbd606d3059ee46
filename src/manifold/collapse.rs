//! Edge collapses, and their effects.

use crate::geom::triangle::{closest_point, mean_ratio};
use crate::manifold::Manifold;
use glam::DVec3;

impl Manifold {
    /// Merges the origin of `h` into its target, followed by Delaunay flips around it.
    pub fn collapse(&mut self, h: u32) {
        let into = self.connectivity.target(h);
        self.connectivity.collapse(h);
        self.make_delaunay_around(into);
    }

    /// [`Self::collapse`] for ends that may be on different feature curves, which then meet in the target.
    pub fn merge(&mut self, h: u32) {
        let into = self.connectivity.target(h);
        self.connectivity.merge(h);
        self.make_delaunay_around(into);
    }

    /// Returns the triangles left around the origin of `h` if it merges into its target, which is their first corner.
    pub fn left_by_collapse(&self, h: u32) -> impl Iterator<Item = [u32; 3]> {
        let c = &self.connectivity;
        let target = c.target(h);
        let around = c.outgoing(c.origin(h)).map(|out| c.triangle(out));
        around.filter(move |t| !t[1..].contains(&target)).map(move |[_, p, q]| [target, p, q])
    }

    /// Returns how well the triangles face the surface and are shaped if the origin of `h` merges into its target: the
    /// minimum cosine of the angle between a triangle's normal and the surface's, and the minimum mean ratio.
    pub fn after_collapse(&self, h: u32) -> (f64, f64) {
        self.left_by_collapse(h).fold((1.0, 1.0), |(facing, shape), corners| {
            let own = mean_ratio(corners.map(|v| self.position(v)));
            (self.agreement(corners).min(facing), own.min(shape))
        })
    }

    /// Returns the minimum cosine of the angle between the normals of a triangle and of the surface at one of its corners if
    /// the origin of `h` merges into its target.
    pub fn bend_after_collapse(&self, h: u32) -> f64 {
        let least = self.left_by_collapse(h).map(|corners| {
            let corners = corners.map(|v| &self.samples[v as usize]);
            let [a, b, c] = corners.map(|s| s.position);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let known = corners.iter().filter(|s| s.normal != DVec3::ZERO);
            known.map(|s| s.normal.dot(normal)).fold(1.0, f64::min)
        });
        least.fold(1.0, f64::min)
    }

    /// Returns the distance from the origin of `h` to the triangles left there if it merges into its target.
    pub fn distance_after_collapse(&self, h: u32) -> f64 {
        let here = self.position(self.connectivity.origin(h));
        let corners = self.left_by_collapse(h).map(|t| t.map(|v| self.position(v)));
        corners.map(|t| here.distance_squared(closest_point(here, t))).fold(f64::INFINITY, f64::min).sqrt()
    }
}
