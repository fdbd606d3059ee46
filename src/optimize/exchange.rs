//! Exchanges vertices: changes their number where small angles and poor triangles need it, and makes up for that elsewhere.
//!
//! Between curves that are near each other, and beside their corners, no vertex positions and no flip give good triangles if
//! there is one vertex too many or too few. At each small angle, a nearby edge collapses or splits, and the triangles around
//! are relaxed. Of the changes that leave the worst triangle no worse and the surface in place, the one with the lowest cost
//! by the measure of [`angles`](crate::optimize::angles) is kept. In the end, as many vertices as this added or removed are
//! removed or added at places that remain good. Narrow strips between curves get their number of vertices before the rest is
//! ordered: an ordered mesh has no place that would stay as good with one vertex less or more.
//!
//! Based on: B. M. Klingner, J. R. Shewchuk, Aggressive tetrahedral mesh improvement, 2007,
//! DOI 10.1007/978-3-540-75103-8_1. Departure: the number of vertices is kept.
//!
//! Cost: some thousand triangles examined for each small angle and each exchanged vertex; nothing if all triangles are good.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::geom::triangle::{closest_point, quality, smallest_angle};
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::facing::FacingGuard;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::angles::Goal;
use crate::optimize::counts::{collapse_shortest, is_away_from_curves, meet_count};
use crate::optimize::places::{GivenUp, Place, disjoint, put_back, relaxed, split};
use crate::surface::domain::Domain;
use glam::DVec3;

/// Angle, in degrees, and quality of a triangle; below either, a nearby edge may collapse or split. With the angle alone,
/// the mean Q of 48 CAD parts is 0.925 instead of 0.927; with 45 degrees and no quality it is 0.928, but smooth models take
/// longer.
const SMALL: f64 = 40.0;
const POOR: f64 = 0.8;

/// Number of changes at a small angle that are relaxed: those with the lowest cost before.
const MOST_RELAXED: usize = 4;

/// Maximum number of passes over all small angles.
const MOST_PASSES: usize = 8;

/// Maximum distance of a removed vertex, and of one on a curve, from the remaining triangles, in target edge lengths.
const FARTHEST: f64 = 0.05;
const FARTHEST_FROM_CURVE: f64 = 0.01;

/// Maximum distance of vertices and edge midpoints from the triangles after a change, in lengths of the edge. Without this
/// bound, the tips of ears and thin ridges lose height.
const FARTHEST_AFTER: f64 = 0.1;

/// Angle, in degrees, below which the surface may move by [`LEEWAY`] at a place, in target edge lengths, whatever its edge
/// lengths. At a narrow strip or a notch, edges are short, and less of the surface is missed than between vertices
/// elsewhere.
const VERY_SMALL: f64 = 25.0;
const LEEWAY: f64 = 0.12;

/// Minimum gain of a change: as much as two or three degrees of an angle of 40 degrees.
const LEAST_GAIN: f64 = 10.0;

/// Number of places tried for each vertex to be added or removed elsewhere, and the factor by which it grows if none of them
/// will do. At most one in this many places is changed at once, so that the worst ones stay. Then, the minimum number of
/// places tried.
const CHOICES: usize = 4;
const FEWEST_CHOICES: usize = 16;

/// Exchanges vertices between small angles and other places, keeping their number. `spacing` is the mean edge length.
pub fn exchange_vertices(
    domain: &Domain,
    mesh: &mut Manifold,
    goal: Goal,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    let exchange = Exchange { domain, goal, spacing, monitor };
    if exchange.small_angles(mesh, |_| true).is_empty() {
        return Ok(());
    }
    let before = mesh.clone();
    let wanted = mesh.connectivity.vertex_count();
    exchange.change_counts(mesh, |_, _| true)?;
    exchange.balance(mesh, wanted)?;
    // With few vertices, there may be none to add or remove.
    if mesh.connectivity.vertex_count() != wanted || goal.cost(mesh) > goal.cost(&before) {
        *mesh = before;
    }
    Ok(())
}

/// Gives the triangles along curves in `narrow` patches the number of vertices that they need. To make up for these, the
/// shortest edges away from curves collapse; the mesh around them is still to be ordered.
pub fn fill_narrow(
    domain: &Domain,
    mesh: &mut Manifold,
    narrow: &VertexSet,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    let before = mesh.connectivity.vertex_count();
    let is_of_strip = |mesh: &Manifold, t: u32| {
        let corners = mesh.connectivity.triangle(3 * t);
        corners.into_iter().filter(|&v| mesh.connectivity.is_on_curve(v)).count() >= 2
            && corners.into_iter().any(|v| narrow.contains(v))
    };
    Exchange { domain, goal: Goal::GOOD, spacing, monitor }.change_counts(mesh, is_of_strip)?;
    collapse_shortest(mesh, before, |mesh, h| {
        is_away_from_curves(mesh, h) && FacingGuard::CAREFUL.passes(mesh.after_collapse(h).0)
    });
    Ok(())
}

/// Brings the mesh to `wanted` vertices, changing it only away from curves and where it remains good.
pub fn balance_count(
    domain: &Domain,
    mesh: &mut Manifold,
    wanted: usize,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    Exchange { domain, goal: Goal::GOOD, spacing, monitor }.balance(mesh, wanted)
}

struct Exchange<'a> {
    domain: &'a Domain,
    goal: Goal,
    spacing: f64,
    monitor: &'a dyn Monitor,
}

impl Exchange<'_> {
    /// Gives the surroundings of small angles the number of vertices that they need, at the triangles that `may` change.
    fn change_counts(&self, mesh: &mut Manifold, may: impl Fn(&Manifold, u32) -> bool) -> Result<()> {
        let mut given_up = GivenUp::default();
        for _ in 0..MOST_PASSES {
            check(self.monitor)?;
            let small = self.small_angles(mesh, |t| !given_up.has(t) && may(mesh, t));
            let places = disjoint(mesh, &small, usize::MAX);
            if places.is_empty() {
                break;
            }
            let faces = Faces::new(mesh);
            given_up.change(mesh, &places, |place| self.better(place, &faces))?;
        }
        Ok(())
    }

    /// Returns a side of each triangle that has a small angle or poor quality and `may` change, the smallest angle first.
    fn small_angles(&self, mesh: &Manifold, may: impl Fn(u32) -> bool) -> Vec<u32> {
        let angles = mesh.triangles().filter(|&t| may(t)).map(|t| (smallest_angle(mesh.corners(t)), t));
        let is_small = |&(angle, t): &(f64, u32)| angle < SMALL || quality(mesh.corners(t)) < POOR;
        let mut small: Vec<(f64, u32)> = angles.filter(is_small).collect();
        small.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        small.into_iter().map(|(_, t)| 3 * t).collect()
    }

    /// Returns the surroundings of a small angle after the change that helps most without new self-intersections, if there
    /// is one.
    fn better(&self, place: &Place, faces: &Faces) -> Result<Option<Neighborhood>> {
        let mesh = &place.around.mesh;
        let c = &mesh.connectivity;
        let edges = place.sides_near();
        let collapses = edges.iter().flat_map(|&h| c.both_sides(h)).filter_map(|h| self.collapsed(place, h));
        let splits = edges.iter().filter_map(|&h| split(self.domain, &place.around, h));
        let changed = collapses.chain(splits).chain([place.around.clone()]);
        let mut changed: Vec<(f64, Neighborhood)> =
            changed.map(|changed| (self.goal.cost(&changed.mesh), changed)).collect();
        changed.sort_by(|a, b| a.0.total_cmp(&b.0));
        changed.truncate(MOST_RELAXED);
        let relaxed = changed.into_iter().map(|(_, changed)| self.relaxed(changed));
        let mut better: Vec<(f64, Neighborhood)> = relaxed.collect::<Result<_>>()?;
        let (most, worst) = (self.goal.cost(mesh) - LEAST_GAIN, self.goal.worst_margin(mesh));
        better.retain(|(after, changed)| *after < most && self.goal.worst_margin(&changed.mesh) >= worst);
        better.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_sound = |changed: &Neighborhood| {
            is_near(mesh, &changed.mesh, leeway(place) * self.spacing) && !changed.adds_self_intersections(faces)
        };
        Ok(better.into_iter().map(|(_, changed)| changed).find(is_sound))
    }

    /// Returns the surroundings of `place` with the origin of `h` merged into its target, if that is allowed and hardly
    /// moves the surface.
    fn collapsed(&self, place: &Place, h: u32) -> Option<Neighborhood> {
        let mesh = &place.around.mesh;
        let c = &mesh.connectivity;
        let origin = c.origin(h);
        let farthest = if c.is_on_curve(origin) { FARTHEST_FROM_CURVE } else { FARTHEST.max(leeway(place)) };
        let may = c.can_collapse(h)
            && FacingGuard::CAREFUL.passes(mesh.after_collapse(h).0)
            && mesh.distance_after_collapse(h) <= farthest * self.spacing * mesh.sample(origin).size;
        may.then(|| {
            let mut changed = place.around.clone();
            changed.mesh.collapse(h);
            changed
        })
    }

    /// Relaxes `around`; returns the cost afterwards and the result.
    fn relaxed(&self, around: Neighborhood) -> Result<(f64, Neighborhood)> {
        let relaxed = relaxed(self.domain, around, self.goal, self.spacing, self.monitor)?;
        Ok((self.goal.cost(&relaxed.mesh), relaxed))
    }

    /// Brings the mesh to `wanted` vertices where it remains good. Splits or collapses edges away from curves: among the
    /// relatively longest or shortest, those that add the least cost once the triangles around are relaxed.
    fn balance(&self, mesh: &mut Manifold, wanted: usize) -> Result<()> {
        let mut choices = CHOICES;
        while mesh.connectivity.vertex_count() != wanted {
            check(self.monitor)?;
            let count = mesh.connectivity.vertex_count();
            let missing = count.abs_diff(wanted);
            let faces = Faces::new(mesh);
            let most = (choices * missing).max(FEWEST_CHOICES);
            let places = disjoint(mesh, &edges_to_change(mesh, count < wanted), most);
            let changed = |place: &Place| {
                let h = place.own_side();
                let changed =
                    if count < wanted { split(self.domain, &place.around, h) } else { self.collapsed(place, h) };
                let relaxed = changed.map(|changed| self.relaxed(changed)).transpose()?;
                let sound = relaxed.filter(|(_, changed)| !changed.adds_self_intersections(&faces));
                Ok(sound.map(|(after, changed)| (after - self.goal.cost(&place.around.mesh), changed)))
            };
            let changed = parallel::each(&places, changed).into_iter().collect::<Result<Vec<_>>>()?;
            let mut changed: Vec<(f64, Neighborhood)> = changed.into_iter().flatten().collect();
            changed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let at_once = missing.min((places.len() / CHOICES).max(1));
            if put_back(mesh, changed.iter().map(|(_, changed)| changed), at_once) > 0 {
                continue;
            }
            if places.len() == most {
                choices *= CHOICES;
            } else {
                meet_count(self.domain, mesh, wanted);
                break;
            }
        }
        Ok(())
    }
}

/// Returns whether the vertices and edge midpoints of the mesh `before` are near the triangles of `after`. The surface may
/// move at least by `leeway` times the sizes of samples.
pub fn is_near(before: &Manifold, after: &Manifold, leeway: f64) -> bool {
    let triangles: Vec<[DVec3; 3]> = after.triangles().map(|t| after.corners(t)).collect();
    let c = &before.connectivity;
    before.edges().flat_map(|h| [(h, 0.0), (h, 0.5)]).all(|(h, along)| {
        let [a, b] = [c.origin(h), c.target(h)].map(|v| before.sample(v));
        let farthest = (FARTHEST_AFTER * a.position.distance(b.position)).max(leeway * a.size);
        let p = a.position.lerp(b.position, along);
        triangles.iter().any(|&t| p.distance_squared(closest_point(p, t)) <= farthest * farthest)
    })
}

/// Returns how far the surface may move at a place, in target edge lengths, even if its edges are short.
fn leeway(place: &Place) -> f64 {
    let mesh = &place.around.mesh;
    if smallest_angle(mesh.corners(place.own_side() / 3)) < VERY_SMALL { LEEWAY } else { 0.0 }
}

/// Returns the edges away from curves: the relatively longest first if they are to be split, else the shortest first.
fn edges_to_change(mesh: &Manifold, to_split: bool) -> Vec<u32> {
    let sign = if to_split { -1.0 } else { 1.0 };
    let free = mesh.edges().filter(|&h| is_away_from_curves(mesh, h));
    let mut edges: Vec<(f64, u32)> = free.map(|h| (sign * mesh.relative_length_squared(h), h)).collect();
    edges.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    edges.into_iter().map(|(_, h)| h).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::optimize::angles::improve_angles;
    use crate::optimize::relax::{Flips, relax};
    use crate::surface::domain::Sample;
    use crate::testing::sheet;

    const SPACING: f64 = 0.1;

    /// A flat square, and a mesh of even triangles over it that has some boundary edges a quarter as long as the others.
    fn with_short_edges() -> (Domain, Manifold) {
        let domain = Domain::new(sheet(20, |_, _| 0.0).try_into().unwrap());
        let even = sheet(10, |_, _| 0.0);
        let mut mesh =
            Manifold::new(even.positions.iter().map(|&p| domain.project_anywhere(p)).collect(), &even.triangles);
        relax(&domain, &mut mesh, &VertexSet::EMPTY, SPACING, Flips::Delaunay, 3, &()).unwrap();
        let long: Vec<u32> = mesh.half_edges().filter(|&h| !mesh.connectivity.has_twin(h)).skip(12).take(3).collect();
        for h in long {
            for end in [h, h] {
                let [a, b] = [mesh.connectivity.origin(end), mesh.connectivity.target(end)].map(|v| *mesh.sample(v));
                mesh.split_at(Sample { position: a.position.midpoint(b.position), ..a }, end);
            }
        }
        mesh.lock_boundary();
        (domain, mesh)
    }

    fn smallest(mesh: &Manifold) -> f64 {
        mesh.triangles().map(|t| smallest_angle(mesh.corners(t))).fold(180.0, f64::min)
    }

    #[test]
    fn vertices_go_where_angles_need_them() {
        let (domain, mut mesh) = with_short_edges();
        let count = mesh.connectivity.vertex_count();
        improve_angles(&domain, &mut mesh, Goal::GOOD, SPACING, &()).unwrap();
        let before = smallest(&mesh);
        exchange_vertices(&domain, &mut mesh, Goal::GOOD, SPACING, &()).unwrap();
        let after = smallest(&mesh);
        assert!(before < 20.0 && after > 30.0, "{before} {after}");
        assert_eq!(mesh.connectivity.vertex_count(), count);
        let left = mesh.to_mesh();
        let t = topology(left.positions.len(), &left.triangles);
        assert!(t.is_manifold() && t.is_oriented() && (t.euler, t.boundary_loops) == (1, 1));
    }

    #[test]
    fn strips_are_filled_from_elsewhere() {
        let worst_at_boundary = |mesh: &Manifold| {
            let c = &mesh.connectivity;
            let is_at = |t: &u32| c.triangle(3 * t).iter().filter(|&&v| c.is_on_curve(v)).count() >= 2;
            mesh.triangles().filter(is_at).map(|t| smallest_angle(mesh.corners(t))).fold(180.0, f64::min)
        };
        let (domain, mut mesh) = with_short_edges();
        let (count, before) = (mesh.connectivity.vertex_count(), worst_at_boundary(&mesh));
        let mut same = mesh.clone();
        fill_narrow(&domain, &mut same, &VertexSet::EMPTY, SPACING, &()).unwrap();
        assert_eq!(same.to_mesh().positions, mesh.to_mesh().positions);
        let all = VertexSet::all(&mesh);
        fill_narrow(&domain, &mut mesh, &all, SPACING, &()).unwrap();
        assert!(before < 20.0 && worst_at_boundary(&mesh) > 30.0, "{before} {}", worst_at_boundary(&mesh));
        assert_eq!(mesh.connectivity.vertex_count(), count);
    }

    #[test]
    fn a_mesh_of_good_angles_stays() {
        let sheared = |p: DVec3| DVec3::new(p.x - 0.5 * p.y, 0.75f64.sqrt() * p.y, 0.0);
        let mut even = sheet(10, |_, _| 0.0);
        even.positions.iter_mut().for_each(|p| *p = sheared(*p));
        let domain = Domain::new(even.clone().try_into().unwrap());
        let samples = even.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &even.triangles);
        mesh.lock_boundary();
        assert!(smallest(&mesh) > 59.0, "{}", smallest(&mesh));
        let before = mesh.to_mesh();
        exchange_vertices(&domain, &mut mesh, Goal::GOOD, SPACING, &()).unwrap();
        assert_eq!(mesh.to_mesh().positions, before.positions);
    }

    #[test]
    fn a_ridge_is_not_near_what_is_left_after_its_edge_has_flipped() {
        let roof = |height: f64, triangles: [[u32; 3]; 2]| {
            let positions = [[0.0, 0.0, height], [1.0, 0.0, height], [0.5, 1.0, 0.0], [0.5, -1.0, 0.0]];
            let sample = |p| Sample { position: DVec3::from(p), normal: DVec3::Z, triangle: 0, size: 1.0 };
            Manifold::new(positions.map(sample).to_vec(), &triangles)
        };
        let (along, across) = ([[0, 1, 2], [1, 0, 3]], [[0, 3, 2], [1, 2, 3]]);
        let is_near = |height: f64, leeway: f64| super::is_near(&roof(height, along), &roof(height, across), leeway);
        assert_eq!([0.0, 0.05, 0.11, 0.5].map(|height| is_near(height, 0.0)), [true, true, false, false]);
        assert_eq!([0.11, 0.5].map(|height| is_near(height, LEEWAY)), [true, false]);
    }

    #[test]
    fn counts_are_met_where_angles_stay_good() {
        for change in [-9, 9] {
            let even = sheet(10, |_, _| 0.0);
            let domain = Domain::new(sheet(20, |_, _| 0.0).try_into().unwrap());
            let samples = even.positions.iter().map(|&p: &DVec3| domain.project_anywhere(p)).collect();
            let mut mesh = Manifold::new(samples, &even.triangles);
            mesh.lock_boundary();
            relax(&domain, &mut mesh, &VertexSet::EMPTY, SPACING, Flips::Delaunay, 3, &()).unwrap();
            let wanted = mesh.connectivity.vertex_count().checked_add_signed(change).unwrap();
            let exchange = Exchange { domain: &domain, goal: Goal::GOOD, spacing: SPACING, monitor: &() };
            exchange.balance(&mut mesh, wanted).unwrap();
            assert_eq!(mesh.connectivity.vertex_count(), wanted);
            assert!(smallest(&mesh) > 35.0, "{change}: {}", smallest(&mesh));
        }
    }
}
