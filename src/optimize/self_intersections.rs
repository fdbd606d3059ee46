//! Resolves self-intersections of the mesh.
//!
//! They have two causes: sheets of the surface that are closer to each other than the faces are to the surface, and folds at
//! narrow rims, where one or two faces lie wrong. So there are four remedies, in turns.
//!
//! - The corners of intersecting faces move back to the surface, from which the fit has moved them.
//! - Sheets separate: the corners of faces that intersect those of another sheet step away from that sheet along the normal,
//!   outwards if there is a wall between the sheets and inwards if there is a gap, by shares of the distance between face
//!   and surface. All step at once, since in a thin shell every face intersects many.
//! - Single edges flip and single vertices move to where fewer faces intersect; of several such places, the one with the
//!   best triangles is chosen.
//! - Where neither helps, the corners move so that the segments shared by faces become shorter, see `optimize/shorten.rs`.
//!
//! A turn that does not reduce the number of intersecting pairs is undone and is the last. Self-intersections of the input
//! are left alone: the sheets belong there. The report counts those that remain.
//!
//! Cost: one search for self-intersections if there are none. Otherwise, one more among the changed faces for each step of
//! the sheets, and some ten local searches for each corner of an intersecting face.
//!
//! Limits: vertices that step away from the surface stay off it, by at most `FARTHEST`. Some self-intersections cannot be
//! resolved with the samples there; splitting edges made more faces intersect, not fewer.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::geom::triangle::mean_ratio;
use crate::manifold::Manifold;
use crate::manifold::facing::{FacingGuard, LEAST_MENDABLE};
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::{next, prev};
use crate::optimize::crossings::{
    Corners, Crossings, Surroundings, acceptable, fan, foot, is_near_surface, longest_edge,
};
use crate::optimize::shorten::shorten_crossings;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of turns; most places need one or two.
const TURNS: usize = 6;

/// Number of steps of the sheets in a turn, and the share of the distance between face and surface that each step covers: in
/// the end, the face is clear of the surface.
const STEPS: usize = 6;
const STEP: f64 = 0.35;

/// Distances, in lengths of the longest edge there, at which a vertex searches for a better place.
const REACHES: [f64; 4] = [0.06, 0.12, 0.25, 0.5];

/// Number of directions in which it searches.
const DIRECTIONS: usize = 8;

/// Maximum number of faces treated one by one in a turn: if more intersect, only separating the sheets helps, if anything.
const MOST_TREATED: usize = 150;

/// If more than [`MOST_TREATED`] intersect, a turn that leaves more than this share of the pairs is the last.
const LEAST_PROGRESS: f64 = 0.8;

/// Moves vertices and flips edges until no avoidable self-intersection is left or nothing helps: separates sheets and treats
/// single faces in turns, while the number of intersecting pairs falls.
pub fn resolve_self_intersections(domain: &Domain, mesh: &mut Manifold, monitor: &dyn Monitor) -> Result<()> {
    let mut crossings = Crossings::new(domain, mesh);
    for _ in 0..TURNS {
        if crossings.avoidable.is_empty() {
            break;
        }
        check(monitor)?;
        let (before, left) = (mesh.clone(), crossings.avoidable.len());
        take_back(domain, mesh, &mut crossings);
        part_sheets(domain, mesh, &mut crossings);
        treat_faces(domain, mesh, &crossings);
        crossings.follow(domain, mesh);
        if crossings.avoidable.len() <= MOST_TREATED {
            shorten_crossings(domain, mesh, &crossings);
            crossings.follow(domain, mesh);
        }
        if crossings.avoidable.len() >= left {
            *mesh = before;
            break;
        }
        if crossings.avoidable.len() > MOST_TREATED.max((LEAST_PROGRESS * left as f64) as usize) {
            break;
        }
    }
    Ok(())
}

/// Moves the corners of crossing faces back to the surface, from which the fit has moved them, if fewer faces cross then.
fn take_back(domain: &Domain, mesh: &mut Manifold, crossings: &mut Crossings) {
    let faces = crossings.avoidable.iter().flat_map(|&(t, u)| [t, u]);
    let corners: BTreeSet<u32> = faces.flat_map(|t| mesh.connectivity.triangle(3 * t)).collect();
    let (before, left) = (mesh.samples().to_vec(), crossings.avoidable.len());
    for v in corners {
        let foot = foot(domain, mesh.sample(v));
        if !mesh.connectivity.is_on_curve(v) && acceptable(mesh, v, &foot) {
            mesh.place(v, foot);
        }
    }
    crossings.follow(domain, mesh);
    if crossings.avoidable.len() >= left {
        mesh.place_all(before);
        crossings.follow(domain, mesh);
    }
}

/// Moves crossing sheets apart, step by step, and keeps the step with the fewest crossings.
fn part_sheets(domain: &Domain, mesh: &mut Manifold, crossings: &mut Crossings) {
    let mut best = (crossings.avoidable.len(), mesh.samples().to_vec());
    for _ in 0..STEPS {
        let ways = ways_apart(domain, mesh, &crossings.avoidable);
        let moved = ways.into_iter().filter(|&(v, way)| step_off(domain, mesh, v, way)).count();
        if moved == 0 {
            break;
        }
        crossings.follow(domain, mesh);
        if crossings.avoidable.len() < best.0 {
            best = (crossings.avoidable.len(), mesh.samples().to_vec());
        }
    }
    mesh.place_all(best.1);
    crossings.follow(domain, mesh);
}

/// Returns, for each corner of the crossing faces, the longest step away from a sheet in its way.
fn ways_apart(domain: &Domain, mesh: &Manifold, pairs: &[(u32, u32)]) -> BTreeMap<u32, DVec3> {
    let faces: BTreeSet<u32> = pairs.iter().flat_map(|&(t, u)| [t, u]).collect();
    let heights: BTreeMap<u32, f64> = faces.iter().map(|&t| (t, height(domain, mesh, t))).collect();
    let corners: BTreeSet<u32> = faces.iter().flat_map(|&t| mesh.connectivity.triangle(3 * t)).collect();
    let feet: BTreeMap<u32, DVec3> = corners.into_iter().map(|v| (v, foot(domain, mesh.sample(v)).position)).collect();
    let mut ways: BTreeMap<u32, DVec3> = BTreeMap::new();
    for &(t, u) in pairs {
        let step = STEP * heights[&t].max(heights[&u]);
        for (face, other) in [(t, u), (u, t)] {
            for v in mesh.connectivity.triangle(3 * face) {
                let way = step * away_from(domain, mesh, v, feet[&v], other);
                let longest = ways.entry(v).or_default();
                if way.length_squared() > longest.length_squared() {
                    *longest = way;
                }
            }
        }
    }
    ways
}

/// Returns the distance of the centroid of a face from the surface that the face represents.
fn height(domain: &Domain, mesh: &Manifold, face: u32) -> f64 {
    let corners = mesh.connectivity.triangle(3 * face).map(|v| mesh.sample(v));
    let middle = corners.iter().map(|s| s.position).sum::<DVec3>() / 3.0;
    let normal = corners.iter().map(|s| s.normal).sum();
    domain.project(middle, normal, on_patch(corners).triangle).position.distance(middle)
}

/// Returns the direction, along the normal at `v`, away from the sheet of the surface that face `other` represents; zero if
/// `v` is on it. `foot` is the foot of `v` on the surface.
fn away_from(domain: &Domain, mesh: &Manifold, v: u32, foot: DVec3, other: u32) -> DVec3 {
    let corners = mesh.connectivity.triangle(3 * other);
    if corners.contains(&v) {
        return DVec3::ZERO;
    }
    let here = mesh.sample(v);
    let corners = corners.map(|w| mesh.sample(w));
    let normal = corners.iter().map(|s| s.normal).sum();
    let there = domain.project(foot, normal, on_patch(corners).triangle).position;
    let ahead = (there - foot).dot(here.normal);
    if ahead == 0.0 { DVec3::ZERO } else { -ahead.signum() * here.normal }
}

/// Returns a corner of a face that is not on a sharp edge, if there is one: it knows the patch.
fn on_patch(corners: [&Sample; 3]) -> &Sample {
    corners.into_iter().find(|s| s.normal != DVec3::ZERO).unwrap_or(corners[0])
}

/// Moves `v` without projecting it back onto the surface, unless it would be too far away, or turn a triangle over or spoil
/// it. Returns whether it moved.
fn step_off(domain: &Domain, mesh: &mut Manifold, v: u32, way: DVec3) -> bool {
    let here = *mesh.sample(v);
    let there = Sample { position: here.position + way, ..here };
    let may = way != DVec3::ZERO
        && !mesh.connectivity.is_on_interface(v)
        && is_near_surface(domain, mesh, v, &there)
        && acceptable(mesh, v, &there);
    if may {
        mesh.place(v, there);
    }
    may
}

/// Flips edges and moves vertices of crossing faces, one by one, where that leaves fewer crossings.
fn treat_faces(domain: &Domain, mesh: &mut Manifold, Crossings { faces, avoidable, .. }: &Crossings) {
    let crossing: BTreeSet<u32> = avoidable.iter().flat_map(|&(t, u)| [t, u]).collect();
    let mut around = Surroundings::new(faces);
    // What did not help will not help until something has changed.
    let (mut edges, mut vertices) = (BTreeSet::new(), BTreeSet::new());
    for face in crossing.into_iter().take(MOST_TREATED) {
        let h = 3 * face;
        for side in [h, next(h), prev(h)] {
            let edge = side.min(mesh.connectivity.twin(side));
            if edges.insert(edge) && around.flip_if_fewer(mesh, side) {
                (edges, vertices) = Default::default();
            }
        }
        for v in mesh.connectivity.triangle(h) {
            if vertices.insert(v) && around.move_if_fewer(domain, mesh, v) {
                (edges, vertices) = Default::default();
            }
        }
    }
}

impl Surroundings<'_> {
    /// Flips an edge if fewer faces cross then; returns whether it did.
    fn flip_if_fewer(&mut self, mesh: &mut Manifold, h: u32) -> bool {
        if !mesh.connectivity.can_flip(h) || !mesh.flip_keeps_facing(h, FacingGuard::SOUND) {
            return false;
        }
        let g = mesh.connectivity.twin(h);
        let old = [h / 3, g / 3];
        let [a, b, top] = mesh.connectivity.triangle(h).map(|v| mesh.position(v));
        let bottom = mesh.position(mesh.connectivity.apex(g));
        let before = [[a, b, top], [b, a, bottom]];
        let after = [[top, a, bottom], [bottom, b, top]];
        let least = |faces: &[Corners]| faces.iter().map(|&t| mean_ratio(t)).fold(1.0, f64::min);
        let shaped = least(&after) >= least(&before).min(LEAST_MENDABLE);
        let crossing = if shaped { self.count(mesh, &before, &old, usize::MAX) } else { 0 };
        let helps = crossing > 0 && self.count(mesh, &after, &old, crossing) < crossing;
        if helps {
            mesh.connectivity.flip(h);
            self.changed.extend(old);
        }
        helps
    }

    /// Moves `v` to the nearest places at which fewer faces cross, while there are any; returns whether there was one.
    fn move_if_fewer(&mut self, domain: &Domain, mesh: &mut Manifold, v: u32) -> bool {
        let old: Vec<u32> = mesh.connectivity.outgoing(v).map(|h| h / 3).collect();
        let before = self.count(mesh, &fan(mesh, v, mesh.position(v)), &old, usize::MAX);
        if before == 0 || !mesh.can_move(v, &VertexSet::EMPTY) {
            return false;
        }
        let mut now = before;
        let longest = longest_edge(mesh, v);
        for reach in REACHES {
            let mut best = (now, 0.0, *mesh.sample(v));
            for place in places(domain, mesh, v, reach * longest) {
                let fan = fan(mesh, v, place.position);
                let shape = fan.iter().map(|&t| mean_ratio(t)).fold(1.0, f64::min);
                let count = if acceptable(mesh, v, &place) { self.count(mesh, &fan, &old, best.0) } else { now };
                if count < best.0 || (count == best.0 && count < now && shape > best.1) {
                    best = (count, shape, place);
                }
            }
            if best.0 < now {
                now = best.0;
                mesh.place(v, best.2);
                self.changed.extend(&old);
            }
            if now == 0 {
                break;
            }
        }
        now < before
    }
}

/// Returns places around `v` at `distance`: on the surface, and a little above and below it; for a vertex on a curve, along
/// the curve.
fn places(domain: &Domain, mesh: &Manifold, v: u32, distance: f64) -> Vec<Sample> {
    let here = *mesh.sample(v);
    if let Some(along) = mesh.along(v) {
        return [along, -along].map(|way| mesh.place_after(domain, v, way * distance, &here)).to_vec();
    }
    let (x, y) = here.normal.any_orthonormal_pair();
    let around = (0..DIRECTIONS).map(|i| {
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * i as f64 / DIRECTIONS as f64);
        domain.project(here.position + distance * (cos * x + sin * y), here.normal, here.triangle)
    });
    let off = [0.3, -0.3].map(|side| Sample { position: here.position + side * distance * here.normal, ..here });
    around.chain(off.into_iter().filter(|there| is_near_surface(domain, mesh, v, there))).collect()
}
