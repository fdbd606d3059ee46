//! Faults of a place of a mesh: faces that cross, above all where the surface does not, and small angles.
//!
//! When a place changes step by step, only its new faces are tested against the others.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::geom::crossing_segment::crossing_segment;
use crate::geom::intersection::cross_deeper_than;
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::small_angles::{SLIVER, SmallAngle, small_angles};
use crate::optimize::angles::Goal;
use crate::optimize::crossings::{Corners, length_of_fold};
use crate::surface::domain::Domain;
use crate::surface::narrow_patches::SHARPEST;
use std::cmp::Ordering;

/// Minimum growth of the smallest angle, in degrees, if as many angles are too small as before.
const LEAST_GAIN: f64 = 1.0;

/// What counts as a fault besides faces that cross although the surface does not, and slivers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counted {
    /// Angle, in degrees, below which unforced angles count.
    pub angles_below: f64,
    /// Whether faces that cross where the surface does, too, count.
    pub inherited: bool,
}

/// The faults of the triangles of a place.
#[derive(Debug, Clone, Default)]
pub(super) struct Faults {
    /// The faces of the place, in the order of their numbers.
    faces: Vec<(u32, Corners)>,
    crossings: Vec<Crossing>,
    /// Number of pairs of faces that cross although the surface does not, and of slivers.
    unsound: usize,
    /// Number of pairs of faces that cross where the surface does, too.
    inherited: usize,
    /// Number of triangles with small unforced angles, and of those that miss even the modest goal.
    small: usize,
    very_small: usize,
    /// The smallest angle in degrees, forced or not; at most the limit.
    smallest: f64,
    /// Number of triangles that face against the surface.
    turned: usize,
    /// Number of edges at which the faces turn by more than [`SHARPEST`], as at the rim of a plate whose two sides meet.
    blades: usize,
    /// Total common length of the pairs of faces that count.
    length: f64,
    /// Cost of the triangles by the measure of [`angles`](crate::optimize::angles).
    cost: f64,
    /// The triangles at fault, in increasing order.
    pub triangles: Vec<u32>,
}

/// A face of the place that crosses another one.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    face: u32,
    /// The other face, if it belongs to the place.
    other: Option<u32>,
    /// Their common length.
    length: f64,
    /// Whether the surface crosses there, too.
    is_inherited: bool,
}

impl Crossing {
    fn new(domain: &Domain, (face, a): (u32, Corners), (other, b): (Option<u32>, Corners)) -> Crossing {
        let length = crossing_segment(a, b).map_or_else(|| length_of_fold(a, b), |segment| segment.length);
        Crossing { face, other, length, is_inherited: [a, b].into_iter().all(|t| domain.intersects_itself_near(t)) }
    }

    fn own_faces(&self) -> impl Iterator<Item = u32> {
        [Some(self.face), self.other].into_iter().flatten()
    }
}

impl Faults {
    /// Returns the faults of the mesh with these `faces` if `around` were put back. `before` are the faults that it had
    /// before some of it changed, or none.
    pub fn new(domain: &Domain, faces: &Faces, counted: Counted, around: &Neighborhood, before: &Faults) -> Faults {
        let mesh = &around.mesh;
        let own: Vec<(u32, Corners)> = mesh.triangles().map(|t| (t, mesh.corners(t))).collect();
        let crossings = crossings(domain, faces, around, &own, before);
        let as_surface = crossings.iter().filter(|crossing| crossing.is_inherited).count();
        let small: Vec<SmallAngle> = small_angles(mesh, counted.angles_below.max(SLIVER)).collect();
        let unforced =
            |degrees: f64| small.iter().filter(move |small| small.unforced < degrees).map(|small| small.triangle);
        let at_fault = || crossings.iter().filter(|crossing| counted.inherited || !crossing.is_inherited);
        let mut triangles: Vec<u32> =
            unforced(counted.angles_below).chain(at_fault().flat_map(Crossing::own_faces)).collect();
        triangles.sort_unstable();
        triangles.dedup();
        Faults {
            unsound: crossings.len() - as_surface + unforced(SLIVER).count(),
            inherited: if counted.inherited { as_surface } else { 0 },
            small: unforced(counted.angles_below).count(),
            very_small: unforced(counted.angles_below.min(Goal::MODEST.smallest_angle)).count(),
            smallest: small.iter().map(|small| small.smallest).fold(counted.angles_below, f64::min),
            turned: own.iter().filter(|(t, _)| mesh.agreement(mesh.connectivity.triangle(3 * t)) < 0.0).count(),
            blades: blades(mesh),
            length: at_fault().map(|crossing| crossing.length).sum(),
            cost: Goal::GOOD.cost(mesh),
            faces: own,
            crossings,
            triangles,
        }
    }

    /// Returns the numbers of faults, the graver ones first.
    fn number(&self) -> (usize, usize, usize, usize) {
        (self.unsound, self.inherited, self.very_small, self.small)
    }

    /// Returns whether there are fewer faults than `before`, or as many with larger angles, and nothing else has become
    /// worse. If something was unsound before, fewer faults suffice.
    pub fn are_fewer_than(&self, before: &Faults) -> bool {
        let loses_nothing = self.crossings.len() <= before.crossings.len()
            && self.small <= before.small
            && self.blades + self.turned <= before.blades + before.turned
            && self.smallest >= before.smallest;
        match self.number().cmp(&before.number()) {
            Ordering::Less => before.unsound > 0 || loses_nothing,
            Ordering::Equal => loses_nothing && self.smallest >= before.smallest + LEAST_GAIN,
            Ordering::Greater => false,
        }
    }

    /// Orders by the numbers of faults, then by what makes it likely that another change helps.
    pub fn total_cmp(&self, other: &Faults) -> Ordering {
        let numbers = (self.number(), self.turned).cmp(&(other.number(), other.turned));
        numbers.then(self.length.total_cmp(&other.length)).then(self.cost.total_cmp(&other.cost))
    }

    /// Returns whether the place has this face.
    fn has(&self, (t, corners): &(u32, Corners)) -> bool {
        self.faces.binary_search_by_key(t, |face| face.0).is_ok_and(|place| self.faces[place].1 == *corners)
    }
}

/// Returns the number of edges that are blades.
fn blades(mesh: &Manifold) -> usize {
    let c = &mesh.connectivity;
    let (_, least) = math::sin_cos(SHARPEST.to_radians());
    let normal = |h: u32| {
        let [a, b, c] = mesh.corners(h / 3);
        (b - a).cross(c - a).normalize_or_zero()
    };
    mesh.edges().filter(|&h| c.has_twin(h) && normal(h).dot(normal(c.twin(h))) < least).count()
}

/// Returns the crossings of the `own` faces of `around`, among themselves and with the `faces` around it.
fn crossings(
    domain: &Domain,
    faces: &Faces,
    around: &Neighborhood,
    own: &[(u32, Corners)],
    before: &Faults,
) -> Vec<Crossing> {
    let depth = faces.depth_of_contact();
    let cross = |a: Corners, b: Corners| cross_deeper_than(depth, a, b);
    let (old, new): (Vec<_>, Vec<_>) =
        own.iter().map(|&(t, a)| (t, a, Aabb::of_triangle(a))).partition(|&(t, a, _)| before.has(&(t, a)));
    let stays = |t: u32| old.binary_search_by_key(&t, |face| face.0).is_ok();
    let mut found: Vec<Crossing> =
        before.crossings.iter().copied().filter(|crossing| crossing.own_faces().all(stays)).collect();
    for (i, &(t, a, bounds)) in new.iter().enumerate() {
        for &(u, b, other) in old.iter().chain(&new[..i]) {
            if other.meets(&bounds) && cross(a, b) {
                found.push(Crossing::new(domain, (t, a), (Some(u), b)));
            }
        }
        faces.in_box(&bounds, |u, b| {
            if !around.has_triangle(u) && cross(a, b) {
                found.push(Crossing::new(domain, (t, a), (None, b)));
            }
        });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_small_angles_that_are_larger_are_better_if_nothing_else_is_worse() {
        let before = Faults { small: 2, smallest: 10.0, turned: 1, blades: 3, ..Faults::default() };
        let is_better = |change: &dyn Fn(&mut Faults)| {
            let mut after = before.clone();
            change(&mut after);
            after.are_fewer_than(&before)
        };
        assert!(is_better(&|after| after.smallest = 12.0) && !is_better(&|after| after.smallest = 10.5));
        assert!(is_better(&|after| after.small = 1) && !is_better(&|after| (after.small, after.smallest) = (1, 9.0)));
        assert!(!is_better(&|after| (after.smallest, after.blades) = (12.0, 4)));
        assert!(is_better(&|after| (after.smallest, after.blades, after.turned) = (12.0, 4, 0)));
    }

    #[test]
    fn very_small_angles_count_before_those_that_are_a_little_small() {
        let before = Faults { small: 3, very_small: 1, ..Faults::default() };
        let is_better =
            |very_small: usize, small: usize| Faults { small, very_small, ..before.clone() }.are_fewer_than(&before);
        assert!(is_better(0, 3) && is_better(1, 2));
        assert!(!is_better(2, 2) && !is_better(0, 4));
    }
}
