//! Replacement of triangles by others.

use super::{Connectivity, OnCurve};
use crate::mesh::topology::NONE;
use std::collections::{BTreeMap, BTreeSet};

impl Connectivity {
    /// Replaces the triangles `old`, given in increasing order, by `triangles` with the same boundary, each with the curves
    /// of its sides. Vertices in `added`, each given by its curve, get the next numbers; vertices that are no longer used by
    /// any triangle are removed. Returns `false` and does nothing if one of the new edges already exists elsewhere, or
    /// occurs twice among the new ones.
    pub fn replace(&mut self, old: &[u32], triangles: &[([u32; 3], [OnCurve; 3])], added: &[OnCurve]) -> bool {
        let inside = |h: u32| old.binary_search(&(h / 3)).is_ok();
        let old_sides: Vec<u32> = old.iter().flat_map(|&t| 3 * t..3 * t + 3).collect();
        let border = old_sides.iter().copied().filter(|&h| !self.has_twin(h) || !inside(self.twin(h)));
        // The twin of each side of the border, and its curve.
        let mut open: BTreeMap<[u32; 2], (u32, OnCurve)> =
            border.map(|h| ([self.origin(h), self.target(h)], (self.twin(h), self.curve(h)))).collect();
        let known: BTreeSet<[u32; 2]> = old_sides.iter().map(|&h| [self.origin(h), self.target(h)]).collect();
        let edges = || {
            let of_triangle =
                |&([a, b, c], curves): &([u32; 3], [OnCurve; 3])| [[a, b], [b, c], [c, a]].into_iter().zip(curves);
            triangles.iter().flat_map(of_triangle)
        };
        let mut new = BTreeSet::new();
        if edges().any(|(edge, _)| !new.insert(edge) || !known.contains(&edge) && self.has_edge(edge)) {
            return false;
        }
        for &side in &old_sides {
            self.remove_half_edge(side);
        }
        for v in known.iter().map(|edge| edge[0]) {
            self.out[v as usize] = NONE;
        }
        self.out.resize(self.out.len() + added.len(), NONE);
        self.curve_at.extend(added);
        let more = 3 * triangles.len().saturating_sub(old.len());
        let first_new = self.half_edge_bound();
        self.origin.resize(self.origin.len() + more, NONE);
        self.twin.resize(self.twin.len() + more, NONE);
        self.curve.resize(self.curve.len() + more, OnCurve::No);
        let sides = || old_sides.iter().copied().chain(first_new..).take(3 * triangles.len());
        for (side, (edge, curve)) in sides().zip(edges()) {
            self.origin[side as usize] = edge[0];
            self.curve[side as usize] = curve;
            match open.remove(&edge) {
                Some((across, curve)) => {
                    self.curve[side as usize] = curve;
                    self.glue(side, across);
                }
                None => {
                    open.insert([edge[1], edge[0]], (side, curve));
                }
            }
        }
        for side in sides() {
            self.set_out(self.origin(side), side);
        }
        self.live_triangles = self.live_triangles + triangles.len() - old.len();
        let before: BTreeSet<u32> = known.into_iter().map(|edge| edge[0]).collect();
        let removed = before.into_iter().filter(|&v| !self.has_vertex(v)).count();
        self.live_vertices = self.live_vertices + added.len() - removed;
        true
    }

    fn remove_half_edge(&mut self, h: u32) {
        self.origin[h as usize] = NONE;
        self.twin[h as usize] = NONE;
        self.curve[h as usize] = OnCurve::No;
    }

    /// Returns whether `a` and `b` are joined by an edge. Either may have been removed or may not exist yet.
    fn has_edge(&self, [a, b]: [u32; 2]) -> bool {
        let has = |v: u32| v < self.vertex_bound() && self.has_vertex(v);
        has(a) && has(b) && self.are_adjacent(a, b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::half_edge::tests::{audit, grid};

    fn on_no_curve(triangle: [u32; 3]) -> ([u32; 3], [OnCurve; 3]) {
        (triangle, [OnCurve::No; 3])
    }

    #[test]
    fn triangles_are_replaced_by_others_with_the_same_border() {
        let (n, triangles) = grid(4, false);
        let mut mesh = Connectivity::new(n, &triangles);
        let [a, b, c] = mesh.triangle(0);
        let d = mesh.triangle(3).into_iter().find(|v| ![a, b, c].contains(v)).unwrap();
        assert!(mesh.replace(&[0, 1], &[[b, c, d], [b, d, a]].map(on_no_curve), &[]));
        assert!(mesh.are_adjacent(b, d) && !mesh.are_adjacent(a, c));
        assert_eq!(audit(&mesh).boundary_loops, 1);
    }

    #[test]
    fn triangles_are_replaced_by_more_or_fewer_with_the_curves_inside() {
        let (n, triangles) = grid(4, false);
        let mut mesh = Connectivity::new(n, &triangles);
        let [a, b, c] = mesh.triangle(0);
        let d = mesh.triangle(3).into_iter().find(|v| ![a, b, c].contains(v)).unwrap();
        mesh.mark_on_curve(a, b, OnCurve::Curve(1));
        let middle = n as u32;
        let on = |curve| [OnCurve::No, OnCurve::Curve(curve), OnCurve::No];
        let fan = [[a, b, middle], [b, c, middle], [c, d, middle], [d, a, middle]];
        let more = fan.map(|corners| if corners[0] == b { (corners, on(2)) } else { on_no_curve(corners) });
        let mut with_curve = more;
        with_curve[2].1[2] = OnCurve::Curve(2);
        assert!(mesh.replace(&[0, 1], &with_curve, &[OnCurve::Curve(2)]));
        assert_eq!((audit(&mesh).vertices, mesh.curve_at(middle)), (n + 1, OnCurve::Curve(2)));
        let curve_of =
            |mesh: &Connectivity, v: u32, w: u32| mesh.curve(mesh.outgoing(v).find(|&h| mesh.target(h) == w).unwrap());
        assert_eq!(
            [curve_of(&mesh, a, b), curve_of(&mesh, middle, c), curve_of(&mesh, c, middle)],
            [1, 2, 2].map(OnCurve::Curve)
        );
        let around: Vec<u32> = mesh.outgoing(middle).map(|h| h / 3).collect::<BTreeSet<u32>>().into_iter().collect();
        assert!(mesh.replace(&around, &[[a, b, c], [a, c, d]].map(on_no_curve), &[]));
        assert_eq!((audit(&mesh).vertices, mesh.has_vertex(middle)), (n, false));
        assert_eq!(curve_of(&mesh, a, b), OnCurve::Curve(1));
    }

    #[test]
    fn triangles_are_not_replaced_where_an_edge_would_be_there_twice() {
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let mut mesh = Connectivity::new(4, &faces);
        assert!(!mesh.replace(&[0, 1], &[[1, 2, 3], [1, 3, 0]].map(on_no_curve), &[]));
        assert_eq!((audit(&mesh).euler, mesh.compact().0), (2, faces.to_vec()));
        // A pocket of two triangles between two edges from a corner to the middle of a square.
        let (n, triangles) = grid(4, false);
        let mut mesh = Connectivity::new(n, &triangles);
        let [a, b, c] = mesh.triangle(0);
        let d = mesh.triangle(3).into_iter().find(|v| ![a, b, c].contains(v)).unwrap();
        let [middle, inside] = [n as u32, n as u32 + 1];
        let fan = [[a, b, middle], [b, c, middle], [c, d, middle], [d, a, middle]];
        let pocket = [[middle, a, inside], [a, middle, inside]];
        let both: Vec<_> = fan.into_iter().chain(pocket).map(on_no_curve).collect();
        assert!(!mesh.replace(&[0, 1], &both, &[OnCurve::No; 2]));
        assert_eq!((audit(&mesh).vertices, mesh.compact().0.len()), (n, triangles.len()));
    }
}
