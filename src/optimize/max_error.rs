//! Brings the mesh to the few places that are still far from it: tips and ridges that no vertex is at.
//!
//! Relaxation leaves few vertices at a tip, and least squares leave the tip where it is if none is near. So the
//! triangles around each far place are taken out as a neighborhood, and one of the nearest vertices is put at the place: the
//! neighborhood relaxes with that vertex held, its worst angles are improved, and it is fitted to the surface again. Where
//! another place of the neighborhood is far then, it gets a vertex, too. The neighborhood is put back if it is nearer to the surface
//! than the one that was there, both ways, and no triangle is far outside of the goal.
//!
//! What no step of single vertices reaches is often one such jump away, because the flips around it change the order of
//! the vertices. No neighborhood is put back that would cross more of the mesh than what was there.
//!
//! Places are of the surface, far from the mesh, or those that are closest to what of the mesh is far from the surface. The
//! farthest come first. What is nearer than a place that could not be mended is left alone, and in the end the farthest
//! ones that are left are tried again with wider neighborhoods and more vertices: the distance of the whole is theirs.
//!
//! Cost: some milliseconds for each place; most models have ten to forty. Limits: vertices on curves stay, and so do
//! places that only those could reach.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::neighborhood::Neighborhood;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::optimize::angles::{bad_triangles, improve_angles_for, worst_margin};
use crate::optimize::fit::{BEYOND, Fitted, POINTS, fit_part, point};
use crate::optimize::relax::{Flips, relax};
use crate::spatial::self_intersections::self_intersections;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use rayon::prelude::*;

/// Rounds over the far places: mending one shows others beside it.
const MOST_ROUNDS: usize = 12;

/// Most places that a round looks at, the farthest first.
const MOST_PLACES: usize = 32;

/// Distance from which on a place is far: in spacings, and in roots of the mean square.
const FAR: f64 = 0.16;
const FAR_OF_MEAN: f64 = 6.5;

/// Share of this distance from which on a place is far of the triangles that face other ways, too: at the bottom of a slit
/// that is narrower than triangles are, those of its sides are near.
const HIDDEN: f64 = 0.5;

/// Share of the farthest distance that could not be mended from which on places are worth it.
const OF_GIVEN_UP: f64 = 0.9;

/// How far from the place, in spacings, distances are measured.
const MEASURED: f64 = 2.5;

/// What is done for a place.
#[derive(Clone, Copy, PartialEq)]
struct Effort {
    /// Rings of triangles that are taken out.
    rings: usize,
    /// Vertices that are tried, the nearest first.
    tried: usize,
    /// Passes over the worst triangles: what needs more is mostly beyond them.
    passes: usize,
}

/// For all places, and in the end for the farthest of those that were given up: the distance of the whole is theirs.
const FIRST: Effort = Effort { rings: 5, tried: 3, passes: 8 };
const LAST: Effort = Effort { rings: 7, tried: 9, passes: 30 };

/// Share of the farthest distance from which on places are given that effort.
const FARTHEST: f64 = 0.9;

/// Places in a neighborhood that get a vertex, one after the other: where the first one leaves another place far away.
const PULLS: usize = 2;

/// Rounds of relaxation with a vertex held.
const RELAX_ROUNDS: usize = 2;

/// Triangles outside of the goal that it may leave: more are not mended.
const MOST_BAD: usize = 24;

/// Degrees that the worst triangle may be outside of the goal, which is a little more than is asked for.
const LEEWAY: f64 = 0.4;

/// Share of the distance that may be left.
const MUST_FALL_TO: f64 = 0.95;

/// Probes that one task looks at.
const CHUNK: usize = 256;

/// Sides of the surface's triangles, in spacings, from which on their insides are looked at, too.
const LONG_SIDE: f64 = 0.6;

/// Brings the mesh, which was `fitted` to the surface, nearer to the places that are far from it. `spacing` is the mean
/// edge length.
pub fn reduce_max_error(
    domain: &Domain,
    mesh: &mut Manifold,
    spacing: f64,
    fitted: &Fitted,
    monitor: &dyn Monitor,
) -> Result<()> {
    let mean_square = fitted.mean_square;
    let least = (FAR * spacing).max(FAR_OF_MEAN * mean_square.sqrt());
    let mut task = Task { domain, spacing, mean_square, least, effort: FIRST };
    let mut faces = Faces::new(mesh);
    let mut far = task.far_places(&faces, fitted);
    let mut given_up: Vec<Place> = Vec::new();
    for _ in 0..MOST_ROUNDS {
        check(monitor)?;
        let mut places = task.apart(&mut far, &given_up);
        if places.is_empty() && task.effort == FIRST {
            task.effort = LAST;
            let worst = given_up.drain(..).map(|place| place.distance).fold(0.0, f64::max);
            far.retain(|place| place.distance >= FARTHEST * worst);
            places = task.apart(&mut far, &given_up);
        }
        if places.is_empty() {
            break;
        }
        let neighborhoods: Vec<Option<Neighborhood>> =
            places.par_iter().map(|place| task.mend(mesh, &faces, place)).collect();
        let mut touched = vec![false; mesh.connectivity.half_edge_bound() as usize / 3];
        let mut mended: Vec<DVec3> = Vec::new();
        for (place, neighborhood) in places.iter().zip(neighborhoods) {
            match neighborhood {
                Some(neighborhood) if neighborhood.put_back(mesh, &mut touched) => mended.push(place.probe.position),
                Some(_) => {}
                None => given_up.push(*place),
            }
        }
        // Only there is anything else than it was.
        let reach = task.reach();
        let is_new = |p: DVec3| mended.iter().any(|at| p.distance(*at) < reach);
        given_up.retain(|place| !is_new(place.probe.position));
        far.retain(|place| !is_new(place.probe.position));
        faces.follow(mesh);
        far.extend(task.far_again(&faces, &mended, &touched));
    }
    Ok(())
}

/// A point of the surface that distances are measured at.
#[derive(Clone, Copy)]
struct Probe {
    position: DVec3,
    normal: DVec3,
}

impl Probe {
    fn at_vertex(domain: &Domain, v: u32) -> Probe {
        Probe { position: domain.mesh.positions[v as usize], normal: domain.vertex_normal(v) }
    }

    /// Those inside of triangle `t`, if that is so large that its corners are not enough.
    fn inside(domain: &Domain, t: u32, spacing: f64) -> impl Iterator<Item = Probe> + use<> {
        let corners = domain.mesh.corners(t as usize);
        let [a, b, c] = corners;
        let is_large = a.distance(b).max(b.distance(c)).max(c.distance(a)) > LONG_SIDE * spacing;
        let normal = domain.mesh.area_vector(t as usize);
        let probes = POINTS.map(|(at, _)| Probe { position: point(corners, at), normal });
        probes.into_iter().filter(move |_| is_large)
    }
}

/// The probes of a part of the surface.
struct Probes {
    /// Vertices of the surface, in increasing order.
    vertices: Vec<u32>,
    inside: Vec<Probe>,
}

impl Probes {
    fn all(&self, domain: &Domain) -> impl Iterator<Item = Probe> {
        let at_vertices = self.vertices.iter().map(|&v| Probe::at_vertex(domain, v));
        at_vertices.chain(self.inside.iter().copied())
    }
}

/// Whether more of the faces would cross if `neighborhood` were put back.
fn would_cross(faces: &Faces, neighborhood: &Neighborhood) -> bool {
    let new = neighborhood.mesh.to_mesh();
    let Some((lo, hi)) = new.bounds() else { return false };
    let (mut now, mut then) = (Vec::new(), Vec::new());
    faces.in_box(lo, hi, |t, corners| {
        now.push(corners);
        if !neighborhood.has_triangle(t) {
            then.push(corners);
        }
    });
    then.extend((0..new.triangles.len()).map(|t| new.corners(t)));
    self_intersections(&Mesh::soup(then)).len() > self_intersections(&Mesh::soup(now)).len()
}

/// How far `probe` is from the faces that look its way, if nearer than `most`, and the number of the closest one. Below
/// `near` any such face will do.
fn distance(faces: &Faces, probe: &Probe, near: f64, most: f64) -> Option<(f64, u32)> {
    let hit = faces.closest_facing(probe.position, probe.normal, near * near..most * most)?;
    Some((hit.distance_squared.sqrt(), hit.triangle))
}

/// A place of the surface that is far from the mesh, and the triangle that is closest to it; or that is closest to what of
/// a triangle is far from the surface.
#[derive(Clone, Copy)]
struct Place {
    probe: Probe,
    distance: f64,
    triangle: u32,
}

/// What all places have in common.
struct Task<'a> {
    domain: &'a Domain,
    spacing: f64,
    mean_square: f64,
    /// The distance from which on a place is far.
    least: f64,
    effort: Effort,
}

impl Task<'_> {
    /// All places that are far, where that was `fitted`.
    fn far_places(&self, faces: &Faces, fitted: &Fitted) -> Vec<Place> {
        let triangles = (0..self.domain.mesh.triangles.len() as u32).into_par_iter().with_min_len(CHUNK);
        let at_vertices = fitted.vertices.par_iter().with_min_len(CHUNK).map(|&v| Probe::at_vertex(self.domain, v));
        let inside = triangles.flat_map_iter(|t| Probe::inside(self.domain, t, self.spacing));
        let of_surface = at_vertices.chain(inside).filter_map(|probe| self.far_place(faces, probe));
        let of_mesh = fitted.triangles.par_iter().filter_map(|&t| self.far_triangle(faces, t));
        of_surface.chain(of_mesh).collect()
    }

    /// The place on the surface that is closest to the point of triangle `t` of the mesh that is farthest from it.
    fn far_triangle(&self, faces: &Faces, t: u32) -> Option<Place> {
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

    /// The places that are far around those that have been `mended`, where triangles were `touched`.
    fn far_again(&self, faces: &Faces, mended: &[DVec3], touched: &[bool]) -> Vec<Place> {
        let around = mended.par_iter().map(|&at| self.probes_near(at, self.reach()));
        let probes: Vec<Probe> = around.flat_map_iter(|probes| probes.all(self.domain).collect::<Vec<_>>()).collect();
        let triangles: Vec<u32> = (0..).zip(touched).filter(|(_, touched)| **touched).map(|(t, _)| t).collect();
        let of_surface = probes.into_par_iter().filter_map(|probe| self.far_place(faces, probe));
        let of_mesh = triangles.into_par_iter().filter_map(|t| self.far_triangle(faces, t));
        of_surface.chain(of_mesh).collect()
    }

    fn far_place(&self, faces: &Faces, probe: Probe) -> Option<Place> {
        let (distance, triangle) = distance(faces, &probe, self.least, BEYOND * self.spacing)?;
        let is_far = distance >= self.least && !faces.any_within(probe.position, HIDDEN * self.least);
        is_far.then_some(Place { probe, distance, triangle })
    }

    /// The probes nearer to `p` than `reach`.
    fn probes_near(&self, p: DVec3, reach: f64) -> Probes {
        let triangles = self.domain.triangles_near(p, reach);
        let is_near = |q: DVec3| q.distance_squared(p) < reach * reach;
        let corners = triangles.iter().flat_map(|&t| self.domain.mesh.triangles[t as usize]);
        let mut vertices: Vec<u32> = corners.filter(|&v| is_near(self.domain.mesh.positions[v as usize])).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let inside = triangles.iter().flat_map(|&t| Probe::inside(self.domain, t, self.spacing));
        let inside = inside.filter(|probe| is_near(probe.position)).collect();
        Probes { vertices, inside }
    }

    /// How far around its place a neighborhood may change anything.
    fn reach(&self) -> f64 {
        (self.effort.rings + 1) as f64 * self.spacing
    }

    /// Those of `far` whose neighborhoods have nothing in common, the farthest first, without what is near to a place that was
    /// given up or much less far than one.
    fn apart(&self, far: &mut [Place], given_up: &[Place]) -> Vec<Place> {
        let by_position = |a: DVec3, b: DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
        far.sort_by(|a, b| {
            b.distance.total_cmp(&a.distance).then_with(|| by_position(a.probe.position, b.probe.position))
        });
        let worth = OF_GIVEN_UP * given_up.iter().map(|place| place.distance).fold(0.0, f64::max);
        let worst: Vec<DVec3> = given_up.iter().filter(|p| p.distance >= worth).map(|p| p.probe.position).collect();
        let is_beside = |p: DVec3| worst.iter().any(|q| p.distance(*q) < self.reach());
        // Rings are at most about a spacing high.
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

    /// The triangles around `place`, nearer to the surface than they are; `None` if no way was found.
    fn mend(&self, mesh: &Manifold, faces: &Faces, place: &Place) -> Option<Neighborhood> {
        let p = place.probe.position;
        let by_distance = |mesh: &Manifold, a: u32, b: u32| {
            mesh.position(a).distance_squared(p).total_cmp(&mesh.position(b).distance_squared(p)).then(a.cmp(&b))
        };
        let corners = mesh.connectivity.triangle(3 * place.triangle).into_iter();
        let free = corners.filter(|&v| mesh.connectivity.curve_at(v) == NONE);
        let middle = free.min_by(|&a, &b| by_distance(mesh, a, b))?;
        let neighborhood = Neighborhood::around(mesh, middle, self.effort.rings)?;
        let measured = Measured::new(self, faces, &neighborhood, p);
        let margin = worst_margin(&neighborhood.mesh).min(-LEEWAY);
        let mut attempt = measured.attempt(neighborhood, Vec::new());
        let most = MUST_FALL_TO * attempt.farthest;
        for _ in 0..PULLS {
            attempt = self.pull_nearest(&attempt, &measured, margin)?;
            if attempt.farthest < most && !would_cross(faces, &attempt.neighborhood) {
                return Some(attempt.neighborhood);
            }
        }
        None
    }

    /// The best of what comes of putting one or another vertex at the farthest place.
    fn pull_nearest(&self, from: &Attempt, measured: &Measured, margin: f64) -> Option<Attempt> {
        let away = |v: u32| from.neighborhood.mesh.position(v).distance_squared(from.place);
        let mut nearest: Vec<u32> = from.neighborhood.free_vertices().filter(|v| !from.held.contains(v)).collect();
        nearest.sort_by(|&a, &b| away(a).total_cmp(&away(b)).then(a.cmp(&b)));
        nearest.truncate(self.effort.tried);
        let tries = nearest.par_iter().filter_map(|&v| {
            let mut neighborhood = from.neighborhood.clone();
            let held: Vec<u32> = from.held.iter().copied().chain([v]).collect();
            neighborhood.mesh.samples[v as usize] = self.domain.project_anywhere(from.place);
            let sound = self.arrange(&mut neighborhood.mesh, &held, measured, margin).ok()?;
            sound.then(|| measured.attempt(neighborhood, held))
        });
        tries.collect::<Vec<_>>().into_iter().min_by(|a, b| a.farthest.total_cmp(&b.farthest))
    }

    /// Arranges the vertices around those that are `held`. Whether no triangle is farther outside of the goal than by
    /// `margin` then.
    fn arrange(&self, mesh: &mut Manifold, held: &[u32], measured: &Measured, margin: f64) -> Result<bool> {
        let improve = |mesh: &mut Manifold| {
            improve_angles_for(self.domain, mesh, self.spacing, self.effort.passes, &())?;
            Ok(worst_margin(mesh) >= margin)
        };
        held.iter().for_each(|&v| mesh.fixed[v as usize] = true);
        relax(self.domain, mesh, self.spacing, Flips::Delaunay, RELAX_ROUNDS, &())?;
        if bad_triangles(mesh) > MOST_BAD || !improve(mesh)? {
            return Ok(false);
        }
        mesh.fixed.fill(false);
        fit_part(self.domain, mesh, self.spacing, self.mean_square, &measured.probes.vertices);
        improve(mesh)
    }
}

/// A neighborhood that has been changed, and how far it is from the surface.
struct Attempt {
    neighborhood: Neighborhood,
    /// The vertices that were put somewhere.
    held: Vec<u32>,
    farthest: f64,
    /// The place on the surface where it is so far.
    place: DVec3,
}

/// Where distances around a place are measured.
struct Measured<'a> {
    task: &'a Task<'a>,
    place: DVec3,
    probes: Probes,
}

impl<'a> Measured<'a> {
    /// Around `place`, at what of the surface is closest to a triangle of `neighborhood`.
    fn new(task: &'a Task<'a>, faces: &Faces, neighborhood: &Neighborhood, place: DVec3) -> Measured<'a> {
        let belongs = |probe: &Probe| {
            distance(faces, probe, 0.0, BEYOND * task.spacing).is_some_and(|(_, t)| neighborhood.has_triangle(t))
        };
        let mut probes = task.probes_near(place, MEASURED * task.spacing);
        probes.vertices.retain(|&v| belongs(&Probe::at_vertex(task.domain, v)));
        probes.inside.retain(belongs);
        Measured { task, place, probes }
    }

    /// `neighborhood` with the largest distance between it and the surface, both ways.
    fn attempt(&self, neighborhood: Neighborhood, held: Vec<u32>) -> Attempt {
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
        Attempt { neighborhood, held, farthest, place }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangular grid with `n` edges of length 1/n to a side, over the rhombus of side 1, at the given heights.
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

    /// Edges to a side of the coarse sheet.
    const COARSE: u32 = 15;

    /// The middle of a triangle of the coarse sheet, about its middle.
    fn middle() -> DVec3 {
        let flat = sheet(COARSE, |_, _| 0.0);
        flat.corners((COARSE * COARSE - 1) as usize).into_iter().sum::<DVec3>() / 3.0
    }

    /// A fine sheet with a spike there, as high as half a coarse edge, and a coarse one laid on it.
    fn spike() -> (Domain, Manifold) {
        let (middle, spacing) = (middle(), 1.0 / f64::from(COARSE));
        let spike = |x: f64, y: f64| 0.5 * (spacing - 1.2 * (x - middle.x).hypot(y - middle.y)).max(0.0);
        let domain = Domain::new(sheet(8 * COARSE, spike));
        let coarse = sheet(COARSE, |_, _| 0.0);
        let samples = coarse.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &coarse.triangles);
        mesh.lock_boundary();
        (domain, mesh)
    }

    /// As from a fit that has all vertices watched.
    fn fitted(domain: &Domain, mean_square: f64) -> Fitted {
        Fitted { mean_square, vertices: (0..domain.mesh.positions.len() as u32).collect(), triangles: Vec::new() }
    }

    /// The largest distance of a vertex of the domain to the mesh.
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
        assert!(before > 1.5 * FAR * spacing && after < FAR * spacing, "{before} {after}");
        assert!(worst_margin(&mesh) >= -LEEWAY);
        assert_eq!(mesh.to_mesh().positions.len(), old.to_mesh().positions.len());
        let corners = (0..mesh.connectivity.vertex_bound()).filter(|&v| mesh.is_locked(v));
        corners.for_each(|v| assert_eq!(mesh.position(v), old.position(v)));
    }

    #[test]
    fn a_vertex_put_through_another_sheet_would_cross_it() {
        let (lower, upper) = (sheet(COARSE, |_, _| 0.0), sheet(COARSE, |_, _| 0.01));
        let first = lower.positions.len() as u32;
        let positions = lower.positions.into_iter().chain(upper.positions);
        let triangles: Vec<[u32; 3]> =
            lower.triangles.into_iter().chain(upper.triangles.into_iter().map(|t| t.map(|v| v + first))).collect();
        let samples = positions.map(|position| Sample { position, normal: DVec3::Z, triangle: 0, size: 1.0 });
        let mesh = Manifold::new(samples.collect(), &triangles);
        let mut neighborhood = Neighborhood::around(&mesh, (first + COARSE) / 2, 2).unwrap();
        let faces = Faces::new(&mesh);
        for (height, crosses) in [(0.0, false), (0.009, false), (0.02, true)] {
            neighborhood.mesh.samples[0].position.z = height;
            assert_eq!(would_cross(&faces, &neighborhood), crosses, "{height}");
        }
    }

    #[test]
    fn a_mesh_that_is_near_everywhere_stays() {
        let domain = Domain::new(sheet(4 * COARSE, |x, y| 0.01 * (3.0 * x).sin() * (2.0 * y).cos()));
        let coarse = sheet(COARSE, |_, _| 0.0);
        let samples = coarse.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &coarse.triangles);
        mesh.lock_boundary();
        let old = mesh.to_mesh();
        reduce_max_error(&domain, &mut mesh, 1.0 / f64::from(COARSE), &fitted(&domain, 1e-9), &()).unwrap();
        assert_eq!((mesh.to_mesh().positions, mesh.to_mesh().triangles), (old.positions, old.triangles));
    }
}
