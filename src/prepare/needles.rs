//! Removes needles and caps: triangles with almost no height. Two corners of a needle almost coincide; the corner of a cap
//! lies almost on the opposite edge.
//!
//! Rounding makes them where a program cuts one surface with another. They have no reliable normal: sharp edges run to and
//! fro along them, and what is sampled between these edges has no area either. A needle is removed by collapsing its
//! shortest edge, a cap by flipping its longest edge, so that its corner divides the triangle across. The surface moves by
//! no more than their height.
//!
//! Based on: M. Botsch, L. Kobbelt, A robust procedure to eliminate degenerate faces from triangle meshes, Vision, Modeling,
//! and Visualization 2001. Departure: flips instead of slices, the longest edge first, so that no vertex is added.
//!
//! Cost: one test per triangle; where one is a needle or a cap, the connectivity of the mesh, and some queue operations for
//! it.
//!
//! Limits: caps whose longest edge is on the boundary stay, and so do those without other neighbours: flips and collapses
//! keep the topology.

use crate::base::heap::Ranked;
use crate::base::parallel;
use crate::mesh::half_edge::Connectivity;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::Provenance;
use crate::mesh::topology::twins;
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::repair::Repaired;
use glam::DVec3;
use std::collections::BinaryHeap;

/// Maximum height of a needle or cap: in diagonals of the bounding box (some units in the last place of single precision),
/// and as a share of its longest edge, so that small triangles of good shape stay however large the mesh is.
const HEIGHT: f64 = 1e-6;
const OF_LONGEST: f64 = 0.01;

/// Removes needles and caps from `repaired`; they count as repairs.
pub fn without_needles(repaired: Repaired) -> Repaired {
    let Repaired { mesh, mut repairs, twins: twin } = repaired;
    let height = HEIGHT * mesh.diagonal();
    let is_low = |&t: &u32| Height::of(mesh.corners(t as usize)).is_low(height);
    let low = parallel::collect(0..mesh.triangles.len() as u32, |block| block.filter(is_low));
    if low.is_empty() {
        return Repaired { mesh, repairs, twins: twin };
    }
    let (mesh, provenance) = mesh.into_parts();
    let connectivity = Connectivity::with_twins(mesh.positions.len(), &mesh.triangles, twin);
    let mut removal = Removal { positions: mesh.positions, connectivity, provenance, height };
    repairs.needles = removal.remove(low);
    let mesh = removal.finish();
    Repaired { twins: twins(&mesh.triangles), mesh, repairs }
}

/// Side lengths of a triangle, and its height above the longest side.
struct Height {
    /// Corners at which the longest and the shortest side begin.
    longest: usize,
    shortest: usize,
    lengths: [f64; 3],
    height: f64,
}

impl Height {
    fn of([a, b, c]: [DVec3; 3]) -> Height {
        let lengths = [a.distance(b), b.distance(c), c.distance(a)];
        let by_length = |i: &usize, j: &usize| lengths[*i].total_cmp(&lengths[*j]);
        let longest = (0..3).max_by(by_length).unwrap_or(0);
        let shortest = (0..3).min_by(by_length).unwrap_or(0);
        let height = (b - a).cross(c - a).length() / lengths[longest];
        Height { longest, shortest, lengths, height }
    }

    fn is_low(&self, height: f64) -> bool {
        self.height <= height.min(OF_LONGEST * self.lengths[self.longest])
    }
}

/// A mesh from which needles and caps are removed.
struct Removal {
    positions: Vec<DVec3>,
    connectivity: Connectivity,
    provenance: Provenance,
    height: f64,
}

impl Removal {
    /// Removes these triangles, and those that become needles or caps in the process, where possible. Returns how many were
    /// removed.
    fn remove(&mut self, low: Vec<u32>) -> usize {
        let mut count = 0;
        let mut queue: BinaryHeap<Ranked> = low.into_iter().map(|t| self.ranked(t)).collect();
        while let Some(Ranked { rank, index: t, .. }) = queue.pop() {
            if !self.connectivity.has_half_edge(3 * t) || self.ranked(t).rank != rank || !self.is_low(t) {
                continue;
            }
            let Some(changed) = self.collapsed(t).or_else(|| self.flipped(t)) else { continue };
            count += 1;
            queue.extend(changed.into_iter().filter(|&t| self.is_low(t)).map(|t| self.ranked(t)));
        }
        count
    }

    /// Collapses the shortest edge of `t`, if `t` is a needle that can be removed. Returns the triangles around the
    /// remaining vertex.
    fn collapsed(&mut self, t: u32) -> Option<Vec<u32>> {
        let Height { shortest, longest, lengths, .. } = self.height_of(t);
        if lengths[shortest] > self.height.min(OF_LONGEST * lengths[longest]) {
            return None;
        }
        let h = 3 * t + shortest as u32;
        let c = &self.connectivity;
        let h = c.both_sides(h).find(|&h| c.can_collapse(h) && !self.is_inserted(c.triangle(h)))?;
        let [gone, left] = [c.origin(h), c.target(h)];
        for out in c.outgoing(gone) {
            self.provenance.put_at(out / 3, left, gone);
        }
        self.connectivity.collapse(h);
        Some(self.connectivity.outgoing(left).map(|h| h / 3).collect())
    }

    /// Flips the longest edge of `t`, if that is possible and helps: fewer of the two triangles are low afterwards, or as
    /// many with a shorter edge. Returns the two triangles.
    fn flipped(&mut self, t: u32) -> Option<Vec<u32>> {
        let Height { longest, lengths, .. } = self.height_of(t);
        let h = 3 * t + longest as u32;
        let c = &self.connectivity;
        if !c.can_flip(h) {
            return None;
        }
        let g = c.twin(h);
        let ([a, b, top], across) = (c.triangle(h), c.apex(g));
        if self.is_inserted([a, b, top]) || self.is_inserted([a, b, across]) {
            return None;
        }
        let [low_before, low_after] = [[[a, b, top], [b, a, across]], [[a, across, top], [across, b, top]]]
            .map(|both| both.into_iter().filter(|corners| self.height_between(*corners).is_low(self.height)).count());
        let place = |v: u32| self.positions[v as usize];
        let is_shorter = place(top).distance(place(across)) < lengths[longest];
        if low_after > low_before || low_after == low_before && !is_shorter {
            return None;
        }
        let along = (place(top) - place(a)).dot(place(b) - place(a)) / place(a).distance_squared(place(b));
        self.provenance.put_on_edge(g / 3, top, [a, b], along.clamp(0.0, 1.0));
        self.provenance.take_source(t, g / 3);
        self.connectivity.flip(h);
        Some(vec![t, g / 3])
    }

    /// Returns whether one of these is not a vertex of the source.
    fn is_inserted(&self, vertices: [u32; 3]) -> bool {
        vertices.into_iter().any(|v| self.provenance.vertex(v).is_none())
    }

    fn height_between(&self, corners: [u32; 3]) -> Height {
        Height::of(corners.map(|v| self.positions[v as usize]))
    }

    fn height_of(&self, t: u32) -> Height {
        self.height_between(self.connectivity.triangle(3 * t))
    }

    fn is_low(&self, t: u32) -> bool {
        self.height_of(t).is_low(self.height)
    }

    /// Ranks triangle `t` by the length of its longest edge.
    fn ranked(&self, t: u32) -> Ranked {
        let Height { longest, lengths, .. } = self.height_of(t);
        Ranked::new(lengths[longest], t)
    }

    /// Returns the remaining mesh.
    fn finish(self) -> OrientedManifold {
        let c = &self.connectivity;
        let live: Vec<u32> = (0..c.half_edge_bound() / 3).filter(|&t| c.has_half_edge(3 * t)).collect();
        let (triangles, old) = c.compact();
        let positions = old.iter().map(|&v| self.positions[v as usize]).collect();
        let provenance = self.provenance.select(&old, &live);
        OrientedManifold::trusted(Mesh { positions, triangles }, provenance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::prepare::repair::repair_welded;
    use crate::prepare::welded::Welded;
    use crate::testing::{cube, joined, moved, sphere};
    use glam::dvec3;

    fn repaired(mesh: &Mesh) -> Repaired {
        repair_welded(mesh.positions.clone(), Welded::at_places(mesh))
    }

    fn lowest(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len()).map(|t| Height::of(mesh.corners(t)).height).fold(f64::INFINITY, f64::min)
    }

    /// A unit cube with `count` vertices along one of its edges, offset from it by `off` to either side in turn. Only the
    /// triangle on one side is divided at them; on the other side are caps, fanned from an end of the edge.
    fn cube_with_caps(count: u32, off: f64) -> Mesh {
        let Mesh { mut positions, mut triangles } = cube();
        let [a, b, top] = triangles[0];
        let [from, to] = [a, b].map(|v| positions[v as usize]);
        let aside = (positions[top as usize] - from).normalize();
        let first = positions.len() as u32;
        for i in 0..count {
            let along = f64::from(i + 1) / f64::from(count + 1);
            positions.push(from.lerp(to, along) + if i % 2 == 0 { off } else { -off } * aside);
        }
        let points: Vec<u32> = [a].into_iter().chain(first..first + count).chain([b]).collect();
        triangles.splice(0..1, points.windows(2).map(|ends| [ends[0], ends[1], top]));
        triangles.extend(points.windows(2).skip(1).map(|ends| [a, ends[1], ends[0]]));
        Mesh { positions, triangles }
    }

    #[test]
    fn caps_along_an_edge_go_and_the_cube_stays() {
        for (count, off) in [(1, 0.0), (1, 1e-15), (2, 1e-9), (7, 0.0), (20, 1e-8)] {
            let mesh = cube_with_caps(count, off);
            assert!(topology(mesh.positions.len(), &mesh.triangles).is_oriented() && lowest(&mesh) < 1e-6);
            let made = without_needles(repaired(&mesh));
            assert_eq!(made.repairs.needles as u32, count, "{count} {off}");
            let topology = topology(made.mesh.positions.len(), &made.mesh.triangles);
            assert!(topology.is_manifold() && topology.is_oriented() && topology.euler == 2);
            assert!(lowest(&made.mesh) > 0.01 && (made.mesh.area() - 6.0).abs() < 1e-5);
            assert_eq!(made.twins, twins(&made.mesh.triangles));
        }
    }

    #[test]
    fn a_needle_goes() {
        let Mesh { mut positions, triangles } = cube_with_caps(1, 0.0);
        let last = positions.len() - 1;
        positions[last] = positions[triangles[0][0] as usize] + dvec3(1e-9, 2e-9, -1e-9);
        let made = without_needles(repaired(&Mesh { positions, triangles }));
        assert_eq!((made.repairs.needles, made.mesh.triangles.len(), made.mesh.positions.len()), (1, 12, 8));
        assert!((made.mesh.area() - 6.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_small_but_no_needle_stays() {
        let mut small = sphere();
        small.positions.iter_mut().for_each(|p| *p *= 1e-9);
        let mesh = joined([small, moved(cube(), DVec3::ONE)]);
        let before = repaired(&mesh);
        let after = without_needles(repaired(&mesh));
        assert!(after.mesh == before.mesh && after.repairs == before.repairs && after.twins == before.twins);
    }

    #[test]
    fn points_are_still_traced_to_where_they_were_in_the_input() {
        for (count, off) in [(1, 0.0), (6, 1e-9)] {
            let source = cube_with_caps(count, off);
            let mesh = without_needles(repaired(&source)).mesh;
            for t in 0..mesh.triangles.len() {
                for weights in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.3, 0.5]] {
                    let of = |[a, b, c]: [DVec3; 3], w: [f64; 3]| w[0] * a + w[1] * b + w[2] * c;
                    let here = of(mesh.corners(t), weights);
                    let origin = mesh.provenance().origin(t as u32, mesh.triangles[t], weights, &source.triangles);
                    let there = of(source.corners(origin.triangle as usize), origin.weights);
                    assert!(here.distance(there) < 1e-7, "{t} {weights:?}: {here} {there}");
                }
            }
            let edge = [source.triangles[0][0], source.triangles[count as usize][1]];
            let sides = mesh.provenance().sides_along(&mesh.triangles, &[edge]);
            assert_eq!(sides.into_iter().filter(|is| *is).count() as u32, count + 1);
        }
    }
}
