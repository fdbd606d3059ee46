//! Flips of edges that are not Delaunay.

use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::mesh::half_edge::{next, prev};

impl Manifold {
    /// Returns whether the edge of `h` is not Delaunay: the two angles opposite it sum to more than 180 degrees.
    ///
    /// The sine of the sum is then negative; it follows from the sines and cosines of both, without computing an angle.
    pub fn breaks_delaunay(&self, h: u32) -> bool {
        if !self.connectivity.has_twin(h) {
            return false;
        }
        let [a, b, c] = self.connectivity.triangle(h).map(|v| self.position(v));
        let d = self.position(self.connectivity.apex(self.connectivity.twin(h)));
        let (ca, cb, da, db) = (a - c, b - c, a - d, b - d);
        let (cos_c, cos_d) = (ca.dot(cb), da.dot(db));
        if cos_c >= 0.0 && cos_d >= 0.0 {
            return false;
        }
        let (sin_c, sin_d) = (ca.cross(cb).length(), da.cross(db).length());
        sin_c * cos_d + cos_c * sin_d < -1e-10 * (cos_c.abs() + sin_c) * (cos_d.abs() + sin_d)
    }

    /// Flips edges that are not Delaunay until there are none, beginning with those in `queue`. Flips that would duplicate
    /// an edge or turn a triangle against the surface are left out.
    pub fn flip_to_delaunay(&mut self, mut queue: Vec<u32>) {
        // In the plane, flips end by themselves; on a curved surface, this bound makes sure that they do.
        let mut left = 20 * queue.len() + 200;
        while let Some(h) = queue.pop() {
            if left == 0 || !self.connectivity.has_half_edge(h) || !self.breaks_delaunay(h) {
                continue;
            }
            if self.connectivity.can_flip(h) && self.flip_keeps_facing(h, FacingGuard::DELAUNAY) {
                let g = self.connectivity.twin(h);
                self.connectivity.flip(h);
                queue.extend([next(h), prev(h), next(g), prev(g)]);
                left -= 1;
            }
        }
    }

    /// Makes the edges of the triangles around `v` Delaunay, and those affected by the flips.
    pub fn make_delaunay_around(&mut self, v: u32) {
        self.flip_to_delaunay(self.connectivity.outgoing(v).flat_map(|h| [h, next(h)]).collect());
    }

    /// Flips all edges that are not Delaunay.
    pub fn make_delaunay(&mut self) {
        let c = &self.connectivity;
        // One of the angles opposite an edge that is not Delaunay is obtuse.
        let has_obtuse = |h: u32| {
            let [a, b, c] = c.triangle(h).map(|v| self.position(v));
            (a - c).dot(b - c) < 0.0
        };
        let mut broken: Vec<u32> = parallel::collect(0..c.half_edge_bound() / 3, |triangles| {
            let sides = triangles.filter(|t| c.has_half_edge(3 * t)).flat_map(|t| 3 * t..3 * t + 3);
            sides.filter(|&h| has_obtuse(h) && self.breaks_delaunay(h)).map(|h| h.min(c.twin(h)))
        });
        broken.sort_unstable();
        broken.dedup();
        broken.reverse();
        self.flip_to_delaunay(broken);
    }
}

#[cfg(test)]
mod tests {
    use crate::manifold::tests::strip;

    #[test]
    fn no_edge_is_left_that_breaks_delaunay() {
        let mut mesh = strip(20, 0.8);
        assert!(mesh.edges().any(|h| mesh.breaks_delaunay(h)));
        mesh.make_delaunay();
        assert!(!mesh.edges().any(|h| mesh.breaks_delaunay(h)));
    }
}
