//! Brings the mesh to the few places that are still far from it: tips and ridges that no vertex is at.
//!
//! Least squares leave a tip where it is if no vertex is near, and relaxation leaves few there. So the triangles around
//! each far place are taken out as a patch and tried in several ways: one of the nearest vertices is put at the place, or
//! a new one, for which another is taken out of the patch. The patch relaxes with that vertex held, its worst angles are
//! improved, and it is fitted to the surface again. The way that leaves the patch nearest to the surface, with all
//! triangles as far inside of the goal as before, is kept if it is nearer by far.
//!
//! Cost: some milliseconds for each place; there are rarely more than ten.
//!
//! Limits: places near curves and the boundary stay as they are.

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::optimize::angles::{improve_angles, worst_margin};
use crate::optimize::fit::{POINTS, fit_part};
use crate::optimize::relax::{Flips, relax};
use crate::surface::bvh::Bvh;
use crate::surface::domain::Domain;
use crate::surface::manifold::Manifold;
use crate::surface::mesh::Mesh;
use crate::surface::patch::Patch;
use glam::DVec3;
use rayon::prelude::*;

/// Rounds over the far places.
const ROUNDS: usize = 2;

/// Distance in spacings from which on a place is far.
const FAR: f64 = 0.2;

/// The same in roots of the mean square.
const FAR_OF_MEAN: f64 = 5.5;

/// Most places that a round looks at, the farthest first.
const MOST_PLACES: usize = 32;

/// Rings of triangles around a place that are taken out, and distance in spacings of the places that a patch is
/// measured at.
const RINGS: usize = 6;
const MEASURED: f64 = 2.5;

/// Vertices that are tried.
const TRIED: usize = 4;

/// Rounds of relaxation.
const RELAX_ROUNDS: usize = 3;

/// Share of the distance that may be left.
const MUST_FALL_TO: f64 = 0.9;

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

    /// How far a vertex of the domain is from the triangles that face its way, if nearer than `most`, and the number of
    /// the closest one.
    fn distance(&self, domain: &Domain, v: u32, most: f64) -> Option<(f64, u32)> {
        let normal = domain.vertex_normal(v);
        let facing = |t: u32| self.mesh.area_vector(t as usize).dot(normal) > 0.0;
        let p = domain.mesh.positions[v as usize];
        let hit = self.bvh.closest_where(&self.mesh, p, most * most, facing)?;
        Some((hit.distance_squared.sqrt(), self.number[hit.triangle as usize]))
    }
}

/// A vertex of the domain that is far from the mesh.
struct Place {
    vertex: u32,
    distance: f64,
    triangle: u32,
}

/// Brings the mesh to the places far from it. `spacing` is the mean edge length, `mean_square` that of the distances
/// between mesh and surface.
pub fn reach_far_places(
    domain: &Domain,
    mesh: &mut Manifold,
    spacing: f64,
    mean_square: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    for _ in 0..ROUNDS {
        check(monitor)?;
        let target = Target::new(mesh);
        let places = far_places(domain, &target, spacing, mean_square);
        if std::env::var("TIPS").is_ok() {
            eprintln!("{} places {:?}", places.len(), places.iter().map(|p| (p.distance / spacing * 1e3).round() / 1e3).collect::<Vec<_>>());
        }
        let mended: Vec<Option<Patch>> = places
            .par_iter()
            .map(|place| mend(domain, mesh, &target, place, spacing, mean_square))
            .collect();
        let mut touched = vec![false; mesh.connectivity.half_edge_bound() as usize / 3];
        let mut changed = false;
        for patch in mended.into_iter().flatten() {
            if patch.triangles.iter().any(|&t| touched[t as usize]) {
                continue;
            }
            patch.triangles.iter().for_each(|&t| touched[t as usize] = true);
            changed |= patch.put_back(mesh);
        }
        if !changed {
            break;
        }
    }
    Ok(())
}

fn far_places(domain: &Domain, target: &Target, spacing: f64, mean_square: f64) -> Vec<Place> {
    let least = (FAR * spacing).max(FAR_OF_MEAN * mean_square.sqrt());
    let far = |v: u32| {
        let (distance, triangle) = target.distance(domain, v, 2.0 * spacing)?;
        (distance >= least).then_some(Place { vertex: v, distance, triangle })
    };
    let vertices = (0..domain.mesh.positions.len() as u32).into_par_iter().with_min_len(256);
    let mut places: Vec<Place> = vertices.filter_map(far).collect();
    places.sort_by(|a, b| b.distance.total_cmp(&a.distance).then(a.vertex.cmp(&b.vertex)));
    let mut kept: Vec<Place> = Vec::new();
    let at = |p: &Place| domain.mesh.positions[p.vertex as usize];
    for place in places {
        if kept.len() < MOST_PLACES && kept.iter().all(|k| at(k).distance(at(&place)) > MEASURED * spacing) {
            kept.push(place);
        }
    }
    kept
}

/// What a patch is measured at.
struct Measure<'a> {
    domain: &'a Domain,
    vertices: Vec<u32>,
    place: DVec3,
    spacing: f64,
}

impl Measure<'_> {
    /// The largest distance between the patch and the surface, both ways, near the place.
    fn farthest(&self, mesh: &Manifold) -> f64 {
        let target = Target::new(mesh);
        let to = |&v: &u32| target.distance(self.domain, v, 2.0 * self.spacing).map_or(2.0 * self.spacing, |d| d.0);
        let inwards = self.vertices.iter().map(to).fold(0.0, f64::max);
        let near = |v: u32| mesh.position(v).distance(self.place) < MEASURED * self.spacing;
        let back = |h: u32| {
            let corners = mesh.connectivity.triangle(h);
            if !corners.into_iter().all(near) {
                return 0.0;
            }
            let x = corners.map(|v| mesh.position(v));
            let distance = |at: [f64; 3]| {
                let position = at[0] * x[0] + at[1] * x[1] + at[2] * x[2];
                self.domain.project_anywhere(position).position.distance(position)
            };
            POINTS.iter().map(|p| distance(p.0)).fold(0.0, f64::max)
        };
        mesh.half_edges().filter(|h| h % 3 == 0).map(back).fold(inwards, f64::max)
    }
}

/// The triangles around `place`, nearer to it; `None` if no way was found.
fn mend(
    domain: &Domain,
    mesh: &Manifold,
    target: &Target,
    place: &Place,
    spacing: f64,
    mean_square: f64,
) -> Option<Patch> {
    let p = domain.mesh.positions[place.vertex as usize];
    let corners = mesh.connectivity.triangle(3 * place.triangle);
    let nearest = corners.into_iter().min_by(|&a, &b| {
        mesh.position(a).distance_squared(p).total_cmp(&mesh.position(b).distance_squared(p)).then(a.cmp(&b))
    })?;
    let patch = Patch::around(mesh, nearest, RINGS)?;
    let mut around = domain.vertices_near(p, MEASURED * spacing);
    around.retain(|&v| {
        let closest = target.distance(domain, v, 2.0 * spacing);
        closest.is_some_and(|(_, t)| patch.triangles.binary_search(&t).is_ok())
    });
    let measure = Measure { domain, vertices: around, place: p, spacing };
    let (margin, distance) = (worst_margin(&patch.mesh).min(0.0), measure.farthest(&patch.mesh));
    let at = domain.project(p, domain.vertex_normal(place.vertex), mesh.samples[nearest as usize].triangle);
    let mut tries = Vec::new();
    let free = |mesh: &Manifold, v: u32| !mesh.is_held(v);
    let mut nearest: Vec<u32> =
        (0..patch.mesh.connectivity.vertex_bound()).filter(|&v| free(&patch.mesh, v)).collect();
    let d = |v: u32| patch.mesh.position(v).distance_squared(p);
    nearest.sort_by(|&a, &b| d(a).total_cmp(&d(b)).then(a.cmp(&b)));
    for &v in nearest.iter().take(TRIED) {
        let mut other = patch.clone();
        other.mesh.samples[v as usize] = at;
        tries.push((other, v));
    }
    let show = std::env::var("TIPS").is_ok();
    let mut best: Option<(f64, Patch)> = None;
    for (mut other, v) in tries {
        other.mesh.fixed[v as usize] = true;
        relax(domain, &mut other.mesh, spacing, Flips::Delaunay, RELAX_ROUNDS, &()).ok()?;
        improve_angles(domain, &mut other.mesh, spacing, &()).ok()?;
        other.mesh.fixed[v as usize] = false;
        fit_part(domain, &mut other.mesh, spacing, mean_square, &measure.vertices);
        improve_angles(domain, &mut other.mesh, spacing, &()).ok()?;
        let far = measure.farthest(&other.mesh);
        let m = worst_margin(&other.mesh);
        if show {
            eprintln!("  place {:.3} local {:.3} -> {:.3} margin {:.2} (was {:.2})", place.distance / spacing, distance / spacing, far / spacing, m, margin);
        }
        if m >= margin && far < MUST_FALL_TO * distance && best.as_ref().is_none_or(|b| far < b.0) {
            best = Some((far, other));
        }
    }
    best.map(|b| b.1)
}
