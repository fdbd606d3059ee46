//! Reduces the maximum (Hausdorff) error: the distance between mesh and surface at the few places where it is still large,
//! such as ends of spikes and ridges without a vertex.
//!
//! Relaxation leaves few vertices at the end of a spike, and least squares do not reach it if none is near. So the triangles
//! around each such place are copied as a neighborhood, and one of the nearest vertices is moved to the place. The
//! neighborhood is relaxed with that vertex locked, its worst angles are improved, and it is fitted to the surface again. If
//! the error is then large at another place of it, a vertex is moved there, too. The neighborhood replaces the triangles if
//! its distance from the surface is smaller in both directions and no triangle is far outside the goal for angles.
//!
//! One such jump often achieves what steps of single vertices do not, because the flips around it change the connectivity. A
//! neighborhood that would add self-intersections is rejected.
//!
//! The distance is measured from points of the surface to the mesh, and from points of the triangles to the surface. The
//! largest errors come first. Errors smaller than one that could not be reduced are left alone, since they do not change the
//! maximum. In the end, the largest remaining ones are tried again with wider neighborhoods and more vertices.
//!
//! Cost: some milliseconds per place; most models have ten to forty. Limits: vertices on feature curves stay, and so do
//! errors that only those could reduce.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::angles::{Goal, improve_angles_for};
use crate::optimize::fit::{BEYOND, Fitted, fit_part};
use crate::optimize::probes::{Probe, Probes, distance, is_nearer};
use crate::optimize::quadrature::{POINTS, point};
use crate::optimize::relax::{Flips, relax};
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

/// Maximum number of rounds over the places of large error: reducing one error may make another beside it the largest.
const MOST_ROUNDS: usize = 12;

/// Maximum number of places treated in a round: those with the largest errors.
const MOST_PLACES: usize = 32;

/// Distance from which on an error is large, in spacings and in root mean squares.
const LARGE: f64 = 0.16;
const LARGE_OF_MEAN: f64 = 6.5;

/// Minimum distance, as a share of the large one, from triangles that face another way: at the bottom of a slit narrower
/// than the triangles, those of its sides are near.
const HIDDEN: f64 = 0.5;

/// Errors below this share of the largest one that could not be reduced are left alone.
const OF_GIVEN_UP: f64 = 0.9;

/// Distance from the place, in spacings, within which errors are measured.
const MEASURED: f64 = 2.5;

/// The effort spent on a place.
#[derive(Clone, Copy, PartialEq)]
struct Effort {
    /// Number of rings of triangles that are taken out.
    rings: usize,
    /// Number of vertices that are tried, the nearest first.
    tried: usize,
    /// Number of rounds of relaxation with the moved vertices locked. With more rounds, triangles are good enough more
    /// often, but thin parts shrink back.
    rounds: usize,
    /// Number of passes over the worst triangles; places that need more are mostly beyond help.
    passes: usize,
}

/// Effort for all places, and in the end for the largest remaining errors, which are the maximum error.
const FIRST: Effort = Effort { rings: 5, tried: 3, rounds: 2, passes: 8 };
const LAST: Effort = Effort { rings: 7, tried: 9, rounds: 8, passes: 30 };

/// Share of the largest error from which on places get the last effort.
const FARTHEST: f64 = 0.9;

/// Maximum number of vertices moved to places in a neighborhood, one after the other.
const MOST_PLACED: usize = 2;

/// The goal without any cost of quality: once it is met, nothing has to improve.
const ONLY_ANGLES: Goal = Goal { of_quality: 0.0, ..Goal::GOOD };

/// Maximum number of triangles outside the goal after relaxation: if there are more, they can rarely all be improved.
const MOST_BAD: usize = 24;

/// Degrees by which the worst triangle may be outside the goal, which is slightly stricter than required.
const LEEWAY: f64 = 0.4;

/// Share of the error that may be left.
const MUST_FALL_TO: f64 = 0.95;

/// Reduces the largest errors of the mesh, which was `fitted` to the surface. `spacing` is the mean edge length.
pub fn reduce_max_error(
    domain: &Domain,
    mesh: &mut Manifold,
    spacing: f64,
    fitted: &Fitted,
    monitor: &dyn Monitor,
) -> Result<()> {
    let mean_square = fitted.mean_square;
    let least = (LARGE * spacing).max(LARGE_OF_MEAN * mean_square.sqrt());
    let mut task = Task { domain, spacing, mean_square, least, effort: FIRST };
    let mut faces = Faces::new(mesh);
    let mut far = task.places(&faces, fitted);
    far.retain(|place| !is_at_interface(mesh, place));
    let mut given_up: Vec<Place> = Vec::new();
    for _ in 0..MOST_ROUNDS {
        check(monitor)?;
        let mut places = task.disjoint(&mut far, &given_up);
        if places.is_empty() && task.effort == FIRST {
            task.effort = LAST;
            let worst = given_up.drain(..).map(|place| place.distance).fold(0.0, f64::max);
            far.retain(|place| place.distance >= FARTHEST * worst);
            places = task.disjoint(&mut far, &given_up);
        }
        if places.is_empty() {
            break;
        }
        let neighborhoods: Vec<Option<Neighborhood>> =
            parallel::each(&places, |place| task.reduced(mesh, &faces, place));
        let mut touched = vec![false; mesh.connectivity.half_edge_bound() as usize / 3];
        let mut changed: Vec<DVec3> = Vec::new();
        for (place, neighborhood) in places.iter().zip(neighborhoods) {
            match neighborhood {
                Some(neighborhood) if neighborhood.put_back(mesh, &mut touched) => changed.push(place.probe.position),
                Some(_) => {}
                None => given_up.push(*place),
            }
        }
        // Nothing has changed elsewhere.
        let reach = task.reach();
        let is_new = |p: DVec3| changed.iter().any(|at| p.distance(*at) < reach);
        given_up.retain(|place| !is_new(place.probe.position));
        far.retain(|place| !is_new(place.probe.position));
        faces.follow(mesh);
        far.extend(task.places_around(&faces, &changed, &touched));
        far.retain(|place| !is_at_interface(mesh, place));
    }
    Ok(())
}

/// Returns whether a place is nearest to a triangle along an interface, which stays: beyond it there may be surface without
/// mesh.
fn is_at_interface(mesh: &Manifold, place: &Place) -> bool {
    let c = &mesh.connectivity;
    c.triangle(3 * place.triangle).into_iter().any(|v| c.is_on_interface(v))
}

/// A place of large error: a point of the surface and its distance to the mesh, or to the point of the mesh of which it is
/// the foot.
#[derive(Clone, Copy)]
struct Place {
    probe: Probe,
    distance: f64,
    /// The triangle at the other end of the distance.
    triangle: u32,
}

/// What all places have in common.
struct Task<'a> {
    domain: &'a Domain,
    spacing: f64,
    mean_square: f64,
    /// The distance from which on an error is large.
    least: f64,
    effort: Effort,
}

impl Task<'_> {
    /// Returns all places of large error in a mesh that was `fitted`.
    fn places(&self, faces: &Faces, fitted: &Fitted) -> Vec<Place> {
        let triangles = 0..self.domain.mesh.triangles.len() as u32;
        let at_vertices = parallel::collect(&fitted.vertices[..], |vertices| {
            vertices.iter().filter_map(|&v| self.place_of_probe(faces, Probe::at_vertex(self.domain, v)))
        });
        let inside = parallel::collect(triangles, |triangles| triangles.flat_map(|t| self.places_inside(faces, t)));
        [at_vertices, inside, self.places_of_triangles(faces, &fitted.triangles)].concat()
    }

    /// Returns the places of large error inside triangle `t` of the surface. A face near one probe is mostly also near the
    /// next one, which then needs no search.
    fn places_inside(&self, faces: &Faces, t: u32) -> impl Iterator<Item = Place> {
        let mut last = None;
        Probe::inside(self.domain, t, self.spacing).filter_map(move |probe| {
            if last.is_some_and(|face| is_nearer(faces, face, &probe, self.least)) {
                return None;
            }
            let found = self.closest_to(faces, &probe)?;
            last = Some(found.1);
            self.place_at(faces, probe, found)
        })
    }

    /// Returns the foot of the point of mesh triangle `t` that is farthest from the surface, if that distance is large.
    fn place_of_triangle(&self, faces: &Faces, t: u32) -> Option<Place> {
        let corners = faces.corners(t)?;
        let mut farthest = None;
        let mut distance = self.least;
        for p in POINTS.map(|(at, _)| point(corners, at)) {
            if let Some(foot) = self.domain.foot_farther_than(p, distance) {
                (farthest, distance) = (Some(foot), p.distance(foot.position));
            }
        }
        let Sample { position, normal, .. } = farthest?;
        Some(Place { probe: Probe { position, normal }, distance, triangle: t })
    }

    /// Returns the places of large error around the points `changed`, where triangles were `touched`.
    fn places_around(&self, faces: &Faces, changed: &[DVec3], touched: &[bool]) -> Vec<Place> {
        let of_surface = parallel::each(changed, |&at| {
            let probes = Probes::near(self.domain, at, self.reach(), self.spacing);
            probes.all(self.domain).filter_map(|probe| self.place_of_probe(faces, probe)).collect::<Vec<_>>()
        });
        let triangles: Vec<u32> = (0..).zip(touched).filter(|(_, touched)| **touched).map(|(t, _)| t).collect();
        [of_surface.concat(), self.places_of_triangles(faces, &triangles)].concat()
    }

    fn places_of_triangles(&self, faces: &Faces, triangles: &[u32]) -> Vec<Place> {
        parallel::collect(triangles, |block| block.iter().filter_map(|&t| self.place_of_triangle(faces, t)))
    }

    fn place_of_probe(&self, faces: &Faces, probe: Probe) -> Option<Place> {
        self.place_at(faces, probe, self.closest_to(faces, &probe)?)
    }

    /// Returns the distance to the closest face that faces the same way as `probe`, or to any such face within a distance
    /// that is not large, and the number of that face.
    fn closest_to(&self, faces: &Faces, probe: &Probe) -> Option<(f64, u32)> {
        distance(faces, probe, self.least, BEYOND * self.spacing)
    }

    fn place_at(&self, faces: &Faces, probe: Probe, (distance, triangle): (f64, u32)) -> Option<Place> {
        let is_large = distance >= self.least && !faces.any_within(probe.position, HIDDEN * self.least);
        is_large.then_some(Place { probe, distance, triangle })
    }

    /// Returns the distance from its place within which a neighborhood may change.
    fn reach(&self) -> f64 {
        (self.effort.rings + 1) as f64 * self.spacing
    }

    /// Returns those of `far` whose neighborhoods are disjoint, the largest errors first. Leaves out those near a place that
    /// was given up, and those with a much smaller error than the largest one given up unless they are beside it.
    fn disjoint(&self, far: &mut [Place], given_up: &[Place]) -> Vec<Place> {
        let by_position = |a: DVec3, b: DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
        far.sort_by(|a, b| {
            b.distance.total_cmp(&a.distance).then_with(|| by_position(a.probe.position, b.probe.position))
        });
        let worth = OF_GIVEN_UP * given_up.iter().map(|place| place.distance).fold(0.0, f64::max);
        let worst: Vec<DVec3> = given_up.iter().filter(|p| p.distance >= worth).map(|p| p.probe.position).collect();
        let is_beside = |p: DVec3| worst.iter().any(|q| p.distance(*q) < self.reach());
        // Rings are at most about a spacing wide.
        let apart = 2.0 * self.effort.rings as f64 * self.spacing;
        let mut places: Vec<Place> = Vec::new();
        for place in far.iter().filter(|place| place.distance >= worth || is_beside(place.probe.position)) {
            let is_apart = |p: DVec3, distance: f64| p.distance(place.probe.position) > distance;
            if places.len() < MOST_PLACES
                && given_up.iter().all(|p| is_apart(p.probe.position, MEASURED * self.spacing))
                && places.iter().all(|p| is_apart(p.probe.position, apart))
            {
                places.push(*place);
            }
        }
        places
    }

    /// Returns the neighborhood of `place` with a smaller error; `None` if no way was found.
    fn reduced(&self, mesh: &Manifold, faces: &Faces, place: &Place) -> Option<Neighborhood> {
        let p = place.probe.position;
        let by_distance = |mesh: &Manifold, a: u32, b: u32| {
            mesh.position(a).distance_squared(p).total_cmp(&mesh.position(b).distance_squared(p)).then(a.cmp(&b))
        };
        let corners = mesh.connectivity.triangle(3 * place.triangle).into_iter();
        let free = corners.filter(|&v| !mesh.connectivity.is_on_curve(v));
        let middle = free.min_by(|&a, &b| by_distance(mesh, a, b))?;
        let neighborhood = Neighborhood::around(mesh, middle, self.effort.rings)?;
        let measured = Measured::new(self, faces, &neighborhood, p);
        let margin = Goal::GOOD.worst_margin(&neighborhood.mesh).min(-LEEWAY);
        let mut attempt = measured.attempt(neighborhood, Vec::new());
        let most = MUST_FALL_TO * attempt.farthest;
        for _ in 0..MOST_PLACED {
            attempt = self.place_nearest(&attempt, &measured, margin)?;
            if attempt.farthest < most && !attempt.neighborhood.adds_self_intersections(faces) {
                return Some(attempt.neighborhood);
            }
        }
        None
    }

    /// Tries each of the nearest vertices at the place of the largest error; returns the attempt with the smallest error.
    fn place_nearest(&self, from: &Attempt, measured: &Measured, margin: f64) -> Option<Attempt> {
        let away = |v: u32| from.neighborhood.mesh.position(v).distance_squared(from.place);
        let mut nearest: Vec<u32> = from.neighborhood.free_vertices().filter(|v| !from.placed.contains(v)).collect();
        nearest.sort_by(|&a, &b| away(a).total_cmp(&away(b)).then(a.cmp(&b)));
        nearest.truncate(self.effort.tried);
        let tries = parallel::each(nearest, |v| {
            let mut neighborhood = from.neighborhood.clone();
            let placed: Vec<u32> = from.placed.iter().copied().chain([v]).collect();
            neighborhood.mesh.place(v, self.domain.project_anywhere(from.place));
            let sound = self.arrange(&mut neighborhood.mesh, &placed, measured, margin).ok()?;
            sound.then(|| measured.attempt(neighborhood, placed))
        });
        tries.into_iter().flatten().min_by(|a, b| a.farthest.total_cmp(&b.farthest))
    }

    /// Arranges the vertices around those that were `placed`. Returns whether the margin of every triangle is at least
    /// `margin` afterwards.
    fn arrange(&self, mesh: &mut Manifold, placed: &[u32], measured: &Measured, margin: f64) -> Result<bool> {
        let improve = |mesh: &mut Manifold, locked: &VertexSet| {
            // A result outside the goal is rejected, so quality does not count here.
            improve_angles_for(self.domain, mesh, locked, ONLY_ANGLES, self.spacing, self.effort.passes, &())?;
            Ok(Goal::GOOD.worst_margin(mesh) >= margin)
        };
        let locked = placed.iter().copied().collect();
        relax(self.domain, mesh, &locked, self.spacing, Flips::Delaunay, self.effort.rounds, &())?;
        if Goal::GOOD.missed_by(mesh).count() > MOST_BAD || !improve(mesh, &locked)? {
            return Ok(false);
        }
        fit_part(self.domain, mesh, self.spacing, self.mean_square, &measured.probes.vertices);
        improve(mesh, &VertexSet::EMPTY)
    }
}

/// A changed neighborhood, and its largest error.
struct Attempt {
    neighborhood: Neighborhood,
    /// The vertices that were moved to places.
    placed: Vec<u32>,
    farthest: f64,
    /// The point of the surface with that error.
    place: DVec3,
}

/// The probes at which the error of a neighborhood is measured.
struct Measured<'a> {
    task: &'a Task<'a>,
    place: DVec3,
    probes: Probes,
}

impl<'a> Measured<'a> {
    /// Returns the probes around `place` that are closest to a triangle of `neighborhood`.
    fn new(task: &'a Task<'a>, faces: &Faces, neighborhood: &Neighborhood, place: DVec3) -> Measured<'a> {
        let belongs = |probe: &Probe| {
            distance(faces, probe, 0.0, BEYOND * task.spacing).is_some_and(|(_, t)| neighborhood.has_triangle(t))
        };
        let mut probes = Probes::near(task.domain, place, MEASURED * task.spacing, task.spacing);
        probes.vertices.retain(|&v| belongs(&Probe::at_vertex(task.domain, v)));
        probes.inside.retain(belongs);
        Measured { task, place, probes }
    }

    /// Returns `neighborhood` with its largest error, in both directions.
    fn attempt(&self, neighborhood: Neighborhood, placed: Vec<u32>) -> Attempt {
        let Task { domain, spacing, .. } = *self.task;
        let faces = Faces::new(&neighborhood.mesh);
        let (mut farthest, mut place) = (0.0, self.place);
        for probe in self.probes.all(domain) {
            let beyond = BEYOND * spacing;
            let distance = distance(&faces, &probe, farthest, beyond).map_or(beyond, |d| d.0);
            if distance > farthest {
                (farthest, place) = (distance, probe.position);
            }
        }
        let is_near = |p: &DVec3| p.distance_squared(self.place) < math::square(MEASURED * spacing);
        let near = faces.iter().filter(|x| x.iter().all(is_near));
        for p in near.flat_map(|x| POINTS.map(|(at, _)| point(x, at))) {
            if let Some(foot) = domain.foot_farther_than(p, farthest) {
                (farthest, place) = (foot.position.distance(p), foot.position);
            }
        }
        Attempt { neighborhood, placed, farthest, place }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;

    /// A triangular grid over the rhombus of side 1, with `n` edges of length 1/n per side, at the given heights.
    fn sheet(n: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let place = |i: u32, j: u32| {
            let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let (x, y) = (u + 0.5 * v, 0.75f64.sqrt() * v);
            DVec3::new(x, y, height(x, y))
        };
        let all = |n: u32| (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)));
        let rhombus = |(i, j)| [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]];
        Mesh {
            positions: all(n + 1).map(|(i, j)| place(i, j)).collect(),
            triangles: all(n).flat_map(rhombus).collect(),
        }
    }

    /// Number of edges per side of the coarse sheet.
    const COARSE: u32 = 15;

    /// The centroid of a triangle near the middle of the coarse sheet.
    fn middle() -> DVec3 {
        let flat = sheet(COARSE, |_, _| 0.0);
        flat.corners((COARSE * COARSE - 1) as usize).into_iter().sum::<DVec3>() / 3.0
    }

    /// A fine sheet with a spike there, half a coarse edge high, and a coarse sheet laid on it.
    fn spike() -> (Domain, Manifold) {
        let (middle, spacing) = (middle(), 1.0 / f64::from(COARSE));
        let spike = |x: f64, y: f64| 0.5 * (spacing - 1.2 * (x - middle.x).hypot(y - middle.y)).max(0.0);
        let domain = Domain::new(sheet(8 * COARSE, spike).try_into().unwrap());
        let coarse = sheet(COARSE, |_, _| 0.0);
        let samples = coarse.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &coarse.triangles);
        mesh.lock_boundary();
        (domain, mesh)
    }

    /// The result of a fit with all vertices watched.
    fn fitted(domain: &Domain, mean_square: f64) -> Fitted {
        Fitted { mean_square, vertices: (0..domain.mesh.positions.len() as u32).collect(), triangles: Vec::new() }
    }

    /// Largest distance of a vertex of the domain from the mesh.
    fn farthest(domain: &Domain, mesh: &Manifold) -> f64 {
        let faces = Faces::new(mesh);
        let distance = |v| distance(&faces, &Probe::at_vertex(domain, v), 0.0, 1.0).map_or(1.0, |d| d.0);
        (0..domain.mesh.positions.len() as u32).map(distance).fold(0.0, f64::max)
    }

    #[test]
    fn a_spike_between_the_vertices_gets_one_and_good_triangles() {
        let (domain, mut mesh) = spike();
        let (before, old, spacing) = (farthest(&domain, &mesh), mesh.clone(), 1.0 / f64::from(COARSE));
        reduce_max_error(&domain, &mut mesh, spacing, &fitted(&domain, 1e-6), &()).unwrap();
        let after = farthest(&domain, &mesh);
        assert!(before > 1.5 * LARGE * spacing && after < LARGE * spacing, "{before} {after}");
        assert!(Goal::GOOD.worst_margin(&mesh) >= -LEEWAY);
        assert_eq!(mesh.to_mesh().positions.len(), old.to_mesh().positions.len());
        let corners = (0..mesh.connectivity.vertex_bound()).filter(|&v| !mesh.can_move(v, &VertexSet::EMPTY));
        corners.for_each(|v| assert_eq!(mesh.position(v), old.position(v)));
    }

    #[test]
    fn a_mesh_that_is_near_everywhere_stays() {
        let domain =
            Domain::new(sheet(4 * COARSE, |x, y| 0.01 * (3.0 * x).sin() * (2.0 * y).cos()).try_into().unwrap());
        let coarse = sheet(COARSE, |_, _| 0.0);
        let samples = coarse.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &coarse.triangles);
        mesh.lock_boundary();
        let old = mesh.to_mesh();
        reduce_max_error(&domain, &mut mesh, 1.0 / f64::from(COARSE), &fitted(&domain, 1e-9), &()).unwrap();
        assert_eq!((mesh.to_mesh().positions, mesh.to_mesh().triangles), (old.positions, old.triangles));
    }
}
