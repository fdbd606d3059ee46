//! Mends folds: faces that still cross, or are slivers, after all else.
//!
//! What is left of these are mostly places where the surface itself is narrower than the faces: a pocket, a flap, curves that
//! run into each other. The faces that cross are a ring or two from each other there, and no mesh of that spacing can follow
//! the surface. So here it need not, within the length of an edge: vertices merge, edges flip and vertices move into the middle of their
//! neighbours wherever that leaves fewer faces that cross and fewer slivers. As many vertices as merge are added again where nothing is near.
//!
//! Cost: some thirty local searches for each such face, and for each change; each change leaves fewer of them.
//!
//! Limits: sheets that have passed through each other are not parted, see `optimize/self_intersections.rs`.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::geom::triangle::{mean_ratio, smallest_angle};
use crate::manifold::Manifold;
use crate::manifold::facing::LEAST_MENDABLE;
use crate::manifold::slivers::{SLIVER, is_sliver};
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::OnCurve;
use crate::optimize::counts::{meet_count, split_longest_where};
use crate::optimize::crossings::{Corners, Crossings, Surroundings, fan, longest_edge};
use crate::spatial::self_intersections::{Inherited, faces_of};
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use std::collections::BTreeSet;

/// Most faces that are mended: where more cross, the mesh is too coarse for the surface as a whole.
const MOST_FACES: usize = 150;

/// Rings around what was mended that no vertex is added to.
const RINGS: usize = 2;

/// How far a change may lead the mesh away from the surface, in lengths of the longest edge there.
pub const NEAR: f64 = 0.5;
pub const FAR: f64 = 1.0;

/// Largest valence of a vertex that may merge into any of its neighbours, not only along a side of the face: a place has no
/// more neighbours that are near, and looking at all takes its square.
const MOST_NEIGHBOURS: usize = 16;

/// Mends folds of `mesh`, which keeps its number of vertices. `of_domain` gives the triangles of the domain that intersect others:
/// what crosses where they do is left alone. No change leads farther from the surface than `farthest`, in lengths of the longest
/// edge there.
pub fn mend_folds<'a>(
    domain: &Domain,
    of_domain: impl FnOnce() -> &'a [u32],
    mesh: &mut Manifold,
    farthest: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    let mut crossings = Crossings::new(mesh);
    let of_domain = if crossings.pairs.is_empty() { &[] } else { of_domain() };
    let inherited = Inherited::new(of_domain.iter().map(|&t| domain.mesh.corners(t as usize)));
    crossings.keep_avoidable(&inherited, mesh);
    let slivers = mesh.triangles().filter(|&t| is_sliver(mesh, t));
    let faulty: BTreeSet<u32> = faces_of(crossings.pairs).into_iter().chain(slivers).collect();
    if (1..=MOST_FACES).contains(&faulty.len()) {
        let wanted = mesh.connectivity.vertex_count();
        let mut around = Surroundings::new(crossings.faces);
        change_for_fewer(domain, &inherited, mesh, &mut around, &faulty, farthest, monitor)?;
        add_elsewhere(domain, mesh, &around, &faulty, wanted);
    }
    Ok(())
}

/// Makes changes at the `faulty` faces as long as each leaves fewer faults.
fn change_for_fewer(
    domain: &Domain,
    inherited: &Inherited,
    mesh: &mut Manifold,
    around: &mut Surroundings,
    faulty: &BTreeSet<u32>,
    farthest: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    for &face in faulty {
        while mesh.connectivity.has_half_edge(3 * face)
            && around.is_faulty(inherited, mesh, face)
            && let Some(change) = best_change(domain, mesh, around, face, farthest)
        {
            check(monitor)?;
            around.changed.extend(change.faces(mesh));
            change.make(mesh);
        }
    }
    Ok(())
}

/// Of the changes at `face` that leave fewer faults one that leaves good triangles, if any does, and of these the one that leaves the
/// fewest faults.
fn best_change(domain: &Domain, mesh: &Manifold, around: &Surroundings, face: u32, farthest: f64) -> Option<Change> {
    let rank = |change: &Change| {
        let old = change.faces(mesh);
        let now: Vec<Corners> = old.iter().map(|&t| mesh.corners(t)).collect();
        let new = change.leaves(mesh);
        let gain = around.faults(mesh, &now, &old).checked_sub(around.faults(mesh, &new, &old))?;
        let shape = new.into_iter().map(mean_ratio).fold(1.0, f64::min);
        let stays_near = || change.leads_away(domain, mesh) <= farthest;
        (gain > 0 && stays_near()).then_some((shape.min(LEAST_MENDABLE), gain, shape))
    };
    let mut best: Option<((f64, usize, f64), Change)> = None;
    for change in changes(mesh, face) {
        if let Some(rank) = rank(&change).filter(|rank| best.as_ref().is_none_or(|(most, _)| rank > most)) {
            best = Some((rank, change));
        }
    }
    best.map(|(_, change)| change)
}

/// What may be changed of `face`.
fn changes(mesh: &Manifold, face: u32) -> Vec<Change> {
    let c = &mesh.connectivity;
    let sides = || 3 * face..3 * face + 3;
    let corners = || sides().map(|h| c.origin(h));
    let middle = |v: u32| c.ring(v).map(|w| mesh.position(w)).sum::<DVec3>() / c.valence(v) as f64;
    let moves = corners().filter(|&v| c.curve_at(v) == OnCurve::No).map(|v| Change::Move(v, middle(v)));
    let flips = sides().filter(|&h| c.can_flip(h)).map(Change::Flip);
    let along_sides = sides().flat_map(|h| c.both_sides(h));
    let others = corners().filter(|&v| c.valence(v) <= MOST_NEIGHBOURS).flat_map(|v| c.outgoing(v));
    let merges = along_sides.chain(others).filter(|&h| c.can_join(h)).map(Change::Merge);
    moves.chain(flips).chain(merges).collect()
}

/// A change of the mesh, whatever the surface is like there.
#[derive(Debug, Clone, Copy)]
enum Change {
    /// A vertex moves to a place.
    Move(u32, DVec3),
    /// The edge of a half-edge flips.
    Flip(u32),
    /// The origin of a half-edge merges into its target.
    Merge(u32),
}

impl Change {
    /// The faces that become others, or none.
    fn faces(self, mesh: &Manifold) -> Vec<u32> {
        let c = &mesh.connectivity;
        let at = |v: u32| c.outgoing(v).map(|h| h / 3).collect();
        match self {
            Change::Move(v, _) => at(v),
            Change::Flip(h) => vec![h / 3, c.twin(h) / 3],
            Change::Merge(h) => at(c.origin(h)),
        }
    }

    /// What they become.
    fn leaves(self, mesh: &Manifold) -> Vec<Corners> {
        match self {
            Change::Move(v, there) => fan(mesh, v, there),
            Change::Flip(h) => {
                let [a, b, top] = mesh.corners_from(h);
                let [.., bottom] = mesh.corners_from(mesh.connectivity.twin(h));
                vec![[top, a, bottom], [bottom, b, top]]
            }
            Change::Merge(h) => mesh.left_by_collapse(h).map(|t| t.map(|v| mesh.position(v))).collect(),
        }
    }

    /// How far it leads the mesh away from the surface, in lengths of the longest edge there.
    fn leads_away(self, domain: &Domain, mesh: &Manifold) -> f64 {
        let (v, distance) = match self {
            Change::Move(v, there) => {
                let Sample { normal, triangle, .. } = mesh.samples[v as usize];
                (v, domain.project(there, normal, triangle).position.distance(there))
            }
            Change::Flip(_) => return 0.0,
            Change::Merge(h) => (mesh.connectivity.origin(h), mesh.distance_after_collapse(h)),
        };
        distance / longest_edge(mesh, v)
    }

    fn make(self, mesh: &mut Manifold) {
        match self {
            Change::Move(v, there) => mesh.samples[v as usize].position = there,
            Change::Flip(h) => mesh.connectivity.flip(h),
            Change::Merge(h) => mesh.connectivity.merge(h),
        }
    }
}

impl Surroundings {
    /// Whether `face` is a sliver or crosses another one where the domain does not.
    fn is_faulty(&self, inherited: &Inherited, mesh: &Manifold, face: u32) -> bool {
        let own = mesh.corners(face);
        let must_not_cross = !inherited.is_near(own);
        let mut crosses = false;
        self.each_across(mesh, own, |t, other| crosses |= t != face && (must_not_cross || !inherited.is_near(other)));
        crosses || is_sliver(mesh, face)
    }

    /// How many of `new` would be slivers and how many pairs would cross with them there in place of the faces `old`.
    fn faults(&self, mesh: &Manifold, new: &[Corners], old: &[u32]) -> usize {
        let slivers = new.iter().filter(|&&corners| smallest_angle(corners) < SLIVER).count();
        slivers + self.count(mesh, new, old)
    }

    /// Whether all faces around the edge of `h` belong to its own sheet.
    fn is_alone(&self, mesh: &Manifold, h: u32) -> bool {
        let c = &mesh.connectivity;
        let corners = [c.origin(h), c.target(h), c.apex(h), c.apex(c.twin(h))];
        let near: BTreeSet<u32> = corners.into_iter().flat_map(|v| c.ring(v)).collect();
        let places = corners.map(|v| mesh.position(v));
        let lo = places.into_iter().fold(DVec3::INFINITY, DVec3::min);
        let hi = places.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max);
        let mut alone = true;
        self.each_in_box(mesh, lo, hi, |t, _| alone &= c.triangle(3 * t).iter().any(|v| near.contains(v)));
        alone
    }
}

/// Adds vertices, up to the `wanted` number: not near what was changed or is faulty still, nor where another sheet is near, if there
/// is room elsewhere.
fn add_elsewhere(domain: &Domain, mesh: &mut Manifold, around: &Surroundings, faulty: &BTreeSet<u32>, wanted: usize) {
    let there = |t: &&u32| mesh.connectivity.has_half_edge(3 * **t);
    let mut near = VertexSet::EMPTY;
    let faces = around.changed.iter().chain(faulty).filter(there);
    faces.flat_map(|&t| mesh.connectivity.triangle(3 * t)).for_each(|v| near.insert(v));
    let near = near.with_rings(mesh, RINGS);
    split_longest_where(domain, mesh, wanted, |mesh, h| {
        let ends = [mesh.connectivity.origin(h), mesh.connectivity.target(h)];
        !ends.into_iter().any(|v| near.contains(v)) && around.is_alone(mesh, h)
    });
    meet_count(domain, mesh, wanted);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing::grid;
    use glam::dvec3;

    /// A flat sheet of unit squares as domain and as mesh, whose vertex in the middle `place` puts somewhere else.
    fn sheet(place: impl Fn(DVec3) -> DVec3) -> (Domain, Manifold, u32) {
        let input: Mesh = grid(12, 12, |u, v| dvec3(12.0 * u, 12.0 * v, 0.0));
        let domain = Domain::new(input.clone().try_into().unwrap());
        let samples = input.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &input.triangles);
        let middle = (0..169).find(|&v| mesh.position(v) == dvec3(6.0, 6.0, 0.0)).unwrap();
        mesh.samples[middle as usize].position = place(mesh.position(middle));
        (domain, mesh, middle)
    }

    fn mended(domain: &Domain, mesh: &Manifold) -> Manifold {
        let mut mended = mesh.clone();
        mend_folds(domain, || &[], &mut mended, FAR, &()).unwrap();
        assert_eq!(mended.connectivity.vertex_count(), mesh.connectivity.vertex_count());
        mended
    }

    #[test]
    fn a_fold_is_undone_and_no_vertex_is_lost() {
        // Under the sheet beside its neighbours, and up through it: no place on the surface is in reach.
        let (domain, mut mesh, middle) = sheet(|p| p + dvec3(2.5, 0.2, 0.4));
        let beside = mesh.connectivity.ring(middle).next().unwrap();
        mesh.samples[beside as usize].position += dvec3(2.2, -0.1, -0.4);
        assert!(Crossings::new(&mesh).pairs.len() > 3);
        let mended = mended(&domain, &mesh);
        assert!(Crossings::new(&mended).pairs.is_empty());
        let far = |v: u32| mesh.position(v).distance(mesh.position(middle)) > 5.0;
        assert!((0..169).filter(|&v| far(v)).all(|v| mended.position(v) == mesh.position(v)));
    }

    #[test]
    fn a_sliver_is_undone() {
        let (domain, mesh, middle) = sheet(|p| p + dvec3(0.9999, 0.0, 0.0));
        assert!(mesh.triangles().any(|t| is_sliver(&mesh, t)));
        let mended = mended(&domain, &mesh);
        assert!(!mended.triangles().any(|t| is_sliver(&mended, t)));
        assert!(!mended.connectivity.has_vertex(middle) || mended.position(middle) != mesh.position(middle));
    }

    #[test]
    fn vertices_on_one_line_between_curves_are_merged() {
        // A vertex with three neighbours, all on one line and on curves: two edges of curves become one.
        let corners = [[0., 0.], [3., 0.], [1., 0.], [2., 0.], [1.5, 3.], [1.5, -3.]].map(|[x, y]| dvec3(x, y, 0.0));
        let sample = |position: DVec3| Sample { position, normal: DVec3::Z, triangle: 0, size: 1.0 };
        let triangles = [[0, 3, 2], [0, 2, 4], [2, 3, 4], [3, 1, 4], [0, 5, 3], [3, 5, 1]];
        let mut mesh = Manifold::new(corners.map(sample).to_vec(), &triangles);
        mesh.mark_curves(&[([0, 2], OnCurve::Curve(0)), ([2, 3], OnCurve::Curve(0)), ([0, 3], OnCurve::Curve(1))], []);
        let domain = Domain::new(grid(4, 4, |u, v| dvec3(4.0 * u, 8.0 * v - 4.0, 0.0)).try_into().unwrap());
        assert_eq!(mesh.triangles().filter(|&t| is_sliver(&mesh, t)).count(), 1);
        let mended = mended(&domain, &mesh);
        assert!(!mended.triangles().any(|t| is_sliver(&mended, t)));
    }

    #[test]
    fn what_crosses_where_the_surface_does_stays() {
        let (domain, mut mesh, middle) = sheet(|p| p + dvec3(2.5, 0.2, 0.4));
        let beside = mesh.connectivity.ring(middle).next().unwrap();
        mesh.samples[beside as usize].position += dvec3(2.2, -0.1, -0.4);
        let all: Vec<u32> = (0..domain.mesh.triangles.len() as u32).collect();
        let before = mesh.to_mesh();
        mend_folds(&domain, || &all, &mut mesh, FAR, &()).unwrap();
        assert!(mesh.to_mesh() == before);
    }
}
