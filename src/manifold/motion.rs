//! Moves each vertex of a manifold once over its domain, by a step that a rule gives. A step is tangential and projected
//! back onto the surface; vertices on a feature curve stay on it. A step that would turn a triangle against the surface, or
//! leave a gap on the curve, is halved until it does not.
//!
//! Vertices of one colour, no two of them adjacent, move at the same time, so the result does not depend on the number of
//! threads.

use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::manifold::vertex_set::VertexSet;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

/// Number of times a step that would fold the mesh is halved before the vertex stays.
const HALVINGS: usize = 4;

/// Maximum ratio of the distances from a vertex on a curve to its two neighbours there after a move. A vertex beside the
/// curve can push those on it apart; without a bound, gaps of seven spacings opened.
const MOST_UNEVEN: f64 = 3.0;

/// Moves all vertices that are not `locked` once. `way` gives the step of each.
pub fn move_vertices(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    way: impl Fn(&Manifold, u32) -> DVec3 + Sync + Send,
) {
    move_vertices_where(domain, mesh, locked, way, |_, _, _| true);
}

/// [`move_vertices`], restricted to places where a vertex `may` go; steps to other places are halved, too.
pub fn move_vertices_where(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    way: impl Fn(&Manifold, u32) -> DVec3 + Sync + Send,
    may: impl Fn(&Manifold, u32, DVec3) -> bool + Sync + Send,
) {
    for class in mesh.colour_classes(locked) {
        mesh.move_all(&class, |mesh, v| step(domain, mesh, v, way(mesh, v), &may));
    }
}

/// Returns where the step `way` takes vertex `v`.
fn step(domain: &Domain, mesh: &Manifold, v: u32, way: DVec3, may: impl Fn(&Manifold, u32, DVec3) -> bool) -> Sample {
    let here = mesh.samples[v as usize];
    let on_curve = mesh.connectivity.is_on_curve(v);
    let mut way = if on_curve { way } else { way.reject_from_normalized(here.normal) };
    if !way.is_finite() || way == DVec3::ZERO {
        return here;
    }
    for _ in 0..HALVINGS {
        let there = mesh.place_after(domain, v, way, &here);
        if mesh.may_move(v, &there) && may(mesh, v, there.position) {
            return there;
        }
        way *= 0.5;
    }
    here
}

impl Manifold {
    /// Moves vertices, no two of them adjacent, each to its `place`.
    pub fn move_all(&mut self, vertices: &[u32], place: impl Fn(&Manifold, u32) -> Sample + Sync) {
        let moved: Vec<Sample> = parallel::map(vertices, |&v| place(self, v));
        for (&v, sample) in vertices.iter().zip(moved) {
            self.samples[v as usize] = sample;
        }
    }

    /// Returns whether vertex `v` may move to `there`: triangles keep facing the surface and no gap is left on a curve, or
    /// neither gets worse.
    pub fn may_move(&self, v: u32, there: &Sample) -> bool {
        self.move_keeps_facing(v, there, FacingGuard::SOUND) && self.leaves_no_gap(v, there.position)
    }

    /// Returns whether vertex `v`, if it is on a curve, is about midway between its two neighbours there with `v` at
    /// `there`, or no farther off than now.
    fn leaves_no_gap(&self, v: u32, there: DVec3) -> bool {
        let Some(ends) = self.connectivity.along_curve(v) else { return true };
        let unevenness = |p: DVec3| {
            let [a, b] = ends.map(|w| self.position(w).distance_squared(p));
            a.max(b) / a.min(b)
        };
        let after = unevenness(there);
        after <= MOST_UNEVEN * MOST_UNEVEN || after <= unevenness(self.position(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::half_edge::OnCurve;
    use crate::testing::grid;
    use glam::dvec3;

    #[test]
    fn a_vertex_on_a_curve_leaves_no_gap() {
        let made = grid(8, 8, |u, v| dvec3(8.0 * u, 8.0 * v, 0.0));
        let sample = |position| Sample { position, normal: DVec3::Z, triangle: 0, size: 1.0 };
        let mut mesh = Manifold::new(made.positions.iter().map(|&p| sample(p)).collect(), &made.triangles);
        let number = |x: f64| made.positions.iter().position(|&p| p == dvec3(x, 4.0, 0.0)).unwrap() as u32;
        let [before, v, after] = [3.0, 4.0, 5.0].map(number);
        let to = |x: f64| sample(dvec3(x, 4.0, 0.0));
        assert!(mesh.may_move(v, &to(4.6)), "a vertex inside may go there");
        mesh.mark_curves(&[([before, v], OnCurve::Curve(0)), ([v, after], OnCurve::Curve(0))], []);
        assert_eq!([4.4, 4.6].map(|x| mesh.may_move(v, &to(x))), [true, false]);
        mesh.samples[v as usize] = to(4.7);
        assert_eq!([4.6, 4.8].map(|x| mesh.may_move(v, &to(x))), [true, false], "what closes a gap is better");
    }
}
