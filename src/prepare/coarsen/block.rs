//! A part of a mesh whose edges are collapsed. Its boundary, where the mesh ends or other blocks begin, stays.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::geom::triangle::{closest_point, mean_ratio};
use crate::mesh::half_edge::{Connectivity, OnCurve, next};
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::order::spatial_order_in;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// How coarse a mesh may become, in its units.
#[derive(Debug, Clone, Copy)]
pub struct Coarseness {
    /// Minimum length that edges should have.
    pub shortest: f64,
    /// Approximate maximum distance of removed vertices from the remaining surface. Deviations of one step count in the
    /// next, but it does not count how triangles of remaining vertices move away later.
    pub tolerance: f64,
}

/// Number of triangles of a block: its data fit into the caches of a core.
pub(super) const BLOCK: usize = 1 << 15;

/// The blocks of the second turn are cut from bounds that are larger than those of the mesh by this share of its extent, so
/// that the two turns have different planes between blocks.
pub(super) const MARGIN: f64 = 1.0 / 3.0;

/// Shares of the shortest length with which edges are compared one after the other, so that the shortest edges go first.
const LENGTHS: [f64; 3] = [0.25, 0.5, 1.0];

/// Maximum length of an edge after a collapse, in shortest lengths.
const LONGEST: f64 = 2.0;

/// Cosine of the largest angle by which a triangle may turn.
const MOST_TURN: f64 = 0.5;

/// Minimum mean ratio of a triangle after a collapse, unless one there was worse before.
const LEAST_SHAPE: f64 = 0.3;

/// A part of a mesh, with its own vertices.
pub(super) struct Block {
    connectivity: Connectivity,
    positions: Vec<DVec3>,
    /// For each vertex, how far the vertices merged into it may be from the surface.
    strayed: Vec<f64>,
}

impl Block {
    /// Makes the block of an oriented manifold that uses all its vertices; those at the boundary may have several fans.
    /// `twin` is as in [`twins`](crate::mesh::topology::twins).
    pub fn new(mesh: Mesh, twin: Vec<u32>, strayed: Vec<f64>) -> Block {
        let connectivity = Connectivity::with_twins(mesh.positions.len(), &mesh.triangles, twin);
        Block { connectivity, positions: mesh.positions, strayed }
    }

    /// Puts the `sharp` sides, given triangle by triangle, on curves. Curves end at vertices with more or fewer than two of
    /// them.
    pub fn mark_sharp(&mut self, sharp: impl Iterator<Item = [bool; 3]>) {
        let connectivity = &mut self.connectivity;
        let mut at = vec![0u32; connectivity.vertex_bound() as usize];
        for (h, _) in (0u32..).zip(sharp.flatten()).filter(|side| side.1) {
            at[connectivity.origin(h) as usize] += 1;
            connectivity.put_half_edge_on_curve(h, OnCurve::Curve(0));
        }
        for v in (0..connectivity.vertex_bound()).filter(|&v| at[v as usize] > 0) {
            let curve = if at[v as usize] == 2 { OnCurve::Curve(0) } else { OnCurve::Corner };
            connectivity.put_on_curve(v, curve);
        }
    }

    /// Collapses edges that are too short, where this does no harm.
    pub fn coarsen(&mut self, coarseness: Coarseness) {
        for share in LENGTHS {
            let square = math::square(share * coarseness.shortest);
            for h in 0..self.connectivity.half_edge_bound() {
                if self.connectivity.has_half_edge(h) && self.length_squared(h) < square {
                    self.collapse_if_near(h, coarseness);
                }
            }
        }
    }

    /// Returns the position of a vertex.
    pub fn position(&self, v: u32) -> DVec3 {
        self.positions[v as usize]
    }

    fn length_squared(&self, h: u32) -> f64 {
        self.position(self.connectivity.origin(h)).distance_squared(self.position(self.connectivity.target(h)))
    }

    /// Collapses the edge of `h` into its target, if the origin is close enough to the remaining surface.
    fn collapse_if_near(&mut self, h: u32, coarseness: Coarseness) {
        let c = &self.connectivity;
        let (from, to) = (c.origin(h), c.target(h));
        if c.is_boundary(from) || c.is_boundary(to) {
            return;
        }
        let Some(distance) = self.distance_after(h, LONGEST * coarseness.shortest) else { return };
        let strayed = self.strayed[from as usize] + distance;
        if strayed <= coarseness.tolerance && self.keeps_topology(h) {
            self.connectivity.collapse(h);
            self.strayed[to as usize] = self.strayed[to as usize].max(strayed);
        }
    }

    /// Returns whether a collapse keeps the topology of the whole mesh, in which vertices on the boundary may have edges
    /// that this block lacks.
    fn keeps_topology(&self, h: u32) -> bool {
        let c = &self.connectivity;
        c.both_sides(h).all(|side| c.valence(c.apex(side)) > 3) && c.can_collapse(h)
    }

    /// Returns the distance of the origin of `h` from the triangles that remain around it once it is merged into the target;
    /// `None` if one of these turns too far, is too long or badly shaped.
    fn distance_after(&self, h: u32, longest: f64) -> Option<f64> {
        let c = &self.connectivity;
        let (from, to) = (self.position(c.origin(h)), self.position(c.target(h)));
        let fan = || c.outgoing(c.origin(h)).map(|out| (out, [c.target(out), c.apex(out)].map(|v| self.position(v))));
        let left = || fan().filter(|&(out, _)| out != h && next(c.twin(h)) != out).map(|(_, ends)| ends);
        let mut least = f64::INFINITY;
        for [a, b] in left() {
            let [before, after] = [from, to].map(|p| (a - p).cross(b - p));
            let is_too_long = a.distance_squared(to) > longest * longest;
            if is_too_long || before.dot(after) < MOST_TURN * before.length() * after.length() {
                return None;
            }
            least = least.min(mean_ratio([to, a, b]));
        }
        let least_before = || fan().map(|(_, [a, b])| mean_ratio([from, a, b])).fold(f64::INFINITY, f64::min);
        if least < LEAST_SHAPE && least < least_before() {
            return None;
        }
        let squares = left().map(|[a, b]| closest_point(from, [to, a, b]).distance_squared(from));
        Some(squares.fold(f64::INFINITY, f64::min).sqrt())
    }

    /// Iterates over the remaining triangles.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        let all = self.connectivity.half_edge_bound() / 3;
        (0..all).filter(|&t| self.connectivity.has_half_edge(3 * t))
    }

    /// Returns the corners of a triangle.
    pub fn corners(&self, t: u32) -> [u32; 3] {
        self.connectivity.triangle(3 * t)
    }

    /// Returns which sides of a triangle are on sharp edges.
    pub fn sharp_sides(&self, t: u32) -> [bool; 3] {
        [0, 1, 2].map(|k| self.connectivity.is_curve_edge(3 * t + k))
    }

    /// Returns how far the vertices merged into a vertex may be from the surface.
    pub fn strayed(&self, v: u32) -> f64 {
        self.strayed[v as usize]
    }

    /// Iterates over the remaining vertices that are not on the boundary.
    pub fn inside(&self) -> impl Iterator<Item = u32> {
        let c = &self.connectivity;
        (0..c.vertex_bound()).filter(|&v| c.has_vertex(v) && !c.is_boundary(v))
    }
}

/// Renumbers the few vertices of a large mesh that `triangles` use in the order of their first use. Returns the triangles and
/// the vertices in that order.
pub(super) fn numbered_apart(triangles: impl ExactSizeIterator<Item = [u32; 3]>) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut number: FxHashMap<u32, u32> = FxHashMap::default();
    number.reserve(triangles.len());
    let mut vertices = Vec::new();
    let mut local = |v: u32| {
        *number.entry(v).or_insert_with(|| {
            vertices.push(v);
            vertices.len() as u32 - 1
        })
    };
    let triangles = triangles.map(|corners| corners.map(&mut local)).collect();
    (triangles, vertices)
}

/// Returns the triangles of `mesh` in spatial order within `bounds`.
pub(super) fn order_of_triangles(mesh: &Mesh, bounds: Aabb) -> Vec<u32> {
    let first = |t: usize| mesh.positions[mesh.triangles[t][0] as usize];
    spatial_order_in(bounds, mesh.triangles.len(), first)
}
