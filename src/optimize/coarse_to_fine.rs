//! Coarse to fine: fewer irregular vertices by arranging a quarter of them first.
//!
//! Half of all irregular vertices (of a valence other than 6) come from the order of the sampling and not from the
//! curvature of the surface. A mesh of a quarter of the vertices has a quarter of them, and splitting each of its
//! triangles in four adds none. A coarser mesh would lose the surface where it bends within the longer edges, at the ends
//! of spikes and in thin parts: the vertices there are locked and stay dense, and their edges are not split. So are those
//! beside an interface, which stays as dense as it is. Once the edges around are split, a few rings of vertices are
//! ordered anew by ascent where dense and once coarse ones meet. Where the coarse mesh is large, the same is done to it first.
//! Where it went past a part of the surface even so, or its faces cross, the vertices that it was made from come back
//! ([`graft`](crate::optimize::graft)); only where a lost part cannot come back so, all is done again with the vertices there kept.
//!
//! Cost: a heap operation for each edge that is collapsed, and a sort of the edges that may be split.

use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::facing::FacingGuard;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::{OnCurve, next, prev};
use crate::mesh::topology::NONE;
use crate::optimize::counts::{collapse_shortest, split_longest};
use crate::spatial::kdtree::Neighbors;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

/// Cosine of the angle between normals within two rings above which vertices are kept: 120 degrees. At 75 a fifth of the
/// vertices of a detailed model were kept and stayed irregular; above 120 ends of spikes are lost for good.
const BENT: f64 = -0.5;

/// Distance, in spacings of the fine mesh, from places where the coarse one went wrong within which vertices are kept.
const CLEARANCE: f64 = 6.0;

/// Longest edge, relative to what is wanted, of a refined mesh in which all that had to be could be split: most have none above
/// 1.9.
const LONGEST_REFINED: f64 = 2.2;

/// Distance, in spacings, of vertices from a refined mesh that has gone past them: at other long edges they are within half a
/// spacing, on ears, muzzles and paws that were lost at .6 to 1.4.
const MISSED: f64 = 0.5;

/// Above this share of the vertices, ends of longer edges are everywhere and not at single places.
const MOST_LONG: f64 = 0.05;

/// Cosine of the angle between the normals of adjacent vertices above which they are tips, at the end of a spike or a
/// slit: 120 degrees. From 102 on too few around them can move.
const TIP: f64 = -0.5;

/// Width of a smooth patch, in spacings of the fine mesh, below which its vertices are locked: what a coarser mesh gains
/// inside it loses at the curves around.
const NARROW: f64 = 12.0;

/// Largest distance, in spacings of the fine mesh, of a collapsed vertex from the coarse mesh.
const TOLERANCE: f64 = 0.25;

/// Rings beside an interface that stay as dense as it is.
const RINGS_BESIDE_INTERFACE: usize = 2;

/// Rings around dense vertices that are ordered anew with them once the edges around have been split: half of the
/// irregular vertices lie where the two meet, and more rings do not remove more of them.
const RINGS_OF_TRANSITION: usize = 4;

/// Cosine of the angle at which a vertex that is too near sees an edge of the interface: 105 degrees.
const ENCROACHED: f64 = -0.26;

/// Edges longer than this many fine spacings are to be split: the middle, in ratio, between one spacing and two.
const SPLIT_ABOVE: f64 = std::f64::consts::SQRT_2;

/// The vertices that a coarser mesh needs: those in `kept`, those where the surface bends, and those beside an interface.
pub fn indispensable(mesh: &Manifold, kept: &VertexSet) -> VertexSet {
    &(&mesh.bent(BENT) | kept) | &beside_interface(mesh)
}

/// The vertices of `fine` around edges of `refined`, which was made of it, that are still as long as those of a coarse mesh, where
/// that has gone past some of them. A part of the surface, an ear or a fin, was lost, and such edges cannot be split. None where
/// such edges are everywhere, as in a part of narrow strips.
pub fn missed(fine: &Manifold, refined: &Manifold, spacing: f64) -> VertexSet {
    let longest = LONGEST_REFINED * LONGEST_REFINED * spacing * spacing;
    let is_long = |h: &u32| refined.connectivity.can_split(*h) && refined.relative_length_squared(*h) > longest;
    let ends = |h: u32| [refined.connectivity.origin(h), refined.connectivity.target(h)].map(|v| refined.position(v));
    let places: Vec<DVec3> = refined.edges().filter(is_long).flat_map(ends).collect();
    let are_everywhere = places.len() as f64 > MOST_LONG * refined.connectivity.vertex_count() as f64;
    if places.is_empty() || are_everywhere {
        return VertexSet::EMPTY;
    }
    let faces = Faces::new(refined);
    let positions: Vec<DVec3> = fine.samples.iter().map(|s| s.position).collect();
    let neighbors = Neighbors::new(&positions);
    let around = |p: &DVec3| -> Vec<u32> {
        let mut found = Vec::new();
        neighbors.collect_within(*p, CLEARANCE * spacing, &mut found);
        found.into_iter().map(|n| n.point).filter(|&v| fine.connectivity.has_vertex(v)).collect()
    };
    let asked: VertexSet = places.iter().flat_map(around).collect();
    let is_left_alone = |v: u32| {
        let Sample { position, size, .. } = fine.samples[v as usize];
        asked.contains(v) && !faces.any_within(position, MISSED * spacing * size)
    };
    let left_alone = VertexSet::new(fine, is_left_alone);
    let of_part = places.iter().map(around).filter(|around| around.iter().any(|&v| left_alone.contains(v)));
    of_part.flatten().collect()
}

/// Collapses vertices so near to an edge of the interface that they see it at an obtuse angle. Nothing there can flip or
/// move out of their way.
///
/// J. Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, 1995, DOI
/// 10.1006/jagm.1995.1021, calls such edges encroached, and splits them.
pub fn remove_encroaching_vertices(mesh: &mut Manifold) {
    let mut changed = true;
    while std::mem::take(&mut changed) {
        let on_interface = |mesh: &Manifold, h: u32| mesh.connectivity.curve(h) == OnCurve::Interface;
        for h in mesh.half_edges().filter(|&h| on_interface(mesh, h)).collect::<Vec<u32>>() {
            // Flips after a collapse may have given the number to another half-edge.
            let is_there = mesh.connectivity.has_half_edge(h) && on_interface(mesh, h);
            if let Some(into) = (is_there && is_encroached(mesh, h)).then(|| way_out(mesh, h)).flatten() {
                mesh.collapse(into);
                changed = true;
            }
        }
    }
}

/// Whether a vertex that is free to go sees the edge of `h` at an obtuse angle.
fn is_encroached(mesh: &Manifold, h: u32) -> bool {
    let [a, b, top] = mesh.connectivity.triangle(h);
    let [p, q] = [a, b].map(|v| (mesh.position(v) - mesh.position(top)).normalize_or_zero());
    !mesh.connectivity.is_on_curve(top) && p.dot(q) < ENCROACHED
}

/// The half-edge along which the vertex across from the edge of `h` can merge into the nearer end of that, or the other.
fn way_out(mesh: &Manifold, h: u32) -> Option<u32> {
    let c = &mesh.connectivity;
    let mut ways = [prev(h), c.twin(next(h))];
    ways.sort_by(|&g, &h| mesh.length_squared(g).total_cmp(&mesh.length_squared(h)));
    ways.into_iter().find(|&h| c.can_collapse(h) && FacingGuard::SOUND.passes(mesh.bend_after_collapse(h)))
}

/// The vertices on an interface and in the rings beside it.
fn beside_interface(mesh: &Manifold) -> VertexSet {
    VertexSet::new(mesh, |v| mesh.connectivity.is_on_interface(v)).with_rings(mesh, RINGS_BESIDE_INTERFACE)
}

/// The vertices in patches, between curves, that are too narrow for a coarser mesh, and those on the curves around them.
pub fn narrow(domain: &Domain, mesh: &Manifold, spacing: f64) -> VertexSet {
    let narrow: Vec<bool> = domain.widths().into_iter().map(|width| width < NARROW * spacing).collect();
    let c = &mesh.connectivity;
    let own = |v: u32| narrow[domain.patch_of(mesh.samples[v as usize].triangle) as usize];
    let is_narrow = |v: u32| own(v) || c.is_on_curve(v) && c.ring(v).any(|w| !c.is_on_curve(w) && own(w));
    VertexSet::new(mesh, is_narrow)
}

/// The vertices at the end of a spike or a slit. Ascent would draw those around into a fan, relaxation would move them
/// away from the end.
pub fn tips(mesh: &Manifold) -> VertexSet {
    let c = &mesh.connectivity;
    let normal = |v: u32| mesh.samples[v as usize].normal;
    VertexSet::new(mesh, |v| c.ring(v).any(|w| normal(w).dot(normal(v)) < TIP))
}

/// Leaves the [`indispensable`] vertices and those in narrow patches dense, and collapses the others until splitting the
/// edges again would give about as many vertices. `spacing` is that of the fine mesh. The dense vertices, and the old number of
/// each vertex.
pub fn coarsen(domain: &Domain, mesh: &mut Manifold, spacing: f64, kept: &VertexSet) -> (VertexSet, Vec<u32>) {
    let dense = &narrow(domain, mesh, spacing) | &indispensable(mesh, kept);
    let coarse = dense.len() + mesh.connectivity.vertex_count().saturating_sub(dense.len()) / 4;
    coarsen_curves(mesh, &dense, spacing);
    collapse(mesh, &dense, coarse, spacing);
    let (ordered, old) = mesh.in_spatial_order();
    *mesh = ordered;
    (dense.renumbered(&old), old)
}

/// Collapses or splits edges such that splitting all long ones will give about `wanted` vertices, now that the vertices
/// have moved. The `dense` vertices stay.
pub fn match_target_count(domain: &Domain, mesh: &mut Manifold, dense: &VertexSet, wanted: usize, spacing: f64) {
    let count = mesh.connectivity.vertex_count();
    let expected = count + long_edges(mesh, spacing);
    // Every vertex of the coarse mesh has three edges.
    if expected > wanted {
        collapse(mesh, dense, count - (expected - wanted) / 4, spacing);
    } else {
        split_longest(domain, mesh, count + (wanted - expected) / 4);
    }
}

/// Splits the longest edges, as many as it takes to have `wanted` vertices. The old number of each vertex; new ones have none.
pub fn split_to(domain: &Domain, mesh: &mut Manifold, wanted: usize) -> Vec<u32> {
    let (_, old) = mesh.connectivity.compact();
    let finer = mesh.with_longest_split(domain, wanted.saturating_sub(old.len()));
    let (ordered, split) = finer.in_spatial_order();
    *mesh = ordered;
    split.into_iter().map(|v| old.get(v as usize).copied().unwrap_or(NONE)).collect()
}

/// The vertices that are to be ordered anew once the edges around the `dense` vertices have been split: these and a few
/// rings around them, without tips, and without narrow patches, which have been ordered as a whole.
pub fn transition(domain: &Domain, mesh: &Manifold, dense: VertexSet, spacing: f64) -> VertexSet {
    let around = dense.with_rings(mesh, RINGS_OF_TRANSITION);
    let settled = &narrow(domain, mesh, spacing) | &tips(mesh);
    VertexSet::new(mesh, |v| around.contains(v) && !settled.contains(v))
}

fn long_edges(mesh: &Manifold, spacing: f64) -> usize {
    let longest = SPLIT_ABOVE * SPLIT_ABOVE * spacing * spacing;
    let may_split = |h: u32| mesh.connectivity.can_split(h) && mesh.relative_length_squared(h) > longest;
    mesh.edges().filter(|&h| may_split(h)).count()
}

/// Takes every other vertex out of each curve, so that splitting puts as many back.
fn coarsen_curves(mesh: &mut Manifold, dense: &VertexSet, spacing: f64) {
    for chain in mesh.curve_chains() {
        for pair in chain[1..chain.len() - 1].chunks(2) {
            let c = &mesh.connectivity;
            let along = c.outgoing(pair[0]).find(|&h| c.curve(h) == c.curve_at(pair[0]));
            if let Some(h) = along.filter(|&h| c.can_collapse(h) && keeps_shape(mesh, dense, h, spacing)) {
                mesh.collapse(h);
            }
        }
    }
}

/// Whether the mesh is still that of the same surface if the origin of `h`, which is not `dense`, merges into its target.
fn keeps_shape(mesh: &Manifold, dense: &VertexSet, h: u32, spacing: f64) -> bool {
    let origin = mesh.connectivity.origin(h);
    !dense.contains(origin)
        && FacingGuard::SOUND.passes(mesh.bend_after_collapse(h))
        && mesh.distance_after_collapse(h) <= TOLERANCE * spacing * mesh.samples[origin as usize].size
}

fn collapse(mesh: &mut Manifold, dense: &VertexSet, wanted: usize, spacing: f64) {
    collapse_shortest(mesh, wanted, |mesh, h| {
        !mesh.connectivity.is_on_curve(mesh.connectivity.origin(h)) && keeps_shape(mesh, dense, h, spacing)
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::grid;
    use glam::dvec3;

    #[test]
    fn vertices_are_missed_around_an_edge_that_could_not_be_split() {
        let (across, spacing) = (40, 0.1);
        let sheet = grid(across, across, |u, v| spacing * f64::from(across) * dvec3(u, v, 0.0));
        let sample = |&position: &DVec3| Sample { position, normal: DVec3::Z, triangle: 0, size: 1.0 };
        let fine = Manifold::new(sheet.positions.iter().map(sample).collect(), &sheet.triangles);
        assert!(missed(&fine, &fine, spacing).is_empty());
        let mut refined = fine.clone();
        let nearest_to =
            |p: DVec3| (0..).zip(&sheet.positions).min_by(|a, b| p.distance(*a.1).total_cmp(&p.distance(*b.1)));
        let (v, &there) = nearest_to(dvec3(1.0, 1.0, 0.0)).unwrap();
        refined.samples[v as usize].position += 2.5 * spacing * DVec3::Z;
        let missed = missed(&fine, &refined, spacing);
        for (w, p) in (0..).zip(&sheet.positions) {
            let away = p.distance(there);
            assert!(missed.contains(w) == (away < 0.55) || (0.5..0.8).contains(&away), "{away}");
        }
    }
}
