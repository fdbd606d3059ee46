//! Separates the chords of patches that would become one edge.
//!
//! A chord is an inner edge of a patch between two points on its rim. Where patches are narrow, two of them can have a chord
//! between the same points, or one can have a chord between adjacent points on a curve: glued together, that edge would have
//! four triangles. The second such chord is flipped if that leaves triangles that can be mended; otherwise it is split. The
//! same applies to a chord from a point to itself, and to edges to one inner vertex from a point that is on the rim of the
//! patch twice, on both sides of a slit.
//!
//! Cost: linear in the edges.

use crate::manifold::facing::FacingGuard;
use crate::mesh::topology::NONE;
use crate::surface::domain::Domain;
use crate::triangulate::stitch::Gluing;
use crate::triangulate::triangulation::Triangulated;
use std::collections::{HashSet, VecDeque};

/// Flips or splits chords of `patches`, which lie on `domain`, so that no two of them become one edge when they are glued.
pub fn part_chords(domain: &Domain, patches: &mut Triangulated, seams: Gluing<'_>) {
    let Triangulated { mesh, source, .. } = patches;
    let points = seams.point.iter().max().map_or(0, |&p| p + 1);
    let point = |v: u32| source.get(v as usize).and_then(|&s| seams.point.get(s as usize)).copied();
    // Points come before inner vertices.
    let named = |v: u32| point(v).unwrap_or(points + v);
    let edge = |v: u32, w: u32| [named(v).min(named(w)), named(v).max(named(w))];
    // Only looked up, never iterated.
    let mut joined: HashSet<[u32; 2]> = seams.edges.iter().map(|&([p, q], _)| [p.min(q), p.max(q)]).collect();
    let is_new = |joined: &mut HashSet<[u32; 2]>, [p, q]: [u32; 2]| p >= points || p != q && joined.insert([p, q]);
    let inner = mesh.edges().filter(|&h| mesh.connectivity.has_twin(h));
    // Flips renumber half-edges.
    let mut ends: VecDeque<[u32; 2]> =
        inner.map(|h| [mesh.connectivity.origin(h), mesh.connectivity.target(h)]).collect();
    while let Some([v, w]) = ends.pop_front() {
        if is_new(&mut joined, edge(v, w)) {
            continue;
        }
        let c = &mesh.connectivity;
        let Some(h) = c.outgoing(v).find(|&h| c.target(h) == w) else { continue };
        let across = edge(c.apex(h), c.apex(c.twin(h)));
        if mesh.flip_leaves_mendable(h, FacingGuard::SOUND) && is_new(&mut joined, across) {
            mesh.connectivity.flip(h);
        } else {
            let middle = mesh.split_anyhow(domain, h);
            ends.extend(mesh.connectivity.ring(middle).map(|w| [middle, w]));
        }
    }
    source.resize(mesh.samples().len(), NONE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifold::Manifold;
    use crate::mesh::half_edge::OnCurve;
    use crate::surface::domain::{Domain, Sample};
    use crate::testing::grid;
    use crate::triangulate::stitch::glue;
    use glam::{DVec3, dvec3};

    /// Both sides of a square plate without thickness, whose rim is a curve through its corners. `across` has the ends of
    /// the diagonal of its lower side, `last` its fourth corner.
    fn plate(across: [u32; 2], last: (f64, f64)) -> (Domain, Triangulated) {
        let domain = Domain::new(grid(4, 4, |u, v| dvec3(u, v, 0.0)).try_into().unwrap());
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), last];
        let side =
            |normal: DVec3| corners.map(|(x, y)| Sample { position: dvec3(x, y, 0.0), normal, triangle: 0, size: 1.0 });
        let samples = [side(DVec3::Z), side(-DVec3::Z)].concat();
        let below = if across == [0, 2] { [[6, 5, 4], [4, 7, 6]] } else { [[4, 7, 5], [5, 7, 6]] };
        let mesh = Manifold::new(samples, &[[0, 1, 2], [0, 2, 3], below[0], below[1]]);
        (domain, Triangulated { mesh, source: (0..8).collect(), tessellated_patches: 0 })
    }

    fn glued(across: [u32; 2], last: (f64, f64)) -> (usize, bool) {
        let (domain, mut patches) = plate(across, last);
        let edges: Vec<([u32; 2], OnCurve)> =
            [[0, 1], [1, 2], [2, 3], [3, 0]].into_iter().map(|ends| (ends, OnCurve::Curve(0))).collect();
        let seams = Gluing { point: &[0, 1, 2, 3, 0, 1, 2, 3], edges: &edges, corners: &[0, 1, 2, 3], spikes: 0 };
        part_chords(&domain, &mut patches, seams);
        (patches.mesh.connectivity.compact().0.len(), glue(&patches, seams).is_ok())
    }

    #[test]
    fn of_two_chords_between_the_same_points_one_is_flipped() {
        assert_eq!(glued([0, 2], (0.0, 1.0)), (4, true));
        assert_eq!(glued([1, 3], (0.0, 1.0)), (4, true));
    }

    /// A square with a slit from its left side. A point on both sides of the slit has edges to the vertex `x` beyond its
    /// end, or to itself.
    fn glued_slit(around_end: [[u32; 3]; 2]) -> bool {
        let domain = Domain::new(grid(4, 4, |u, v| dvec3(6.0 * u - 3.0, 6.0 * v - 3.0, 0.0)).try_into().unwrap());
        let slit = [(-2.0, 0.0), (-1.0, 0.3), (0.0, 0.0), (-1.0, -0.3), (-2.0, 0.0)];
        let square = [(-2.0, -1.0), (2.0, -1.0), (2.0, 1.0), (-2.0, 1.0), (1.0, 0.0)];
        let at = |(x, y)| Sample { position: dvec3(x, y, 0.0), normal: DVec3::Z, triangle: 0, size: 1.0 };
        let above = [[0, 1, 8], [1, 9, 8], [9, 7, 8], [9, 6, 7]];
        let below = [[9, 5, 6], [3, 5, 9], [4, 5, 3]];
        let triangles = [above.as_slice(), &below, &around_end].concat();
        let mesh = Manifold::new(slit.into_iter().chain(square).map(at).collect(), &triangles);
        let mut patches = Triangulated { mesh, source: (0..10).collect(), tessellated_patches: 0 };
        let ends = [[0, 1], [1, 2], [0, 3], [3, 4], [4, 5], [5, 6], [6, 0]];
        let edges = ends.map(|ends| (ends, OnCurve::Curve(0)));
        let seams = Gluing { point: &[0, 1, 2, 1, 0, 3, 4, 5, 6], edges: &edges, corners: &[0, 2], spikes: 0 };
        assert!(glue(&patches, seams).is_err());
        part_chords(&domain, &mut patches, seams);
        glue(&patches, seams).is_ok()
    }

    #[test]
    fn edges_from_both_sides_of_a_slit_do_not_become_one() {
        assert!(glued_slit([[1, 2, 9], [2, 3, 9]]));
    }

    #[test]
    fn an_edge_across_the_end_of_a_slit_goes() {
        assert!(glued_slit([[1, 2, 3], [1, 3, 9]]));
    }

    #[test]
    fn where_a_flip_would_leave_a_needle_the_chord_is_split() {
        assert_eq!(glued([0, 2], (0.02, 0.05)), (6, true));
    }
}
