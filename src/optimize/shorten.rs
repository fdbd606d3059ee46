//! Shortens the segments that crossing faces have in common until there are none.
//!
//! Where a sheet or a fold has passed through a face, the curve along which they cross ends where one of them does. The
//! corners of all faces along the curve step down the gradient of its length, each by no more than a share of its longest
//! edge, and the curve shrinks towards that end. The length after each step is known, so a step that is too long is
//! shortened, and one that does not help is the last.
//!
//! Based on: P. Volino, N. Magnenat-Thalmann, Resolving surface collisions through intersection contour minimization,
//! 2006, DOI 10.1145/1141911.1142007. Departures: vertices stay near the surface, triangles stay good, and the gradient is
//! that of [`crossing_segment`].
//!
//! Cost: some ten local searches for each face around a cluster of crossing faces, in each of at most `STEPS` steps.

use crate::base::union_find::UnionFind;
use crate::geom::crossing_segment::crossing_segment;
use crate::manifold::Manifold;
use crate::mesh::half_edge::OnCurve;
use crate::optimize::crossings::{
    Crossings, FARTHEST, Surroundings, acceptable, foot, is_near_surface, length_of_fold, longest_edge,
};
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of steps per cluster, and maximum distance that a vertex moves in each, in lengths of its longest edge.
const STEPS: usize = 40;
const REACH: f64 = 0.05;

/// Shares of a step that are tried, and the maximum share of the length that a step may leave.
const SHARES: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
const LEAST_PROGRESS: f64 = 0.99;

/// Shortens the segments that faces have in common where the input has no self-intersection, one cluster of crossing faces
/// at a time.
pub(super) fn shorten_crossings(domain: &Domain, mesh: &mut Manifold, crossings: &Crossings) {
    let clusters = clusters(mesh, &crossings.avoidable);
    let mut around = Surroundings::new(&crossings.faces);
    for cluster in clusters {
        shorten(domain, mesh, &mut around, cluster);
    }
}

/// Groups the faces of the pairs into clusters that are connected by common corners.
fn clusters(mesh: &Manifold, pairs: &[(u32, u32)]) -> Vec<BTreeSet<u32>> {
    let corners = |t: u32| mesh.connectivity.triangle(3 * t);
    let mut parts = UnionFind::new(mesh.samples().len());
    for &(t, u) in pairs {
        let first = corners(t)[0];
        corners(t).into_iter().chain(corners(u)).for_each(|v| _ = parts.join(first, v));
    }
    let mut clusters: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    for &(t, u) in pairs {
        clusters.entry(parts.find(corners(t)[0])).or_default().extend([t, u]);
    }
    clusters.into_values().collect()
}

/// What some faces have in common with others: the length of the segments, and its gradient with respect to the vertices.
#[derive(Default)]
struct Common {
    pairs: BTreeSet<(u32, u32)>,
    length: f64,
    gradient: BTreeMap<u32, DVec3>,
}

impl Common {
    /// Returns what `faces` have in common with others, except near self-intersections of the input.
    fn of(faces: &BTreeSet<u32>, domain: &Domain, mesh: &Manifold, around: &Surroundings) -> Common {
        let mut common = Common::default();
        for &t in faces {
            let own = mesh.corners(t);
            around.each_across(mesh, own, |u, other| {
                let is_new = t != u && !(domain.intersects_itself_near(own) && domain.intersects_itself_near(other));
                if is_new && common.pairs.insert((t.min(u), t.max(u))) {
                    common.add(mesh, [t, u]);
                }
            });
        }
        common
    }

    fn add(&mut self, mesh: &Manifold, faces: [u32; 2]) {
        let [a, b] = faces.map(|t| mesh.corners(t));
        let Some(segment) = crossing_segment(a, b) else {
            self.length += length_of_fold(a, b);
            return;
        };
        self.length += segment.length;
        for (t, by_corner) in faces.into_iter().zip(segment.gradient) {
            for (v, gradient) in mesh.connectivity.triangle(3 * t).into_iter().zip(by_corner) {
                *self.gradient.entry(v).or_default() += gradient;
            }
        }
    }

    /// Returns the faces of the pairs.
    fn faces(&self) -> BTreeSet<u32> {
        self.pairs.iter().flat_map(|&(t, u)| [t, u]).collect()
    }
}

/// Steps down the gradient of the length that the faces of a cluster have in common, while that decreases.
fn shorten(domain: &Domain, mesh: &mut Manifold, around: &mut Surroundings, mut cluster: BTreeSet<u32>) {
    for _ in 0..STEPS {
        let corners: BTreeSet<u32> = cluster.iter().flat_map(|&t| mesh.connectivity.triangle(3 * t)).collect();
        let stars: BTreeSet<u32> = corners.iter().flat_map(|&v| mesh.connectivity.outgoing(v)).map(|h| h / 3).collect();
        let mut now = Common::of(&stars, domain, mesh, around);
        now.gradient.retain(|v, _| corners.contains(v));
        if now.gradient.is_empty() {
            break;
        }
        let here: Vec<(u32, Sample)> = now.gradient.keys().map(|&v| (v, *mesh.sample(v))).collect();
        let unchanged: Vec<u32> = stars.difference(&around.changed).copied().collect();
        around.changed.extend(&unchanged);
        let shorter = SHARES.into_iter().find_map(|share| {
            step(domain, mesh, &now, share);
            let after = Common::of(&stars, domain, mesh, around);
            if after.length < LEAST_PROGRESS * now.length {
                return Some(after);
            }
            here.iter().for_each(|&(v, sample)| mesh.place(v, sample));
            None
        });
        match shorter {
            Some(after) => cluster = after.faces(),
            None => {
                unchanged.iter().for_each(|t| _ = around.changed.remove(t));
                break;
            }
        }
    }
}

/// Moves the vertices by a share of the step that would make the length zero if it were linear, each as far as it may.
fn step(domain: &Domain, mesh: &mut Manifold, common: &Common, share: f64) {
    let squared: f64 = common.gradient.values().map(|g| g.length_squared()).sum();
    for (&v, gradient) in &common.gradient {
        if mesh.connectivity.is_on_interface(v) {
            continue;
        }
        let way = (-common.length / squared * *gradient).clamp_length_max(REACH * longest_edge(mesh, v));
        let there = place_after(domain, mesh, v, share * way);
        if is_near_surface(domain, mesh, v, &there) && acceptable(mesh, v, &there) {
            mesh.place(v, there);
        }
    }
}

/// Returns where the step `way` takes `v`, pulled back to where it is not too far from the surface.
fn place_after(domain: &Domain, mesh: &Manifold, v: u32, way: DVec3) -> Sample {
    let here = *mesh.sample(v);
    let there = Sample { position: here.position + way, ..here };
    if mesh.connectivity.curve_at(v) != OnCurve::No {
        return there;
    }
    let own = foot(domain, &there);
    let off = (there.position - own.position).clamp_length_max(FARTHEST * longest_edge(mesh, v));
    Sample { position: own.position + off, ..own }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing::{grid, joined};
    use glam::dvec3;

    /// Two sheets of unit squares, one above the other.
    fn sheets(apart: f64) -> Mesh {
        joined([0.0, apart].map(|z| grid(12, 12, move |u, v| dvec3(12.0 * u, 12.0 * v, z))))
    }

    #[test]
    fn a_vertex_that_went_through_another_sheet_comes_back() {
        let input = sheets(0.05);
        let domain = Domain::new(input.clone().try_into().unwrap());
        let samples = input.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &input.triangles);
        // The vertex in the middle of the lower sheet.
        mesh.raise(6 * 13 + 6, 0.1);
        let mut crossings = Crossings::new(&domain, &mesh);
        assert!(crossings.avoidable.len() > 5);
        shorten_crossings(&domain, &mut mesh, &crossings);
        crossings.follow(&domain, &mesh);
        assert!(crossings.avoidable.is_empty());
        let off = mesh.samples().iter().map(|s| domain.project_anywhere(s.position).position.distance(s.position));
        assert!(off.fold(0.0, f64::max) < 1.5 * FARTHEST);
    }
}
