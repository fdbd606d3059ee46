//! Brings the mesh to the few places that are still far from it: tips and ridges that no vertex is at.
//!
//! Relaxation leaves few vertices at a tip, and least squares leave the tip where it is if none is near. So the
//! triangles around each far place are taken out as a patch, and one of the nearest vertices after the other is put at
//! the place: the patch relaxes with that vertex held, its worst angles are improved, and it is fitted to the surface
//! again. The patch that is nearest to the surface then, both ways, is put back if it is nearer by far than the one that
//! was there, and no triangle is farther outside of the goal.
//!
//! What no step of single vertices reaches is often one such jump away, because the flips around it change the order of
//! the vertices: on thirteen models the Hausdorff distance fell by a third.
//!
//! Cost: some milliseconds for each place; there are rarely more than twenty. Limits: vertices on curves stay, and so do
//! places that only those could reach.

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::optimize::angles::{bad_triangles, improve_angles, worst_margin};
use crate::optimize::fit::{POINTS, fit_part, point};
use crate::optimize::relax::{Flips, relax};
use crate::surface::bvh::Bvh;
use crate::surface::domain::{Domain, Sample};
use crate::surface::manifold::Manifold;
use crate::surface::mesh::Mesh;
use crate::surface::patch::Patch;
use crate::surface::topology::NONE;
use glam::DVec3;
use rayon::prelude::*;

/// Rounds over the far places: mending one shows others beside it.
const MOST_ROUNDS: usize = 16;

/// Most places that a round looks at, the farthest first.
const MOST_PLACES: usize = 32;

/// Distance from which on a place is far: in spacings, and in roots of the mean square.
const FAR: f64 = 0.2;
const FAR_OF_MEAN: f64 = 5.5;

/// Distance, in spacings, beyond which surfaces have nothing to do with each other.
const BEYOND: f64 = 2.0;

/// Rings of triangles that are taken out, and how far from the place, in spacings, distances are measured.
const RINGS: usize = 5;
const MEASURED: f64 = 2.5;

/// Distance, in spacings, of places whose patches have nothing in common: rings are at most so high.
const APART: f64 = 2.0 * RINGS as f64;

/// Vertices that are tried, the nearest first.
const TRIED: usize = 4;

/// Rounds of relaxation with a vertex held.
const RELAX_ROUNDS: usize = 3;

/// Triangles outside of the goal that it may leave: more are not mended.
const MOST_BAD: usize = 12;

/// Share of the distance that may be left.
const MUST_FALL_TO: f64 = 0.9;

/// Probes that one task looks at.
const CHUNK: usize = 256;

/// Sides of the surface's triangles, in spacings, from which on their insides are looked at, too.
const LONG_SIDE: f64 = 0.6;

/// Brings the mesh nearer to the places that are far from it. `spacing` is the mean edge length, `mean_square` the mean
/// of the squared distances between mesh and surface.
pub fn reach_far_places(
    domain: &Domain,
    mesh: &mut Manifold,
    spacing: f64,
    mean_square: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    let probes = probes(domain, spacing);
    let least = (FAR * spacing).max(FAR_OF_MEAN * mean_square.sqrt());
    let task = Task { domain, probes: &probes, spacing, mean_square, least };
    let everywhere = |_: DVec3| true;
    let mut target = Target::new(mesh);
    let mut far = task.far_probes(&target, everywhere);
    let mut given_up: Vec<DVec3> = Vec::new();
    for _ in 0..MOST_ROUNDS {
        check(monitor)?;
        let places = task.places(&mut far, &given_up);
        if places.is_empty() {
            break;
        }
        let patches: Vec<Option<Patch>> = places.par_iter().map(|place| task.mend(mesh, &target, place)).collect();
        let mut touched = vec![false; mesh.connectivity.half_edge_bound() as usize / 3];
        let mut mended: Vec<DVec3> = Vec::new();
        for (place, patch) in places.iter().zip(patches) {
            let at = probes[place.probe].position;
            match patch {
                Some(patch) if patch.put_back(mesh, &mut touched) => mended.push(at),
                Some(_) => {}
                None => given_up.push(at),
            }
        }
        // Only there is anything else than it was.
        let is_new = |p: DVec3| mended.iter().any(|at| p.distance(*at) < (RINGS + 1) as f64 * spacing);
        given_up.retain(|&p| !is_new(p));
        far.retain(|place| !is_new(probes[place.probe].position));
        if !mended.is_empty() {
            target.follow(mesh);
            far.extend(task.far_probes(&target, is_new));
        }
    }
    Ok(())
}

/// A point of the surface that distances are measured at.
struct Probe {
    position: DVec3,
    normal: DVec3,
}

/// The vertices of the surface, and points inside of its large triangles.
fn probes(domain: &Domain, spacing: f64) -> Vec<Probe> {
    let mesh = &domain.mesh;
    let at_vertex = |v: u32| Probe { position: mesh.positions[v as usize], normal: domain.vertex_normal(v) };
    let is_large = |t: &usize| {
        let [a, b, c] = mesh.corners(*t);
        a.distance(b).max(b.distance(c)).max(c.distance(a)) > LONG_SIDE * spacing
    };
    let inside = |t: usize| {
        let (corners, normal) = (mesh.corners(t), mesh.area_vector(t));
        POINTS.map(|(at, _)| Probe { position: point(corners, at), normal })
    };
    let large = (0..mesh.triangles.len()).filter(is_large);
    (0..mesh.positions.len() as u32).map(at_vertex).chain(large.flat_map(inside)).collect()
}

/// A mesh to measure distances to.
struct Target {
    mesh: Mesh,
    bvh: Bvh,
    /// For each triangle its number in the manifold.
    number: Vec<u32>,
}

impl Target {
    fn new(mesh: &Manifold) -> Target {
        let c = &mesh.connectivity;
        let number: Vec<u32> = mesh.half_edges().filter(|h| h % 3 == 0).map(|h| h / 3).collect();
        let triangles = number.iter().map(|&t| c.triangle(3 * t)).collect();
        let mesh = Mesh { positions: mesh.samples.iter().map(|s| s.position).collect(), triangles };
        Target { bvh: Bvh::new(&mesh), mesh, number }
    }

    /// Takes over where the vertices are, and what triangles there are in the place of as many others.
    fn follow(&mut self, mesh: &Manifold) {
        self.mesh.positions.iter_mut().zip(&mesh.samples).for_each(|(p, sample)| *p = sample.position);
        let triangles = self.mesh.triangles.iter_mut().zip(&self.number);
        triangles.for_each(|(corners, &t)| *corners = mesh.connectivity.triangle(3 * t));
        self.bvh.refit(&self.mesh);
    }

    /// How far `probe` is from the triangles that face its way, if nearer than `most`, and the number of the closest one.
    fn distance(&self, probe: &Probe, most: f64) -> Option<(f64, u32)> {
        let facing = |t: u32| self.mesh.area_vector(t as usize).dot(probe.normal) > 0.0;
        let hit = self.bvh.closest_where(&self.mesh, probe.position, most * most, facing)?;
        Some((hit.distance_squared.sqrt(), self.number[hit.triangle as usize]))
    }
}

/// A probe that is far from the mesh, and the triangle that is closest to it.
#[derive(Clone, Copy)]
struct Place {
    probe: usize,
    distance: f64,
    triangle: u32,
}

/// What all places have in common.
struct Task<'a> {
    domain: &'a Domain,
    probes: &'a [Probe],
    spacing: f64,
    mean_square: f64,
    /// The distance from which on a place is far.
    least: f64,
}

impl Task<'_> {
    /// The probes that are far, of those that are `here`.
    fn far_probes(&self, target: &Target, here: impl Fn(DVec3) -> bool + Sync) -> Vec<Place> {
        let far = |(probe, at): (usize, &Probe)| {
            let (distance, triangle) = here(at.position).then(|| target.distance(at, BEYOND * self.spacing))??;
            (distance >= self.least).then_some(Place { probe, distance, triangle })
        };
        self.probes.par_iter().enumerate().with_min_len(CHUNK).filter_map(far).collect()
    }

    /// Those of `far` whose patches have nothing in common, the farthest first, without what is near to a place that was
    /// given up.
    fn places(&self, far: &mut [Place], given_up: &[DVec3]) -> Vec<Place> {
        far.sort_by(|a, b| b.distance.total_cmp(&a.distance).then(a.probe.cmp(&b.probe)));
        let mut places: Vec<Place> = Vec::new();
        let at = |place: &Place| self.probes[place.probe].position;
        for place in far {
            let is_apart = |p: DVec3, spacings: f64| p.distance(at(place)) > spacings * self.spacing;
            if places.len() < MOST_PLACES
                && given_up.iter().all(|&p| is_apart(p, MEASURED))
                && places.iter().all(|p| is_apart(at(p), APART))
            {
                places.push(*place);
            }
        }
        places
    }

    /// The triangles around `place`, nearer to the surface than they are; `None` if no way was found.
    fn mend(&self, mesh: &Manifold, target: &Target, place: &Place) -> Option<Patch> {
        let probe = &self.probes[place.probe];
        let p = probe.position;
        let by_distance = |mesh: &Manifold, a: u32, b: u32| {
            mesh.position(a).distance_squared(p).total_cmp(&mesh.position(b).distance_squared(p)).then(a.cmp(&b))
        };
        let corners = mesh.connectivity.triangle(3 * place.triangle).into_iter();
        let free = corners.filter(|&v| mesh.connectivity.curve_at(v) == NONE);
        let middle = free.min_by(|&a, &b| by_distance(mesh, a, b))?;
        let patch = Patch::around(mesh, middle, RINGS)?;
        let measured = Measured::new(self, target, &patch, p);
        let tip = self.domain.project(p, probe.normal, mesh.samples[middle as usize].triangle);
        let mut nearest: Vec<u32> = patch.free_vertices().collect();
        nearest.sort_by(|&a, &b| by_distance(&patch.mesh, a, b));

        let margin = worst_margin(&patch.mesh).min(0.0);
        let tries = nearest[..TRIED.min(nearest.len())].par_iter().filter_map(|&v| {
            let mut other = patch.clone();
            self.pull(&mut other.mesh, v, tip, &measured, margin).ok()?.then(|| (measured.farthest(&other.mesh), other))
        });
        let best = tries.collect::<Vec<_>>().into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        (best.0 < MUST_FALL_TO * measured.farthest(&patch.mesh)).then_some(best.1)
    }

    /// Puts `v` at `tip` and arranges the others around it. Whether no triangle is farther outside of the goal than by
    /// `margin` then.
    fn pull(&self, mesh: &mut Manifold, v: u32, tip: Sample, measured: &Measured, margin: f64) -> Result<bool> {
        let improve = |mesh: &mut Manifold| {
            improve_angles(self.domain, mesh, self.spacing, &())?;
            Ok(worst_margin(mesh) >= margin)
        };
        mesh.samples[v as usize] = tip;
        mesh.fixed[v as usize] = true;
        relax(self.domain, mesh, self.spacing, Flips::Delaunay, RELAX_ROUNDS, &())?;
        if bad_triangles(mesh) > MOST_BAD || !improve(mesh)? {
            return Ok(false);
        }
        mesh.fixed[v as usize] = false;
        fit_part(self.domain, mesh, self.spacing, self.mean_square, &measured.vertices);
        improve(mesh)
    }
}

/// Where distances around a place are measured.
struct Measured<'a> {
    task: &'a Task<'a>,
    place: DVec3,
    probes: Vec<&'a Probe>,
    /// Those of the probes that are vertices of the surface.
    vertices: Vec<u32>,
}

impl<'a> Measured<'a> {
    /// Around `place`, at what of the surface is closest to a triangle of `patch`.
    fn new(task: &'a Task<'a>, target: &Target, patch: &Patch, place: DVec3) -> Measured<'a> {
        let is_near = |probe: &Probe| probe.position.distance_squared(place) < (MEASURED * task.spacing).powi(2);
        let closest = |probe: &Probe| target.distance(probe, BEYOND * task.spacing);
        let belongs = |probe: &Probe| is_near(probe) && closest(probe).is_some_and(|(_, t)| patch.has_triangle(t));
        let (numbers, probes): (Vec<usize>, Vec<&Probe>) =
            task.probes.iter().enumerate().filter(|(_, probe)| belongs(probe)).unzip();
        let vertices = task.domain.mesh.positions.len();
        let vertices = numbers.into_iter().filter(|&i| i < vertices).map(|i| i as u32).collect();
        Measured { task, place, probes, vertices }
    }

    /// The largest distance between the patch and the surface, both ways.
    fn farthest(&self, mesh: &Manifold) -> f64 {
        let Task { domain, spacing, .. } = *self.task;
        let target = Target::new(mesh);
        let to_mesh = |probe: &&Probe| target.distance(probe, BEYOND * spacing).map_or(BEYOND * spacing, |d| d.0);
        let farthest = self.probes.iter().map(to_mesh).fold(0.0, f64::max);
        let is_near = |p: &DVec3| p.distance_squared(self.place) < (MEASURED * spacing).powi(2);
        let near = (0..target.mesh.triangles.len()).map(|t| target.mesh.corners(t)).filter(|x| x.iter().all(is_near));
        let points = near.flat_map(|x| POINTS.map(|(at, _)| point(x, at)));
        points.map(|p| domain.project_anywhere(p).position.distance(p)).fold(farthest, f64::max)
    }
}
