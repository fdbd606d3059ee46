//! Untangles a mesh: changes the number and the connectivity of vertices at crossing faces and at small angles.
//!
//! Where curves come close to each other, at the rim of a hole in a thin wall or in a fold, no vertex positions separate the
//! faces, or enlarge their angles, if there is one vertex too many or too few. At each face that crosses another one, and at
//! each triangle with a small angle, a nearby edge collapses, splits, flips, or lets a curve pass through the opposite
//! corner, and the triangles around are relaxed. Of these changes, the one that leaves the fewest faults is kept. Where no
//! single change helps, those that leave the shortest common segments are followed by others. No edge becomes too long, and
//! points of the surface stay near the triangles, whatever changed there before.
//!
//! Cost: a search for self-intersections, and a hundred to a thousand examinations of the surrounding faces per fault.
//!
//! Limits: the number of vertices changes; the caller makes up for that elsewhere.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::small_angles::with_angles_below;
use crate::optimize::angles::Goal;
use crate::optimize::crossings::Crossings;
use crate::optimize::exchange::is_near;
use crate::optimize::faults::{Counted, Faults};
use crate::optimize::places::{GivenUp, Place, disjoint, relaxed, split};
use crate::optimize::probes::{Probe, Probes, distance};
use crate::spatial::self_intersections::faces_of;
use crate::surface::domain::Domain;
use glam::DVec3;
use std::cell::OnceCell;
use std::collections::BTreeSet;

/// Maximum number of passes over all faults. Each pass handles one fault of a cluster of neighbouring ones.
const MOST_PASSES: usize = 30;

/// Minimum number of places per pass if only the excess of crossing faces is to be removed.
const FEWEST_AT_ONCE: usize = 8;

/// Maximum number of changes in a row, and number of candidates that are followed by others.
const MOST_IN_A_ROW: usize = 3;
const MOST_FOLLOWED: usize = 3;

/// Number of candidates that are relaxed: those with the fewest faults before.
const MOST_RELAXED: usize = 3;

/// Maximum edge length after a change, in target edge lengths. Without this limit, successive changes would dissolve rods
/// thinner than the target edge length.
const LONGEST: f64 = 2.0;

/// Maximum number of surface points watched at a place; a dense surface has more.
const MOST_PROBES: usize = 200;

/// What is untangled besides faces that cross although the surface does not, and how far the surface may move.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    /// Angle, in degrees, below which angles are too small unless they are forced.
    pub angles_below: f64,
    /// Number of faces that may cross where the surface does, too. If there are more, they are untangled until there are
    /// not.
    pub most_crossing: usize,
    /// Maximum distance by which the surface may move at a place, in target edge lengths.
    pub farthest: f64,
    /// Maximum share of the triangles at fault. If there are more, none is untangled: too many would remain for the time it
    /// takes.
    pub most_at_fault: f64,
}

/// Changes the mesh where faces cross although the surface does not, and at small angles, until no such fault is left or
/// nothing helps. Then does the same where too many faces cross as the surface does. `spacing` is the mean edge length.
/// Returns whether anything changed.
pub fn untangle(domain: &Domain, mesh: &mut Manifold, aim: Aim, spacing: f64, monitor: &dyn Monitor) -> Result<bool> {
    let of = |inherited: bool| Counted { angles_below: aim.angles_below, inherited };
    let is_better = untangle_counted(domain, mesh, aim, of(false), spacing, monitor)?;
    let is_freer = aim.most_crossing < usize::MAX && untangle_counted(domain, mesh, aim, of(true), spacing, monitor)?;
    Ok(is_better || is_freer)
}

/// Changes the mesh at one kind of fault; returns whether it did.
fn untangle_counted(
    domain: &Domain,
    mesh: &mut Manifold,
    aim: Aim,
    counted: Counted,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<bool> {
    let mut crossings = Crossings::new(domain, mesh);
    let most_at_fault = aim.most_at_fault * mesh.triangles().count() as f64;
    let mut has_changed = false;
    let (mut in_a_row, mut given_up) = (1, GivenUp::default());
    for pass in 0..MOST_PASSES {
        check(monitor)?;
        let excess = faces_of(crossings.all.clone()).len().saturating_sub(aim.most_crossing);
        if counted.inherited && excess == 0 {
            break;
        }
        // Each change separates at least two faces, but not every place has one that helps.
        let most = if counted.inherited { excess.div_ceil(2).max(FEWEST_AT_ONCE) } else { usize::MAX };
        let faults = faults(mesh, &crossings, counted);
        let at_fault = if counted.inherited { excess } else { faults.len() };
        if pass == 0 && at_fault as f64 > most_at_fault {
            break;
        }
        let sides: Vec<u32> = faults.iter().filter(|&&t| !given_up.has(t)).map(|t| 3 * t).collect();
        let places = disjoint(mesh, &sides, most);
        if places.is_empty() {
            if faults.is_empty() || in_a_row == MOST_IN_A_ROW {
                break;
            }
            (in_a_row, given_up) = (MOST_IN_A_ROW, GivenUp::default());
            continue;
        }
        let farthest = aim.farthest * spacing;
        let untangling = Untangling { domain, faces: &crossings.faces, counted, farthest, spacing, monitor };
        let touched = given_up.change(mesh, &places, |place| untangling.better(place, in_a_row))?;
        crossings.renew(domain, mesh, &touched);
        has_changed |= touched.contains(&true);
        if in_a_row > 1 {
            // All faults of a place were examined together.
            let in_vain: Vec<&Place> = places.iter().filter(|place| given_up.has(place.triangle())).collect();
            let is_in_vain = |t: u32| in_vain.iter().any(|place| place.around.has_triangle(t));
            faults.into_iter().filter(|&t| is_in_vain(t)).for_each(|t| given_up.add(t));
        }
    }
    Ok(has_changed)
}

/// Returns the triangles at fault, in increasing order: all that cross if inherited crossings count, or else those that
/// cross avoidably or have small angles.
fn faults(mesh: &Manifold, crossings: &Crossings, counted: Counted) -> BTreeSet<u32> {
    let faces = |pairs: &[(u32, u32)]| pairs.iter().flat_map(|&(t, u)| [t, u]).collect();
    if counted.inherited {
        return faces(&crossings.all);
    }
    let small = with_angles_below(mesh, counted.angles_below).into_iter().collect();
    &faces(&crossings.avoidable) | &small
}

struct Untangling<'a> {
    domain: &'a Domain,
    /// The faces of the mesh.
    faces: &'a Faces,
    counted: Counted,
    /// How far the surface may move, to be multiplied by the sizes of samples.
    farthest: f64,
    spacing: f64,
    monitor: &'a dyn Monitor,
}

/// The part of the surface near a place. It has to stay near, whatever changed at the place before.
struct Watched {
    probes: Vec<Probe>,
    farthest: f64,
}

impl Watched {
    /// Returns whether all of it is near the triangles of `mesh` that face the same way.
    fn is_kept_by(&self, mesh: &Manifold) -> bool {
        let faces = Faces::new(mesh);
        self.probes.iter().all(|probe| distance(&faces, probe, self.farthest, self.farthest).is_some())
    }
}

/// A possible new state of a place, with its faults.
type Candidate = (Faults, Neighborhood);

impl Untangling<'_> {
    /// Returns the surroundings of `place` after changes that leave fewer and fewer faults there, up to `in_a_row` of them
    /// at a time; `None` if there are none. If only one is made at a time, the first one is made at the triangle of the
    /// place.
    fn better(&self, place: &Place, in_a_row: usize) -> Result<Option<Neighborhood>> {
        let mut now = (self.faults(&place.around, &Faults::default()), place.around.clone());
        if in_a_row == 1 {
            now.0.triangles = vec![place.own_side() / 3];
        }
        let (mut is_better, watched) = (false, OnceCell::new());
        while !now.0.triangles.is_empty() {
            let Some(next) = self.improved(place, &watched, &now, in_a_row)? else { break };
            (now, is_better) = (next, true);
            // Of the faces that cross as the surface does, only the excess is separated.
            if self.counted.inherited {
                break;
            }
        }
        Ok(is_better.then_some(now.1))
    }

    /// Returns the state of `place`, which is `now`, after the fewest changes in a row that leave it with fewer faults.
    fn improved(
        &self,
        place: &Place,
        watched: &OnceCell<Watched>,
        now: &Candidate,
        in_a_row: usize,
    ) -> Result<Option<Candidate>> {
        let most = longest(&place.around.mesh).max(LONGEST * self.spacing);
        let is_near = |changed: &Neighborhood| {
            longest(&changed.mesh) <= most
                && is_near(&place.around.mesh, &changed.mesh, self.farthest)
                && watched.get_or_init(|| self.watched(place)).is_kept_by(&changed.mesh)
        };
        let mut followed = vec![now.clone()];
        for _ in 0..in_a_row {
            let changes = followed.iter().flat_map(|(faults, around)| {
                let changed = changes(self.domain, around, &faults.triangles);
                changed.into_iter().map(move |changed| (faults, changed))
            });
            // Done in parallel, since in the end there are few places, each with many changes.
            let mut changed: Vec<Candidate> =
                parallel::each(changes, |(faults, changed)| (self.faults(&changed, faults), changed));
            changed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let relaxed = parallel::each(changed.iter().take(MOST_RELAXED), |(faults, changed)| {
                let relaxed = relaxed(self.domain, changed.clone(), Goal::GOOD, self.spacing, self.monitor)?;
                Ok((self.faults(&relaxed, faults), relaxed))
            });
            let relaxed: Vec<Candidate> = relaxed.into_iter().collect::<Result<_>>()?;
            changed.extend(relaxed);
            changed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let is_better = |(faults, around): &Candidate| faults.are_fewer_than(&now.0) && is_near(around);
            if let Some(better) = changed.iter().position(is_better) {
                return Ok(Some(changed.swap_remove(better)));
            }
            changed.truncate(MOST_FOLLOWED);
            followed = changed;
        }
        Ok(None)
    }

    /// Returns the part of the surface that is near `place`.
    fn watched(&self, place: &Place) -> Watched {
        let mesh = &place.around.mesh;
        let middle = mesh.samples().iter().map(|sample| sample.position).sum::<DVec3>() / mesh.samples().len() as f64;
        let reach = mesh.samples().iter().map(|sample| sample.position.distance(middle)).fold(0.0, f64::max);
        let [size, ..] = mesh.connectivity.triangle(place.own_side()).map(|v| mesh.sample(v).size);
        let farthest = size * self.farthest;
        let belongs = |probe: &Probe| {
            distance(self.faces, probe, 0.0, farthest).is_some_and(|(_, t)| place.around.has_triangle(t))
        };
        let probes = Probes::near(self.domain, middle, reach, size * self.spacing);
        let each = probes.count().div_ceil(MOST_PROBES).max(1);
        Watched { probes: probes.all(self.domain).step_by(each).filter(belongs).collect(), farthest }
    }

    /// Returns the faults of the mesh if `around` were put back; `before` are those that it had before some of it changed.
    fn faults(&self, around: &Neighborhood, before: &Faults) -> Faults {
        Faults::new(self.domain, self.faces, self.counted, around, before)
    }
}

/// Returns the length of the longest edge of a mesh, relative to the sizes at its ends.
fn longest(mesh: &Manifold) -> f64 {
    mesh.edges().map(|h| mesh.relative_length_squared(h)).fold(0.0, f64::max).sqrt()
}

/// Returns `around` after each possible change of one edge around these triangles.
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

/// Returns whether the origin of `h` may merge into its target. Vertices on the border to the rest stay there, and on their
/// curves; a corner merges only into another corner.
fn may_merge(around: &Neighborhood, h: u32) -> bool {
    let c = &around.mesh.connectivity;
    let (origin, target) = (c.origin(h), c.target(h));
    let leaves_corner = c.is_corner(origin) && !c.is_corner(target);
    let leaves_border = c.is_boundary(origin) || c.is_on_curve(origin) && c.is_boundary(target);
    c.can_collapse(h) || c.can_merge(h) && !leaves_corner && !leaves_border
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifold::small_angles::SLIVER;
    use crate::mesh::topology::topology;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing::{grid, joined};
    use glam::dvec3;

    /// A valley over a flat sheet of `N` by `N` unit squares, `lowest` above it in the middle, and a mesh over both.
    fn valley_over_sheet(lowest: f64) -> (Domain, Manifold) {
        let sheet = |height: &dyn Fn(f64, f64) -> f64| {
            grid(N, N, |u, v| dvec3(f64::from(N) * u, f64::from(N) * v, height(u, v)))
        };
        let input: Mesh = joined([sheet(&|_, _| 0.0), sheet(&|u, _| lowest + 2.0 * (u - 0.5).abs())]);
        let domain = Domain::new(input.clone().try_into().unwrap());
        let samples = input.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &input.triangles);
        mesh.lock_boundary();
        (domain, mesh)
    }

    const N: u32 = 12;
    const SOUND: Aim = Aim { angles_below: SLIVER, most_crossing: usize::MAX, farthest: 1.0, most_at_fault: 1.0 };

    #[test]
    fn faces_that_cross_are_taken_apart_by_other_edges() {
        let (domain, mut mesh) = valley_over_sheet(0.1);
        // The bottom of the valley goes through the sheet.
        let middle = N * (N + 1) / 2 + N / 2;
        let upper = (N + 1) * (N + 1) + middle;
        mesh.raise(upper as usize, -0.3);
        let crossing = |mesh: &Manifold| Crossings::new(&domain, mesh).avoidable.len();
        assert!(crossing(&mesh) > 3);
        let few = Aim { most_at_fault: 0.001, ..SOUND };
        assert!(!untangle(&domain, &mut mesh, few, 1.0, &()).unwrap());
        assert!(untangle(&domain, &mut mesh, SOUND, 1.0, &()).unwrap());
        assert_eq!(crossing(&mesh), 0);
        let left = mesh.to_mesh();
        let t = topology(left.positions.len(), &left.triangles);
        assert!(t.is_manifold() && t.is_oriented() && (t.components, t.euler, t.boundary_loops) == (2, 2, 2));
    }

    #[test]
    fn a_sliver_goes_and_what_is_sound_stays() {
        let (domain, mut mesh) = valley_over_sheet(0.1);
        let before = mesh.to_mesh();
        assert!(!untangle(&domain, &mut mesh, SOUND, 1.0, &()).unwrap());
        assert_eq!(mesh.to_mesh().positions, before.positions);
        let v = N * (N + 1) / 2 + N / 2;
        let neighbour = mesh.connectivity.ring(v).next().unwrap();
        mesh.place_at(v, mesh.position(neighbour).lerp(mesh.position(v), 1e-3));
        let slivers = |mesh: &Manifold| with_angles_below(mesh, SLIVER).len();
        assert!(slivers(&mesh) > 0);
        untangle(&domain, &mut mesh, SOUND, 1.0, &()).unwrap();
        assert_eq!(slivers(&mesh), 0);
    }

    #[test]
    fn what_moves_away_from_the_surface_does_not_keep_it() {
        let (domain, mesh) = valley_over_sheet(0.1);
        let faces = Faces::new(&mesh);
        let counted = Counted { angles_below: 30.0, inherited: false };
        let untangling =
            Untangling { domain: &domain, faces: &faces, counted, farthest: 0.6, spacing: 1.0, monitor: &() };
        let upper = mesh.triangles().find(|&t| mesh.corners(t).iter().all(|p| p.z > 0.1)).unwrap();
        let [place] = disjoint(&mesh, &[3 * upper], 1).try_into().unwrap_or_else(|_| unreachable!("one was asked for"));
        let watched = untangling.watched(&place);
        let keeps_it = |way: f64| {
            let mut moved = place.around.mesh.clone();
            moved.change_samples(|_, sample| sample.position.z += way);
            watched.is_kept_by(&moved)
        };
        assert_eq!([0.0, 0.3, -0.3, 0.9, -0.9].map(keeps_it), [true, true, true, false, false]);
    }

    #[test]
    fn small_angles_go() {
        let (domain, mut mesh) = valley_over_sheet(0.1);
        let v = N * (N + 1) / 2 + N / 2;
        let neighbour = mesh.connectivity.ring(v).next().unwrap();
        mesh.place_at(v, mesh.position(neighbour).lerp(mesh.position(v), 0.2));
        let angles = Aim { angles_below: 30.0, farthest: 0.6, ..SOUND };
        let small = |mesh: &Manifold| with_angles_below(mesh, angles.angles_below).len();
        assert!(small(&mesh) > 0);
        untangle(&domain, &mut mesh, angles, 1.0, &()).unwrap();
        assert_eq!(small(&mesh), 0);
    }

    #[test]
    fn faces_that_cross_where_the_surface_does_become_fewer_only_if_they_are_too_many() {
        let (domain, mesh) = valley_over_sheet(-0.05);
        let crossing = |mesh: &Manifold| faces_of(Crossings::new(&domain, mesh).all).len();
        let left = |most_crossing: usize| {
            let mut mesh = mesh.clone();
            untangle(&domain, &mut mesh, Aim { most_crossing, ..SOUND }, 1.0, &()).unwrap();
            crossing(&mesh)
        };
        let before = crossing(&mesh);
        let [enough, fewer] = [before, before / 2].map(left);
        assert!(before > 20 && enough == before && fewer < before, "{before} {enough} {fewer}");
    }

    #[test]
    fn faults_after_a_change_are_those_of_all_faces() {
        let (domain, mut mesh) = valley_over_sheet(0.1);
        let upper = (N + 1) * (N + 1) + N * (N + 1) / 2 + N / 2;
        mesh.raise(upper as usize, -0.3);
        let faces = Faces::new(&mesh);
        let counted = Counted { angles_below: SLIVER, inherited: false };
        let middle = mesh.connectivity.outgoing(upper).next().unwrap() / 3;
        let around = Neighborhood::across_curves(&mesh, middle, 2, |_| false).unwrap();
        let faults = |around: &Neighborhood, before: &Faults| Faults::new(&domain, &faces, counted, around, before);
        let before = faults(&around, &Faults::default());
        let changed = changes(&domain, &around, &before.triangles);
        assert!(before.triangles.len() > 3 && changed.len() > 20);
        let mut fewer = 0;
        for changed in changed {
            let [known, anew] = [&before, &Faults::default()].map(|before| faults(&changed, before));
            assert!(!known.are_fewer_than(&anew) && !anew.are_fewer_than(&known));
            assert_eq!(known.triangles, anew.triangles);
            fewer += usize::from(known.are_fewer_than(&before));
        }
        assert!(fewer > 0);
    }
}
