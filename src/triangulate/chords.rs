//! Parts the chords of patches that would become one edge.
//!
//! A chord is an inner edge of a patch between two points on its rim. Where patches are narrow two of them can have a chord
//! between the same points, or one a chord between neighbours on a curve: glued together, that edge would have four
//! triangles. The second such chord is flipped if that leaves triangles that can be mended, else split.
//!
//! Cost: linear in the edges.

use crate::manifold::facing::FacingGuard;
use crate::mesh::topology::NONE;
use crate::surface::domain::Domain;
use crate::triangulate::stitch::Gluing;
use crate::triangulate::triangulation::Triangulated;
use std::collections::HashSet;

/// Flips or splits chords of `patches`, which lie on `domain`, such that no two are one edge once they are glued.
pub fn part_chords(domain: &Domain, patches: &mut Triangulated, seams: Gluing<'_>) {
    let Triangulated { mesh, source, .. } = patches;
    let point = |v: u32| source.get(v as usize).and_then(|&s| seams.point.get(s as usize)).copied();
    let between = |v: u32, w: u32| point(v).zip(point(w)).map(|(p, q)| [p.min(q), p.max(q)]);
    // Only looked up, never iterated.
    let mut joined: HashSet<[u32; 2]> = seams.edges.iter().map(|&([p, q], _)| [p.min(q), p.max(q)]).collect();
    let inner = mesh.edges().filter(|&h| mesh.connectivity.has_twin(h));
    // Flips give half-edges other numbers.
    let ends: Vec<[u32; 2]> = inner.map(|h| [mesh.connectivity.origin(h), mesh.connectivity.target(h)]).collect();
    for [v, w] in ends {
        let c = &mesh.connectivity;
        if between(v, w).is_none_or(|chord| joined.insert(chord)) {
            continue;
        }
        let Some(h) = c.outgoing(v).find(|&h| c.target(h) == w) else { continue };
        let across = between(c.apex(h), c.apex(c.twin(h)));
        if mesh.flip_leaves_mendable(h, FacingGuard::SOUND) && across.is_none_or(|ends| joined.insert(ends)) {
            mesh.connectivity.flip(h);
        } else {
            mesh.split_anyhow(domain, h);
        }
    }
    source.resize(mesh.samples.len(), NONE);
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

    /// Both sides of a square plate without thickness, whose rim is a curve through its corners. `across` are the ends of
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

    #[test]
    fn where_a_flip_would_leave_a_needle_the_chord_is_split() {
        assert_eq!(glued([0, 2], (0.02, 0.05)), (6, true));
    }
}
