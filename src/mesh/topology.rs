//! The properties of a triangle mesh that do not depend on positions: whether it is manifold and oriented, its genus, its
//! components and its holes.
//!
//! Cost: linear in the triangles, plus one sort of the edges.

use crate::base::union_find::UnionFind;
use crate::mesh::sides::{edges, pairs_of_sides, sorted_sides};
use serde::{Deserialize, Serialize};

pub use crate::mesh::sides::NONE;

/// The topology of a mesh, restricted to the vertices that triangles use.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Topology {
    /// Number of vertices that triangles use.
    pub vertices: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of triangles.
    pub faces: usize,
    /// Euler characteristic, vertices - edges + faces.
    pub euler: i64,
    /// Number of components, connected through edges.
    pub components: usize,
    /// Number of boundary loops: closed chains of boundary edges (components of the boundary that are connected through
    /// vertices).
    pub boundary_loops: usize,
    /// Number of edges with three or more faces.
    pub nonmanifold_edges: usize,
    /// Number of vertices with more than one fan.
    pub nonmanifold_vertices: usize,
    /// Number of edges whose two faces run along them in the same direction.
    pub misoriented_edges: usize,
}

impl Topology {
    /// Returns whether every edge has at most two faces and every vertex a single fan.
    pub fn is_manifold(&self) -> bool {
        self.nonmanifold_edges == 0 && self.nonmanifold_vertices == 0
    }

    /// Returns whether neighbouring faces agree on which side is outside.
    pub fn is_oriented(&self) -> bool {
        self.misoriented_edges == 0
    }
}

/// The topology of `triangles` over vertices numbered below `vertex_count`.
///
/// Triangles with two equal corners are counted as faces, but contribute no edge between the equal corners.
pub fn topology(vertex_count: usize, triangles: &[[u32; 3]]) -> Topology {
    let sides = sorted_sides(triangles);
    let mut t = Topology { faces: triangles.len(), ..Topology::default() };
    let mut components = UnionFind::new(vertex_count);
    let mut boundary = UnionFind::new(vertex_count);
    let mut on_boundary = vec![false; vertex_count];
    let mut fans = UnionFind::new(3 * triangles.len());
    for group in edges(&sides) {
        let [lo, hi] = group[0].ends();
        t.edges += 1;
        components.join(lo, hi);
        match group {
            [_] => {
                boundary.join(lo, hi);
                on_boundary[lo as usize] = true;
                on_boundary[hi as usize] = true;
            }
            [a, b] if a.forward() == b.forward() => t.misoriented_edges += 1,
            [_, _] => {}
            _ => t.nonmanifold_edges += 1,
        }
        for pair in group.windows(2) {
            for v in [lo, hi] {
                fans.join(pair[0].corner_at(v), pair[1].corner_at(v));
            }
        }
    }
    let mut fans_at = vec![0u32; vertex_count];
    let mut used = vec![false; vertex_count];
    for (f, triangle) in triangles.iter().enumerate() {
        for (k, &v) in triangle.iter().enumerate() {
            used[v as usize] = true;
            let corner = (3 * f + k) as u32;
            fans_at[v as usize] += u32::from(fans.find(corner) == corner);
        }
    }
    for v in 0..vertex_count {
        t.vertices += usize::from(used[v]);
        t.components += usize::from(used[v] && components.find(v as u32) == v as u32);
        t.boundary_loops += usize::from(on_boundary[v] && boundary.find(v as u32) == v as u32);
        t.nonmanifold_vertices += usize::from(fans_at[v] > 1);
    }
    t.euler = t.vertices as i64 - t.edges as i64 + t.faces as i64;
    t
}

/// Returns for each side `3 t + k` of a manifold mesh the opposite side `3 u + l` of the other face, or [`NONE`] at a
/// boundary. Side `k` of a triangle runs from corner `k` to corner `k + 1`.
///
/// Sides of edges with more than two faces, or with two faces that run the same way, get [`NONE`], too.
pub fn twins(triangles: &[[u32; 3]]) -> Vec<u32> {
    pairs_of_sides(&sorted_sides(triangles), 3 * triangles.len(), |a, b| a.forward() != b.forward())
}

/// [`topology`] of an oriented manifold that uses all its vertices; `component` and `twin` are its [`components`] and [`twins`].
pub fn topology_of_manifold(triangles: &[[u32; 3]], component: &[u32], twin: &[u32]) -> Topology {
    let open = || (0..twin.len()).filter(|&side| twin[side] == NONE);
    let mut boundary = UnionFind::new(component.len());
    let mut starts = Vec::new();
    for side in open() {
        let [from, to] = [side, side / 3 * 3 + (side + 1) % 3].map(|corner| triangles[corner / 3][corner % 3]);
        boundary.join(from, to);
        starts.push(from);
    }
    let (vertices, edges) = (component.len(), (twin.len() + starts.len()) / 2);
    Topology {
        vertices,
        edges,
        faces: triangles.len(),
        euler: vertices as i64 - edges as i64 + triangles.len() as i64,
        components: component_count(component),
        // Each boundary vertex of a manifold is the start of one boundary edge.
        boundary_loops: starts.iter().filter(|&&v| boundary.find(v) == v).count(),
        ..Topology::default()
    }
}

/// Returns the number of components, given that of each vertex.
pub fn component_count(component: &[u32]) -> usize {
    component.iter().max().map_or(0, |&last| last as usize + 1)
}

/// Returns the component of each vertex, numbered in the order of their first vertices; unused vertices are components, too.
pub fn components(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut components = UnionFind::new(vertex_count);
    for &[a, b, c] in triangles {
        components.join(a, b);
        components.join(b, c);
    }
    let mut number = vec![NONE; vertex_count];
    let mut next = 0;
    (0..vertex_count as u32)
        .map(|v| {
            let root = components.find(v) as usize;
            if number[root] == NONE {
                number[root] = next;
                next += 1;
            }
            number[root]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_is_a_sphere() {
        let t = topology(4, &TETRAHEDRON);
        assert_eq!((t.vertices, t.edges, t.faces, t.euler), (4, 6, 4, 2));
        assert_eq!((t.components, t.boundary_loops), (1, 0));
        assert_eq!(topology_of_manifold(&TETRAHEDRON, &[0; 4], &twins(&TETRAHEDRON)), t);
        assert!(t.is_manifold() && t.is_oriented());
        assert!(twins(&TETRAHEDRON).iter().all(|&s| s != NONE));
    }

    #[test]
    fn a_face_less_is_a_disk_and_a_flipped_one_is_noticed() {
        let t = topology(4, &TETRAHEDRON[..3]);
        assert_eq!((t.euler, t.boundary_loops), (1, 1));
        assert_eq!(topology_of_manifold(&TETRAHEDRON[..3], &[0; 4], &twins(&TETRAHEDRON[..3])), t);
        let mut flipped = TETRAHEDRON;
        flipped[0].swap(0, 1);
        assert_eq!(topology(4, &flipped).misoriented_edges, 3);
    }

    #[test]
    fn three_faces_at_an_edge_and_a_bow_tie_are_not_manifold() {
        let fan = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        assert_eq!(topology(5, &fan).nonmanifold_edges, 1);
        let bow_tie = [[0, 1, 2], [0, 3, 4]];
        let t = topology(5, &bow_tie);
        assert_eq!((t.nonmanifold_edges, t.nonmanifold_vertices, t.components), (0, 1, 1));
    }

    #[test]
    fn unused_vertices_do_not_count() {
        let t = topology(10, &[[7, 8, 9]]);
        assert_eq!((t.vertices, t.euler, t.components, t.boundary_loops), (3, 1, 1, 1));
    }
}
