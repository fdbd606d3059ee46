//! Untangles a mesh: changes how many vertices there are at faces that cross and at slivers, and how they are joined.
//!
//! Where curves come near each other, at the rim of a hole in a thin wall or in a fold, no place of the vertices takes the faces
//! apart if there is one vertex too many or too few. At each face that crosses another one, and at each sliver, an edge near it
//! collapses, splits, flips, or lets a curve pass through the corner across, and the triangles around settle. Of these changes the
//! one that leaves the fewest faults stays. Where no single one helps, those that leave the shortest segments in common
//! are followed by others.
//!
//! Cost: a search for self-intersections, and for each fault a hundred to a thousand looks at the faces around it.
//!
//! Limits: the number of vertices changes; the caller makes up for that elsewhere.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::geom::aabb::Aabb;
use crate::geom::crossing_segment::crossing_segment;
use crate::geom::intersection::cross_deeper_than;
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::small_angles::is_sliver;
use crate::optimize::angles::cost;
use crate::optimize::crossings::{Corners, Crossings, length_of_fold};
use crate::optimize::exchange::is_near;
use crate::optimize::places::{GivenUp, Place, disjoint, settled, split};
use crate::surface::domain::Domain;
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// Passes over all faults: of those near each other one is looked at in each.
const MOST_PASSES: usize = 30;

/// Changes in a row that are looked for, and how many are followed by others.
const MOST_IN_A_ROW: usize = 3;
const MOST_FOLLOWED: usize = 3;

/// How many settle, of those that leave the fewest faults before.
const MOST_SETTLED: usize = 3;

/// How far the surface may move at a place, in wanted lengths.
const FARTHEST: f64 = 1.0;

/// Changes the mesh where faces cross although the surface does not, and at slivers, until there is no such fault or nothing helps.
/// `spacing` is the mean edge length.
pub fn untangle(domain: &Domain, mesh: &mut Manifold, spacing: f64, monitor: &dyn Monitor) -> Result<()> {
    let mut crossings = Crossings::new(domain, mesh);
    let (mut in_a_row, mut given_up) = (1, GivenUp::default());
    for _ in 0..MOST_PASSES {
        check(monitor)?;
        let faults = faults(mesh, &crossings);
        let sides: Vec<u32> = faults.iter().filter(|&&t| !given_up.has(t)).map(|t| 3 * t).collect();
        let places = disjoint(mesh, &sides, usize::MAX);
        if places.is_empty() {
            if faults.is_empty() || in_a_row == MOST_IN_A_ROW {
                break;
            }
            (in_a_row, given_up) = (MOST_IN_A_ROW, GivenUp::default());
            continue;
        }
        let untangling = Untangling { domain, faces: &crossings.faces, spacing, monitor };
        let touched = given_up.change(mesh, &places, |place| untangling.better(place, in_a_row))?;
        crossings.renew(domain, mesh, &touched);
        if in_a_row > 1 {
            // All faults of a place were looked at together.
            let in_vain: Vec<&Place> = places.iter().filter(|place| given_up.has(place.triangle())).collect();
            let is_in_vain = |t: u32| in_vain.iter().any(|place| place.around.has_triangle(t));
            faults.into_iter().filter(|&t| is_in_vain(t)).for_each(|t| given_up.add(t));
        }
    }
    Ok(())
}

/// The triangles that cross others although the surface does not, and slivers, in increasing order.
fn faults(mesh: &Manifold, crossings: &Crossings) -> BTreeSet<u32> {
    let crossing = crossings.avoidable.iter().flat_map(|&(t, u)| [t, u]);
    crossing.chain(mesh.triangles().filter(|&t| is_sliver(mesh, t))).collect()
}

struct Untangling<'a> {
    domain: &'a Domain,
    /// The faces of the mesh.
    faces: &'a Faces,
    spacing: f64,
    monitor: &'a dyn Monitor,
}

/// What may become of a place.
type Candidate = (Faults, Neighborhood);

impl Untangling<'_> {
    /// What is around `place` after changes that leave fewer and fewer faults there, up to `in_a_row` of them at a time; `None`
    /// if there are none. If only one is made at a time, the first one is made at the triangle of the place.
    fn better(&self, place: &Place, in_a_row: usize) -> Result<Option<Neighborhood>> {
        let mut now = (self.faults(&place.around), place.around.clone());
        if in_a_row == 1 {
            now.0.triangles = vec![place.own_side() / 3];
        }
        let mut is_better = false;
        while now.0.count > 0 && !now.0.triangles.is_empty() {
            let Some(next) = self.improved(place, &now, in_a_row)? else { break };
            (now, is_better) = (next, true);
        }
        Ok(is_better.then_some(now.1))
    }

    /// What `place`, which is `now` so, becomes by the fewest changes in a row after which it has fewer faults.
    fn improved(&self, place: &Place, now: &Candidate, in_a_row: usize) -> Result<Option<Candidate>> {
        let is_near = |changed: &Neighborhood| is_near(&place.around.mesh, &changed.mesh, FARTHEST * self.spacing);
        let mut followed = vec![now.clone()];
        for _ in 0..in_a_row {
            let changes = followed.iter().flat_map(|(faults, around)| changes(self.domain, around, &faults.triangles));
            let mut changed: Vec<Candidate> = changes.map(|around| (self.faults(&around), around)).collect();
            changed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let settled = changed.iter().take(MOST_SETTLED).map(|(_, changed)| {
                let settled = settled(self.domain, changed.clone(), self.spacing, self.monitor)?;
                Ok((self.faults(&settled), settled))
            });
            let settled: Vec<Candidate> = settled.collect::<Result<_>>()?;
            changed.extend(settled);
            changed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let fewer = changed.partition_point(|(faults, _)| faults.count < now.0.count);
            if let Some(better) = changed[..fewer].iter().position(|(_, around)| is_near(around)) {
                return Ok(Some(changed.swap_remove(better)));
            }
            changed.truncate(MOST_FOLLOWED);
            followed = changed;
        }
        Ok(None)
    }

    /// The faults of the mesh if `around` were put back.
    fn faults(&self, around: &Neighborhood) -> Faults {
        let mesh = &around.mesh;
        let (depth, inherited) = (self.faces.depth_of_contact(), self.domain.inherited());
        let cross =
            |a: Corners, b: Corners| cross_deeper_than(depth, a, b) && !(inherited.is_near(a) && inherited.is_near(b));
        let bounded = |t: u32| (t, Aabb::of_triangle(mesh.corners(t)), mesh.corners(t));
        let own: Vec<(u32, Aabb, Corners)> = mesh.triangles().map(bounded).collect();
        let mut faults = Faults { cost: cost(mesh), ..Faults::default() };
        for (i, &(t, bounds, a)) in own.iter().enumerate() {
            for &(u, other, b) in &own[..i] {
                if other.meets(&bounds) && cross(a, b) {
                    faults.add_crossing(&[t, u], a, b);
                }
            }
            self.faces.in_box(&bounds, |u, b| {
                if !around.has_triangle(u) && cross(a, b) {
                    faults.add_crossing(&[t], a, b);
                }
            });
            if is_sliver(mesh, t) {
                faults.count += 1;
                faults.triangles.push(t);
            }
            faults.turned += usize::from(mesh.agreement(mesh.connectivity.triangle(3 * t)) < 0.0);
        }
        faults.triangles.sort_unstable();
        faults.triangles.dedup();
        faults
    }
}

/// What is wrong with the triangles of a place.
#[derive(Debug, Clone, Default)]
struct Faults {
    /// Pairs of faces that cross although the surface does not, and slivers.
    count: usize,
    /// Triangles that face against the surface.
    turned: usize,
    /// The length of what faces have in common.
    length: f64,
    /// What the triangles cost by the measure of [`angles`](crate::optimize::angles).
    cost: f64,
    /// The triangles at fault, in increasing order.
    triangles: Vec<u32>,
}

impl Faults {
    /// Adds faces that cross, of which `own` are in the place.
    fn add_crossing(&mut self, own: &[u32], a: Corners, b: Corners) {
        self.count += 1;
        self.length += crossing_segment(a, b).map_or_else(|| length_of_fold(a, b), |segment| segment.length);
        self.triangles.extend(own);
    }

    fn total_cmp(&self, other: &Faults) -> Ordering {
        let numbers = (self.count, self.turned).cmp(&(other.count, other.turned));
        numbers.then(self.length.total_cmp(&other.length)).then(self.cost.total_cmp(&other.cost))
    }
}

/// What becomes of `around` by each change of one edge around some of its triangles.
fn changes(domain: &Domain, around: &Neighborhood, triangles: &[u32]) -> Vec<Neighborhood> {
    let c = &around.mesh.connectivity;
    let corners = triangles.iter().flat_map(|&t| c.triangle(3 * t));
    let triangles: BTreeSet<u32> = corners.flat_map(|v| c.outgoing(v)).map(|h| h / 3).collect();
    let is_first = |h: u32| !c.has_twin(h) || h < c.twin(h) || !triangles.contains(&(c.twin(h) / 3));
    let edges = || triangles.iter().flat_map(|&t| 3 * t..3 * t + 3).filter(|&h| is_first(h));
    let sides = || edges().flat_map(|h| c.both_sides(h));
    let changed = |change: &dyn Fn(&mut Manifold)| {
        let mut changed = around.clone();
        change(&mut changed.mesh);
        changed
    };
    let merged = sides().filter(|&h| may_merge(around, h)).map(|h| changed(&|mesh| mesh.merge(h)));
    let bends = sides().filter(|&h| c.can_bend(h) && !c.is_boundary(c.apex(h)));
    let bent = bends.map(|h| changed(&|mesh| mesh.connectivity.bend(h)));
    let flipped = edges().filter(|&h| c.can_flip(h)).map(|h| changed(&|mesh| mesh.connectivity.flip(h)));
    let split = edges().filter_map(|h| split(domain, around, h));
    merged.chain(bent).chain(flipped).chain(split).collect()
}

/// Whether the origin of `h` may merge into its target. What is on the border to the rest stays there, and on its curves.
fn may_merge(around: &Neighborhood, h: u32) -> bool {
    let c = &around.mesh.connectivity;
    let (origin, target) = (c.origin(h), c.target(h));
    c.can_collapse(h) || c.can_merge(h) && !c.is_boundary(origin) && !(c.is_on_curve(origin) && c.is_boundary(target))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing::{grid, joined};
    use glam::dvec3;

    /// A valley over a flat sheet of `N` by `N` unit squares, a tenth above it where it is lowest, and a mesh over both.
    fn valley_over_sheet() -> (Domain, Manifold) {
        let sheet = |height: &dyn Fn(f64, f64) -> f64| {
            grid(N, N, |u, v| dvec3(f64::from(N) * u, f64::from(N) * v, height(u, v)))
        };
        let input: Mesh = joined([sheet(&|_, _| 0.0), sheet(&|u, _| 0.1 + 2.0 * (u - 0.5).abs())]);
        let domain = Domain::new(input.clone().try_into().unwrap());
        let samples = input.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &input.triangles);
        mesh.lock_boundary();
        (domain, mesh)
    }

    const N: u32 = 12;

    #[test]
    fn faces_that_cross_are_taken_apart_by_other_edges() {
        let (domain, mut mesh) = valley_over_sheet();
        // The bottom of the valley goes through the sheet.
        let middle = N * (N + 1) / 2 + N / 2;
        let upper = (N + 1) * (N + 1) + middle;
        mesh.samples[upper as usize].position.z = -0.3;
        let crossing = |mesh: &Manifold| Crossings::new(&domain, mesh).avoidable.len();
        assert!(crossing(&mesh) > 3);
        untangle(&domain, &mut mesh, 1.0, &()).unwrap();
        assert_eq!(crossing(&mesh), 0);
        let left = mesh.to_mesh();
        let t = topology(left.positions.len(), &left.triangles);
        assert!(t.is_manifold() && t.is_oriented() && (t.components, t.euler, t.boundary_loops) == (2, 2, 2));
    }

    #[test]
    fn a_sliver_goes_and_what_is_sound_stays() {
        let (domain, mut mesh) = valley_over_sheet();
        let before = mesh.to_mesh();
        untangle(&domain, &mut mesh, 1.0, &()).unwrap();
        assert_eq!(mesh.to_mesh().positions, before.positions);
        let v = N * (N + 1) / 2 + N / 2;
        let neighbour = mesh.connectivity.ring(v).next().unwrap();
        mesh.samples[v as usize].position = mesh.position(neighbour).lerp(mesh.position(v), 1e-3);
        let slivers = |mesh: &Manifold| mesh.triangles().filter(|&t| is_sliver(mesh, t)).count();
        assert!(slivers(&mesh) > 0);
        untangle(&domain, &mut mesh, 1.0, &()).unwrap();
        assert_eq!(slivers(&mesh), 0);
    }
}
