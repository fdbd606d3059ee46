//! Edge collapses.

use super::{Connectivity, OnCurve, next, prev};
use crate::mesh::topology::NONE;

impl Connectivity {
    /// The link condition: returns whether merging the origin of `h` into its target leaves a manifold of the same topology.
    ///
    /// A boundary vertex may only be merged along the boundary, a vertex on a curve only along that curve. H. Edelsbrunner,
    /// Geometry and topology for mesh generation, 2001, section 4.2.
    pub fn can_collapse(&self, h: u32) -> bool {
        self.keeps_curves(h) && self.keeps_topology(h)
    }

    /// Returns whether merging the origin of `h` into its target leaves a manifold of the same topology and at most moves
    /// feature curves: if the two ends are on different curves, these meet in the target afterwards.
    pub fn can_merge(&self, h: u32) -> bool {
        // Two curve edges may only become one if their curves also meet at the opposite corner.
        let fold =
            |h: u32| !self.is_curve_edge(next(h)) || !self.is_curve_edge(prev(h)) || self.is_corner(self.apex(h));
        self.both_sides(h).all(fold) && !self.is_on_interface(self.origin(h)) && self.keeps_topology(h)
    }

    fn keeps_topology(&self, h: u32) -> bool {
        let (a, b) = (self.origin(h), self.target(h));
        if self.is_boundary(a) && self.has_twin(h) {
            return false;
        }
        let shared = self.ring(a).filter(|&v| v != b && self.are_adjacent(b, v)).count();
        let apex_stays = |h: u32| {
            let c = self.apex(h);
            self.valence(c) > if self.is_boundary(c) { 2 } else { 3 }
        };
        shared == self.both_sides(h).count() && self.both_sides(h).all(apex_stays)
    }

    /// Returns whether merging the origin of `h` into its target leaves the course of every curve unchanged.
    fn keeps_curves(&self, h: u32) -> bool {
        let alone = || !self.is_curve_edge(prev(h)) && (!self.has_twin(h) || !self.is_curve_edge(next(self.twin(h))));
        match self.curve_at(self.origin(h)) {
            OnCurve::No => true,
            OnCurve::Corner => false,
            curve => self.curve(h) == curve && alone(),
        }
    }

    /// Merges the origin of `h` into its target. Requires [`Self::can_collapse`].
    pub fn collapse(&mut self, h: u32) {
        let (a, b) = (self.origin(h), self.target(h));
        let moved: Vec<u32> = self.outgoing(a).collect();
        for out in moved {
            self.origin[out as usize] = b;
        }
        self.out[a as usize] = NONE;
        self.live_vertices -= 1;
        self.both_sides(h).for_each(|side| self.close(side));
    }

    /// [`Self::collapse`] for ends that may be on different curves, which makes the target a corner. Requires
    /// [`Self::can_merge`].
    pub fn merge(&mut self, h: u32) {
        let (a, b) = (self.origin(h), self.target(h));
        if self.is_on_curve(a) && (self.curve_at(a) != self.curve_at(b) || self.curve(h) != self.curve_at(a)) {
            self.put_on_curve(b, OnCurve::Corner);
        }
        self.collapse(h);
    }

    /// Returns whether flipping the edge of `h` can reroute the curve along it through the apex, which lies on a curve, too.
    pub fn can_bend(&self, h: u32) -> bool {
        matches!(self.curve(h), OnCurve::Curve(_))
            && self.has_twin(h)
            && self.apex(h) != self.apex(self.twin(h))
            && !self.are_adjacent(self.apex(h), self.apex(self.twin(h)))
    }

    /// Reroutes the curve along the edge of `h` through the apex, which becomes a corner of curves, and flips the edge.
    /// Requires [`Self::can_bend`].
    pub fn bend(&mut self, h: u32) {
        let [a, b, top] = self.triangle(h);
        let curve = self.curve(h);
        self.both_sides(h).for_each(|side| self.curve[side as usize] = OnCurve::No);
        for (from, to, side) in [(a, top, prev(h)), (top, b, next(h))] {
            if !self.is_curve_edge(side) {
                self.mark_on_curve(from, to, curve);
            }
        }
        self.put_on_curve(top, OnCurve::Corner);
        self.flip(h);
    }

    /// Removes the triangle of `h`, whose ends already are the same vertex, and glues its other two sides.
    fn close(&mut self, h: u32) {
        let (end, apex) = (self.origin(next(h)), self.apex(h));
        let (one, other) = (self.twin(next(h)), self.twin(prev(h)));
        // If both of the edges that become one are on curves, as after a merge, the curve of the first is kept.
        let curve = if self.is_curve_edge(next(h)) { self.curve(next(h)) } else { self.curve(prev(h)) };
        for side in [one, other].into_iter().filter(|&side| side != NONE) {
            self.curve[side as usize] = curve;
        }
        if one != NONE {
            self.glue(one, other);
        } else if other != NONE {
            self.glue(other, NONE);
        }
        for side in [h, next(h), prev(h)] {
            self.origin[side as usize] = NONE;
            self.twin[side as usize] = NONE;
        }
        self.live_triangles -= 1;
        // `one` runs from the apex to the merged vertex, `other` back.
        let (from_apex, from_end) = if one != NONE { (one, next(one)) } else { (next(other), other) };
        self.set_out(apex, from_apex);
        self.set_out(end, from_end);
    }
}
