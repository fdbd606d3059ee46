//! Coarse to fine: fewer irregular vertices by arranging a quarter of them first.
//!
//! Half of all irregular vertices (of a valence other than 6) come from the order of the sampling and not from the
//! curvature of the surface. A mesh of a quarter of the vertices has a quarter of them, and splitting each of its
//! triangles in four adds none. Where the surface bends within the longer edges, at tips and in thin parts, a coarser
//! mesh would lose it: the vertices there are fixed, stay as dense as they are, and their edges are not split. So are those
//! beside an interface, which stays as dense as it is. Once the edges around are split, dense and once coarse vertices meet in no
//! order; a few rings of both are freed for ascent.
//!
//! Cost: a heap operation for each edge that is collapsed, and a sort of the edges that may be split.

use crate::manifold::Manifold;
use crate::mesh::half_edge::{INTERFACE, next, prev};
use crate::mesh::topology::NONE;
use crate::optimize::counts::{collapse_shortest, split_longest};
use crate::spatial::kdtree::Neighbors;
use crate::spatial::self_intersections::self_intersections;
use crate::surface::domain::Domain;
use glam::DVec3;

/// Cosine of the turn of the surface within two rings from which on vertices are kept: 120 degrees. At 75 a fifth of the
/// vertices of a detailed model were kept and stayed irregular; above 120 tips are lost that are not found again.
const BENT: f64 = -0.5;

/// Distance, in spacings of the fine mesh, from faces of the coarse one that cross, within which vertices are kept.
const CLEARANCE: f64 = 6.0;

/// Cosine of the turn of the surface within an edge from which on a vertex is at a tip, the end of a spike or a slit: 120
/// degrees. From 102 on too few around it can move.
const TIP: f64 = -0.5;

/// Width of a patch in spacings of the fine mesh below which its vertices are fixed: what a coarser mesh gains inside it
/// loses at the curves around.
const NARROW: f64 = 12.0;

/// Least cosine between a triangle of the coarse mesh and the surface at any of its corners: 72 degrees.
const LEAST_FACING: f64 = 0.3;

/// How far, in spacings of the fine mesh, a vertex that is collapsed may be from the coarse one.
const TOLERANCE: f64 = 0.25;

/// Rings beside an interface that stay as dense as it is.
const RINGS_BESIDE_INTERFACE: usize = 2;

/// Rings around vertices that stayed dense that are ordered anew with them once the edges around have been split: half of
/// the irregular vertices lie where the two meet, and more rings do not get rid of more of them.
const RINGS_OF_TRANSITION: usize = 4;

/// Cosine of the angle at which a vertex that is too near sees an edge of the interface: 105 degrees.
const ENCROACHED: f64 = -0.26;

/// Edges longer than this many fine spacings are to be split: the middle, in ratio, between one spacing and two.
const SPLIT_ABOVE: f64 = std::f64::consts::SQRT_2;

/// Fixes all vertices but those in patches too narrow for a coarser mesh; whether there are any.
pub fn fix_all_but_narrow(domain: &Domain, mesh: &mut Manifold, spacing: f64) -> bool {
    mesh.fixed = narrow(domain, mesh, spacing).into_iter().map(|narrow| !narrow).collect();
    mesh.fixed.iter().any(|fixed| !fixed)
}

/// The vertices that a coarser mesh could not do without: those that are `kept`, and those where the surface bends or that
/// are beside an interface.
pub fn indispensable(mesh: &Manifold, kept: &[bool]) -> Vec<bool> {
    let bent_or_kept = mesh.bent(BENT).into_iter().zip(kept).map(|(bent, kept)| bent || *kept);
    bent_or_kept.zip(beside_interface(mesh)).map(|(dense, beside)| dense || beside).collect()
}

/// Adds to `kept` the vertices of `mesh` around the faces of `coarse` that cross: the surface is a wall there that is
/// too thin for such large faces. Whether there are any.
pub fn keep_where_crossing(kept: &mut [bool], mesh: &Manifold, coarse: &Manifold, spacing: f64) -> bool {
    let coarse = coarse.to_mesh();
    let crossing = self_intersections(&coarse);
    if crossing.is_empty() {
        return false;
    }
    let positions: Vec<DVec3> = mesh.samples.iter().map(|s| s.position).collect();
    let neighbors = Neighbors::new(&positions);
    for p in crossing.into_iter().flat_map(|t| coarse.corners(t as usize)) {
        let near = neighbors.within(p, CLEARANCE * spacing);
        near.into_iter().for_each(|n| kept[n.point as usize] = mesh.connectivity.has_vertex(n.point));
    }
    true
}

/// Takes vertices out that are so near to an edge of the interface that they see it at an obtuse angle. Nothing there can
/// flip or move out of their way.
///
/// J. Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, 1995, DOI
/// 10.1006/jagm.1995.1021, calls such edges encroached, and splits them.
pub fn remove_encroaching_vertices(mesh: &mut Manifold) {
    let mut changed = true;
    while std::mem::take(&mut changed) {
        for h in mesh.half_edges().filter(|&h| mesh.connectivity.curve(h) == INTERFACE).collect::<Vec<u32>>() {
            // Flips after a collapse may have given the number to another half-edge.
            let is_there = mesh.connectivity.has_half_edge(h) && mesh.connectivity.curve(h) == INTERFACE;
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
    mesh.connectivity.curve_at(top) == NONE && p.dot(q) < ENCROACHED
}

/// The half-edge along which the vertex across from the edge of `h` can merge into the nearer end of that, or the other.
fn way_out(mesh: &Manifold, h: u32) -> Option<u32> {
    let c = &mesh.connectivity;
    let mut ways = [prev(h), c.twin(next(h))];
    ways.sort_by(|&g, &h| mesh.length_squared(g).total_cmp(&mesh.length_squared(h)));
    ways.into_iter().find(|&h| c.can_collapse(h) && mesh.bend_after_collapse(h) >= LEAST_FACING)
}

/// The vertices on an interface and in the rings beside it.
fn beside_interface(mesh: &Manifold) -> Vec<bool> {
    let c = &mesh.connectivity;
    let on_interface = (0..c.vertex_bound()).map(|v| c.has_vertex(v) && c.is_on_interface(v)).collect();
    with_rings(mesh, on_interface, RINGS_BESIDE_INTERFACE)
}

/// The vertices of `set` and of that many rings around it.
fn with_rings(mesh: &Manifold, mut set: Vec<bool>, rings: usize) -> Vec<bool> {
    let c = &mesh.connectivity;
    for _ in 0..rings {
        let is_next = |v: u32| c.has_vertex(v) && (set[v as usize] || c.ring(v).any(|w| set[w as usize]));
        set = (0..c.vertex_bound()).map(is_next).collect();
    }
    set
}

/// The vertices in patches, between curves, that are too narrow for a coarser mesh, and those on the curves around them.
pub fn narrow(domain: &Domain, mesh: &Manifold, spacing: f64) -> Vec<bool> {
    let narrow: Vec<bool> = domain.widths().into_iter().map(|width| width < NARROW * spacing).collect();
    let c = &mesh.connectivity;
    let own = |v: u32| narrow[domain.patch_of(mesh.samples[v as usize].triangle) as usize];
    let is_narrow = |v: u32| own(v) || c.curve_at(v) != NONE && c.ring(v).any(|w| c.curve_at(w) == NONE && own(w));
    (0..c.vertex_bound()).map(|v| c.has_vertex(v) && is_narrow(v)).collect()
}

/// Fixes the tips alone: the vertices at which the surface turns away within an edge.
pub fn fix_tips(mesh: &mut Manifold) {
    mesh.fixed = tips(mesh);
}

/// The vertices at which the surface turns away within an edge: ascent would draw those around into a fan, relaxation
/// would take them from the end of their spike.
fn tips(mesh: &Manifold) -> Vec<bool> {
    let c = &mesh.connectivity;
    let normal = |v: u32| mesh.samples[v as usize].normal;
    let is_tip = |v: u32| c.ring(v).any(|w| normal(w).dot(normal(v)) < TIP);
    (0..c.vertex_bound()).map(|v| c.has_vertex(v) && is_tip(v)).collect()
}

/// Fixes the [`indispensable`] vertices and those in narrow patches, and collapses the others until splitting what is left
/// would give about as many vertices again. `spacing` is that of the fine mesh.
pub fn coarsen(domain: &Domain, mesh: &mut Manifold, spacing: f64, kept: &[bool]) {
    let narrow = narrow(domain, mesh, spacing);
    mesh.fixed = narrow.into_iter().zip(indispensable(mesh, kept)).map(|(narrow, kept)| narrow || kept).collect();
    let fixed = mesh.fixed.iter().filter(|f| **f).count();
    let coarse = fixed + mesh.connectivity.vertex_count().saturating_sub(fixed) / 4;
    coarsen_curves(mesh, spacing);
    collapse(mesh, coarse, spacing);
    *mesh = mesh.without_gaps();
}

/// Collapses or splits edges such that splitting all long ones will give about `wanted` vertices, now that the vertices
/// have moved.
pub fn match_target_count(domain: &Domain, mesh: &mut Manifold, wanted: usize, spacing: f64) {
    let count = mesh.connectivity.vertex_count();
    let expected = count + long_edges(mesh, spacing);
    // Every vertex of the coarse mesh has three edges.
    if expected > wanted {
        collapse(mesh, count - (expected - wanted) / 4, spacing);
    } else {
        split_longest(domain, mesh, count + (wanted - expected) / 4);
    }
}

/// The mesh with its longest edges split, as many as it takes to have `wanted` vertices. Free are those that were fixed,
/// because they are dense already, and a few rings around them, but for tips and for narrow patches, which have been ordered
/// as a whole; all others are fixed.
pub fn split_to(domain: &Domain, mesh: &Manifold, wanted: usize, spacing: f64) -> Manifold {
    let (_, old) = mesh.connectivity.compact();
    let mut finer = mesh.with_longest_split(domain, wanted.saturating_sub(old.len()));
    let mut dense: Vec<bool> = old.iter().map(|&v| mesh.fixed[v as usize]).collect();
    dense.resize(finer.samples.len(), false);
    let dense = with_rings(&finer, dense, RINGS_OF_TRANSITION);
    let (narrow, at_tip) = (narrow(domain, &finer, spacing), tips(&finer));
    finer.fixed = (0..dense.len()).map(|v| !dense[v] || narrow[v] || at_tip[v]).collect();
    finer
}

fn long_edges(mesh: &Manifold, spacing: f64) -> usize {
    let longest = SPLIT_ABOVE * SPLIT_ABOVE * spacing * spacing;
    let may_split = |h: u32| mesh.connectivity.can_split(h) && mesh.relative_length_squared(h) > longest;
    mesh.edges().filter(|&h| may_split(h)).count()
}

/// Takes every other vertex out of each curve, so that splitting puts as many back.
fn coarsen_curves(mesh: &mut Manifold, spacing: f64) {
    for chain in mesh.curve_chains() {
        for pair in chain[1..chain.len() - 1].chunks(2) {
            let c = &mesh.connectivity;
            let along = c.outgoing(pair[0]).find(|&h| c.curve(h) == c.curve_at(pair[0]));
            if let Some(h) = along.filter(|&h| c.can_collapse(h) && keeps_shape(mesh, h, spacing)) {
                mesh.collapse(h);
            }
        }
    }
}

/// Whether the mesh is still that of the same surface if the origin of `h` merges into its target.
fn keeps_shape(mesh: &Manifold, h: u32, spacing: f64) -> bool {
    let origin = mesh.connectivity.origin(h) as usize;
    !mesh.fixed[origin]
        && mesh.bend_after_collapse(h) >= LEAST_FACING
        && mesh.distance_after_collapse(h) <= TOLERANCE * spacing * mesh.samples[origin].size
}

fn collapse(mesh: &mut Manifold, wanted: usize, spacing: f64) {
    collapse_shortest(mesh, wanted, |mesh, h| {
        mesh.connectivity.curve_at(mesh.connectivity.origin(h)) == NONE && keeps_shape(mesh, h, spacing)
    });
}
