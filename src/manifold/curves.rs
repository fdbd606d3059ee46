//! Feature curves on a manifold: creases and boundaries, along which vertices move and merge.

use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::{OnCurve, prev};
use crate::mesh::topology::NONE;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

impl Manifold {
    /// Puts edges, each given by its ends and its curve, and their ends on these curves, then makes the vertices `corners`
    /// corners. Returns whether all the edges exist.
    pub fn mark_curves(&mut self, edges: &[([u32; 2], OnCurve)], corners: impl IntoIterator<Item = u32>) -> bool {
        let mut all = true;
        for &([a, b], curve) in edges {
            all &= self.connectivity.mark_on_curve(a, b, curve);
            self.connectivity.put_on_curve(a, curve);
            self.connectivity.put_on_curve(b, curve);
        }
        for v in corners {
            self.connectivity.put_on_curve(v, OnCurve::Corner);
        }
        all
    }

    /// Makes all boundary vertices corners.
    pub fn lock_boundary(&mut self) {
        for v in 0..self.connectivity.vertex_bound() {
            if self.connectivity.has_vertex(v) && self.connectivity.is_boundary(v) {
                self.connectivity.put_on_curve(v, OnCurve::Corner);
            }
        }
    }

    /// Returns whether vertex `v` may move: it is neither `locked` nor a corner.
    #[inline]
    pub fn can_move(&self, v: u32, locked: &VertexSet) -> bool {
        !locked.contains(v) && !self.connectivity.is_corner(v)
    }

    /// Returns the unit direction of the curve at `v`, if `v` lies on one.
    pub fn along(&self, v: u32) -> Option<DVec3> {
        let [a, b] = self.connectivity.along_curve(v)?;
        Some((self.position(a) - self.position(b)).normalize_or(DVec3::X))
    }

    /// Returns where a step `way` from `here` takes vertex `v`; along its curve if it is on one.
    pub fn place_after(&self, domain: &Domain, v: u32, way: DVec3, here: &Sample) -> Sample {
        match self.connectivity.curve_at(v) {
            OnCurve::Curve(curve) => domain.project_on_curve(here.position + way, curve),
            _ => domain.follow(here, way),
        }
    }

    /// Returns the vertices along each curve; a closed curve ends with its first vertex again.
    pub fn curve_chains(&self) -> Vec<Vec<u32>> {
        let c = &self.connectivity;
        let mut seen = vec![false; self.samples.len()];
        let mut chains = Vec::new();
        let vertices = || (0..c.vertex_bound()).filter(|&v| c.has_vertex(v));
        let corners = vertices().filter(|&v| c.is_corner(v));
        let on_curves = vertices().filter(|&v| matches!(c.curve_at(v), OnCurve::Curve(_)));
        for start in corners.chain(on_curves) {
            for first in self.neighbours_on_curves(start) {
                if c.is_corner(first) || seen[first as usize] {
                    continue;
                }
                let mut chain = vec![start, first];
                seen[start as usize] = true;
                let (mut before, mut at) = (start, first);
                while at != start
                    && let Some(ends) = c.along_curve(at)
                {
                    seen[at as usize] = true;
                    (before, at) = (at, if ends[0] == before { ends[1] } else { ends[0] });
                    chain.push(at);
                }
                chains.push(chain);
            }
        }
        chains
    }

    /// Returns the neighbours of `v` along curve edges.
    fn neighbours_on_curves(&self, v: u32) -> Vec<u32> {
        let c = &self.connectivity;
        let last = c.outgoing(v).map(prev).find(|&h| !c.has_twin(h) && c.is_curve_edge(h));
        let out = c.outgoing(v).filter(|&h| c.is_curve_edge(h)).map(|h| c.target(h));
        out.chain(last.map(|h| c.origin(h))).collect()
    }

    /// Copies the curves of this mesh to one made from it by splitting edges. `number` holds the number of each vertex
    /// there, `middle_of` the vertex that splits each half-edge, or [`NONE`].
    pub(super) fn copy_curves(&self, finer: &mut Manifold, number: &[u32], middle_of: &[u32]) {
        let c = &self.connectivity;
        let mut edges = Vec::new();
        for h in self.edges().filter(|&h| c.is_curve_edge(h)) {
            let [a, b] = [c.origin(h), c.target(h)].map(|v| number[v as usize]);
            match middle_of[h as usize] {
                NONE => edges.push(([a, b], c.curve(h))),
                m => edges.extend([([a, m], c.curve(h)), ([m, b], c.curve(h))]),
            }
        }
        let corners = (0..c.vertex_bound()).filter(|&v| c.has_vertex(v) && c.is_corner(v));
        finer.mark_curves(&edges, corners.map(|v| number[v as usize]));
    }
}
