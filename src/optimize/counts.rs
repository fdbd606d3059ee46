//! Brings a mesh to the wanted number of vertices: splits the longest edges or collapses the shortest, by their length
//! relative to the local target edge length.
//!
//! Every step keeps the topology. If that needs more vertices than wanted, more are left; the caller compares.
//!
//! Cost: n log n in the edges once, and a queue operation for each changed edge.

use crate::base::heap::{Ranked, RankedQueue};
use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::mesh::half_edge::next;
use crate::surface::domain::Domain;

/// Maximum distance of a vertex removed from a curve to what remains, in lengths of the collapsed edge.
const STRAIGHT: f64 = 0.05;

/// Brings `mesh` to `wanted` vertices, as far as its topology allows.
pub fn meet_count(domain: &Domain, mesh: &mut Manifold, wanted: usize) {
    // First under the guard, then without.
    split_longest(domain, mesh, wanted);
    split_longest_with(mesh, wanted, |mesh, h| Some(mesh.split_anyhow(domain, h)));
    collapse_shortest(mesh, wanted, |mesh, h| {
        let c = &mesh.connectivity;
        let keeps_curve =
            !c.is_on_curve(c.origin(h)) || mesh.distance_after_collapse(h) <= STRAIGHT * mesh.length_squared(h).sqrt();
        keeps_curve && FacingGuard::CAREFUL.passes(mesh.after_collapse(h).0)
    });
    collapse_shortest(mesh, wanted, |_, _| true);
    if mesh.connectivity.vertex_count() > wanted {
        // The count takes precedence over feature curves and their corners.
        mesh.connectivity.forget_curves();
        collapse_shortest(mesh, wanted, |_, _| true);
    }
}

/// Collapses edges shorter than `shortest`, relative to the local target edge length, the shortest first: those with an end
/// that is `near`, with no triangle at a curve, and where the surface allows it.
pub(super) fn collapse_shorter(mesh: &mut Manifold, shortest: f64, near: impl Fn(u32) -> bool) {
    collapse_while(
        mesh,
        |_, square| square < shortest * shortest,
        |mesh, h| {
            let ends = [mesh.connectivity.origin(h), mesh.connectivity.target(h)];
            ends.into_iter().any(&near)
                && is_away_from_curves(mesh, h)
                && FacingGuard::CAREFUL.passes(mesh.after_collapse(h).0)
        },
    );
}

/// Returns whether no triangle at the edge of `h` has a vertex on a curve.
pub(super) fn is_away_from_curves(mesh: &Manifold, h: u32) -> bool {
    let c = &mesh.connectivity;
    c.both_sides(h).all(|h| c.triangle(h).into_iter().all(|v| !c.is_on_curve(v)))
}

/// Splits the longest inner edges, where the surface allows it, until there are `wanted` vertices.
pub fn split_longest(domain: &Domain, mesh: &mut Manifold, wanted: usize) {
    split_longest_with(mesh, wanted, |mesh, h| mesh.split_at_middle(domain, h));
}

/// Splits the longest inner edges with `split`, which returns the new vertex if it splits one, until there are `wanted`
/// vertices.
fn split_longest_with(mesh: &mut Manifold, wanted: usize, split: impl Fn(&mut Manifold, u32) -> Option<u32>) {
    let is_missing = |mesh: &Manifold| mesh.connectivity.vertex_count() < wanted;
    if is_missing(mesh) {
        split_while(mesh, |mesh, _| is_missing(mesh), split);
    }
}

/// Splits inner edges longer than `longest`, relative to the local target edge length, that have an end that is `near`, the
/// longest first, until there are `most` vertices. In flat triangles that lie on each other, splits need not shorten edges.
pub(super) fn split_longer(
    domain: &Domain,
    mesh: &mut Manifold,
    longest: f64,
    near: impl Fn(u32) -> bool,
    most: usize,
) {
    let first = mesh.connectivity.vertex_bound();
    let is_near = |v: u32| v >= first || near(v);
    split_while(
        mesh,
        |mesh, square| square > longest * longest && mesh.connectivity.vertex_count() < most,
        |mesh, h| {
            let ends = [mesh.connectivity.origin(h), mesh.connectivity.target(h)];
            ends.into_iter().any(is_near).then(|| mesh.split_at_middle(domain, h)).flatten()
        },
    );
}

/// Splits inner edges with `split`, which returns the new vertex if it splits one, the longest first, while `goes_on` holds
/// for the mesh and the squared relative length of the longest edge.
fn split_while(
    mesh: &mut Manifold,
    goes_on: impl Fn(&Manifold, f64) -> bool,
    split: impl Fn(&mut Manifold, u32) -> Option<u32>,
) {
    let entry = |mesh: &Manifold, h: u32| {
        let c = &mesh.connectivity;
        (c.has_twin(h) && c.can_split(h)).then(|| Ranked::new(mesh.relative_length_squared(h), h.min(c.twin(h))))
    };
    let mut queue: RankedQueue = mesh.half_edges().filter_map(|h| entry(mesh, h)).collect();
    while let Some(top) = queue.pop().filter(|top| goes_on(mesh, top.rank)) {
        if mesh.relative_length_squared(top.index) != top.rank || !mesh.connectivity.can_split(top.index) {
            continue;
        }
        let Some(v) = split(mesh, top.index) else { continue };
        mesh.make_delaunay_around(v);
        queue.extend(mesh.connectivity.outgoing(v).flat_map(|h| [h, next(h)]).filter_map(|h| entry(mesh, h)));
    }
}

/// Collapses the shortest of the edges that `may` collapse until there are `wanted` vertices.
pub(super) fn collapse_shortest(mesh: &mut Manifold, wanted: usize, may: impl Fn(&Manifold, u32) -> bool) {
    let is_surplus = |mesh: &Manifold| mesh.connectivity.vertex_count() > wanted;
    if is_surplus(mesh) {
        collapse_while(mesh, |mesh, _| is_surplus(mesh), may);
    }
}

/// Collapses edges that `may` collapse, the shortest first, while `goes_on` holds for the mesh and the squared relative
/// length of the shortest edge.
fn collapse_while(mesh: &mut Manifold, goes_on: impl Fn(&Manifold, f64) -> bool, may: impl Fn(&Manifold, u32) -> bool) {
    let entry = |mesh: &Manifold, h: u32| Ranked::new(-mesh.relative_length_squared(h), h);
    let mut queue: RankedQueue = mesh.half_edges().map(|h| entry(mesh, h)).collect();
    while let Some(Ranked { rank, index: h, .. }) = queue.pop().filter(|top| goes_on(mesh, -top.rank)) {
        let c = &mesh.connectivity;
        if !c.has_half_edge(h) || -mesh.relative_length_squared(h) != rank || !c.can_collapse(h) || !may(mesh, h) {
            continue;
        }
        let into = c.target(h);
        mesh.collapse(h);
        let c = &mesh.connectivity;
        let changed = c.outgoing(into).flat_map(|h| c.both_sides(h));
        queue.extend(changed.map(|h| entry(mesh, h)));
    }
}
