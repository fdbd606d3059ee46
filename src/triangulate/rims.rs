//! Straightens the rims of patches on which vertices of the domain have remained.
//!
//! A mutual tessellation cannot always remove a vertex of the domain. If one remains on the rim, it separates two samples
//! that are adjacent on a curve, and the patch on the other side does not have it. If these two are joined by an edge behind
//! it, the triangles in front of that edge are removed. Otherwise, an almost flat triangle between the three makes it an
//! inner vertex, which merges into the neighbour that leaves the best triangles, if there is one that it may merge into. An
//! edge that joins the two elsewhere is split before.
//!
//! A place where the result would not be a manifold stays as it is.
//!
//! Cost: linear in the triangles if there is such a place, otherwise in the rims; plus n log k for each of k places that
//! cannot be straightened.

use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::mesh::half_edge::Connectivity;
use crate::mesh::sides::lower_first;
use crate::mesh::topology::{NONE, topology};
use crate::surface::domain::Domain;
use crate::triangulate::mutual_tessellation::merge_away;
use crate::triangulate::triangulation::{Boundary, Triangulated};
use std::collections::BTreeSet;

/// Maximum number of vertices that may have remained between two samples.
const MOST_BETWEEN: usize = 8;

/// Joins samples adjacent on `boundary` by an edge where vertices of the domain lie between them on the rim of `patches`,
/// which lie on `domain`.
pub fn straighten_rims(domain: &Domain, patches: &mut Triangulated, boundary: Boundary<'_>) {
    let bays = without_those_on_one_edge(&patches.mesh.connectivity, bays(patches, boundary));
    if bays.is_empty() {
        return;
    }
    let Triangulated { mesh, source, .. } = patches;
    for bay in &bays {
        if let Some(h) = bay.edge_elsewhere(&mesh.connectivity) {
            mesh.split_anyhow(domain, h);
        }
    }
    source.resize(mesh.samples().len(), NONE);
    let triangles: Vec<[u32; 3]> = mesh.triangles().map(|t| mesh.connectivity.triangle(3 * t)).collect();
    let (triangles, straightened) = straightened(mesh.samples().len(), triangles, &bays);
    *mesh = Manifold::new(mesh.samples().to_vec(), &triangles);
    for &v in straightened.into_iter().flat_map(|bay| &bay.between) {
        if mesh.connectivity.has_vertex(v) {
            merge_away(mesh, v, |facing| FacingGuard::SOUND.passes(facing));
        }
    }
    let (compact, old) = mesh.without_gaps();
    *mesh = compact;
    *source = old.into_iter().map(|v| source[v as usize]).collect();
}

/// Two vertices that are adjacent samples on a curve, and the vertices of the domain on the rim between them.
struct Bay {
    ends: [u32; 2],
    between: Vec<u32>,
}

/// Returns `triangles` over this many `vertices`, with edges along as many `bays` as a manifold permits, and these bays.
fn straightened(vertices: usize, triangles: Vec<[u32; 3]>, bays: &[Bay]) -> (Vec<[u32; 3]>, Vec<&Bay>) {
    let mut made = triangles.clone();
    bays.iter().for_each(|bay| bay.straighten(&mut made));
    if topology(vertices, &made).is_manifold() {
        return (made, bays.iter().collect());
    }
    if bays.len() <= 1 {
        return (triangles, Vec::new());
    }
    let (some, others) = bays.split_at(bays.len() / 2);
    let (triangles, mut done) = straightened(vertices, triangles, some);
    let (triangles, more) = straightened(vertices, triangles, others);
    done.extend(more);
    (triangles, done)
}

impl Bay {
    /// Returns whether `v` is one of its vertices.
    fn has(&self, v: u32) -> bool {
        self.ends.contains(&v) || self.between.contains(&v)
    }

    /// Returns the half-edge between its ends, if there is one with more than triangles of its own vertices between it and
    /// the rim.
    fn edge_elsewhere(&self, c: &Connectivity) -> Option<u32> {
        let [v, w] = self.ends;
        let h = c.outgoing(v).find(|&h| c.target(h) == w && c.has_twin(h))?;
        let around = self.between.iter().flat_map(|&x| c.outgoing(x));
        let before: BTreeSet<u32> =
            around.filter(|&h| c.triangle(h).iter().all(|&v| self.has(v))).map(|h| h / 3).collect();
        (before.len() != self.between.len()).then_some(h)
    }

    /// Makes the edge between its ends part of the rim.
    fn straighten(&self, triangles: &mut Vec<[u32; 3]>) {
        let Bay { ends: [v, w], between } = self;
        triangles.retain(|t| !t.iter().all(|&v| self.has(v)));
        let on_rim: Vec<u32> = between.iter().copied().filter(|x| triangles.iter().any(|t| t.contains(x))).collect();
        triangles.extend(on_rim.windows(2).map(|pair| [*v, pair[1], pair[0]]));
        triangles.extend(on_rim.last().map(|&last| [*v, *w, last]));
    }
}

/// Returns the `bays` of a mesh with this connectivity that would not coincide with another one, or with an edge of the rim,
/// once straightened: the patch between the two is so narrow that it would have no rim any more.
fn without_those_on_one_edge(c: &Connectivity, mut bays: Vec<Bay>) -> Vec<Bay> {
    let is_straight = |[v, w]: [u32; 2]| c.outgoing(v).any(|h| c.target(h) == w && !c.has_twin(h));
    let mut edges: Vec<[u32; 2]> = bays.iter().map(|bay| lower_first(bay.ends)).collect();
    edges.sort_unstable();
    let count = |edge: [u32; 2]| edges.partition_point(|e| *e <= edge) - edges.partition_point(|e| *e < edge);
    bays.retain(|Bay { ends: [v, w], .. }| count(lower_first([*v, *w])) == 1 && !is_straight([*w, *v]));
    bays
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
    use crate::testing::grid;
    use glam::{DVec3, dvec3};

    fn at(x: f64, y: f64) -> Sample {
        Sample { position: dvec3(x, y, 0.0), normal: DVec3::Z, triangle: 0, size: 1.0 }
    }

    /// A square to serve as the surface.
    fn domain() -> Domain {
        Domain::new(grid(2, 2, |u, v| dvec3(u, v, 0.0)).try_into().unwrap())
    }

    #[test]
    fn vertices_between_two_samples_of_the_rim_go() {
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(0.4, 0.0), at(0.6, 0.0)];
        let mesh = Manifold::new(samples, &[[0, 3, 2], [3, 4, 2], [4, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2, 7, 8], tessellated_patches: 0 };
        straighten_rims(&domain(), &mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        assert_eq!(patches.source, [0, 1, 2]);
        assert_eq!(patches.mesh.connectivity.compact().0.len(), 1);
    }

    #[test]
    fn an_edge_behind_a_vertex_of_the_rim_comes_to_the_rim() {
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(0.5, 0.0)];
        let mesh = Manifold::new(samples, &[[0, 3, 1], [0, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2, 7], tessellated_patches: 0 };
        straighten_rims(&domain(), &mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        assert_eq!(patches.source, [0, 1, 2]);
        assert_eq!(patches.mesh.connectivity.compact().0, [[0, 1, 2]]);
    }

    #[test]
    fn triangles_between_vertices_of_the_rim_go() {
        // Two vertices of the domain on the rim, the first at the end of an ear.
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.5, 1.0), at(0.3, -0.2), at(0.6, -0.1)];
        let mesh = Manifold::new(samples, &[[0, 3, 4], [0, 4, 2], [4, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2, 7, 8], tessellated_patches: 0 };
        straighten_rims(&domain(), &mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        assert_eq!(patches.source, [0, 1, 2]);
        assert_eq!(patches.mesh.connectivity.compact().0.len(), 1);
    }

    #[test]
    fn an_edge_elsewhere_between_two_samples_of_the_rim_is_split() {
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.5, 0.8), at(0.5, -0.1), at(0.5, -0.4)];
        let mesh = Manifold::new(samples, &[[0, 4, 3], [4, 1, 3], [0, 3, 1], [0, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2, 3, 7], tessellated_patches: 0 };
        straighten_rims(&domain(), &mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        let c = &patches.mesh.connectivity;
        let on_rim = (0..c.vertex_bound()).filter(|&v| c.is_boundary(v)).map(|v| patches.source[v as usize]);
        assert_eq!(on_rim.collect::<Vec<u32>>(), [0, 1, 2]);
    }

    #[test]
    fn what_cannot_be_straightened_keeps_nothing_else_from_it() {
        // The ends of the first bay are adjacent on the rim already.
        let disc = [[0, 6, 7], [6, 1, 7], [1, 0, 7]];
        let other = [[2, 5, 4], [5, 3, 4]];
        let xs = [0.0, 1.0, 5.0, 6.0, 5.0, 5.5, 0.5, 0.5];
        let ys = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -0.2, 0.4];
        let samples: Vec<Sample> = xs.into_iter().zip(ys).map(|(x, y)| at(x, y)).collect();
        let mesh = Manifold::new(samples, &[disc.as_slice(), &other].concat());
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2, 3, 4, 7, 8, 9], tessellated_patches: 0 };
        let successor = [1, 0, 3, 4, 2];
        straighten_rims(&domain(), &mut patches, Boundary { sites: &[(0, 0.0); 5], successor: &successor, spikes: 0 });
        let left = patches.mesh.connectivity.compact().0;
        assert!(left.len() == 4 && !patches.source.contains(&7) && patches.source.contains(&8), "{left:?}");
    }

    #[test]
    fn a_patch_whose_rims_would_be_one_edge_stays() {
        // Two curves between the same two samples, each with a vertex of the domain.
        let samples = vec![at(0.0, 0.0), at(1.0, 0.0), at(0.5, -0.1), at(0.5, 0.1)];
        let triangles = [[0, 2, 3], [2, 1, 3]];
        let mesh = Manifold::new(samples, &triangles);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 7, 8], tessellated_patches: 0 };
        straighten_rims(&domain(), &mut patches, Boundary { sites: &[(0, 0.0); 2], successor: &[1, 0], spikes: 0 });
        assert_eq!(patches.mesh.connectivity.compact().0, triangles);
    }

    #[test]
    fn rims_without_other_vertices_stay() {
        let mesh = Manifold::new(vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)], &[[0, 1, 2]]);
        let mut patches = Triangulated { mesh, source: vec![0, 1, 2], tessellated_patches: 0 };
        straighten_rims(&domain(), &mut patches, Boundary { sites: &[(0, 0.0); 3], successor: &[1, 2, 0], spikes: 0 });
        assert_eq!(patches.mesh.connectivity.compact().0, [[0, 1, 2]]);
    }
}
