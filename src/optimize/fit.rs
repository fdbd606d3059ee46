//! Moves the vertices to where the triangles, and not only their corners, lie best on the surface.
//!
//! Triangles whose corners are on a convex surface are inside of it everywhere else. So the vertices x are moved to
//! where this energy is least, in units of the squared spacing d²:
//!
//! ```text
//! Σ w (n · (p - q))²  +  μ d² E(x)
//! ```
//!
//! p are points of the triangles, six each, by a rule that is exact up to degree four: the square of the distance to a
//! surface that bends evenly. q is the point of the surface that is closest to p, n its normal, and E the energy of
//! shape and size that relaxation lowers, so that vertices slide where that fits better without spoiling the triangles.
//! Planes are found, vertices take a few Newton steps one after the other, and again.
//!
//! Least squares leave single places, tips and ridges, far away. In the later rounds the weights w of points farther
//! than some multiples of the root of the mean square grow with the square of the distance, and vertices of the input
//! that are as far join them, each with the direction to its closest point on the triangles in the place of n.
//!
//! Based on: H. Hoppe, T. DeRose, T. Duchamp, J. McDonald, W. Stuetzle, Mesh optimization, 1993,
//! DOI 10.1145/166117.166119 (distance and a spring); Y. Chen, G. Medioni, Object modelling by registration of multiple
//! range images, 1992, DOI 10.1016/0262-8856(92)90066-C (distance to planes); D. A. Dunavant, High degree efficient
//! symmetrical Gaussian quadrature rules for the triangle, 1985, DOI 10.1002/nme.1620210612; C. L. Lawson's weights, as
//! in J. R. Rice, K. H. Usow, The Lawson algorithm and extensions, 1968, DOI 10.1090/S0025-5718-1968-0227663-1.
//! Departures: the connectivity stays, and weights start anew in every round.
//!
//! No step takes a triangle out of the goal for angles and quality, or further out. A vertex that a slide around a sharp
//! bend has led away from all of the surface is taken back, whatever that does to its triangles. Vertices on the
//! boundary and on sharp edges stay.
//!
//! Cost: some ten microseconds a vertex, and a search for each vertex of the input.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::geom::symmetric::Symmetric;
use crate::geom::triangle::barycentric;
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::mesh::topology::NONE;
use crate::optimize::angles::{is_good_around, least_margin};
use crate::optimize::relax::pull;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use rayon::prelude::*;

/// Rounds of plain least squares, and those that are drawn to what is far.
const PLAIN_ROUNDS: usize = 1;
const DRAWN_ROUNDS: usize = 2;

/// Further rounds where the distance has a limit.
const LIMITED_ROUNDS: usize = 4;

/// Rounds for a part of a mesh.
const PART_ROUNDS: usize = 2;

/// Share of the limit from which on points weigh more.
const OF_LIMIT: f64 = 0.7;

/// Steps of every vertex in a round.
const SWEEPS: usize = 3;

/// μ: more makes triangles better and leaves them farther from the surface. RMS in percent of the diagonal and mean Q of
/// a koala of 13,000 vertices, right after the fit: 0.0104 and 0.972 with 0.02, 0.0112 and 0.973 with 0.05, 0.0118 and
/// 0.9735 with 0.2; 0.0212 and 0.973 before. The value is between the last two.
const SHAPE_WEIGHT: f64 = 0.12;

/// Submesh of the planes' own stiffness that is added along the normal: a place that they do not hold stays.
const STIFFNESS: f64 = 0.01;

/// Longest step in spacings.
const LONGEST_STEP: f64 = 0.2;

/// Shortest step in spacings: a tenth of the distance that is left in the end.
const SHORTEST_STEP: f64 = 0.001;

/// How far from the surface a vertex may be, in spacings or lengths of its shortest edge, whichever is less.
const FARTHEST: f64 = 0.15;

/// How far from the surface, in spacings, a walk over it is believed to have found the closest point.
const REACH: f64 = 0.3;

/// How often a step that would spoil a triangle is halved before the vertex stays.
const HALVINGS: usize = 3;

/// Least cosine between a triangle and the surface after a step.
const LEAST_FACING: f64 = 0.3;

/// Vertices that one task moves, or triangles or points that it looks at.
const CHUNK: usize = 64;

/// Distance, in roots of the mean square, from which on points weigh more, and the share of it from which on vertices of
/// the input are watched.
const FAR: f64 = 5.5;
const WATCHED: f64 = 0.55;

/// Distance, in spacings, beyond which surfaces have nothing to do with each other.
pub(super) const BEYOND: f64 = 2.0;

/// How much more a point weighs for each mean square farther. With six times as much the root of the mean square rose
/// by a tenth, and ridges were overshot.
const GAIN: f64 = 0.05;

/// Weight of a vertex of the input, where a triangle's own points weigh one together.
const WEIGHT_OF_VERTEX: f64 = 0.1;

/// Barycentric coordinates and weights of the points of a triangle.
pub(super) const POINTS: [([f64; 3], f64); 6] = {
    const A: (f64, f64, f64) = (0.108_103_018_168_070, 0.445_948_490_915_965, 0.223_381_589_678_011);
    const B: (f64, f64, f64) = (0.816_847_572_980_459, 0.091_576_213_509_771, 0.109_951_743_655_322);
    [
        ([A.0, A.1, A.1], A.2),
        ([A.1, A.0, A.1], A.2),
        ([A.1, A.1, A.0], A.2),
        ([B.0, B.1, B.1], B.2),
        ([B.1, B.0, B.1], B.2),
        ([B.1, B.1, B.0], B.2),
    ]
};

/// How far the surface is from a mesh that was fitted to it.
pub struct Fitted {
    /// The mean of the squared distances.
    pub mean_square: f64,
    /// The vertices of the surface that are farther from the mesh than others, or were before the last steps.
    pub vertices: Vec<u32>,
    /// The numbers of the triangles of the mesh that are farther from the surface than others.
    pub triangles: Vec<u32>,
}

/// Moves the vertices to where the triangles fit the surface. `spacing` is the mean edge length; what is farther from
/// the other surface than `limit`, an absolute length, is drawn in as far as it can be.
pub fn fit(
    domain: &Domain,
    mesh: &mut Manifold,
    spacing: f64,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Fitted> {
    let mut watched: Vec<u32> = (0..domain.mesh.positions.len() as u32).collect();
    let longest = mesh.edges().map(|h| mesh.length_squared(h)).fold(0.0, f64::max).sqrt();
    // Where the topology takes more vertices than were asked for, no edge is as long as the spacing.
    let spacing = spacing.min(longest);
    let mut targets = Targets::new(mesh);
    let drawn_rounds = DRAWN_ROUNDS + limit.map_or(0, |_| LIMITED_ROUNDS);
    let mut mean_square = 0.0;
    for round in 0..PLAIN_ROUNDS + drawn_rounds {
        check(monitor)?;
        targets.find(domain, mesh, spacing);
        if round >= PLAIN_ROUNDS {
            mean_square = targets.mean_square(mesh);
            let scale = Scale::new(mean_square, limit);
            watched = targets.draw(domain, mesh, &scale, spacing, &watched);
        }
        targets.pull(mesh, spacing);
    }
    take_back(domain, mesh, spacing);
    let triangles = targets.triangles_beyond(mesh, Scale::new(mean_square, limit).watched());
    Ok(Fitted { mean_square, vertices: watched, triangles })
}

/// Fits a part of a mesh to a part of the surface, whose vertices are `watched`, where the mean square of the distances
/// of the whole is known.
pub(super) fn fit_part(domain: &Domain, mesh: &mut Manifold, spacing: f64, mean_square: f64, watched: &[u32]) {
    let mut targets = Targets::new(mesh);
    let scale = Scale::new(mean_square, None);
    for _ in 0..PART_ROUNDS {
        targets.find(domain, mesh, spacing);
        targets.draw(domain, mesh, &scale, spacing, watched);
        targets.pull(mesh, spacing);
    }
    take_back(domain, mesh, spacing);
}

/// What is far.
struct Scale {
    mean_square: f64,
    /// The squared distance from which on points weigh more.
    far: f64,
}

impl Scale {
    fn new(mean_square: f64, limit: Option<f64>) -> Scale {
        let limit = limit.map_or(f64::INFINITY, |limit| OF_LIMIT * limit);
        Scale { mean_square, far: (FAR * FAR * mean_square).min(limit * limit) }
    }

    /// The squared distance from which on vertices of the input are watched.
    fn watched(&self) -> f64 {
        WATCHED * WATCHED * self.far
    }

    /// The factor of the weight of a point at this distance: zero for those that are not far.
    fn excess(&self, distance: f64) -> f64 {
        GAIN * ((distance * distance - self.far) / self.mean_square).max(0.0)
    }
}

/// A plane that a point of a triangle is drawn to.
#[derive(Debug, Clone, Copy)]
struct Target {
    /// Barycentric coordinates of the point.
    at: [f64; 3],
    /// Unit normal of the plane, and the distance along it from the origin.
    normal: DVec3,
    offset: f64,
    weight: f64,
    /// The triangle of the domain where the surface was closest.
    foot: u32,
}

impl Target {
    const NONE: Target = Target { at: [0.0; 3], normal: DVec3::ZERO, offset: 0.0, weight: 0.0, foot: NONE };

    /// How far the point is from the plane if the corners are at `x`.
    #[inline]
    fn residual(&self, x: [DVec3; 3]) -> f64 {
        self.normal.dot(point(x, self.at)) - self.offset
    }
}

#[inline]
pub(super) fn point(x: [DVec3; 3], at: [f64; 3]) -> DVec3 {
    at[0] * x[0] + at[1] * x[1] + at[2] * x[2]
}

/// What draws the triangles of a mesh.
struct Targets {
    /// For each triangle number those of its own points.
    own: Vec<[Target; POINTS.len()]>,
    /// Those of far vertices of the input, each with its triangle, by increasing triangles.
    far: Vec<(u32, Target)>,
    /// For each vertex the closest point of the surface.
    feet: Vec<DVec3>,
}

impl Targets {
    fn new(mesh: &Manifold) -> Targets {
        let count = mesh.connectivity.half_edge_bound() as usize / 3;
        Targets { own: vec![[Target::NONE; POINTS.len()]; count], far: Vec::new(), feet: Vec::new() }
    }

    /// Those of triangle `t`.
    fn of(&self, t: u32) -> impl Iterator<Item = &Target> {
        let first = self.far.partition_point(|f| f.0 < t);
        let far = self.far[first..].iter().take_while(move |f| f.0 == t);
        self.own[t as usize].iter().chain(far.map(|f| &f.1))
    }

    /// Looks for the planes anew, from where they were.
    fn find(&mut self, domain: &Domain, mesh: &mut Manifold, spacing: f64) {
        self.feet = settle_vertices(domain, mesh, spacing);
        let triangles = self.own.par_iter_mut().enumerate().with_min_len(CHUNK).map(|(t, own)| (t as u32, own));
        let there = triangles.filter(|(t, _)| mesh.connectivity.has_half_edge(3 * t));
        there.for_each(|(t, own)| find_planes(domain, mesh, t, own, REACH * spacing));
    }

    /// Gives weight to what is far, of the triangles and of the vertices `watched`; those of them that may be so again.
    fn draw(&mut self, domain: &Domain, mesh: &Manifold, scale: &Scale, spacing: f64, watched: &[u32]) -> Vec<u32> {
        let beyond = BEYOND * spacing;
        let mut far = vertices_beyond(scale.watched()..beyond * beyond, domain, mesh, watched);
        let watched = far.iter().map(|f| f.0).collect();
        far.retain(|Far(_, t, target)| target.residual(corners(mesh, *t)).abs() < spacing);
        self.weigh(mesh, scale, far);
        watched
    }

    /// Moves all vertices some steps.
    fn pull(&self, mesh: &mut Manifold, spacing: f64) {
        let classes = mesh.colour_classes();
        for _ in 0..SWEEPS {
            classes.iter().for_each(|class| move_all(mesh, class, |mesh, v| step(mesh, self, v, spacing)));
        }
    }

    /// The mean of the squared distances of the triangles' own points to their planes.
    fn mean_square(&self, mesh: &Manifold) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for (own, t) in self.own.iter().zip(0..).filter(|(own, _)| own[0].weight > 0.0) {
            let x = corners(mesh, t);
            sum += own.iter().map(|target| target.weight * math::square(target.residual(x))).sum::<f64>();
            weight += own.iter().map(|target| target.weight).sum::<f64>();
        }
        sum / weight
    }

    /// The triangles with a point whose squared distance to its plane is above `square`.
    fn triangles_beyond(&self, mesh: &Manifold, square: f64) -> Vec<u32> {
        let is_beyond = |own: &[Target], t: u32| {
            let x = corners(mesh, t);
            own.iter().any(|target| math::square(target.residual(x)) > square)
        };
        let there = self.own.iter().zip(0..).filter(|(own, _)| own[0].weight > 0.0);
        there.filter(|(own, t)| is_beyond(*own, *t)).map(|(_, t)| t).collect()
    }

    /// Gives weight to what is far: to points of triangles, and to the vertices of the input in `far`.
    fn weigh(&mut self, mesh: &Manifold, scale: &Scale, far: Vec<Far>) {
        for (own, t) in self.own.iter_mut().zip(0..).filter(|(own, _)| own[0].weight > 0.0) {
            let x = corners(mesh, t);
            own.iter_mut().for_each(|target| target.weight *= 1.0 + scale.excess(target.residual(x)));
        }
        self.far.clear();
        for Far(_, t, target) in far {
            let weight = WEIGHT_OF_VERTEX * scale.excess(target.residual(corners(mesh, t)));
            if weight > 0.0 {
                self.far.push((t, Target { weight, ..target }));
            }
        }
        self.far.sort_by_key(|f| f.0);
    }
}

/// Gives the vertices that move the normals of where they are. For each, the closest point of the surface.
fn settle_vertices(domain: &Domain, mesh: &mut Manifold, spacing: f64) -> Vec<DVec3> {
    let settle = |v: usize| {
        let here = mesh.samples[v];
        let moves = mesh.connectivity.has_vertex(v as u32) && mesh.connectivity.curve_at(v as u32) == NONE;
        let foot = if moves { domain.settle(&here, REACH * spacing) } else { here };
        (Sample { position: here.position, ..foot }, foot.position)
    };
    let (samples, feet) = (0..mesh.samples.len()).into_par_iter().with_min_len(CHUNK).map(settle).unzip();
    mesh.samples = samples;
    feet
}

/// Takes vertices that have slid away from the surface back to near it.
fn take_back(domain: &Domain, mesh: &mut Manifold, spacing: f64) {
    let feet = settle_vertices(domain, mesh, spacing);
    let back = |(v, foot): (u32, DVec3)| {
        let here = &mesh.samples[v as usize];
        let (p, size) = (here.position, here.size);
        let far = |q: DVec3, most: f64| p.distance_squared(q) > most * most;
        if !far(foot, 0.0) {
            return p;
        }
        let farthest = FARTHEST * shortest_edge(mesh, v).min(spacing * size);
        // At the end of a fin the surface may be near, and only face another way.
        let away = far(foot, farthest) && far(domain.project_anywhere(p).position, farthest);
        if away { foot + (p - foot).clamp_length_max(farthest) } else { p }
    };
    let places: Vec<DVec3> =
        (0..).zip(feet).collect::<Vec<_>>().into_par_iter().with_min_len(CHUNK).map(back).collect();
    mesh.samples.iter_mut().zip(places).for_each(|(sample, p)| sample.position = p);
}

/// The length of the shortest edge at `v`; infinite where it has none.
fn shortest_edge(mesh: &Manifold, v: u32) -> f64 {
    let c = &mesh.connectivity;
    let squares = c.has_vertex(v).then(|| c.outgoing(v)).into_iter().flatten().map(|h| mesh.length_squared(h));
    squares.fold(f64::INFINITY, f64::min).sqrt()
}

#[inline]
fn corners(mesh: &Manifold, t: u32) -> [DVec3; 3] {
    mesh.connectivity.triangle(3 * t).map(|v| mesh.position(v))
}

/// The planes of the points of triangle `t`; none if all its corners stay where they are.
fn find_planes(domain: &Domain, mesh: &Manifold, t: u32, own: &mut [Target; POINTS.len()], reach: f64) {
    let numbers = mesh.connectivity.triangle(3 * t);
    // A corner on no curve knows the patch.
    let Some(v) = numbers.into_iter().find(|&v| mesh.connectivity.curve_at(v) == NONE) else {
        return;
    };
    let x = corners(mesh, t);
    let normal = (x[1] - x[0]).cross(x[2] - x[0]);
    let mut triangle = mesh.samples[v as usize].triangle;
    for (target, (at, weight)) in own.iter_mut().zip(POINTS) {
        if target.foot != NONE {
            triangle = target.foot;
        }
        let foot = domain.settle(&Sample { position: point(x, at), normal, triangle, size: 1.0 }, reach);
        triangle = foot.triangle;
        *target = Target { at, normal: foot.normal, offset: foot.normal.dot(foot.position), weight, foot: triangle };
    }
}

/// A vertex of the domain that is far from the triangles, the triangle that is closest to it, and the plane that
/// triangle is drawn to.
struct Far(u32, u32, Target);

/// Those of `vertices` whose squared distance to the triangles that face their way is in `range`, in their order.
fn vertices_beyond(range: std::ops::Range<f64>, domain: &Domain, mesh: &Manifold, vertices: &[u32]) -> Vec<Far> {
    let faces = Faces::new(mesh);
    let far = |&v: &u32| {
        let p = domain.mesh.positions[v as usize];
        let hit = faces.closest_facing(p, domain.vertex_normal(v), range.clone())?;
        if hit.distance_squared < range.start {
            return None;
        }
        let at = barycentric(hit.point, faces.corners(hit.triangle)?);
        let way = (p - hit.point).normalize_or_zero();
        let target = Target { at, normal: way, offset: way.dot(p), ..Target::NONE };
        Some(Far(v, hit.triangle, target))
    };
    vertices.par_iter().with_min_len(CHUNK).filter_map(far).collect()
}

/// Moves vertices, no two of them adjacent, each to its `place`.
fn move_all(mesh: &mut Manifold, vertices: &[u32], place: impl Fn(&Manifold, u32) -> Sample + Sync) {
    let moved: Vec<Sample> = vertices.par_iter().with_min_len(CHUNK).map(|&v| place(mesh, v)).collect();
    for (&v, sample) in vertices.iter().zip(moved) {
        mesh.samples[v as usize] = sample;
    }
}

/// Where `v` comes to by a step that spoils no triangle.
fn step(mesh: &Manifold, targets: &Targets, v: u32, spacing: f64) -> Sample {
    let here = mesh.samples[v as usize];
    if mesh.connectivity.curve_at(v) != NONE {
        return here;
    }
    let way = newton_step(mesh, targets, v, spacing);
    let spacing = spacing * here.size;
    let mut way = way.clamp_length_max(LONGEST_STEP * spacing);
    let height = here.normal.dot(here.position + way - targets.feet[v as usize]);
    let farthest = FARTHEST * shortest_edge(mesh, v).min(spacing);
    way += (height.clamp(-farthest, farthest) - height) * here.normal;
    if way.length() <= SHORTEST_STEP * spacing || !way.is_finite() {
        return here;
    }
    for _ in 0..HALVINGS {
        let there = Sample { position: here.position + way, ..here };
        if mesh.faces_surface(v, &there, LEAST_FACING) && keeps_shape(mesh, v, there.position) {
            return there;
        }
        way *= 0.5;
    }
    here
}

/// The step of `v` to where the energy is least while its neighbours stay.
fn newton_step(mesh: &Manifold, targets: &Targets, v: u32, spacing: f64) -> DVec3 {
    let (mut hessian, mut gradient) = (Symmetric::default(), DVec3::ZERO);
    for h in mesh.connectivity.outgoing(v) {
        let (t, k) = (h / 3, h as usize % 3);
        let x = corners(mesh, t);
        for target in targets.of(t) {
            let slope = target.weight * target.at[k];
            gradient += slope * target.residual(x) * target.normal;
            hessian += Symmetric::outer(target.normal) * (slope * target.at[k]);
        }
    }
    let normal = mesh.samples[v as usize].normal;
    let (shape, stiffness) = pull(mesh, v, spacing);
    let scale = SHAPE_WEIGHT * math::square(spacing * mesh.samples[v as usize].size);
    gradient += scale * shape.reject_from_normalized(normal);
    let along_normal = STIFFNESS * hessian.diagonal.element_sum() - scale * stiffness;
    hessian += Symmetric::outer(normal) * along_normal;
    hessian.diagonal += scale * stiffness;
    -(hessian.matrix().inverse() * gradient)
}

/// Whether the triangles at `v` are within the goal, or no further outside, with `v` at `p`.
fn keeps_shape(mesh: &Manifold, v: u32, p: DVec3) -> bool {
    is_good_around(mesh, v, p) || least_margin(mesh, v, p) >= least_margin(mesh, v, mesh.position(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use std::collections::BTreeMap;

    /// An icosahedron whose faces are split in four `levels` times, blown up to a unit ball.
    fn ball(levels: u32) -> Mesh {
        let g = 0.5 + 1.25f64.sqrt();
        let rectangle = [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)];
        let corners = rectangle.map(|(a, b)| [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
        let mut positions: Vec<DVec3> = corners.into_iter().flatten().map(DVec3::normalize).collect();
        let near = |a: usize, b: usize| positions[a].distance(positions[b]) < 1.1;
        let triples = (0..12).flat_map(|a| (0..12).flat_map(move |b| (0..12).map(move |c| [a, b, c])));
        let outside = |[a, b, c]: [usize; 3]| positions[a].cross(positions[b]).dot(positions[c]) > 0.0;
        let faces = triples.filter(|&t| t[0] < t[1] && t[0] < t[2] && outside(t));
        let faces = faces.filter(|&[a, b, c]| near(a, b) && near(b, c) && near(c, a));
        let mut triangles: Vec<[u32; 3]> = faces.map(|t| t.map(|v| v as u32)).collect();
        for _ in 0..levels {
            let mut middles = BTreeMap::new();
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    positions.push((positions[a as usize] + positions[b as usize]).normalize());
                    positions.len() as u32 - 1
                })
            };
            let split = |[a, b, c]: [u32; 3]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            };
            triangles = triangles.into_iter().flat_map(split).collect();
        }
        Mesh { positions, triangles }
    }

    /// A sheet of `n` by `n` squares, each two triangles, with a bump.
    fn bump(n: u32) -> Mesh {
        let place = |i: u32| f64::from(i) / f64::from(n);
        let height = |x: f64, y: f64| 0.3 * (-20.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2))).exp();
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let corners = (0..=n).flat_map(|i| (0..=n).map(move |j| (place(i), place(j))));
        Mesh {
            positions: corners.map(|(x, y)| DVec3::new(x, y, height(x, y))).collect(),
            triangles: squares
                .flat_map(|(i, j)| {
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    [[a, b, c], [a, c, d]]
                })
                .collect(),
        }
    }

    /// A manifold whose vertices are those of `mesh`, put on the domain.
    fn on(domain: &Domain, mesh: &Mesh) -> Manifold {
        let samples = mesh.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut manifold = Manifold::new(samples, &mesh.triangles);
        manifold.lock_boundary();
        manifold
    }

    /// Root of the mean squared distance of points of the triangles to the domain.
    fn rms(domain: &Domain, mesh: &Manifold) -> f64 {
        let squares = mesh.half_edges().filter(|h| h % 3 == 0).flat_map(|h| {
            let x = corners(mesh, h / 3);
            POINTS.map(|(at, weight)| {
                weight * domain.project_anywhere(point(x, at)).position.distance_squared(point(x, at))
            })
        });
        (squares.sum::<f64>() / (mesh.connectivity.half_edge_bound() / 3) as f64).sqrt()
    }

    fn volume(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.cross(b).dot(c) / 6.0).sum()
    }

    fn margins(mesh: &Manifold) -> Vec<f64> {
        (0..mesh.connectivity.vertex_bound()).map(|v| least_margin(mesh, v, mesh.position(v))).collect()
    }

    #[test]
    fn a_ball_is_fitted_with_half_the_error_and_its_volume() {
        let fine = ball(5);
        let domain = Domain::new(fine.clone());
        let mut mesh = on(&domain, &ball(2));
        let (before, lost) = (rms(&domain, &mesh), volume(&fine) - volume(&mesh.to_mesh()));
        fit(&domain, &mut mesh, 0.31, None, &()).unwrap();
        let (after, left) = (rms(&domain, &mesh), volume(&fine) - volume(&mesh.to_mesh()));
        assert!(after < 0.5 * before, "{before} {after}");
        assert!(left.abs() < 0.1 * lost, "{lost} {left}");
    }

    #[test]
    fn no_triangle_leaves_the_goal_and_the_boundary_stays() {
        let domain = Domain::new(bump(60));
        let mut mesh = on(&domain, &bump(10));
        let start = mesh.clone();
        fit(&domain, &mut mesh, 0.11, None, &()).unwrap();
        assert!(rms(&domain, &mesh) < 0.8 * rms(&domain, &start));
        let worst = |mesh: &Manifold| margins(mesh).into_iter().fold(0.0, f64::min);
        assert!(worst(&mesh) >= worst(&start));
        let c = &mesh.connectivity;
        let (held, free): (Vec<u32>, Vec<u32>) = (0..c.vertex_bound()).partition(|&v| c.is_boundary(v));
        assert!(held.iter().all(|&v| mesh.position(v) == start.position(v)));
        assert!(free.iter().filter(|&&v| mesh.position(v) != start.position(v)).count() > free.len() / 2);
    }

    #[test]
    fn the_same_bits_with_any_number_of_threads() {
        let domain = Domain::new(ball(4));
        let start = on(&domain, &ball(2));
        let with = |threads| {
            let mut mesh = start.clone();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| fit(&domain, &mut mesh, 0.31, Some(0.02), &())).unwrap();
            mesh.samples
        };
        assert!(with(1) == with(8));
    }
}
