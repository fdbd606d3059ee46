//! Self-intersecting faces of a changing mesh: which faces cross, which would, and how far vertices may move to avoid it.

use crate::geom::aabb::Aabb;
use crate::geom::intersection::cross_deeper_than;
use crate::geom::triangle::{longest_side, mean_ratio};
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::facing::LEAST_MENDABLE;
use crate::spatial::self_intersections::faces_of;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum distance of a vertex from its foot on the surface, in lengths of its longest edge.
pub(super) const FARTHEST: f64 = 0.14;

/// Common length assigned to crossing faces without a common segment, as a share of their longest side.
const FOLDED: f64 = 0.1;

/// The corners of a face.
pub(super) type Corners = [DVec3; 3];

/// A snapshot of the faces of a mesh, and the pairs of them that intersect.
pub(super) struct Crossings {
    pub faces: Faces,
    pub all: Vec<(u32, u32)>,
    /// Pairs at places where the surface does not intersect itself.
    pub avoidable: Vec<(u32, u32)>,
}

impl Crossings {
    /// Finds the crossings of `mesh`, a mesh of the surface `domain`.
    pub fn new(domain: &Domain, mesh: &Manifold) -> Crossings {
        let faces = Faces::new(mesh);
        let all = faces.self_intersecting_pairs();
        Crossings { avoidable: avoidable(&all, domain, mesh), all, faces }
    }

    /// Updates the crossings after vertices have moved and edges have flipped; pairs of unchanged faces are not tested
    /// again.
    pub fn follow(&mut self, domain: &Domain, mesh: &Manifold) {
        let changed = self.faces.follow(mesh);
        let stays = |t: u32| changed.binary_search(&t).is_err();
        self.all.retain(|&(t, u)| stays(t) && stays(u));
        self.all.extend(self.faces.self_intersecting_pairs_of(&changed));
        self.all.sort_unstable();
        self.avoidable = avoidable(&self.all, domain, mesh);
    }

    /// Updates the crossings after the `touched` triangles of the mesh have been replaced.
    pub fn renew(&mut self, domain: &Domain, mesh: &Manifold, touched: &[bool]) {
        self.faces = Faces::new(mesh);
        let is_touched = |t: u32| touched.get(t as usize).is_some_and(|touched| *touched);
        self.all.retain(|&(t, u)| !is_touched(t) && !is_touched(u));
        let touched: Vec<u32> = mesh.triangles().filter(|&t| is_touched(t)).collect();
        self.all.extend(self.faces.self_intersecting_pairs_of(&touched));
        self.all.sort_unstable();
        self.avoidable = avoidable(&self.all, domain, mesh);
    }
}

/// Returns the triangles of `mesh` that cross others where the surface does not intersect itself, in increasing order.
pub fn crossing_faces(domain: &Domain, mesh: &Manifold) -> Vec<u32> {
    faces_of(Crossings::new(domain, mesh).avoidable)
}

/// Returns the `pairs` at places where the surface does not intersect itself.
fn avoidable(pairs: &[(u32, u32)], domain: &Domain, mesh: &Manifold) -> Vec<(u32, u32)> {
    let crossing = faces_of(pairs.to_vec()).into_iter();
    let need_not: BTreeMap<u32, bool> =
        crossing.map(|t| (t, !domain.intersects_itself_near(mesh.corners(t)))).collect();
    pairs.iter().copied().filter(|(t, u)| need_not[t] || need_not[u]).collect()
}

/// The faces of a changing mesh: a snapshot, and those that have changed since.
pub(super) struct Surroundings<'a> {
    faces: &'a Faces,
    pub changed: BTreeSet<u32>,
    /// Depth up to which faces merely touch.
    depth: f64,
}

impl Surroundings<'_> {
    /// Creates the surroundings of a mesh that has not changed.
    pub fn new(faces: &Faces) -> Surroundings<'_> {
        Surroundings { depth: faces.depth_of_contact(), faces, changed: BTreeSet::new() }
    }

    /// Returns how many pairs of faces with one of `new` would cross if `new` replaced the faces `old`; some number above
    /// `most` if there are more than that.
    pub fn count(&self, mesh: &Manifold, new: &[Corners], old: &[u32], most: usize) -> usize {
        let among: usize = (1..new.len()).map(|i| new[..i].iter().filter(|&&t| self.cross(t, new[i])).count()).sum();
        let mut count = among;
        for &corners in new {
            if count > most {
                break;
            }
            self.each_across(mesh, corners, |t, _| count += usize::from(!old.contains(&t)));
        }
        count
    }

    /// Calls `visit` with each face that crosses `triangle`, and its corners.
    pub fn each_across(&self, mesh: &Manifold, triangle: Corners, mut visit: impl FnMut(u32, Corners)) {
        let wanted = Aabb::of_triangle(triangle);
        self.faces.in_box(&wanted, |t, corners| {
            if !self.changed.contains(&t) && self.cross(triangle, corners) {
                visit(t, corners);
            }
        });
        for (&t, corners) in self.changed.iter().map(|t| (t, mesh.corners(*t))) {
            if Aabb::of_triangle(corners).meets(&wanted) && self.cross(triangle, corners) {
                visit(t, corners);
            }
        }
    }

    fn cross(&self, a: Corners, b: Corners) -> bool {
        cross_deeper_than(self.depth, a, b)
    }
}

/// Returns the common length assigned to faces that cross without a common segment, folded over or coplanar.
pub(super) fn length_of_fold(a: Corners, b: Corners) -> f64 {
    FOLDED * longest_side(a).max(longest_side(b))
}

/// Returns the triangles around `v` if it were at `there`.
pub(super) fn fan(mesh: &Manifold, v: u32, there: DVec3) -> Vec<Corners> {
    let triangle = |h: u32| {
        let [_, p, q] = mesh.connectivity.triangle(h);
        [there, mesh.position(p), mesh.position(q)]
    };
    mesh.connectivity.outgoing(v).map(triangle).collect()
}

/// Returns whether the triangles around `v` are no worse, or other changes can mend them, with `v` at `there`.
pub(super) fn acceptable(mesh: &Manifold, v: u32, there: &Sample) -> bool {
    let shapes = |p: DVec3| fan(mesh, v, p).into_iter().map(mean_ratio);
    mesh.may_move(v, there)
        && shapes(there.position)
            .zip(shapes(mesh.position(v)))
            .all(|(after, before)| after >= before.min(LEAST_MENDABLE))
}

/// Returns the foot on the surface of a sample that lies off it.
pub(super) fn foot(domain: &Domain, off: &Sample) -> Sample {
    domain.project(off.position, off.normal, off.triangle)
}

/// Returns whether `there` is a place for `v` that is not too far from the surface.
pub(super) fn is_near_surface(domain: &Domain, mesh: &Manifold, v: u32, there: &Sample) -> bool {
    foot(domain, there).position.distance(there.position) <= FARTHEST * longest_edge(mesh, v)
}

/// Returns the length of the longest edge at `v`.
pub(super) fn longest_edge(mesh: &Manifold, v: u32) -> f64 {
    let here = mesh.position(v);
    mesh.connectivity.ring(v).map(|w| mesh.position(w).distance(here)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{grid, joined};
    use glam::dvec3;

    #[test]
    fn crossings_that_the_surface_has_are_not_avoidable() {
        // A floor, a ceiling close above, and a wall through both.
        let flat = |z: f64| grid(24, 12, move |u, v| dvec3(24.0 * u, 12.0 * v, z));
        let wall = grid(12, 12, |u, v| dvec3(3.5, 12.0 * v, 8.0 * u - 7.9));
        let input = joined([flat(0.0), flat(0.3), wall]);
        let domain = Domain::new(input.clone().try_into().unwrap());
        let samples = input.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &input.triangles);
        assert!(!Crossings::new(&domain, &mesh).all.is_empty() && crossing_faces(&domain, &mesh).is_empty());
        // The vertex in the middle of the floor, far from the wall, passes through the ceiling.
        let v = 12 * 13 + 6;
        mesh.raise(v, 0.6);
        let found = crossing_faces(&domain, &mesh);
        let near = |t: &u32| mesh.corners(*t).iter().all(|p| p.distance(mesh.samples()[v].position) < 3.0);
        assert!(found.len() > 3 && found.iter().all(near), "{found:?}");
    }

    #[test]
    fn crossings_that_follow_a_mesh_are_those_of_the_mesh() {
        let sheet = |z: f64| grid(12, 12, move |u, v| dvec3(12.0 * u, 12.0 * v, z));
        let input = joined([sheet(0.0), sheet(0.3)]);
        let domain = Domain::new(input.clone().try_into().unwrap());
        let samples = input.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &input.triangles);
        // Two vertices of the lower sheet pass through the upper one.
        let through = [4 * 13 + 4, 7 * 13 + 8];
        through.iter().for_each(|&v| mesh.raise(v, 0.6));
        let mut crossings = Crossings::new(&domain, &mesh);
        // One comes back, one moves on, another passes through, and an edge beside it flips.
        mesh.raise(through[0], 0.0);
        mesh.raise(through[1], 0.8);
        mesh.raise(9 * 13 + 3, 0.5);
        let beside = mesh.connectivity.outgoing(9 * 13 + 3).find(|&h| mesh.connectivity.can_flip(h)).unwrap();
        mesh.connectivity.flip(beside);
        let before = crossings.avoidable.clone();
        crossings.follow(&domain, &mesh);
        let anew = Crossings::new(&domain, &mesh);
        assert!(crossings.avoidable != before && crossings.avoidable.len() > 10);
        assert_eq!((&crossings.all, &crossings.avoidable), (&anew.all, &anew.avoidable));
    }
}
