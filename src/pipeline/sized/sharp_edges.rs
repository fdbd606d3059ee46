//! Sharp edges of the sampled surface, as segments.

use crate::mesh::triangle_mesh::Mesh;
use crate::surface::domain::Domain;
use glam::DVec3;

/// Returns the ends of the edges of `mesh` whose sides were sharp `before` but are not `now`.
pub(in crate::pipeline) fn left_out(mesh: &Mesh, twin: &[u32], before: &[bool], now: &[bool]) -> Vec<[DVec3; 2]> {
    let is_left_out = |&s: &u32| before[s as usize] && !now[s as usize] && s < twin[s as usize];
    (0..twin.len() as u32).filter(is_left_out).map(|s| mesh.segment(s)).collect()
}

/// Returns the ends of the sharp edges of `domain` on curves whose number `is_wanted`, once per edge.
pub(in crate::pipeline) fn sharp_edges(
    domain: &Domain,
    is_wanted: impl Fn(u32) -> bool,
) -> impl Iterator<Item = [DVec3; 2]> {
    let curves = domain.sharp_curves().filter(move |&curve| is_wanted(curve));
    curves.flat_map(|curve| &domain.curves.list[curve as usize].sides).map(|&s| domain.mesh.segment(s))
}
