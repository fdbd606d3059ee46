//! Parts faces that cross each other, at the places where they do.
//!
//! Two kinds of places make faces cross: sheets that are nearer to each other than a face is to the surface that it
//! stands for, and folds at narrow rims, where a face or two lie wrong. So there are two means, in turns.
//!
//! - Sheets part: the corners of faces that cross those of another sheet step away from that sheet along the normal,
//!   outwards where there is a wall between the sheets and inwards where there is a gap, by shares of the distance
//!   between face and surface. All step at once, since at a thin shell every face is in the way of many.
//! - Single edges flip and single vertices move to where fewer faces cross; of several such places to the one with the
//!   best triangles.
//!
//! A turn that leaves as many crossings as there were is taken back, and is the last. Places where the input crosses
//! itself are left alone: there the sheets are where they should be. What crosses in the end is for the report to tell.
//!
//! Cost: one search for crossings where there are none. Else one for each step of the sheets, and some ten searches
//! among its surroundings for each corner of a crossing face.
//!
//! Limits: vertices that step away from the surface stay off it, by at most `FARTHEST`. A place whose samples cannot be
//! joined without a crossing keeps it: splitting the edges there made more faces cross, not fewer.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::geom::intersection::cross;
use crate::geom::triangle::{longest_side, mean_ratio};
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::mesh::half_edge::{next, prev};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::spatial::self_intersections::{faces_of, self_intersections};
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Turns of both means; most places need one or two.
const TURNS: usize = 6;

/// Steps of the sheets in a turn, and the share of the distance between face and surface that each makes: in the end
/// the face is clear of the surface.
const STEPS: usize = 6;
const STEP: f64 = 0.35;

/// Distance around a face, in lengths of its longest edge, in which crossings of the input are looked for: one, and what
/// those that cross there reach.
const SURROUNDINGS: f64 = 3.0;

/// How far a vertex may step away from its place on the surface, in lengths of its longest edge.
const FARTHEST: f64 = 0.14;

/// Distances, in lengths of the longest edge there, at which a vertex looks for a better place.
const REACHES: [f64; 4] = [0.06, 0.12, 0.25, 0.5];

/// Directions in which it looks.
const DIRECTIONS: usize = 8;

/// Least cosine between a triangle and the surface, and least mean ratio, after a change, unless they were worse before.
const LEAST_FACING: f64 = 0.2;
const LEAST_SHAPE: f64 = 0.25;

/// Faces that are mended one by one in a turn: where more cross, only parting sheets can help, if anything.
const MOST_MENDED: usize = 150;

/// Where more cross than that, a turn that leaves so large a share of the crossings is the last.
const LEAST_PROGRESS: f64 = 0.8;

/// Moves vertices and flips edges until no faces cross that need not, or nothing helps.
pub fn resolve_self_intersections(domain: &Domain, mesh: &mut Manifold, monitor: &dyn Monitor) -> Result<()> {
    if Crossings::new(mesh).pairs.is_empty() {
        return Ok(());
    }
    take_turns(domain, mesh, monitor)
}

/// The faces of a mesh at one time, and the pairs of them that cross.
struct Crossings {
    faces: Faces,
    pairs: Vec<(u32, u32)>,
}

impl Crossings {
    /// All pairs.
    fn new(mesh: &Manifold) -> Crossings {
        let faces = Faces::new(mesh);
        Crossings { pairs: faces.self_intersecting_pairs(), faces }
    }

    /// The pairs that need not cross.
    fn avoidable(domain: &Domain, mesh: &Manifold) -> Crossings {
        let mut crossings = Crossings::new(mesh);
        let crossing = faces_of(crossings.pairs.clone());
        let triangles: Vec<Corners> = crossing.iter().map(|&t| corners(mesh, 3 * t)).collect();
        let inherited = Inherited::around(domain, &triangles);
        let need_not = triangles.iter().map(|&t| !inherited.is_near(t));
        let need_not: BTreeMap<u32, bool> = crossing.into_iter().zip(need_not).collect();
        crossings.pairs.retain(|(t, u)| need_not[t] || need_not[u]);
        crossings
    }
}

/// The triangles of the input that cross each other.
struct Inherited {
    mesh: Mesh,
    bvh: Bvh,
}

impl Inherited {
    /// Those around `triangles`.
    fn around(domain: &Domain, triangles: &[Corners]) -> Inherited {
        let reach = |t: &Corners| SURROUNDINGS * longest_side(*t);
        let mut near: Vec<u32> = triangles.iter().flat_map(|t| domain.triangles_near(middle(*t), reach(t))).collect();
        near.sort_unstable();
        near.dedup();
        let near = Mesh::soup(near.into_iter().map(|t| domain.mesh.corners(t as usize)));
        let mesh = Mesh::soup(self_intersections(&near).into_iter().map(|t| near.corners(t as usize)));
        Inherited { bvh: Bvh::new(&mesh), mesh }
    }

    /// Whether some of them are within a triangle's length of it.
    fn is_near(&self, triangle: Corners) -> bool {
        let length = longest_side(triangle);
        !self.mesh.triangles.is_empty()
            && self.bvh.closest_where(&self.mesh, middle(triangle), length * length, |_| true).is_some()
    }
}

fn middle(triangle: Corners) -> DVec3 {
    triangle.iter().sum::<DVec3>() / 3.0
}

/// Parts sheets and mends faces in turns; no turn leaves more pairs that cross.
fn take_turns(domain: &Domain, mesh: &mut Manifold, monitor: &dyn Monitor) -> Result<()> {
    let mut crossings = Crossings::avoidable(domain, mesh);
    for _ in 0..TURNS {
        if crossings.pairs.is_empty() {
            break;
        }
        check(monitor)?;
        let (before, left) = (mesh.clone(), crossings.pairs.len());
        crossings = part_sheets(domain, mesh, crossings);
        mend_faces(domain, mesh, crossings);
        crossings = Crossings::avoidable(domain, mesh);
        if crossings.pairs.len() >= left {
            *mesh = before;
            break;
        }
        if crossings.pairs.len() > MOST_MENDED.max((LEAST_PROGRESS * left as f64) as usize) {
            break;
        }
    }
    Ok(())
}

/// Moves the sheets that cross apart, step by step, and keeps the step with the fewest crossings; those that are left.
fn part_sheets(domain: &Domain, mesh: &mut Manifold, crossings: Crossings) -> Crossings {
    let mut pairs = crossings.pairs.clone();
    let mut best = (crossings, mesh.samples.clone());
    for _ in 0..STEPS {
        let ways = ways_apart(domain, mesh, &pairs);
        let moved = ways.into_iter().filter(|&(v, way)| step_off(domain, mesh, v, way)).count();
        if moved == 0 {
            break;
        }
        let crossings = Crossings::avoidable(domain, mesh);
        pairs.clone_from(&crossings.pairs);
        if pairs.len() < best.0.pairs.len() {
            best = (crossings, mesh.samples.clone());
        }
    }
    mesh.samples = best.1;
    best.0
}

/// For each corner of the faces that cross the longest step away from a sheet in its way.
fn ways_apart(domain: &Domain, mesh: &Manifold, pairs: &[(u32, u32)]) -> BTreeMap<u32, DVec3> {
    let mut ways: BTreeMap<u32, DVec3> = BTreeMap::new();
    for &(t, u) in pairs {
        let step = STEP * height(domain, mesh, t).max(height(domain, mesh, u));
        for (face, other) in [(t, u), (u, t)] {
            for v in mesh.connectivity.triangle(3 * face) {
                let way = step * away_from(domain, mesh, v, other);
                let longest = ways.entry(v).or_default();
                if way.length_squared() > longest.length_squared() {
                    *longest = way;
                }
            }
        }
    }
    ways
}

/// How far the middle of a face is from the surface that it stands for.
fn height(domain: &Domain, mesh: &Manifold, face: u32) -> f64 {
    let corners = mesh.connectivity.triangle(3 * face).map(|v| &mesh.samples[v as usize]);
    let middle = corners.iter().map(|s| s.position).sum::<DVec3>() / 3.0;
    let normal = corners.iter().map(|s| s.normal).sum();
    domain.project(middle, normal, on_patch(corners).triangle).position.distance(middle)
}

/// The direction, along the normal at `v`, away from the sheet of the surface that face `other` stands for; zero if `v`
/// is on it.
fn away_from(domain: &Domain, mesh: &Manifold, v: u32, other: u32) -> DVec3 {
    let corners = mesh.connectivity.triangle(3 * other);
    if corners.contains(&v) {
        return DVec3::ZERO;
    }
    let here = &mesh.samples[v as usize];
    let place = domain.project(here.position, here.normal, here.triangle).position;
    let corners = corners.map(|w| &mesh.samples[w as usize]);
    let normal = corners.iter().map(|s| s.normal).sum();
    let there = domain.project(place, normal, on_patch(corners).triangle).position;
    let ahead = (there - place).dot(here.normal);
    if ahead == 0.0 { DVec3::ZERO } else { -ahead.signum() * here.normal }
}

/// Of the corners of a face one that is not on a sharp edge, if there is one: it knows the patch.
fn on_patch(corners: [&Sample; 3]) -> &Sample {
    corners.into_iter().find(|s| s.normal != DVec3::ZERO).unwrap_or(corners[0])
}

/// Moves `v`, without putting it back on the surface, unless it would be too far away or turn a triangle over.
fn step_off(domain: &Domain, mesh: &mut Manifold, v: u32, way: DVec3) -> bool {
    let here = mesh.samples[v as usize];
    let there = Sample { position: here.position + way, ..here };
    let may = way != DVec3::ZERO
        && !mesh.connectivity.is_on_interface(v)
        && is_near_surface(domain, mesh, v, &there)
        && mesh.worst_facing(v, &there) >= mesh.worst_facing(v, &here).min(LEAST_FACING);
    if may {
        mesh.samples[v as usize] = there;
    }
    may
}

/// Whether `there` is a place for `v` that is not too far from the surface.
fn is_near_surface(domain: &Domain, mesh: &Manifold, v: u32, there: &Sample) -> bool {
    let own = domain.project(there.position, there.normal, there.triangle).position;
    own.distance(there.position) <= FARTHEST * longest_edge(mesh, v)
}

fn longest_edge(mesh: &Manifold, v: u32) -> f64 {
    let here = mesh.position(v);
    mesh.connectivity.ring(v).map(|w| mesh.position(w).distance(here)).fold(0.0, f64::max)
}

/// Flips edges and moves vertices of faces that cross, one by one, where that leaves fewer crossings.
fn mend_faces(domain: &Domain, mesh: &mut Manifold, Crossings { faces, pairs }: Crossings) {
    let crossing: BTreeSet<u32> = pairs.iter().flat_map(|&(t, u)| [t, u]).collect();
    let mut around = Surroundings { faces, changed: BTreeSet::new() };
    for face in crossing.into_iter().take(MOST_MENDED) {
        let h = 3 * face;
        for side in [h, next(h), prev(h)] {
            around.flip_if_fewer(mesh, side);
        }
        for v in mesh.connectivity.triangle(h) {
            around.move_if_fewer(domain, mesh, v);
        }
    }
}

/// What is around a place of a mesh that changes: its faces at one time, and those that have changed since.
struct Surroundings {
    faces: Faces,
    changed: BTreeSet<u32>,
}

type Corners = [DVec3; 3];

impl Surroundings {
    /// How many pairs of faces would cross, of those that `new` is in, if it were there in place of the faces `old`.
    fn count(&self, mesh: &Manifold, new: &[Corners], old: &[u32]) -> usize {
        let among: usize = (1..new.len()).map(|i| new[..i].iter().filter(|&&t| cross(t, new[i])).count()).sum();
        among + new.iter().map(|&t| self.count_of(mesh, t, old)).sum::<usize>()
    }

    /// How many faces, those of `old` left out, cross a triangle.
    fn count_of(&self, mesh: &Manifold, triangle: Corners, old: &[u32]) -> usize {
        let [a, b, c] = triangle;
        let mut count = 0;
        self.faces.in_box(a.min(b).min(c), a.max(b).max(c), |t, corners| {
            let stays = !old.contains(&t) && !self.changed.contains(&t);
            count += usize::from(stays && cross(triangle, corners));
        });
        let changed = self.changed.iter().filter(|t| !old.contains(t));
        count + changed.filter(|&&t| cross(triangle, corners(mesh, 3 * t))).count()
    }

    fn flip_if_fewer(&mut self, mesh: &mut Manifold, h: u32) {
        let g = mesh.connectivity.twin(h);
        if g == NONE || !mesh.connectivity.can_flip(h) || !mesh.flip_keeps_facing(h, LEAST_FACING) {
            return;
        }
        let old = [h / 3, g / 3];
        let ([a, b, top], bottom) = (corners(mesh, h), mesh.position(mesh.connectivity.apex(g)));
        let before = [[a, b, top], [b, a, bottom]];
        let after = [[top, a, bottom], [bottom, b, top]];
        let least = |faces: &[Corners]| faces.iter().map(|&t| mean_ratio(t)).fold(1.0, f64::min);
        let shaped = least(&after) >= least(&before).min(LEAST_SHAPE);
        if shaped && self.count(mesh, &after, &old) < self.count(mesh, &before, &old) {
            mesh.connectivity.flip(h);
            self.changed.extend(old);
        }
    }

    /// Moves `v` to the nearest places at which fewer faces cross, as long as there are such places.
    fn move_if_fewer(&mut self, domain: &Domain, mesh: &mut Manifold, v: u32) {
        let old: Vec<u32> = mesh.connectivity.outgoing(v).map(|h| h / 3).collect();
        let mut now = self.count(mesh, &fan(mesh, v, mesh.position(v)), &old);
        if now == 0 || mesh.is_locked(v) {
            return;
        }
        let longest = longest_edge(mesh, v);
        for reach in REACHES {
            let mut best = (now, 0.0, mesh.samples[v as usize]);
            for place in places(domain, mesh, v, reach * longest) {
                let fan = fan(mesh, v, place.position);
                let shape = fan.iter().map(|&t| mean_ratio(t)).fold(1.0, f64::min);
                let count = if acceptable(mesh, v, &place) { self.count(mesh, &fan, &old) } else { now };
                if count < best.0 || (count == best.0 && count < now && shape > best.1) {
                    best = (count, shape, place);
                }
            }
            if best.0 < now {
                now = best.0;
                mesh.samples[v as usize] = best.2;
                self.changed.extend(&old);
            }
            if now == 0 {
                break;
            }
        }
    }
}

/// The corners of the triangle of `h`, from its origin on.
fn corners(mesh: &Manifold, h: u32) -> Corners {
    mesh.connectivity.triangle(h).map(|v| mesh.position(v))
}

/// The triangles around `v` if it were at `there`.
fn fan(mesh: &Manifold, v: u32, there: DVec3) -> Vec<Corners> {
    let triangle = |h: u32| {
        let [_, p, q] = mesh.connectivity.triangle(h);
        [there, mesh.position(p), mesh.position(q)]
    };
    mesh.connectivity.outgoing(v).map(triangle).collect()
}

/// Whether the triangles around `v` are no worse, or good enough, with `v` at `there`.
fn acceptable(mesh: &Manifold, v: u32, there: &Sample) -> bool {
    let here = &mesh.samples[v as usize];
    let shape = |p: DVec3| fan(mesh, v, p).into_iter().map(mean_ratio).fold(1.0, f64::min);
    mesh.worst_facing(v, there) >= mesh.worst_facing(v, here).min(LEAST_FACING)
        && shape(there.position) >= shape(here.position).min(LEAST_SHAPE)
}

/// Places around `v` at a distance: on the surface, and a little above and below it; along the curve of a vertex on one.
fn places(domain: &Domain, mesh: &Manifold, v: u32, distance: f64) -> Vec<Sample> {
    let here = mesh.samples[v as usize];
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
