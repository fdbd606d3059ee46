//! How triangles face the surface, and the guard that keeps moves from turning them against it.

use crate::geom::triangle::mean_ratio;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::surface::domain::Sample;
use glam::DVec3;

/// The minimum mean ratio at which other changes can still mend a triangle; triangles of a row sheared twice have 0.27.
pub const LEAST_MENDABLE: f64 = 0.25;

/// Decides whether a move may create a triangle, by the cosine of the angle between its normal and that of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacingGuard {
    least: f64,
}

impl FacingGuard {
    /// For changes that improve a mesh: at most 73 degrees between triangle and surface.
    pub const SOUND: FacingGuard = FacingGuard { least: 0.3 };

    /// For Delaunay flips and for splits: at most 75 degrees. They follow other changes and so meet worse triangles: with 73
    /// degrees for splits, a scan with holes (the bunny) got angles of 103 degrees instead of 90.
    pub const DELAUNAY: FacingGuard = FacingGuard { least: 0.26 };

    /// For collapses and flips made for the vertex count or the valences: at most 60 degrees. There are other vertices and
    /// edges to choose from, and the vertices have yet to move.
    pub const CAREFUL: FacingGuard = FacingGuard { least: 0.5 };

    /// Returns whether a triangle with this cosine faces the surface.
    #[inline]
    pub fn passes(self, cosine: f64) -> bool {
        cosine >= self.least
    }

    /// Returns whether a triangle may change to the cosine `after`: it then faces the surface, or does so no worse than
    /// `before`.
    #[inline]
    pub fn allows(self, after: f64, before: impl FnOnce() -> f64) -> bool {
        self.passes(after) || after >= before()
    }
}

/// Returns the cosine of the angle between the normal of a triangle with these corners and that of the surface at them; -1
/// if the triangle is degenerate.
#[inline]
pub(super) fn cosine_to_surface([a, b, c]: [&Sample; 3]) -> f64 {
    let own = (b.position - a.position).cross(c.position - a.position);
    let surface = a.normal + b.normal + c.normal;
    if surface == DVec3::ZERO && own != DVec3::ZERO {
        // All three corners are on sharp edges and have no normal to compare with.
        return 1.0;
    }
    let cosine = own.dot(surface) / (own.length_squared() * surface.length_squared()).sqrt();
    if cosine.is_finite() { cosine } else { -1.0 }
}

impl Manifold {
    /// Returns the cosine of the angle between the normal of a triangle with these vertices and that of the surface at them;
    /// -1 if the triangle is degenerate.
    #[inline]
    pub fn agreement(&self, corners: [u32; 3]) -> f64 {
        cosine_to_surface(corners.map(|v| &self.samples[v as usize]))
    }

    /// Returns whether `guard` allows the triangles that flipping the edge of `h` creates.
    pub fn flip_keeps_facing(&self, h: u32, guard: FacingGuard) -> bool {
        let g = self.connectivity.twin(h);
        let [a, b, c] = self.connectivity.triangle(h);
        let d = self.connectivity.apex(g);
        let after = self.agreement([c, a, d]).min(self.agreement([d, b, c]));
        guard.allows(after, || self.agreement([a, b, c]).min(self.agreement([b, a, d])))
    }

    /// Returns whether the edge of `h`, which has two faces, can be flipped and leaves triangles that pass `guard` and can
    /// be mended.
    pub fn flip_leaves_mendable(&self, h: u32, guard: FacingGuard) -> bool {
        let c = &self.connectivity;
        let [a, b, top] = c.triangle(h);
        let bottom = c.apex(c.twin(h));
        let good =
            |t: [u32; 3]| guard.passes(self.agreement(t)) && mean_ratio(t.map(|v| self.position(v))) >= LEAST_MENDABLE;
        c.can_flip(h) && good([top, a, bottom]) && good([bottom, b, top])
    }

    /// Returns whether `guard` allows the triangles around `v` if it moves to `there`.
    pub fn move_keeps_facing(&self, v: u32, there: &Sample, guard: FacingGuard) -> bool {
        self.star_passes(v, there, guard) || self.star_is_no_worse(v, there)
    }

    /// Returns whether all triangles around `v` would pass `guard` if it were at `there`; needs neither a root nor a
    /// division. A triangle whose corners are all on sharp edges does not pass: it has no normal to compare with.
    pub fn star_passes(&self, v: u32, there: &Sample, guard: FacingGuard) -> bool {
        self.connectivity.outgoing(v).all(|h| {
            let [_, p, q] = self.connectivity.triangle(h);
            let (p, q) = (&self.samples[p as usize], &self.samples[q as usize]);
            let own = (p.position - there.position).cross(q.position - there.position);
            let surface = there.normal + p.normal + q.normal;
            let dot = own.dot(surface);
            dot > 0.0 && dot * dot >= guard.least * guard.least * own.length_squared() * surface.length_squared()
        })
    }

    #[cold]
    fn star_is_no_worse(&self, v: u32, there: &Sample) -> bool {
        self.worst_facing(v, there) >= self.worst_facing(v, &self.samples[v as usize])
    }

    /// Returns the minimum cosine of the angle between a triangle around `v` and the surface if `v` were at `there`.
    fn worst_facing(&self, v: u32, there: &Sample) -> f64 {
        let facing = |h: u32| {
            let [_, p, q] = self.connectivity.triangle(h);
            cosine_to_surface([there, &self.samples[p as usize], &self.samples[q as usize]])
        };
        self.connectivity.outgoing(v).map(facing).fold(1.0, f64::min)
    }

    /// Returns the vertices whose normal has a cosine below `cosine` with that of a vertex within two rings, not across
    /// curves.
    pub fn bent(&self, cosine: f64) -> VertexSet {
        let c = &self.connectivity;
        let normal = |v: u32| self.samples[v as usize].normal;
        let inside = |v: u32| c.ring(v).filter(|&w| !c.is_on_curve(w));
        VertexSet::new(self, |v| inside(v).any(|w| c.ring(w).any(|x| normal(x).dot(normal(v)) < cosine)))
    }
}
