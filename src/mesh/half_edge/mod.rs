//! The connectivity of a triangle mesh that changes: half-edges in flat arrays, without positions.
//!
//! Half-edge 3 t + k runs from corner k of triangle t to its corner k + 1. So the next and previous half-edges follow by
//! arithmetic, and only origin and twin are stored. Each vertex stores one outgoing half-edge; for a boundary vertex, it is
//! the one along the boundary, from which turning counter-clockwise reaches all others.
//!
//! Edges can be put on feature curves: creases and boundaries of the surface. Such an edge is never flipped, a vertex on a
//! curve collapses only along it, and a corner, where curves meet or end, does not collapse at all. So curves keep their
//! course, unless vertices are deliberately merged across them. An interface is a boundary along which the mesh will be
//! joined to another one. Its vertices are corners, and neither its edges nor those of adjacent triangles are split, so it
//! remains the same edge by edge.
//!
//! Removed triangles and vertices leave gaps until [`Connectivity::compact`].

mod collapse;
mod replace;

use crate::mesh::topology::{NONE, twins};

/// The half-edge after `h` in its triangle.
#[inline]
pub fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its triangle.
#[inline]
pub fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// The feature curve that an edge or a vertex lies on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum OnCurve {
    /// None.
    #[default]
    No,
    /// The curve of that number.
    Curve(u32),
    /// A vertex where curves meet or end, or that must be kept for other reasons.
    Corner,
    /// An edge of an interface.
    Interface,
}

/// Triangles and their adjacency.
#[derive(Debug, Clone, Default)]
pub struct Connectivity {
    origin: Vec<u32>,
    twin: Vec<u32>,
    /// The curve of each half-edge; never a corner.
    curve: Vec<OnCurve>,
    out: Vec<u32>,
    /// The curve of each vertex.
    curve_at: Vec<OnCurve>,
    live_vertices: usize,
    live_triangles: usize,
}

impl Connectivity {
    /// Returns the connectivity of an oriented 2-manifold with `vertex_count` vertices, all of them used.
    pub fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        Connectivity::with_twins(vertex_count, triangles, twins(triangles))
    }

    /// Like [`Self::new`], if the [`twins`] of the triangles are known.
    pub fn with_twins(vertex_count: usize, triangles: &[[u32; 3]], twin: Vec<u32>) -> Self {
        let origin: Vec<u32> = triangles.iter().flatten().copied().collect();
        let mut out = vec![NONE; vertex_count];
        for h in 0..origin.len() {
            let slot = &mut out[origin[h] as usize];
            if *slot == NONE || twin[h] == NONE {
                *slot = h as u32;
            }
        }
        let (curve, curve_at) = (vec![OnCurve::No; origin.len()], vec![OnCurve::No; vertex_count]);
        Connectivity {
            live_triangles: triangles.len(),
            live_vertices: vertex_count,
            origin,
            twin,
            curve,
            out,
            curve_at,
        }
    }

    /// Puts vertex `v` on a curve, or makes it a corner.
    pub fn put_on_curve(&mut self, v: u32, curve: OnCurve) {
        self.curve_at[v as usize] = curve;
    }

    /// Puts the edge between `v` and `w` on a curve; returns whether this edge exists.
    pub fn mark_on_curve(&mut self, v: u32, w: u32, curve: OnCurve) -> bool {
        let mut found = false;
        for (from, to) in [(v, w), (w, v)] {
            if let Some(h) = self.outgoing(from).find(|&h| self.target(h) == to) {
                self.curve[h as usize] = curve;
                found = true;
            }
        }
        found
    }

    /// Puts only half-edge `h` on a curve. Its twin must be put there, too.
    pub fn put_half_edge_on_curve(&mut self, h: u32, curve: OnCurve) {
        self.curve[h as usize] = curve;
    }

    /// The curve that the edge of `h` lies on.
    #[inline]
    pub fn curve(&self, h: u32) -> OnCurve {
        self.curve[h as usize]
    }

    /// The curve that vertex `v` lies on.
    #[inline]
    pub fn curve_at(&self, v: u32) -> OnCurve {
        self.curve_at[v as usize]
    }

    /// Returns whether the edge of `h` lies on a curve.
    #[inline]
    pub fn is_curve_edge(&self, h: u32) -> bool {
        self.curve(h) != OnCurve::No
    }

    /// Returns whether vertex `v` lies on a curve or is a corner.
    #[inline]
    pub fn is_on_curve(&self, v: u32) -> bool {
        self.curve_at(v) != OnCurve::No
    }

    /// Returns whether vertex `v` is a corner.
    #[inline]
    pub fn is_corner(&self, v: u32) -> bool {
        self.curve_at(v) == OnCurve::Corner
    }

    /// The neighbours of `v` along its curve; `None` off the curves and at corners.
    pub fn along_curve(&self, v: u32) -> Option<[u32; 2]> {
        let curve @ OnCurve::Curve(_) = self.curve_at(v) else { return None };
        let mut ends = [NONE; 2];
        for h in self.outgoing(v) {
            if self.curve(h) == curve {
                ends[usize::from(ends[0] != NONE)] = self.target(h);
            }
            if !self.has_twin(prev(h)) && self.curve(prev(h)) == curve {
                ends[1] = self.apex(h);
            }
        }
        (!ends.contains(&NONE)).then_some(ends)
    }

    /// The number of vertices, excluding gaps.
    pub fn vertex_count(&self) -> usize {
        self.live_vertices
    }

    /// One more than the largest vertex number.
    pub fn vertex_bound(&self) -> u32 {
        self.out.len() as u32
    }

    /// One more than the largest half-edge number.
    pub fn half_edge_bound(&self) -> u32 {
        self.origin.len() as u32
    }

    /// Returns whether vertex `v` has not been removed.
    #[inline]
    pub fn has_vertex(&self, v: u32) -> bool {
        self.out[v as usize] != NONE
    }

    /// Returns whether the triangle of half-edge `h` has not been removed.
    #[inline]
    pub fn has_half_edge(&self, h: u32) -> bool {
        self.origin[h as usize] != NONE
    }

    /// The vertex at which `h` begins.
    #[inline]
    pub fn origin(&self, h: u32) -> u32 {
        self.origin[h as usize]
    }

    /// The vertex at which `h` ends.
    #[inline]
    pub fn target(&self, h: u32) -> u32 {
        self.origin[next(h) as usize]
    }

    /// Returns whether the edge of `h` has a triangle on both sides, that is, is not on the boundary.
    #[inline]
    pub fn has_twin(&self, h: u32) -> bool {
        self.twin[h as usize] != NONE
    }

    /// The half-edge opposite to `h`. Requires [`Self::has_twin`].
    #[inline]
    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    /// The half-edges of the edge of `h`: `h` itself, and its twin if it has one.
    #[inline]
    pub fn both_sides(&self, h: u32) -> impl Iterator<Item = u32> + use<> {
        [h, self.twin(h)].into_iter().filter(|&h| h != NONE)
    }

    /// The corner opposite `h` in its triangle.
    #[inline]
    pub fn apex(&self, h: u32) -> u32 {
        self.origin[prev(h) as usize]
    }

    /// The corners of the triangle of `h`, starting with the origin of `h`.
    #[inline]
    pub fn triangle(&self, h: u32) -> [u32; 3] {
        [self.origin(h), self.target(h), self.apex(h)]
    }

    /// Returns whether `v` lies on the boundary.
    #[inline]
    pub fn is_boundary(&self, v: u32) -> bool {
        self.twin[self.out[v as usize] as usize] == NONE
    }

    /// The half-edges that leave `v`, counter-clockwise, one for each triangle at `v`.
    #[inline]
    pub fn outgoing(&self, v: u32) -> Outgoing<'_> {
        Outgoing { mesh: self, first: self.out[v as usize], at: self.out[v as usize] }
    }

    /// The one-ring of `v`, counter-clockwise.
    #[inline]
    pub fn ring(&self, v: u32) -> impl Iterator<Item = u32> {
        let mut last = NONE;
        let mut outgoing = self.outgoing(v);
        std::iter::from_fn(move || match outgoing.next() {
            Some(h) => {
                last = h;
                Some(self.target(h))
            }
            None if last != NONE && !self.has_twin(prev(last)) => {
                let end = self.apex(last);
                last = NONE;
                Some(end)
            }
            None => None,
        })
    }

    /// The number of edges at `v`.
    pub fn valence(&self, v: u32) -> usize {
        self.ring(v).count()
    }

    /// Returns whether `v` and `w` are joined by an edge.
    pub fn are_adjacent(&self, v: u32, w: u32) -> bool {
        self.ring(v).any(|u| u == w)
    }

    /// Returns whether the edge of `h` can be flipped: it has two faces, is not on a curve, and the new edge does not exist
    /// yet.
    pub fn can_flip(&self, h: u32) -> bool {
        let across = |h: u32| self.apex(self.twin(h));
        self.has_twin(h)
            && !self.is_curve_edge(h)
            && self.apex(h) != across(h)
            && !self.are_adjacent(self.apex(h), across(h))
    }

    /// Replaces the edge of `h` by the other diagonal of its two triangles; `h` becomes the new edge, which runs from the
    /// opposite apex to the apex on its own side. Requires [`Self::can_flip`].
    pub fn flip(&mut self, h: u32) {
        let g = self.twin(h);
        let [a, b, c] = self.triangle(h);
        let d = self.apex(g);
        let (bc, ca) = (self.twin(next(h)), self.twin(prev(h)));
        let (ad, db) = (self.twin(next(g)), self.twin(prev(g)));
        let outs = [a, b, c, d].map(|v| self.is_boundary(v).then(|| self.out[v as usize]));
        let old = [next(h), prev(h), next(g), prev(g)];
        let new = [prev(g), next(h), prev(h), next(g)];
        let curves = old.map(|side| self.curve(side));
        for (i, (from, across)) in [(b, bc), (c, ca), (a, ad), (d, db)].into_iter().enumerate() {
            let side = new[i];
            self.origin[side as usize] = from;
            self.curve[side as usize] = curves[i];
            self.glue(side, across);
            self.out[from as usize] = side;
        }
        self.origin[h as usize] = d;
        self.origin[g as usize] = c;
        for (v, out) in [a, b, c, d].into_iter().zip(outs) {
            if let Some(out) = out {
                let moved = old.iter().position(|&o| o == out);
                self.out[v as usize] = moved.map_or(out, |i| new[i]);
            }
        }
    }

    /// Returns whether `v` is an end of an interface edge, which is on the boundary.
    pub fn is_on_interface(&self, v: u32) -> bool {
        let on_interface = |h: u32| !self.has_twin(h) && self.curve(h) == OnCurve::Interface;
        self.is_boundary(v) && self.outgoing(v).any(|h| on_interface(h) || on_interface(prev(h)))
    }

    /// Returns whether the edge of `h` can be split: no triangle at it may have an edge on the interface. Otherwise,
    /// vertices would pile up along the interface, between its ends and the opposite corner.
    pub fn can_split(&self, h: u32) -> bool {
        let mut sides = self.both_sides(h).flat_map(|h| [h, next(h), prev(h)]);
        sides.all(|side| self.curve(side) != OnCurve::Interface)
    }

    /// Takes all edges and vertices off their curves, except those on the interface.
    pub fn forget_curves(&mut self) {
        self.curve.iter_mut().filter(|curve| **curve != OnCurve::Interface).for_each(|curve| *curve = OnCurve::No);
        for v in 0..self.vertex_bound() {
            if !self.has_vertex(v) || !self.is_on_interface(v) {
                self.curve_at[v as usize] = OnCurve::No;
            }
        }
    }

    /// Stores at `v` the boundary half-edge of the fan that contains `out`, or `out` itself if `v` is an inner vertex.
    fn set_out(&mut self, v: u32, out: u32) {
        let mut h = out;
        while self.has_twin(h) {
            h = next(self.twin(h));
            if h == out {
                break;
            }
        }
        self.out[v as usize] = h;
    }

    fn glue(&mut self, h: u32, g: u32) {
        self.twin[h as usize] = g;
        if g != NONE {
            self.twin[g as usize] = h;
        }
    }

    /// Inserts a vertex on the edge of `h` and joins it to the apexes; returns its number.
    pub fn split_edge(&mut self, h: u32) -> u32 {
        let v = self.out.len() as u32;
        self.live_vertices += 1;
        let g = self.twin(h);
        let far = self.split_side(h, v);
        // v stores the half-edge that continues h; on the boundary, this is the boundary half-edge.
        self.out.push(far);
        self.curve_at.push(self.curve(h));
        if g == NONE {
            return v;
        }
        let near = self.split_side(g, v);
        self.glue(h, near);
        self.glue(g, far);
        v
    }

    /// Splits the triangle of `h` between `v`, a vertex on `h`, and the apex; returns the half-edge from `v` to the old end
    /// of `h`.
    fn split_side(&mut self, h: u32, v: u32) -> u32 {
        let (b, c) = (self.target(h), self.apex(h));
        let new = self.origin.len() as u32;
        let across = self.twin(next(h));
        self.origin.extend([v, b, c]);
        self.twin.extend([NONE; 3]);
        self.curve.extend([self.curve(h), self.curve(next(h)), OnCurve::No]);
        self.curve[next(h) as usize] = OnCurve::No;
        self.live_triangles += 1;
        self.glue(new + 1, across);
        self.origin[next(h) as usize] = v;
        self.glue(next(h), new + 2);
        if self.out[b as usize] == next(h) {
            self.out[b as usize] = new + 1;
        }
        new
    }

    /// Returns the triangles in the order of their half-edges, and the old number of each of their vertices.
    pub fn compact(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let old: Vec<u32> = (0..self.vertex_bound()).filter(|&v| self.has_vertex(v)).collect();
        let mut number = vec![NONE; self.out.len()];
        for (&v, n) in old.iter().zip(0u32..) {
            number[v as usize] = n;
        }
        let live = self.origin.chunks_exact(3).filter(|t| t[0] != NONE);
        let triangles = live.map(|t| [t[0], t[1], t[2]].map(|v| number[v as usize])).collect();
        (triangles, old)
    }
}

/// See [`Connectivity::outgoing`].
pub struct Outgoing<'a> {
    mesh: &'a Connectivity,
    first: u32,
    at: u32,
}

impl Iterator for Outgoing<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        let h = self.at;
        if h == NONE {
            return None;
        }
        self.at = self.mesh.twin(prev(h));
        if self.at == self.first {
            self.at = NONE;
        }
        Some(h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};
    use crate::mesh::topology::{Topology, topology};
    use proptest::prelude::*;
    use rand_chacha::rand_core::Rng;

    /// A grid of n by n squares, with opposite sides glued (a torus) or not (a disk).
    pub(super) fn grid(n: u32, torus: bool) -> (usize, Vec<[u32; 3]>) {
        let width = if torus { n } else { n + 1 };
        let at = |i: u32, j: u32| (i % width) * width + j % width;
        let square = |i, j| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let triangles = (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect();
        ((width * width) as usize, triangles)
    }

    /// Checks the invariants of the arrays; returns the topology of the remaining mesh.
    pub(super) fn audit(mesh: &Connectivity) -> Topology {
        for h in (0..mesh.half_edge_bound()).filter(|&h| mesh.has_half_edge(h)) {
            let g = mesh.twin(h);
            if g != NONE {
                assert_eq!((mesh.twin(g), mesh.origin(g), mesh.target(g)), (h, mesh.target(h), mesh.origin(h)));
            }
            let v = mesh.origin(h);
            assert_eq!(mesh.origin(mesh.out[v as usize]), v);
            assert!(mesh.outgoing(v).any(|o| o == h), "half-edge {h} is not in the fan of its origin");
        }
        let (triangles, old) = mesh.compact();
        assert_eq!((old.len(), triangles.len()), (mesh.vertex_count(), mesh.live_triangles));
        let t = topology(old.len(), &triangles);
        assert!(t.is_manifold() && t.is_oriented() && t.vertices == old.len(), "{t:?}");
        t
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn any_allowed_operations_keep_the_topology(seed in any::<u64>(), torus in any::<bool>()) {
            let (n, triangles) = grid(6, torus);
            let mut mesh = Connectivity::new(n, &triangles);
            let before = audit(&mesh);
            let mut rng = stream(seed, Stage::Scan);
            for _ in 0..300 {
                let h = rng.next_u32() % mesh.half_edge_bound();
                if !mesh.has_half_edge(h) {
                    continue;
                }
                match rng.next_u32() % 5 {
                    0 => { mesh.split_edge(h); }
                    1 if mesh.can_flip(h) => mesh.flip(h),
                    2.. if mesh.can_collapse(h) => mesh.collapse(h),
                    _ => {}
                }
            }
            let after = audit(&mesh);
            prop_assert_eq!(
                (before.euler, before.components, before.boundary_loops),
                (after.euler, after.components, after.boundary_loops)
            );
        }
    }

    #[test]
    fn collapsing_all_that_can_be_ends_at_the_smallest_of_its_kind() {
        for (torus, fewest) in [(false, 3), (true, 7)] {
            let (n, triangles) = grid(5, torus);
            let mut mesh = Connectivity::new(n, &triangles);
            while let Some(h) = (0..mesh.half_edge_bound()).find(|&h| mesh.has_half_edge(h) && mesh.can_collapse(h)) {
                mesh.collapse(h);
            }
            audit(&mesh);
            assert!(mesh.vertex_count() >= fewest && mesh.vertex_count() <= fewest + 3);
        }
    }

    #[test]
    fn a_tetrahedron_has_nothing_to_give() {
        let mut mesh = Connectivity::new(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert!((0..12).all(|h| !mesh.can_collapse(h) && !mesh.can_flip(h)));
        let v = mesh.split_edge(0);
        assert_eq!((v, mesh.valence(v)), (4, 4));
        assert_eq!(audit(&mesh).euler, 2);
    }
}
