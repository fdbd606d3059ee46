//! A mesh on its way to the result: a 2-manifold whose vertices are samples of a domain, changed by local operations
//! that keep its topology and never turn a triangle against the surface.

use crate::geom::triangle::{closest_point, mean_ratio};
use crate::surface::connectivity::{Connectivity, next, prev};
use crate::surface::domain::{Domain, Sample};
use crate::surface::mesh::Mesh;
use crate::surface::topology::NONE;
use glam::DVec3;
use rayon::prelude::*;

/// A 2-manifold over samples.
#[derive(Debug, Clone)]
pub struct Manifold {
    /// How the vertices are joined.
    pub connectivity: Connectivity,
    /// A sample for each vertex number, those of removed vertices included.
    pub samples: Vec<Sample>,
    /// Vertices that neither move nor go.
    pub fixed: Vec<bool>,
}

impl Manifold {
    /// The manifold of `triangles`, which have to be an oriented 2-manifold that uses all of `samples`.
    pub fn new(samples: Vec<Sample>, triangles: &[[u32; 3]]) -> Self {
        let fixed = vec![false; samples.len()];
        Manifold { connectivity: Connectivity::new(samples.len(), triangles), samples, fixed }
    }

    /// Where vertex `v` is.
    #[inline]
    pub fn position(&self, v: u32) -> DVec3 {
        self.samples[v as usize].position
    }

    /// The mesh without gaps.
    pub fn to_mesh(&self) -> Mesh {
        let (triangles, old) = self.connectivity.compact();
        Mesh { positions: old.iter().map(|&v| self.position(v)).collect(), triangles }
    }

    /// The cosine between the normal of a triangle of these vertices and that of the surface at them; -1 if the
    /// triangle is flat.
    #[inline]
    pub fn agreement(&self, corners: [u32; 3]) -> f64 {
        cosine_to_surface(corners.map(|v| &self.samples[v as usize]))
    }

    /// The squared length of the edge of `h`.
    #[inline]
    pub fn length_squared(&self, h: u32) -> f64 {
        self.position(self.connectivity.origin(h)).distance_squared(self.position(self.connectivity.target(h)))
    }

    /// Whether the edge of `h` is not Delaunay: the angles across from it sum to more than two right ones.
    ///
    /// With the cosines and sines of both the sum's sine is negative then; no angle needs to be computed.
    pub fn breaks_delaunay(&self, h: u32) -> bool {
        let g = self.connectivity.twin(h);
        if g == NONE {
            return false;
        }
        let [a, b, c] = self.connectivity.triangle(h).map(|v| self.position(v));
        let d = self.position(self.connectivity.apex(g));
        let (ca, cb, da, db) = (a - c, b - c, a - d, b - d);
        let (cos_c, cos_d) = (ca.dot(cb), da.dot(db));
        let (sin_c, sin_d) = (ca.cross(cb).length(), da.cross(db).length());
        sin_c * cos_d + cos_c * sin_d < -1e-10 * (cos_c.abs() + sin_c) * (cos_d.abs() + sin_d)
    }

    /// Whether flipping the edge of `h` keeps both triangles facing the way of the surface, or at least no worse.
    pub fn flip_keeps_facing(&self, h: u32, least: f64) -> bool {
        let g = self.connectivity.twin(h);
        let [a, b, c] = self.connectivity.triangle(h);
        let d = self.connectivity.apex(g);
        let after = self.agreement([c, a, d]).min(self.agreement([d, b, c]));
        after > least || after > self.agreement([a, b, c]).min(self.agreement([b, a, d]))
    }

    /// Flips edges that are not Delaunay until there are none, beginning with those in `queue`. Flips that would make an
    /// edge twice or turn a triangle against the surface are left out.
    pub fn flip_to_delaunay(&mut self, mut queue: Vec<u32>) {
        // In the plane flips end by themselves; on a bent surface a bound makes sure of it.
        let mut left = 20 * queue.len() + 200;
        while let Some(h) = queue.pop() {
            if left == 0 || !self.connectivity.has_half_edge(h) || !self.breaks_delaunay(h) {
                continue;
            }
            if self.connectivity.can_flip(h) && self.flip_keeps_facing(h, LEAST_FACING) {
                let g = self.connectivity.twin(h);
                self.connectivity.flip(h);
                queue.extend([next(h), prev(h), next(g), prev(g)]);
                left -= 1;
            }
        }
    }

    /// All half-edges, in increasing order.
    pub fn half_edges(&self) -> impl Iterator<Item = u32> {
        (0..self.connectivity.half_edge_bound()).filter(|&h| self.connectivity.has_half_edge(h))
    }

    /// One half-edge of each edge, in increasing order.
    pub fn edges(&self) -> impl Iterator<Item = u32> {
        self.half_edges().filter(|&h| h < self.connectivity.twin(h))
    }

    /// Splits the edge of `h` at its middle, put back on the domain; the new vertex. `None`, and nothing is done, if that
    /// place is not between the ends, as happens where the edge cuts through a thin part.
    pub fn split_at_middle(&mut self, domain: &Domain, h: u32) -> Option<u32> {
        let middle = self.middle(domain, h);
        let ends = [self.connectivity.origin(h), self.connectivity.target(h)].map(|v| self.position(v));
        let longest = MIDDLE_REACH * MIDDLE_REACH * self.length_squared(h);
        if ends.iter().any(|end| end.distance_squared(middle.position) > longest) {
            return None;
        }
        self.samples.push(middle);
        self.fixed.push(false);
        Some(self.connectivity.split_edge(h))
    }

    /// The middle of the edge of `h`, put back on the domain, or on its boundary.
    fn middle(&self, domain: &Domain, h: u32) -> Sample {
        let (a, b) = (self.connectivity.origin(h), self.connectivity.target(h));
        let (a, b) = (&self.samples[a as usize], &self.samples[b as usize]);
        let middle = (a.position + b.position) / 2.0;
        if self.connectivity.twin(h) == NONE {
            domain.project_on_boundary(middle, a.triangle)
        } else {
            domain.project(middle, a.normal + b.normal, a.triangle)
        }
    }

    /// The mesh with its `count` longest edges split at their middles, put back on the domain: a triangle with three such
    /// edges becomes four, the others two or three or stay.
    pub fn with_longest_split(&self, domain: &Domain, count: usize) -> Manifold {
        let (_, old) = self.connectivity.compact();
        let mut number = vec![NONE; self.samples.len()];
        for (&v, n) in old.iter().zip(0u32..) {
            number[v as usize] = n;
        }
        let mut samples: Vec<Sample> = old.iter().map(|&v| self.samples[v as usize]).collect();
        let mut edges: Vec<u32> = self.edges().collect();
        edges.sort_by(|&g, &h| self.length_squared(h).total_cmp(&self.length_squared(g)).then(g.cmp(&h)));
        edges.truncate(count);
        let mut middle_of = vec![NONE; self.connectivity.half_edge_bound() as usize];
        for (&h, v) in edges.iter().zip(samples.len() as u32..) {
            middle_of[h as usize] = v;
            if self.connectivity.twin(h) != NONE {
                middle_of[self.connectivity.twin(h) as usize] = v;
            }
        }
        samples.par_extend(edges.par_iter().map(|&h| self.middle(domain, h)));
        let mut triangles = Vec::with_capacity(4 * self.connectivity.half_edge_bound() as usize / 3);
        for h in self.half_edges().filter(|h| h % 3 == 0) {
            let corners = self.connectivity.triangle(h).map(|v| number[v as usize]);
            let m = [0, 1, 2].map(|k| middle_of[h as usize + k]);
            let split = m.iter().filter(|&&v| v != NONE).count();
            match split {
                0 => triangles.push(corners),
                3 => {
                    triangles.extend([[corners[0], m[0], m[2]], [m[0], corners[1], m[1]], [m[2], m[1], corners[2]], m])
                }
                _ => {
                    // Turn so that side 0 is split and, of two split sides, side 1 is the other one.
                    let k = (0..3).find(|&k| m[k] != NONE && m[(k + 2) % 3] == NONE).unwrap_or(0);
                    let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
                    let (p, q) = (m[k], m[(k + 1) % 3]);
                    if q == NONE {
                        triangles.extend([[a, p, c], [p, b, c]]);
                    } else {
                        triangles.extend([[p, b, q], [a, p, q], [a, q, c]]);
                    }
                }
            }
        }
        Manifold::new(samples, &triangles)
    }

    /// The vertices where the surface turns by more than the angle of that cosine within two rings.
    pub fn bent(&self, cosine: f64) -> Vec<bool> {
        let c = &self.connectivity;
        let normal = |v: u32| self.samples[v as usize].normal;
        let turns = |v: u32| c.ring(v).any(|w| c.ring(w).any(|x| normal(x).dot(normal(v)) < cosine));
        (0..c.vertex_bound()).into_par_iter().map(|v| c.has_vertex(v) && turns(v)).collect()
    }

    /// The least cosine between a triangle at `v` and the surface if `v` were at `there`.
    pub fn worst_facing(&self, v: u32, there: &Sample) -> f64 {
        let facing = |h: u32| {
            let [_, p, q] = self.connectivity.triangle(h);
            let (p, q) = (&self.samples[p as usize], &self.samples[q as usize]);
            cosine_to_surface([there, p, q])
        };
        self.connectivity.outgoing(v).map(facing).fold(1.0, f64::min)
    }

    /// The vertices in classes such that no two of a class are adjacent: greedily, in the order of their numbers.
    pub fn colour_classes(&self) -> Vec<Vec<u32>> {
        const UNCOLOURED: u8 = u8::MAX;
        let c = &self.connectivity;
        let mut colour = vec![UNCOLOURED; c.vertex_bound() as usize];
        let mut classes: Vec<Vec<u32>> = Vec::new();
        for v in (0..c.vertex_bound()).filter(|&v| c.has_vertex(v)) {
            let taken = c.ring(v).map(|w| colour[w as usize]).filter(|&k| k < 64).fold(0u64, |taken, k| taken | 1 << k);
            let free = taken.trailing_ones().min(63) as u8;
            colour[v as usize] = free;
            if classes.len() <= free as usize {
                classes.resize_with(free as usize + 1, Vec::new);
            }
            classes[free as usize].push(v);
        }
        classes
    }

    /// Flips all edges that are not Delaunay.
    pub fn make_delaunay(&mut self) {
        let c = &self.connectivity;
        let all = (0..c.half_edge_bound()).rev();
        self.flip_to_delaunay(all.filter(|&h| c.has_half_edge(h) && c.twin(h) != NONE && h < c.twin(h)).collect());
    }

    /// How well the triangles face the surface and are shaped if the origin of `h` merges into its target: the worst
    /// cosine between a triangle's normal and the surface's, and the worst mean ratio.
    pub fn after_collapse(&self, h: u32) -> (f64, f64) {
        let c = &self.connectivity;
        let target = c.target(h);
        let mut worst = (1.0f64, 1.0f64);
        for out in c.outgoing(c.origin(h)) {
            let [_, p, q] = c.triangle(out);
            if p != target && q != target {
                let corners = [target, p, q];
                let shape = mean_ratio(corners.map(|v| self.position(v)));
                worst = (worst.0.min(self.agreement(corners)), worst.1.min(shape));
            }
        }
        worst
    }
}

impl Manifold {
    /// The least cosine between a triangle and the surface at one of its corners if the origin of `h` merges into its
    /// target.
    pub fn bend_after_collapse(&self, h: u32) -> f64 {
        let c = &self.connectivity;
        let target = c.target(h);
        let left = c.outgoing(c.origin(h)).map(|out| c.triangle(out)).filter(|t| !t[1..].contains(&target));
        let least = left.map(|[_, p, q]| {
            let corners = [target, p, q].map(|v| &self.samples[v as usize]);
            let [a, b, c] = corners.map(|s| s.position);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            corners.iter().map(|s| s.normal.dot(normal)).fold(1.0, f64::min)
        });
        least.fold(1.0, f64::min)
    }

    /// How far the origin of `h` is from the triangles that are left there if it merges into its target.
    pub fn distance_after_collapse(&self, h: u32) -> f64 {
        let c = &self.connectivity;
        let (here, target) = (self.position(c.origin(h)), c.target(h));
        let squared = c.outgoing(c.origin(h)).map(|out| c.triangle(out)).filter(|t| !t[1..].contains(&target));
        let squared = squared
            .map(|[_, p, q]| here.distance_squared(closest_point(here, [target, p, q].map(|v| self.position(v)))));
        squared.fold(f64::INFINITY, f64::min).sqrt()
    }
}

/// How far, in lengths of an edge, the point that splits it may be from either end.
const MIDDLE_REACH: f64 = 0.75;

/// See [`Manifold::agreement`].
#[inline]
fn cosine_to_surface([a, b, c]: [&Sample; 3]) -> f64 {
    let own = (b.position - a.position).cross(c.position - a.position);
    let surface = a.normal + b.normal + c.normal;
    let cosine = own.dot(surface) / (own.length_squared() * surface.length_squared()).sqrt();
    if cosine.is_finite() { cosine } else { -1.0 }
}

/// Cosine between a triangle and the surface that a flip must keep: 75 degrees.
const LEAST_FACING: f64 = 0.26;
