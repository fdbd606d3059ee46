//! Coarse to fine: reduces irregular vertices by arranging a quarter of the vertices first.
//!
//! Half of all irregular vertices (those of a valence other than 6) come from the order of the sampling and not from the
//! curvature of the surface. A mesh of a quarter of the vertices has a quarter of them, and splitting each of its triangles
//! in four adds none. A coarser mesh would lose the surface where it bends within the longer edges, at the ends of spikes
//! and in thin parts: the vertices there are locked and stay dense, and their edges are not split. The same holds for
//! vertices beside an interface, which keeps its density. Once the edges around are split, a few rings of vertices are
//! ordered anew by ascent where dense and formerly coarse ones meet. If the coarse mesh is large, it is first coarsened in
//! the same way. Where it still missed a part of the surface, or its faces cross, the vertices that it was made from are
//! restored ([`graft`](crate::optimize::graft)). Only where a lost part cannot be restored is everything repeated with the
//! vertices there kept.
//!
//! Cost: a heap operation for each collapsed edge, and a sort of the edges that may be split.

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

/// Cosine of the angle between normals within two rings above which vertices are kept: 120 degrees. At 75 degrees, a fifth
/// of the vertices of a detailed model were kept and stayed irregular; above 120, ends of spikes are lost for good.
const BENT: f64 = -0.5;

/// Distance, in spacings of the fine mesh, from places where the coarse mesh went wrong, within which vertices are kept.
const CLEARANCE: f64 = 6.0;

/// Longest edge, relative to the target edge length, of a refined mesh in which every necessary split was possible. Most
/// have none above 1.9.
const LONGEST_REFINED: f64 = 2.2;

/// Distance, in spacings, beyond which a refined mesh has missed a vertex. At other long edges, vertices are within half a
/// spacing of it; on lost ears, muzzles and paws, at 0.6 to 1.4.
const MISSED: f64 = 0.5;

/// Above this share of the vertices, ends of long edges are everywhere instead of at single places.
const MOST_LONG: f64 = 0.05;

/// Cosine of the angle between the normals of adjacent vertices above which they are tips, at the end of a spike or slit:
/// 120 degrees. From 102 degrees on, too few vertices around them can move.
const TIP: f64 = -0.5;

/// Width of a smooth patch, in spacings of the fine mesh, below which its vertices are locked: what a coarser mesh gains
/// inside the patch, it loses at the curves around it.
const NARROW: f64 = 12.0;

/// Maximum distance, in spacings of the fine mesh, of a collapsed vertex from the coarse mesh.
const TOLERANCE: f64 = 0.25;

/// Number of rings beside an interface that keep its density.
const RINGS_BESIDE_INTERFACE: usize = 2;

/// Number of rings around dense vertices that are ordered anew with them once the edges around have been split. Half of the
/// irregular vertices lie where the two meet, and more rings do not remove more of them.
const RINGS_OF_TRANSITION: usize = 4;

/// Cosine of the angle at which an encroaching vertex sees an edge of the interface: 105 degrees.
const ENCROACHED: f64 = -0.26;

/// Length, in fine spacings, above which edges are to be split: the geometric mean of one spacing and two.
const SPLIT_ABOVE: f64 = std::f64::consts::SQRT_2;

/// Returns the vertices that a coarser mesh needs: those in `kept`, those where the surface bends, and those beside an
/// interface.
pub fn indispensable(mesh: &Manifold, kept: &VertexSet) -> VertexSet {
    &(&mesh.bent(BENT) | kept) | &beside_interface(mesh)
}

/// Returns the vertices of `fine` around parts of the surface, such as ears or fins, that were lost in `refined`, which was
/// made from it. There, edges that cannot be split are still as long as those of a coarse mesh, and vertices of `fine` are
/// far from the mesh. Returns none if such edges are everywhere, as in a part of narrow strips.
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
    let positions: Vec<DVec3> = fine.samples().iter().map(|s| s.position).collect();
    let neighbors = Neighbors::new(&positions);
    let around = |p: &DVec3| -> Vec<u32> {
        let mut found = Vec::new();
        neighbors.collect_within(*p, CLEARANCE * spacing, &mut found);
        found.into_iter().map(|n| n.point).filter(|&v| fine.connectivity.has_vertex(v)).collect()
    };
    let asked: VertexSet = places.iter().flat_map(around).collect();
    let is_left_alone = |v: u32| {
        let Sample { position, size, .. } = *fine.sample(v);
        asked.contains(v) && !faces.any_within(position, MISSED * spacing * size)
    };
    let left_alone = VertexSet::new(fine, is_left_alone);
    let of_part = places.iter().map(around).filter(|around| around.iter().any(|&v| left_alone.contains(v)));
    of_part.flatten().collect()
}

/// Collapses encroaching vertices: those so close to an edge of the interface that they see it at an obtuse angle. Nothing
/// there can flip or move out of their way.
///
/// J. Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, 1995, DOI
/// 10.1006/jagm.1995.1021, calls such edges encroached, and splits them.
pub fn remove_encroaching_vertices(mesh: &mut Manifold) {
    let mut changed = true;
    while std::mem::take(&mut changed) {
        let on_interface = |mesh: &Manifold, h: u32| mesh.connectivity.curve(h) == OnCurve::Interface;
        for h in mesh.half_edges().filter(|&h| on_interface(mesh, h)).collect::<Vec<u32>>() {
            // Flips after a collapse may have given this number to another half-edge.
            let is_there = mesh.connectivity.has_half_edge(h) && on_interface(mesh, h);
            if let Some(into) = (is_there && is_encroached(mesh, h)).then(|| way_out(mesh, h)).flatten() {
                mesh.collapse(into);
                changed = true;
            }
        }
    }
}

/// Returns whether a vertex that is on no curve sees the edge of `h` at an obtuse angle.
fn is_encroached(mesh: &Manifold, h: u32) -> bool {
    let [a, b, top] = mesh.connectivity.triangle(h);
    let [p, q] = [a, b].map(|v| (mesh.position(v) - mesh.position(top)).normalize_or_zero());
    !mesh.connectivity.is_on_curve(top) && p.dot(q) < ENCROACHED
}

/// Returns the half-edge along which the vertex opposite the edge of `h` can merge into the nearer end of the edge, or else
/// the other.
fn way_out(mesh: &Manifold, h: u32) -> Option<u32> {
    let c = &mesh.connectivity;
    let mut ways = [prev(h), c.twin(next(h))];
    ways.sort_by(|&g, &h| mesh.length_squared(g).total_cmp(&mesh.length_squared(h)));
    ways.into_iter().find(|&h| c.can_collapse(h) && FacingGuard::SOUND.passes(mesh.bend_after_collapse(h)))
}

/// Returns the vertices on an interface and in the rings beside it.
fn beside_interface(mesh: &Manifold) -> VertexSet {
    VertexSet::new(mesh, |v| mesh.connectivity.is_on_interface(v)).with_rings(mesh, RINGS_BESIDE_INTERFACE)
}

/// Returns the vertices in patches that are too narrow for a coarser mesh, and those on the curves around them.
pub fn narrow(domain: &Domain, mesh: &Manifold, spacing: f64) -> VertexSet {
    let c = &mesh.connectivity;
    let own = |v: u32| domain.widths()[domain.patch_of(mesh.sample(v).triangle) as usize] < NARROW * spacing;
    let is_narrow = |v: u32| own(v) || c.is_on_curve(v) && c.ring(v).any(|w| !c.is_on_curve(w) && own(w));
    VertexSet::new(mesh, is_narrow)
}

/// Returns the vertices at the end of a spike or slit. Ascent would draw the vertices around into a fan, and relaxation
/// would move them away from the end.
pub fn tips(mesh: &Manifold) -> VertexSet {
    let c = &mesh.connectivity;
    let normal = |v: u32| mesh.sample(v).normal;
    VertexSet::new(mesh, |v| c.ring(v).any(|w| normal(w).dot(normal(v)) < TIP))
}

/// Leaves the [`indispensable`] vertices and those in narrow patches dense, and collapses the others until splitting the
/// edges again would restore about the same number of vertices. `spacing` is that of the fine mesh. Returns the dense
/// vertices, and the old number of each vertex.
pub fn coarsen(domain: &Domain, mesh: &mut Manifold, spacing: f64, kept: &VertexSet) -> (VertexSet, Vec<u32>) {
    let dense = &narrow(domain, mesh, spacing) | &indispensable(mesh, kept);
    let coarse = dense.len() + mesh.connectivity.vertex_count().saturating_sub(dense.len()) / 4;
    coarsen_curves(mesh, &dense, spacing);
    collapse(mesh, &dense, coarse, spacing);
    let (ordered, old) = mesh.in_spatial_order();
    *mesh = ordered;
    (dense.renumbered(&old), old)
}

/// Collapses or splits edges so that splitting all long ones will give about `wanted` vertices, now that the vertices have
/// moved. The `dense` vertices stay.
pub fn match_target_count(domain: &Domain, mesh: &mut Manifold, dense: &VertexSet, wanted: usize, spacing: f64) {
    let count = mesh.connectivity.vertex_count();
    let expected = count + long_edges(mesh, spacing);
    // A coarse mesh has three edges per vertex.
    if expected > wanted {
        collapse(mesh, dense, count - (expected - wanted) / 4, spacing);
    } else {
        split_longest(domain, mesh, count + (wanted - expected) / 4);
    }
}

/// Splits as many of the longest edges as it takes to have `wanted` vertices. Returns the old number of each vertex;
/// [`NONE`] for new ones.
pub fn split_to(domain: &Domain, mesh: &mut Manifold, wanted: usize) -> Vec<u32> {
    let (_, old) = mesh.connectivity.compact();
    let finer = mesh.with_longest_split(domain, wanted.saturating_sub(old.len()));
    let (ordered, split) = finer.in_spatial_order();
    *mesh = ordered;
    split.into_iter().map(|v| old.get(v as usize).copied().unwrap_or(NONE)).collect()
}

/// Returns the vertices to be ordered anew once the edges around the `dense` vertices have been split: these and a few rings
/// around them, except tips and narrow patches, which have been ordered as a whole.
pub fn transition(domain: &Domain, mesh: &Manifold, dense: VertexSet, spacing: f64) -> VertexSet {
    if dense.is_empty() {
        return dense;
    }
    let around = dense.with_rings(mesh, RINGS_OF_TRANSITION);
    let arranged = &narrow(domain, mesh, spacing) | &tips(mesh);
    VertexSet::new(mesh, |v| around.contains(v) && !arranged.contains(v))
}

fn long_edges(mesh: &Manifold, spacing: f64) -> usize {
    let longest = SPLIT_ABOVE * SPLIT_ABOVE * spacing * spacing;
    let may_split = |h: u32| mesh.connectivity.can_split(h) && mesh.relative_length_squared(h) > longest;
    mesh.edges().filter(|&h| may_split(h)).count()
}

/// Removes every other vertex from each curve, so that splitting puts as many back.
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

/// Returns whether the origin of `h` is not `dense` and can merge into its target without changing the shape of the mesh
/// much.
fn keeps_shape(mesh: &Manifold, dense: &VertexSet, h: u32, spacing: f64) -> bool {
    let origin = mesh.connectivity.origin(h);
    !dense.contains(origin)
        && FacingGuard::SOUND.passes(mesh.bend_after_collapse(h))
        && mesh.distance_after_collapse(h) <= TOLERANCE * spacing * mesh.sample(origin).size
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
        refined.place_at(v, refined.position(v) + 2.5 * spacing * DVec3::Z);
        let missed = missed(&fine, &refined, spacing);
        for (w, p) in (0..).zip(&sheet.positions) {
            let away = p.distance(there);
            assert!(missed.contains(w) == (away < 0.55) || (0.5..0.8).contains(&away), "{away}");
        }
    }
}
