//! Points of triangles that are fitted to planes, each with a weight.
//!
//! The weights are initially those of the quadrature rule, and grow where the error is large.

use crate::base::math;
use crate::base::parallel;
use crate::geom::triangle::barycentric;
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::mesh::topology::NONE;
use crate::optimize::quadrature::{POINTS, point};
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use std::ops::Range;

/// Share of the limit above which an error is large.
const OF_LIMIT: f64 = 0.7;

/// Distance, in root mean squares, above which an error is large, and the share of it above which input vertices are
/// watched.
const LARGE: f64 = 5.5;
const WATCHED: f64 = 0.55;

/// Growth of the weight per mean square by which a squared distance exceeds the large one. With six times as much, the root
/// mean square rose by a tenth, and ridges were overshot.
const GAIN: f64 = 0.05;

/// Weight of an input vertex; the own points of a triangle together weigh one.
const WEIGHT_OF_VERTEX: f64 = 0.1;

/// Distance, in spacings, beyond which surfaces are unrelated.
pub(in crate::optimize) const BEYOND: f64 = 2.0;

/// Decides which errors are large.
pub(super) struct ErrorScale {
    mean_square: f64,
    /// Squared distance from which on an error is large.
    large: f64,
}

impl ErrorScale {
    pub(super) fn new(mean_square: f64, limit: Option<f64>) -> ErrorScale {
        let limit = limit.map_or(f64::INFINITY, |limit| OF_LIMIT * limit);
        ErrorScale { mean_square, large: (LARGE * LARGE * mean_square).min(limit * limit) }
    }

    /// Returns the squared distance above which input vertices are watched.
    pub(super) fn watched(&self) -> f64 {
        WATCHED * WATCHED * self.large
    }

    /// Returns the factor by which the weight of a point at this distance grows: zero if the distance is not large.
    fn excess(&self, distance: f64) -> f64 {
        GAIN * ((distance * distance - self.large) / self.mean_square).max(0.0)
    }
}

/// A point of a triangle and the plane that it is fitted to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    /// Barycentric coordinates of the point.
    pub at: [f64; 3],
    pub plane: Plane,
}

/// A plane that a point is fitted to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    /// Unit normal, and the distance along it from the origin.
    pub normal: DVec3,
    offset: f64,
    pub weight: f64,
    /// The triangle of the domain with the closest point.
    foot: u32,
}

impl Plane {
    const NONE: Plane = Plane { normal: DVec3::ZERO, offset: 0.0, weight: 0.0, foot: NONE };
}

impl Target {
    /// Returns the signed distance of the point from the plane if the corners are at `x`.
    #[inline]
    pub fn residual(&self, x: [DVec3; 3]) -> f64 {
        self.plane.normal.dot(point(x, self.at)) - self.plane.offset
    }
}

/// All targets of a mesh.
pub(super) struct Targets {
    /// For each triangle, the planes of its quadrature points.
    own: Vec<[Plane; POINTS.len()]>,
    /// Points closest to input vertices with large errors, each with its triangle, in increasing order of triangles.
    of_vertices: Vec<(u32, Target)>,
}

impl Targets {
    pub(super) fn new(mesh: &Manifold) -> Targets {
        let count = mesh.connectivity.half_edge_bound() as usize / 3;
        Targets { own: vec![[Plane::NONE; POINTS.len()]; count], of_vertices: Vec::new() }
    }

    /// Returns the targets of triangle `t`.
    pub(super) fn of(&self, t: u32) -> impl Iterator<Item = Target> {
        let first = self.of_vertices.partition_point(|other| other.0 < t);
        let others = self.of_vertices[first..].iter().take_while(move |other| other.0 == t);
        own_targets(&self.own[t as usize]).chain(others.map(|other| other.1))
    }

    /// Finds the planes anew by walks over the surface, which are trusted up to the distance `reach`.
    pub(super) fn find(&mut self, domain: &Domain, mesh: &Manifold, reach: f64) {
        parallel::for_each_mut(&mut self.own, |t, own| {
            if mesh.connectivity.has_half_edge(3 * t as u32) {
                find_planes(domain, mesh, t as u32, own, reach);
            }
        });
    }

    /// Gives more weight to large errors of the triangles and of the vertices in `watched`. Returns the vertices to be
    /// watched from now on.
    pub(super) fn reweight(
        &mut self,
        domain: &Domain,
        mesh: &Manifold,
        scale: &ErrorScale,
        spacing: f64,
        watched: &[u32],
    ) -> Vec<u32> {
        let beyond = BEYOND * spacing;
        let mut far = vertices_in_range(scale.watched()..beyond * beyond, domain, mesh, watched);
        let watched = far.iter().map(|far| far.vertex).collect();
        far.retain(|far| far.target.residual(mesh.corners(far.triangle)).abs() < spacing);
        self.reweight_triangles(mesh, scale);
        self.weigh_vertices(mesh, scale, far);
        watched
    }

    /// Returns the mean squared distance of the triangles' own points from their planes.
    pub(super) fn mean_square(&self, mesh: &Manifold) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for (own, t) in self.own.iter().zip(0..).filter(|(own, _)| own[0].weight > 0.0) {
            let x = mesh.corners(t);
            sum += own_targets(own).map(|target| target.plane.weight * math::square(target.residual(x))).sum::<f64>();
            weight += own.iter().map(|plane| plane.weight).sum::<f64>();
        }
        sum / weight
    }

    /// Returns the triangles with a point whose squared distance from its plane exceeds `square`.
    pub(super) fn triangles_beyond(&self, mesh: &Manifold, square: f64) -> Vec<u32> {
        let is_beyond = |own: &[Plane], t: u32| {
            let x = mesh.corners(t);
            own_targets(own).any(|target| math::square(target.residual(x)) > square)
        };
        let there = self.own.iter().zip(0..).filter(|(own, _)| own[0].weight > 0.0);
        there.filter(|(own, t)| is_beyond(*own, *t)).map(|(_, t)| t).collect()
    }

    fn reweight_triangles(&mut self, mesh: &Manifold, scale: &ErrorScale) {
        for (own, t) in self.own.iter_mut().zip(0..).filter(|(own, _)| own[0].weight > 0.0) {
            let x = mesh.corners(t);
            for (plane, (at, _)) in own.iter_mut().zip(POINTS) {
                plane.weight *= 1.0 + scale.excess(Target { at, plane: *plane }.residual(x));
            }
        }
    }

    fn weigh_vertices(&mut self, mesh: &Manifold, scale: &ErrorScale, far: Vec<FarVertex>) {
        self.of_vertices.clear();
        for FarVertex { triangle, target, .. } in far {
            let weight = WEIGHT_OF_VERTEX * scale.excess(target.residual(mesh.corners(triangle)));
            if weight > 0.0 {
                let plane = Plane { weight, ..target.plane };
                self.of_vertices.push((triangle, Target { plane, ..target }));
            }
        }
        self.of_vertices.sort_by_key(|target| target.0);
    }
}

/// Returns the quadrature points with these planes.
#[inline]
fn own_targets(planes: &[Plane]) -> impl Iterator<Item = Target> {
    planes.iter().zip(POINTS).map(|(&plane, (at, _))| Target { at, plane })
}

/// Finds the planes of the points of triangle `t`, unless all its corners are on feature curves, which stay.
fn find_planes(domain: &Domain, mesh: &Manifold, t: u32, own: &mut [Plane; POINTS.len()], reach: f64) {
    let numbers = mesh.connectivity.triangle(3 * t);
    // A corner that is on no curve tells which patch the triangle is on.
    let Some(v) = numbers.into_iter().find(|&v| !mesh.connectivity.is_on_curve(v)) else {
        return;
    };
    let x = mesh.corners(t);
    let normal = (x[1] - x[0]).cross(x[2] - x[0]);
    let mut triangle = mesh.sample(v).triangle;
    for (plane, (at, weight)) in own.iter_mut().zip(POINTS) {
        if plane.foot != NONE {
            triangle = plane.foot;
        }
        let foot = domain.project_by_walk(&Sample { position: point(x, at), normal, triangle, size: 1.0 }, reach);
        triangle = foot.triangle;
        *plane = Plane { normal: foot.normal, offset: foot.normal.dot(foot.position), weight, foot: triangle };
    }
}

/// A vertex of the domain with a large distance to the mesh.
struct FarVertex {
    vertex: u32,
    /// The triangle closest to it, and the target there.
    triangle: u32,
    target: Target,
}

/// Returns those of `vertices` whose squared distance to the triangles that face the same way is in `range`, in the same
/// order.
fn vertices_in_range(range: Range<f64>, domain: &Domain, mesh: &Manifold, vertices: &[u32]) -> Vec<FarVertex> {
    let faces = Faces::new(mesh);
    let far_vertex = |&v: &u32| {
        let p = domain.mesh.positions[v as usize];
        let hit = faces.closest_facing(p, domain.vertex_normal(v), range.clone())?;
        if hit.distance_squared < range.start {
            return None;
        }
        let at = barycentric(hit.point, faces.corners(hit.triangle)?);
        let way = (p - hit.point).normalize_or_zero();
        let plane = Plane { normal: way, offset: way.dot(p), ..Plane::NONE };
        Some(FarVertex { vertex: v, triangle: hit.triangle, target: Target { at, plane } })
    };
    parallel::collect(vertices, |vertices| vertices.iter().filter_map(far_vertex))
}
