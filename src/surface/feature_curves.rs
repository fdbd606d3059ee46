//! The curves of a surface: its boundary and its sharp edges, from corner to corner.
//!
//! A corner is a vertex where curves meet or end, or where a curve turns sharply. The turn is measured at the scale of the
//! samples, between the chords of one spacing on both sides, so the zigzag of a scan's rim has no corners. A curve without a
//! corner is closed.
//!
//! Cost: linear in the sides on curves, plus a bounding-volume hierarchy for long curves.

use crate::geom::triangle::closest_point_of_segment;
use crate::mesh::cut::{Cut, OfSides};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::spatial::groups::Groups;
use glam::DVec3;

/// Cosine of the angle between two chords, 44 degrees, from which the point between them is a corner.
pub(super) const CORNER_TURN: f64 = 0.72;

/// Longest chord, relative to the length of the whole curve: a circle turns by 36 degrees between two such chords.
const LONGEST_CHORD: f64 = 0.1;

/// A curve of a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// The sides `3 t + k` of the cut surface along it, from its first end to its second. Those of a boundary have the
    /// surface on their left; each of those of a sharp edge has an opposite side.
    pub sides: Vec<u32>,
    /// Whether it is a closed curve.
    pub closed: bool,
    /// Whether it is an edge of the interface, along which the surface is cut out of a larger one. Every mesh keeps it as a
    /// single edge.
    pub interface: bool,
}

/// All curves of a surface.
#[derive(Default)]
pub struct Curves {
    /// The curves, identified by their index here.
    pub list: Vec<Curve>,
    /// The curve of each side, [`NONE`] off the curves.
    of_side: OfSides,
    /// Whether each vertex of the cut surface is a corner.
    corner: Vec<bool>,
    /// The sides of the curves, one for each edge, in the order of `list`; `segments` has them as triangles with two equal
    /// corners.
    sides: Vec<u32>,
    segments: Mesh,
    /// The segments of each curve.
    of_curve: Groups,
    bvh: Bvh,
}

impl Curves {
    /// Finds the curves of a surface that is cut along its sharp edges. `spacing` is that of the samples. `interface` has
    /// the ends of each edge of the interface, sorted, with the surface on the left of the direction between them. On the
    /// boundary, several sides may lie between them.
    pub fn new(cut: &Cut, spacing: f64, interface: &[[u32; 2]]) -> Self {
        let mut net = Net::new(cut);
        interface.iter().flatten().for_each(|&v| net.corner[v as usize] = true);
        let list: Vec<Curve> = net.curves(interface).into_iter().flat_map(|c| net.split_at_turns(c, spacing)).collect();
        let mut of_side = OfSides::default();
        let mut put = |side: u32, number: u32| of_side.set(side, number, cut.twin.len());
        for (curve, number) in list.iter().zip(0u32..) {
            for &side in &curve.sides {
                put(side, number);
                let across = cut.across.get(side);
                if across != NONE {
                    put(across, number);
                }
            }
        }
        let corner = cut.original.iter().map(|&v| net.corner[v as usize]).collect();
        let sides: Vec<u32> = list.iter().flat_map(|c| &c.sides).copied().collect();
        let positions = sides.iter().flat_map(|&s| net.ends(s)).map(|v| cut.mesh.positions[v as usize]).collect();
        let triangles = (0..sides.len() as u32).map(|i| [2 * i, 2 * i + 1, 2 * i + 1]).collect();
        let segments = Mesh { positions, triangles };
        let bvh = Bvh::new(&segments);
        let of_curve = Groups::new((&segments, &bvh), list.len(), |segment| of_side.get(sides[segment as usize]));
        Curves { list, of_side, corner, sides, bvh, segments, of_curve }
    }

    /// Total length of all curves.
    pub fn length(&self) -> f64 {
        let length = |t: usize| self.segments.corners(t)[0].distance(self.segments.corners(t)[1]);
        (0..self.sides.len()).map(length).sum()
    }

    /// Returns the curve of `side`, or [`NONE`].
    #[inline]
    pub fn of_side(&self, side: u32) -> u32 {
        self.of_side.get(side)
    }

    /// Returns whether vertex `v` of the cut surface is a corner.
    #[inline]
    pub fn is_corner(&self, v: u32) -> bool {
        self.corner[v as usize]
    }

    /// Returns the point of curve `curve` closest to `p`: a side of the curve, and the position along it in 0..=1.
    pub fn closest(&self, p: DVec3, curve: u32) -> Option<(u32, f64)> {
        let closest = self.closest_segment(p, curve)? as usize;
        let [a, b, _] = self.segments.corners(closest);
        let along = closest_point_of_segment(p, a, b).distance(a) / a.distance(b).max(f64::MIN_POSITIVE);
        Some((self.sides[closest], along.min(1.0)))
    }

    /// Returns the curve closest to `p` of those with a side that `is_wanted`.
    pub fn nearest(&self, p: DVec3, is_wanted: impl Fn(u32) -> bool) -> Option<u32> {
        let is_own = |segment: u32| is_wanted(self.sides[segment as usize]);
        let hit = self.bvh.closest_where(&self.segments, p, f64::INFINITY, is_own)?;
        Some(self.of_side(self.sides[hit.triangle as usize]))
    }

    /// Returns the segment of curve `curve` closest to `p`; the first one of several equally close.
    fn closest_segment(&self, p: DVec3, curve: u32) -> Option<u32> {
        let is_own = |segment: u32| self.of_side(self.sides[segment as usize]) == curve;
        let all = (&self.segments, &self.bvh);
        self.of_curve.closest(all, (curve, is_own), p, f64::INFINITY, |_| true).map(|hit| hit.triangle)
    }
}

/// The sides on curves, and how they are connected at the vertices of the surface before the cut.
struct Net<'a> {
    cut: &'a Cut,
    /// Each side on a curve, preceded by the vertex that it leaves; sorted.
    out: Vec<(u32, u32)>,
    /// Whether each vertex is a corner.
    corner: Vec<bool>,
}

impl<'a> Net<'a> {
    fn new(cut: &'a Cut) -> Self {
        let mut net = Net { cut, out: Vec::new(), corner: vec![false; cut.original.len()] };
        let on_curve = (0..cut.twin.len() as u32).filter(|&s| cut.twin[s as usize] == NONE);
        net.out = on_curve.map(|s| (net.ends(s)[0], s)).collect();
        net.out.sort_unstable();
        for same in net.out.chunk_by(|a, b| a.0 == b.0) {
            net.corner[same[0].0 as usize] = !net.goes_on(same);
        }
        net
    }

    /// Returns the start and the end vertex of `side`, numbered as before the cut.
    fn ends(&self, side: u32) -> [u32; 2] {
        self.cut.mesh.ends(side).map(|v| self.cut.original[v as usize])
    }

    fn position(&self, v: u32) -> DVec3 {
        self.cut.mesh.positions[v as usize]
    }

    /// Returns whether a single curve continues through the vertex that these sides leave: one side of a boundary, or two
    /// sharp ones.
    fn goes_on(&self, leaving: &[(u32, u32)]) -> bool {
        let boundary = |s: u32| self.cut.across.get(s) == NONE;
        match *leaving {
            [(_, s)] => boundary(s),
            [(_, s), (_, t)] => !boundary(s) && !boundary(t),
            _ => false,
        }
    }

    /// Returns the side of the same curve after `side`, unless it ends there.
    fn following(&self, side: u32) -> Option<u32> {
        let at = self.ends(side)[1];
        let back = self.cut.across.get(side);
        let begin = self.out.partition_point(|o| o.0 < at);
        let mut on = self.out[begin..].iter().take_while(|o| o.0 == at).map(|o| o.1).filter(|&s| s != back);
        if self.corner[at as usize] { None } else { on.next() }
    }

    /// Returns all curves between vertices where they meet or end, and the closed ones.
    fn curves(&self, interface: &[[u32; 2]]) -> Vec<Curve> {
        let mut used = vec![false; self.cut.twin.len()];
        let mut curves = Vec::new();
        // Curves that begin at a corner come first; those left after them are closed.
        let (first, rest): (Vec<_>, Vec<_>) = self.out.iter().partition(|o| self.corner[o.0 as usize]);
        for (_, begin) in first.into_iter().chain(rest) {
            let mut curve = Curve { closed: true, ..Curve::default() };
            let mut side = begin;
            while !used[side as usize] {
                for s in [side, self.cut.across.get(side)].into_iter().filter(|&s| s != NONE) {
                    used[s as usize] = true;
                }
                curve.sides.push(side);
                match self.following(side) {
                    Some(next) => side = next,
                    None => curve.closed = false,
                }
            }
            if let (Some(&first), Some(&last)) = (curve.sides.first(), curve.sides.last()) {
                let between = [self.ends(first)[0], self.ends(last)[1]];
                curve.interface = self.cut.across.get(first) == NONE && interface.binary_search(&between).is_ok();
                curves.push(curve);
            }
        }
        curves
    }

    /// Splits a curve at the vertices where it turns sharply, which become corners.
    fn split_at_turns(&mut self, mut curve: Curve, spacing: f64) -> Vec<Curve> {
        let turns = if curve.interface { Vec::new() } else { Polyline::new(self, &curve).turns(spacing) };
        let Some(&first) = turns.first() else { return vec![curve] };
        for &i in &turns {
            let [at, _] = self.ends(curve.sides[i]);
            self.corner[at as usize] = true;
        }
        let mut cuts = turns;
        if curve.closed {
            curve.sides.rotate_left(first);
            cuts.iter_mut().for_each(|i| *i -= first);
        } else {
            cuts.insert(0, 0);
        }
        cuts.push(curve.sides.len());
        cuts.windows(2).map(|c| Curve { sides: curve.sides[c[0]..c[1]].to_vec(), ..Curve::default() }).collect()
    }
}

/// A curve as a sequence of points.
struct Polyline {
    points: Vec<DVec3>,
    /// Arc length of the curve up to each point.
    arc: Vec<f64>,
    closed: bool,
}

impl Polyline {
    fn new(net: &Net<'_>, curve: &Curve) -> Self {
        let first = curve.sides[..1].iter().map(|&s| net.ends(s)[0]);
        let points: Vec<DVec3> =
            first.chain(curve.sides.iter().map(|&s| net.ends(s)[1])).map(|v| net.position(v)).collect();
        let mut arc = vec![0.0];
        for pair in points.windows(2) {
            arc.push(arc[arc.len() - 1] + pair[0].distance(pair[1]));
        }
        Polyline { points, arc, closed: curve.closed }
    }

    /// Returns the point at arc length `at`: wrapped around a closed curve, clamped to the ends of an open one.
    fn point(&self, at: f64) -> DVec3 {
        let total = self.arc[self.arc.len() - 1];
        let at = if self.closed { at.rem_euclid(total) } else { at.clamp(0.0, total) };
        let i = self.arc.partition_point(|&a| a <= at).clamp(1, self.arc.len() - 1);
        let share = (at - self.arc[i - 1]) / (self.arc[i] - self.arc[i - 1]).max(f64::MIN_POSITIVE);
        self.points[i - 1].lerp(self.points[i], share.clamp(0.0, 1.0))
    }

    /// Returns the points, except ends, where the curve turns sharply, and more than at any other point within a chord.
    fn turns(&self, spacing: f64) -> Vec<usize> {
        let count = self.points.len() - 1;
        let total = self.arc[count];
        let chord = spacing.min(LONGEST_CHORD * total);
        let cosine = |i: usize| {
            let before = self.points[i] - self.point(self.arc[i] - chord);
            let after = self.point(self.arc[i] + chord) - self.points[i];
            before.normalize_or_zero().dot(after.normalize_or_zero())
        };
        let first = usize::from(!self.closed);
        let sharp: Vec<(usize, f64)> =
            (first..count).map(|i| (i, cosine(i))).filter(|turn| turn.1 < CORNER_TURN).collect();
        let near = |i: usize, j: usize| {
            let apart = (self.arc[i] - self.arc[j]).abs();
            apart < chord || self.closed && total - apart < chord
        };
        let n = sharp.len();
        let sharpest = |&k: &usize| {
            let (i, turn) = sharp[k];
            let within = |&(j, _): &(usize, f64)| near(i, j);
            let before = (1..n).map(|d| sharp[(k + n - d) % n]).take_while(within);
            let after = (1..n).map(|d| sharp[(k + d) % n]).take_while(within);
            before.chain(after).all(|(j, other)| (turn, i) < (other, j))
        };
        (0..n).filter(sharpest).map(|k| sharp[k].0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::cut::cut;
    use crate::mesh::topology::twins;
    use crate::surface::features::{Features, sharp_sides};
    use crate::testing::{cube, sheet};

    fn curves_of(mesh: Mesh, features: Features) -> (Cut, Curves) {
        let twin = twins(&mesh.triangles);
        let manifold = mesh.try_into().unwrap();
        let sharp = sharp_sides(&manifold, &twin, &features, 0.01, 0.0, |_| false);
        let cut = cut(manifold.into_mesh(), twin, &sharp);
        let curves = Curves::new(&cut, 0.1, &[]);
        (cut, curves)
    }

    #[test]
    fn a_cube_has_twelve_curves_between_eight_corners() {
        let (cut, curves) = curves_of(cube(), Features::Automatic);
        assert_eq!(curves.list.len(), 12);
        assert!(curves.list.iter().all(|c| !c.closed && c.sides.len() == 1));
        assert!((0..cut.original.len() as u32).all(|v| curves.is_corner(v)));
        assert_eq!(cut.original.len(), 24, "three faces meet at each corner");
        let (side, along) = curves.closest(DVec3::new(0.3, -1.0, -0.1), curves.of_side(0)).unwrap();
        assert_eq!(curves.of_side(side), curves.of_side(0));
        assert!((0.0..=1.0).contains(&along));
    }

    #[test]
    fn the_boundary_of_a_square_has_four_corners_and_that_of_a_disk_none() {
        let mut square = cube();
        square.triangles.truncate(2);
        square.drop_unused();
        let (_, curves) = curves_of(square, Features::Smooth);
        assert_eq!(curves.list.iter().map(|c| c.sides.len()).collect::<Vec<_>>(), [1, 1, 1, 1]);
        let n = 12;
        let rim = (0..n).map(|i| DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(n)));
        let positions = rim.map(|p| p.extend(0.0)).chain([DVec3::ZERO]).collect();
        let triangles = (0..n as u32).map(|i| [n as u32, i, (i + 1) % n as u32]).collect();
        let (_, curves) = curves_of(Mesh { positions, triangles }, Features::Smooth);
        assert_eq!(curves.list.len(), 1);
        assert!(curves.list[0].closed && curves.list[0].sides.len() == 12);
    }

    use glam::DVec2;

    #[test]
    fn the_closest_point_of_a_curve_is_on_that_curve_whether_it_has_few_or_many_sides() {
        for sides in [4, 100] {
            let (_, curves) = curves_of(sheet(sides, |_, _| 0.0), Features::Smooth);
            assert_eq!(curves.list.len(), 4);
            for curve in 0..4 {
                let (side, along) = curves.closest(DVec3::new(0.3, 0.2, 0.5), curve).unwrap();
                assert_eq!(curves.of_side(side), curve);
                let at = curves.sides.iter().position(|&s| s == side).unwrap();
                let [a, b, _] = curves.segments.corners(at);
                let p = a.lerp(b, along);
                // The foot on a side of the unit square.
                let expected = [(0.3, 0.0), (0.3, 1.0), (0.0, 0.2), (1.0, 0.2)];
                assert!(expected.iter().any(|&(x, y)| p.distance(DVec3::new(x, y, 0.0)) < 1e-12), "{p}");
            }
        }
    }

    #[test]
    fn the_sides_of_a_curve_follow_each_other() {
        let (cut, curves) = curves_of(cube(), Features::Automatic);
        let net = Net::new(&cut);
        for curve in &curves.list {
            for pair in curve.sides.windows(2) {
                assert_eq!(net.ends(pair[0])[1], net.ends(pair[1])[0]);
            }
        }
    }
}
