//! The neighbourhood of a sample along the surface, unrolled into a plane.
//!
//! From the sample's own triangle, the surface is walked edge by edge, the nearest edge first, and every triangle reached is
//! laid flat beside its predecessor. Lengths and angles along the path stay those of the surface, so the samples found have
//! the places of a discrete exponential map: a thin sheet is unrolled around its rim, and the far side of a gap is not
//! reached at all.
//!
//! Based on: the unfolding step of J. S. B. Mitchell, D. M. Mount, C. H. Papadimitriou, The discrete geodesic problem, 1987,
//! DOI 10.1137/0216045. Departure: it follows one path to each triangle instead of all.
//!
//! Cost: n log n in the triangles within the radius.
//!
//! Limits: a triangle has a single place, that of the shortest path found to it; beyond the tip of a spike, paths around
//! both sides compete. On a rough surface, paths curl back to the origin in the plane. Since no path is shorter than the
//! straight line in space, that distance also bounds the walk, approximately.

use crate::base::csr::Csr;
use crate::base::heap::Ranked;
use crate::base::math;
use crate::geom::triangle::{barycentric, closest_point_of_segment};
use crate::mesh::topology::NONE;
use crate::surface::domain::{Domain, Sample};
use glam::{DVec2, DVec3};
use std::collections::BinaryHeap;

/// Cosine of the largest angle between two normals for which the chord determines the arc length of the bend.
const LEAST_AGREEMENT: f64 = 0.2;

/// Maximum distance of a walk in space, in radii: where the surface is curved, places in the plane are slightly closer than
/// they should be.
const FARTHEST: f64 = 2.0;

/// Samples grouped by the triangle that they lie on.
pub struct SamplesByTriangle(Csr<u32>);

impl SamplesByTriangle {
    /// Groups the samples by triangle, of `triangle_count` triangles.
    pub fn new(triangle_count: usize, samples: &[Sample]) -> Self {
        SamplesByTriangle(Csr::new(triangle_count, || samples.iter().map(|s| s.triangle).zip(0u32..)))
    }

    /// Returns the samples on triangle `t`, sorted.
    pub fn on(&self, t: u32) -> &[u32] {
        self.0.row(t)
    }
}

/// A sample near another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedNeighbor {
    /// Its index.
    pub sample: u32,
    /// Its place in the plane, with the queried sample at the origin and the surface seen from outside.
    pub place: DVec2,
}

/// A side of a triangle not visited yet that the walk has reached, ordered with the one nearest to the origin first, and the
/// places of its two ends.
type Front = Ranked<[DVec2; 2]>;

/// Walks over a domain, and reuses its memory for the next walk.
pub struct Unfolding<'a> {
    domain: &'a Domain,
    samples: &'a [Sample],
    by_triangle: &'a SamplesByTriangle,
    /// The last walk that reached each triangle.
    walked: Vec<u32>,
    walk: u32,
    front: BinaryHeap<Front>,
}

impl<'a> Unfolding<'a> {
    /// Prepares walks over `domain` between `samples`.
    pub fn new(domain: &'a Domain, samples: &'a [Sample], by_triangle: &'a SamplesByTriangle) -> Self {
        let walked = vec![0; domain.mesh.triangles.len()];
        Unfolding { domain, samples, by_triangle, walked, walk: 0, front: BinaryHeap::new() }
    }

    /// Collects the samples within `radius` of sample `centre` along the surface into `found`, except `centre` itself.
    pub fn neighbours(&mut self, centre: u32, radius: f64, found: &mut Vec<PlacedNeighbor>) {
        found.clear();
        self.front.clear();
        self.walk += 1;
        let t = self.samples[centre as usize].triangle;
        let corners = self.lay_down(t, &self.samples[centre as usize]);
        self.visit(t, corners, [None; 3], centre, radius, found);
        while let Some(Ranked { index: side, item: [p, q], .. }) = self.front.pop() {
            let t = side / 3;
            if self.walked[t as usize] != self.walk {
                let k = side as usize % 3;
                let mut corners = [DVec2::ZERO; 3];
                corners[k] = p;
                corners[(k + 1) % 3] = q;
                corners[(k + 2) % 3] = self.apex(side, p, q);
                let mut from = [None; 3];
                from[k] = Some(());
                self.visit(t, corners, from, centre, radius, found);
            }
        }
    }

    /// Returns the places of the corners of triangle `t`, which contains the sample, with the sample at the origin.
    fn lay_down(&self, t: u32, sample: &Sample) -> [DVec2; 3] {
        let normal = self.domain.mesh.area_vector(t as usize).normalize_or(sample.normal);
        let x =
            sample.normal.any_orthonormal_pair().0.reject_from(normal).normalize_or(normal.any_orthonormal_vector());
        let y = normal.cross(x);
        self.domain.mesh.corners(t as usize).map(|p| {
            let offset = p - sample.position;
            DVec2::new(offset.dot(x), offset.dot(y))
        })
    }

    /// Collects the samples of a triangle laid flat, and queues the sides from which to continue.
    fn visit(
        &mut self,
        t: u32,
        corners: [DVec2; 3],
        from: [Option<()>; 3],
        centre: u32,
        radius: f64,
        found: &mut Vec<PlacedNeighbor>,
    ) {
        self.walked[t as usize] = self.walk;
        let here = &self.samples[centre as usize];
        for &s in self.by_triangle.on(t).iter().filter(|&&s| s != centre) {
            let w = barycentric(self.samples[s as usize].position, self.domain.mesh.corners(t as usize));
            let place = corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
            if place.length_squared() <= radius * radius {
                let there = &self.samples[s as usize];
                let place = along_gentle_bend(here, there).unwrap_or(place);
                found.push(PlacedNeighbor { sample: s, place });
            }
        }
        for k in (0..3).filter(|&k| from[k].is_none()) {
            let side = self.domain.twin[3 * t as usize + k];
            // Seen from the other face, the side has the opposite direction.
            let ends = [corners[(k + 1) % 3], corners[k]];
            let distance = distance_to_origin(ends[0], ends[1]);
            if side != NONE
                && distance <= radius
                && self.walked[side as usize / 3] != self.walk
                && self.is_within(FARTHEST * radius, here.position, side)
            {
                self.front.push(Ranked { rank: -distance, index: side, item: ends });
            }
        }
    }

    /// Returns whether `side` is at most `radius` from `p` in space.
    fn is_within(&self, radius: f64, p: DVec3, side: u32) -> bool {
        let corners = self.domain.mesh.corners(side as usize / 3);
        let k = side as usize % 3;
        closest_point_of_segment(p, corners[k], corners[(k + 1) % 3]).distance_squared(p) <= radius * radius
    }

    /// Returns the place of the corner opposite `side`, whose ends are at `p` and `q` with the triangle on its left.
    fn apex(&self, side: u32, p: DVec2, q: DVec2) -> DVec2 {
        let k = side as usize % 3;
        let corners = self.domain.mesh.corners(side as usize / 3);
        let (a, b, c) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let base = a.distance_squared(b);
        if base == 0.0 {
            return p;
        }
        let along = (c - a).dot(b - a) / base;
        let height = (b - a).cross(c - a).length() / base;
        p + along * (q - p) + height * (q - p).perp()
    }
}

/// Returns the place of `there` in the tangent plane of `here`, see [`along_bend`]; `None` if the normals differ too much.
pub fn along_gentle_bend(here: &Sample, there: &Sample) -> Option<DVec2> {
    let is_gentle = here.normal.dot(there.normal) >= LEAST_AGREEMENT;
    is_gentle.then(|| along_bend(here.normal, there.normal, there.position - here.position))
}

/// Returns the place of the point at `offset` in the tangent plane with normal `here`, if the surface bends evenly in
/// between: in the direction of the offset, at the length of the arc that has the offset as its chord and the unit normals
/// `here` and `there` at its ends.
pub fn along_bend(here: DVec3, there: DVec3, offset: DVec3) -> DVec2 {
    let (x, y) = here.any_orthonormal_pair();
    let half_sine = 0.5 * here.distance(there);
    let stretch = if half_sine > 1e-6 { math::asin(half_sine.min(1.0)) / half_sine } else { 1.0 };
    let direction = DVec2::new(offset.dot(x), offset.dot(y)).normalize_or_zero();
    direction * offset.length() * stretch
}

fn distance_to_origin(p: DVec2, q: DVec2) -> f64 {
    let way = q - p;
    let along = (-p.dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (p + along * way).length()
}
