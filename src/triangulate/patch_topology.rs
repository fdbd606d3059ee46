//! The topology of each smooth patch of a domain, and of the triangles over its samples.

use crate::mesh::topology::NONE;
use crate::surface::domain::Domain;
use crate::triangulate::star::INTERIOR;

/// Counts of a connected patch, or of its mesh, that determine its topology.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Kind {
    pub vertices: usize,
    faces: usize,
    boundary_edges: usize,
    boundary_loops: usize,
    components: usize,
}

impl Kind {
    /// Counts each of `patches` patches. `component` is the connected component of each vertex, `next` the next vertex on
    /// the boundary, or [`INTERIOR`].
    pub fn of_patches(
        patches: usize,
        patch: impl Fn(u32) -> u32,
        triangles: &[[u32; 3]],
        component: &[u32],
        next: &[u32],
    ) -> Vec<Kind> {
        let mut kinds = vec![Kind::default(); patches];
        let mut used = vec![false; next.len()];
        for t in triangles {
            t.iter().for_each(|&v| used[v as usize] = true);
            kinds[patch(t[0]) as usize].faces += 1;
        }
        let mut counted = vec![false; next.len()];
        let mut walked = vec![false; next.len()];
        for v in (0..next.len() as u32).filter(|&v| used[v as usize]) {
            let kind = &mut kinds[patch(v) as usize];
            kind.vertices += 1;
            kind.boundary_edges += usize::from(next[v as usize] != INTERIOR);
            kind.components += usize::from(!std::mem::replace(&mut counted[component[v as usize] as usize], true));
            let mut at = v;
            kind.boundary_loops += usize::from(next[at as usize] != INTERIOR && !walked[at as usize]);
            while next[at as usize] != INTERIOR && !std::mem::replace(&mut walked[at as usize], true) {
                at = next[at as usize];
            }
        }
        kinds
    }

    /// Euler characteristic, components and boundary loops.
    pub fn topology(&self) -> (i64, usize, usize) {
        let edges = (3 * self.faces + self.boundary_edges) / 2;
        let euler = self.vertices as i64 - edges as i64 + self.faces as i64;
        (euler, self.components, self.boundary_loops)
    }
}

/// Counts of the patches of the domain.
pub(super) fn kinds_of_domain(domain: &Domain) -> Vec<Kind> {
    let mut next = vec![INTERIOR; domain.mesh.positions.len()];
    for (t, corners) in domain.mesh.triangles.iter().enumerate() {
        for k in (0..3).filter(|k| domain.twin[3 * t + k] == NONE) {
            next[corners[k] as usize] = corners[(k + 1) % 3];
        }
    }
    let patches = domain.patch_count();
    Kind::of_patches(patches, |v| domain.patch[v as usize], &domain.mesh.triangles, &domain.patch, &next)
}
