//! The spikes of a surface: narrow cones without a feature curve that leads to their end. Random samples cut them off.
//!
//! A cone whose side makes an angle α with its axis has the curvature 2π (1 - sin α) at its apex. However its tip is rounded
//! or tessellated, the angle defects of the tip's vertices (2π minus the sum of the angles around each) add up to that
//! (Gauss-Bonnet). So there is a spike where the defects of the vertices within a spacing add up to a large part of 2π.
//! Where they are spread too far for triangles to resolve, the tip is round, and free samples fit it better. Next to a
//! boundary or a feature curve, the samples on it keep the shape.
//!
//! Cost: linear in the triangles. The centres of the balls that are examined lie a certain share of a spacing apart.

use crate::base::parallel;
use crate::geom::triangle::angles;
use crate::mesh::half_edge::next;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use rustc_hash::FxHashSet;
use std::ops::RangeInclusive;

/// Curvature of the tip of a spike, in multiples of 2π: α is below 24 degrees. A needle has 1, a separate body 2.
const CURVATURE: RangeInclusive<f64> = 0.6..=1.02;

/// Minimum angle defect, in multiples of 2π, of the vertices around which tips are sought: in a mesh with thirty vertices
/// per sample, no tip that is not round has thirty vertices with equal shares of its curvature.
const LEAST_DEFECT: f64 = 0.02;

/// Radius of a tip around its vertex of largest angle defect, and of the part of the spike that is examined, in spacings.
const TIP: f64 = 0.7;
const SPIKE: f64 = 3.0;

/// Share of the tip's radius, around its vertex of largest angle defect, within which no other tip is sought.
const LOOKED_AT: f64 = 0.5;

/// Minimum distance between the ends of two spikes, in spacings: closer ones leave no room for triangles between them.
const APART: f64 = 2.0;

/// Root mean square distance of a tip's curvature from its centre, in spacings, above which the tip is round. Claws and
/// fingers of scans begin at 0.35.
const ROUND: f64 = 0.3;

/// Number of triangles whose angles are in memory at once.
const BLOCK: usize = 1 << 16;

/// Minimum height of the end above the centre of mass of the spike, in spacings: two for a cone, less for a scrap of
/// surface.
const LEAST_HEIGHT: f64 = 1.2;

/// Returns the spikes of `mesh` for samples whose distance at each vertex is `spacing`, each as a side `3 t + k` that leaves
/// its end. `twin` has the opposite side of each side, or [`NONE`].
pub fn spikes(mesh: &Mesh, twin: &[u32], spacing: impl Fn(u32) -> f64) -> Vec<u32> {
    let surface = Surface { mesh, twin, defects: angle_defects(mesh, twin) };
    let mut is_done = vec![false; mesh.positions.len()];
    let mut spikes = Vec::new();
    for seed in surface.seeds() {
        let v = surface.vertex(seed);
        if is_done[v as usize] {
            continue;
        }
        let spacing = spacing(v);
        let end = surface.end_of_spike(seed, spacing);
        let (middle, reach) = end.map_or((seed, LOOKED_AT * TIP), |end| (end, APART));
        let done = surface.sides_within(middle, reach * spacing);
        done.into_iter().for_each(|side| is_done[surface.vertex(side) as usize] = true);
        spikes.extend(end);
    }
    spikes
}

/// A mesh with the angle defects of its vertices.
struct Surface<'a> {
    mesh: &'a Mesh,
    twin: &'a [u32],
    defects: Vec<Option<f64>>,
}

impl Surface<'_> {
    /// The vertex that `side` leaves, its position, and its angle defect.
    fn vertex(&self, side: u32) -> u32 {
        self.mesh.origin(side)
    }

    fn place(&self, side: u32) -> DVec3 {
        self.mesh.positions[self.vertex(side) as usize]
    }

    fn defect(&self, side: u32) -> Option<f64> {
        self.defects[self.vertex(side) as usize]
    }

    /// Returns a side that leaves each vertex whose angle defect may belong to a tip, the largest defects first.
    fn seeds(&self) -> Vec<u32> {
        let mut is_seen = vec![false; self.mesh.positions.len()];
        let sides = (0..self.twin.len() as u32).map(|side| (self.defect(side).unwrap_or(0.0), side));
        let mut seeds: Vec<(f64, u32)> = sides
            .filter(|&(defect, side)| {
                defect > LEAST_DEFECT && !std::mem::replace(&mut is_seen[self.vertex(side) as usize], true)
            })
            .collect();
        seeds.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        seeds.into_iter().map(|(_, side)| side).collect()
    }

    /// Returns the end of the spike whose tip is around the vertex that `seed` leaves, if there is one.
    fn end_of_spike(&self, seed: u32, spacing: f64) -> Option<u32> {
        let tip = self.sides_within(seed, TIP * spacing);
        let curvature: f64 = tip.iter().map(|&side| self.defect(side)).sum::<Option<f64>>()?;
        if !CURVATURE.contains(&curvature) || self.spread(&tip) > ROUND * spacing {
            return None;
        }
        let spike = self.center(&self.ball(seed, SPIKE * spacing));
        let axis = (self.center(&self.ball(seed, TIP * spacing)) - spike).normalize_or_zero();
        let height = |side: u32| (self.place(side) - spike).dot(axis);
        let end = tip.into_iter().max_by(|&a, &b| height(a).total_cmp(&height(b)))?;
        (height(end) > LEAST_HEIGHT * spacing).then_some(end)
    }

    /// Root mean square distance of a tip's curvature from its centre. `tip` has a side for each of its vertices.
    fn spread(&self, tip: &[u32]) -> f64 {
        let weighted = || tip.iter().map(|&side| (self.defect(side).unwrap_or(0.0).max(0.0), self.place(side)));
        let sum: f64 = weighted().map(|(weight, _)| weight).sum();
        let middle = weighted().map(|(weight, p)| weight * p).sum::<DVec3>() / sum;
        (weighted().map(|(weight, p)| weight * p.distance_squared(middle)).sum::<f64>() / sum).sqrt()
    }

    /// Returns the triangles connected to that of `seed` by edges that reach into the ball around the vertex that `seed`
    /// leaves.
    fn ball(&self, seed: u32, radius: f64) -> Vec<u32> {
        let middle = self.place(seed);
        let mut found = vec![seed / 3];
        let mut is_found = FxHashSet::from_iter([seed / 3]);
        let mut i = 0;
        while i < found.len() {
            let t = found[i];
            i += 1;
            for side in 3 * t..3 * t + 3 {
                let across = self.twin[side as usize];
                let reaches_in = || [side, next(side)].iter().any(|&s| self.place(s).distance(middle) <= radius);
                if across != NONE && reaches_in() && is_found.insert(across / 3) {
                    found.push(across / 3);
                }
            }
        }
        found
    }

    /// Returns a side that leaves each vertex in that ball.
    fn sides_within(&self, seed: u32, radius: f64) -> Vec<u32> {
        let middle = self.place(seed);
        let mut is_found = FxHashSet::default();
        let sides = self.ball(seed, radius).into_iter().flat_map(|t| 3 * t..3 * t + 3);
        let is_within = |side: &u32| self.place(*side).distance(middle) <= radius;
        sides.filter(is_within).filter(|&side| is_found.insert(self.vertex(side))).collect()
    }

    /// Centre of mass of `triangles`.
    fn center(&self, triangles: &[u32]) -> DVec3 {
        let mut moment = DVec3::ZERO;
        let mut mass = 0.0;
        for &t in triangles {
            let area = self.mesh.triangle_area(t as usize);
            moment += area * self.mesh.centroid(t as usize);
            mass += area;
        }
        moment / mass
    }
}

/// One minus the sum of the angles around each vertex, in full turns; `None` on the boundary and on feature curves.
fn angle_defects(mesh: &Mesh, twin: &[u32]) -> Vec<Option<f64>> {
    let mut defects = vec![Some(1.0); mesh.positions.len()];
    let count = mesh.triangles.len();
    for first in (0..count).step_by(BLOCK) {
        let block = first..count.min(first + BLOCK);
        let of_triangles = parallel::map(block.clone(), |t| angles(mesh.corners(t)));
        for (&v, angle) in mesh.triangles[block].iter().flatten().zip(of_triangles.iter().flatten()) {
            defects[v as usize] = defects[v as usize].map(|defect| defect - angle / 360.0);
        }
    }
    for side in (0..twin.len() as u32).filter(|&side| twin[side as usize] == NONE) {
        mesh.ends(side).into_iter().for_each(|v| defects[v as usize] = None);
    }
    defects
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::twins;
    use crate::testing::{joined, revolved, sphere};
    use glam::dvec3;

    /// Ends of the spikes, for samples at a distance of 0.1.
    fn spikes_of(mesh: &Mesh) -> Vec<DVec3> {
        let surface = Surface { mesh, twin: &[], defects: Vec::new() };
        spikes(mesh, &twins(&mesh.triangles), |_| 0.1).into_iter().map(|side| surface.place(side)).collect()
    }

    /// A cone of height 1 over a circle of this radius, truncated where its radius is `blunt`.
    fn cone(radius: f64, blunt: f64) -> Mesh {
        let rings = 40;
        let at = |i: i32| f64::from(i) / f64::from(rings);
        let profile: Vec<(f64, f64)> = (0..=rings).map(|i| (radius + (blunt - radius) * at(i), at(i))).collect();
        revolved([0.0, 1.0], &profile, 24)
    }

    #[test]
    fn narrow_cones_are_spikes_and_wide_ones_and_spheres_are_not() {
        let [at] = spikes_of(&cone(0.25, 1e-3))[..] else { panic!("not one spike") };
        assert!(at.distance(DVec3::Z) < 2e-3, "{at}");
        assert!(spikes_of(&cone(0.5, 1e-3)).is_empty());
        assert!(spikes_of(&sphere()).is_empty());
    }

    #[test]
    fn a_tip_that_is_cut_off_ends_in_one_vertex_of_its_end() {
        let [at] = spikes_of(&cone(0.15, 0.02))[..] else { panic!("not one spike") };
        assert!((at - DVec3::Z).length() < 0.021, "{at}");
        assert!(spikes_of(&cone(0.15, 0.06)).is_empty(), "what is wider is round");
    }

    #[test]
    fn bodies_smaller_than_the_spacing_have_none() {
        let mut small = sphere();
        small.positions.iter_mut().for_each(|p| *p = 0.02 * *p);
        let beside = |mesh: Mesh| {
            let moved = mesh.positions.into_iter().map(|p| p + dvec3(3.0, 0.0, 0.0)).collect();
            Mesh { positions: moved, ..mesh }
        };
        assert_eq!(spikes_of(&joined([small, beside(cone(0.25, 1e-3))])).len(), 1);
    }
}
