//! Straightens the rims of patches where vertices of the domain stayed on them.
//!
//! A mutual tessellation cannot always take a vertex of the domain away. One that stays on the rim parts two samples that
//! are next to each other on a curve, and the patch on the other side knows nothing of it. Where these two have an edge
//! behind it, the triangles before that go. Else a triangle between the three, all but flat, makes it an inner vertex, which
//! merges into the neighbour that leaves the best triangles if there is one that it may merge into.
//!
//! Cost: linear in the triangles if there is such a place, else in the rims.

use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::mesh::topology::{NONE, topology};
use crate::triangulate::mutual_tessellation::merge_away;
use crate::triangulate::triangulation::{Boundary, Triangulated};

/// Vertices that may have stayed between two samples.
const MOST_BETWEEN: usize = 8;

/// Joins samples next to each other on `boundary` by an edge where vertices of the domain are between them on the rim of
/// `patches`.
pub fn straighten_rims(patches: &mut Triangulated, boundary: Boundary<'_>) {
    let bays = bays(patches, boundary);
    if bays.is_empty() || are_on_one_edge(&bays) {
        return;
    }
    let Triangulated { mesh, source, .. } = patches;
    let mut triangles: Vec<[u32; 3]> = mesh.triangles().map(|t| mesh.connectivity.triangle(3 * t)).collect();
    for Bay { ends: [v, w], between } in &bays {
        if mesh.connectivity.are_adjacent(*v, *w) {
            triangles.retain(|t| !t.iter().all(|c| c == v || c == w || between.contains(c)));
        } else {
            triangles.extend(between.windows(2).map(|pair| [*v, pair[1], pair[0]]));
            triangles.extend(between.last().map(|&last| [*v, *w, last]));
        }
    }
    if !topology(mesh.samples.len(), &triangles).is_manifold() {
        return;
    }
    *mesh = Manifold::new(std::mem::take(&mut mesh.samples), &triangles);
    for v in bays.into_iter().flat_map(|bay| bay.between) {
        if mesh.connectivity.has_vertex(v) {
            merge_away(mesh, v, |facing| FacingGuard::SOUND.passes(facing));
        }
    }
    let (compact, old) = mesh.without_gaps();
    *mesh = compact;
    *source = old.into_iter().map(|v| source[v as usize]).collect();
}

/// Two vertices that are samples next to each other on a curve, and the vertices of the domain on the rim between them.
struct Bay {
    ends: [u32; 2],
    between: Vec<u32>,
}

/// Whether two bays would become one edge: the patch between them is as narrow as that, and would have no rim any more.
fn are_on_one_edge(bays: &[Bay]) -> bool {
    let mut ends: Vec<[u32; 2]> = bays.iter().map(|bay| bay.ends).map(|[v, w]| [v.min(w), v.max(w)]).collect();
    ends.sort_unstable();
    ends.windows(2).any(|pair| pair[0] == pair[1])
}

fn bays(patches: &Triangulated, boundary: Boundary<'_>) -> Vec<Bay> {
    let Triangulated { mesh, source, .. } = patches;
    let c = &mesh.connectivity;
    let samples = boundary.successor.len() as u32;
    let mut vertex = vec![NONE; boundary.successor.len()];
    for (v, &s) in (0u32..).zip(source).filter(|(_, s)| **s < samples) {
        vertex[s as usize] = v;
    }
    let along_rim = |v: u32| c.outgoing(v).find(|&h| !c.has_twin(h)).map(|h| c.target(h));
    let bay = |(&v, &successor): (&u32, &u32)| {
        let end = vertex[successor as usize];
        if v == NONE || end == NONE {
            return None;
        }
        let way = std::iter::successors(along_rim(v), |&w| along_rim(w)).take(MOST_BETWEEN + 1);
        let between: Vec<u32> = way.take_while(|&w| source[w as usize] >= samples).collect();
        let ends_there = along_rim(*between.last()?) == Some(end);
        ends_there.then_some(Bay { ends: [v, end], between })
    };
    vertex.iter().zip(boundary.successor).filter_map(bay).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::domain::Sample;
    use glam::{DVec3, dvec3};

    fn at(x: f64, y: f64) -> Sample {
        Sample { position: dvec3(x, y, 0.0), normal: DVec3::Z, triangle: 0, size: 1.0 }
    }

    #[test]
    fn vertices_between_two_samples_of_the_rim_go() {
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(0.4, 0.0), at(0.6, 0.0)];
        let mesh = Manifold::new(samples, &[[0, 3, 2], [3, 4, 2], [4, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2, 7, 8], tessellated_patches: 0 };
        straighten_rims(&mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        assert_eq!(patches.source, [0, 1, 2]);
        assert_eq!(patches.mesh.connectivity.compact().0.len(), 1);
    }

    #[test]
    fn an_edge_behind_a_vertex_of_the_rim_comes_to_the_rim() {
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(0.5, 0.0)];
        let mesh = Manifold::new(samples, &[[0, 3, 1], [0, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2, 7], tessellated_patches: 0 };
        straighten_rims(&mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        assert_eq!(patches.source, [0, 1, 2]);
        assert_eq!(patches.mesh.connectivity.compact().0, [[0, 1, 2]]);
    }

    #[test]
    fn a_patch_whose_rims_would_be_one_edge_stays() {
        // Two curves between the same two samples, and a vertex of the domain on each.
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.5, -0.1), at(0.5, 0.1)];
        let triangles = [[0, 2, 3], [2, 1, 3]];
        let mesh = Manifold::new(samples, &triangles);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 7, 8], tessellated_patches: 0 };
        straighten_rims(&mut patches, Boundary { sites: &[(0, 0.0); 2], successor: &[1, 0], spikes: 0 });
        assert_eq!(patches.mesh.connectivity.compact().0, triangles);
    }

    #[test]
    fn rims_without_other_vertices_stay() {
        let mesh = Manifold::new(vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)], &[[0, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2], tessellated_patches: 0 };
        straighten_rims(&mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        assert_eq!(patches.mesh.connectivity.compact().0, [[0, 1, 2]]);
    }
}
