//! A part of a mesh that is cut out, changed and sewn back in.
//!
//! The part has a boundary along the interface, with the vertices of the whole. Whatever changes inside, the part fits back
//! in if it keeps the edges of the interface, and the rest of the whole is unaffected.
//!
//! A vertex at which the part touches itself is split into one vertex for each fan of triangles, so that a part of a
//! manifold is a manifold.
//!
//! Cost: linear in the triangles of the whole, with a logarithmic factor for the part.

use crate::base::union_find::UnionFind;
use crate::mesh::half_edge::next;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;

/// A part of an oriented manifold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Submesh {
    /// The part as a separate mesh, with triangles and vertices in the order of the whole.
    pub mesh: Mesh,
    /// For each of its vertices, the vertex of the whole.
    pub source: Vec<u32>,
    /// The edges along which it is cut out, in increasing order; each is given by its ends, in the direction that has the
    /// part on its left.
    pub interface: Vec<[u32; 2]>,
}

/// The vertices and triangles that a mesh has kept of the mesh it was made from; they come first in it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Kept {
    /// The old number of each of these vertices; [`NONE`] for a new one.
    pub vertices: Vec<u32>,
    /// The old number of each of these triangles; [`NONE`] for a new one.
    pub triangles: Vec<u32>,
}

/// The vertices of a part of an oriented manifold: one for each fan of the part's triangles around a vertex of the whole.
pub struct Fans {
    /// The vertex of each corner, triangle by triangle of the part.
    pub of_corner: Vec<u32>,
    /// The first corner of each vertex, in increasing order.
    pub first_corner: Vec<u32>,
    /// The sides along which the part is cut out, as half-edges `3 i + k` of its i-th triangle.
    pub interface: Vec<u32>,
}

impl Fans {
    /// Returns the fans of the triangles `part`, given in increasing order; `twin` has the twin of each half-edge of the
    /// whole, or [`NONE`].
    pub fn new(part: &[u32], twin: &[u32]) -> Fans {
        let mut fans = UnionFind::new(3 * part.len());
        let mut interface = Vec::new();
        for (side, h) in (0..).zip(part.iter().flat_map(|&t| 3 * t..3 * t + 3)) {
            let across = twin[h as usize];
            if across == NONE {
                continue;
            }
            match part.binary_search(&(across / 3)) {
                // The corners at the other end are joined when the opposite side is processed.
                Ok(j) => {
                    fans.join(side, next(3 * j as u32 + across % 3));
                }
                Err(_) => interface.push(side),
            }
        }
        // The representative of a fan is its first corner.
        let first: Vec<u32> = (0..3 * part.len() as u32).map(|corner| fans.find(corner)).collect();
        let first_corner: Vec<u32> =
            (0..).zip(&first).filter(|&(corner, &first)| corner == first).map(|c| c.0).collect();
        let mut number = vec![NONE; first.len()];
        first_corner.iter().zip(0..).for_each(|(&corner, v)| number[corner as usize] = v);
        Fans { of_corner: first.into_iter().map(|corner| number[corner as usize]).collect(), first_corner, interface }
    }
}

impl Submesh {
    /// Cuts the `selected` triangles out of `whole`, an oriented manifold.
    pub fn cut_out(whole: &Mesh, selected: &[bool]) -> Submesh {
        let part: Vec<u32> = (0..selected.len() as u32).filter(|&t| selected[t as usize]).collect();
        let Fans { of_corner, first_corner, interface } = Fans::new(&part, &twins(&whole.triangles));
        let source_of = |corner: u32| whole.triangles[part[corner as usize / 3] as usize][corner as usize % 3];
        let mut vertices: Vec<(u32, u32)> = first_corner.into_iter().map(source_of).zip(0..).collect();
        vertices.sort_unstable();
        let mut number = vec![NONE; vertices.len()];
        vertices.iter().zip(0..).for_each(|(&(_, v), n)| number[v as usize] = n);
        let vertex = |corner: u32| number[of_corner[corner as usize] as usize];
        let mut interface: Vec<[u32; 2]> = interface.into_iter().map(|s| [s, next(s)].map(vertex)).collect();
        interface.sort_unstable();
        let positions = vertices.iter().map(|v| whole.positions[v.0 as usize]).collect();
        let triangles = (0..part.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2].map(vertex)).collect();
        Submesh { mesh: Mesh { positions, triangles }, source: vertices.into_iter().map(|v| v.0).collect(), interface }
    }

    /// Number of its vertices on the interface.
    pub fn interface_vertices(&self) -> usize {
        let mut ends: Vec<u32> = self.interface.iter().flatten().copied().collect();
        ends.sort_unstable();
        ends.dedup();
        ends.len()
    }
}

/// Returns `whole` with `piece` in place of its `selected` triangles. For each vertex of `piece`, `joined` has its number in
/// the whole, or [`NONE`] for a new one.
///
/// The other triangles and their vertices come first, in the order of the whole.
pub fn sew(whole: &Mesh, selected: &[bool], piece: &Mesh, joined: &[u32]) -> (Mesh, Kept) {
    let triangles: Vec<u32> = (0..selected.len() as u32).filter(|&t| !selected[t as usize]).collect();
    let mut number = vec![NONE; whole.positions.len()];
    let corners = triangles.iter().flat_map(|&t| whole.triangles[t as usize]);
    corners.for_each(|v| number[v as usize] = 0);
    let vertices: Vec<u32> = (0..number.len() as u32).filter(|&v| number[v as usize] != NONE).collect();
    vertices.iter().zip(0..).for_each(|(&v, n)| number[v as usize] = n);
    let mut positions: Vec<_> = vertices.iter().map(|&v| whole.positions[v as usize]).collect();
    let mut number_of = |(&p, &join): (_, &u32)| match join {
        NONE => {
            positions.push(p);
            positions.len() as u32 - 1
        }
        v => number[v as usize],
    };
    let of_piece: Vec<u32> = piece.positions.iter().zip(joined).map(&mut number_of).collect();
    let old = triangles.iter().map(|&t| whole.triangles[t as usize].map(|v| number[v as usize]));
    let new = piece.triangles.iter().map(|t| t.map(|v| of_piece[v as usize]));
    (Mesh { triangles: old.chain(new).collect(), positions }, Kept { vertices, triangles })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::testing;

    #[test]
    fn a_part_sewn_in_again_is_the_whole() {
        let cube = testing::cube();
        let selected: Vec<bool> = (0..12).map(|t| t < 2 || t == 7).collect();
        let part = Submesh::cut_out(&cube, &selected);
        assert_eq!(part.mesh.triangles.len(), 3);
        assert_eq!(part.interface.len(), 5);
        let (whole, kept) = sew(&cube, &selected, &part.mesh, &part.source);
        assert_eq!(whole.positions, cube.positions);
        assert_eq!(kept.vertices, (0..8).collect::<Vec<u32>>());
        assert_eq!(kept.triangles, [2, 3, 4, 5, 6, 8, 9, 10, 11]);
        let sorted = |mut mesh: Mesh| {
            mesh.triangles.sort_unstable();
            mesh.triangles
        };
        assert_eq!(sorted(whole), sorted(cube));
    }

    #[test]
    fn a_part_that_touches_itself_at_a_vertex_is_a_manifold() {
        // Triangles on two faces of the cube that share only the corner 0, not an edge.
        let cube = testing::cube();
        let at_corner: Vec<usize> = (0..12).filter(|&t| cube.triangles[t].contains(&0)).collect();
        let apart =
            |&&t: &&usize| cube.triangles[at_corner[0]].iter().filter(|v| cube.triangles[t].contains(v)).count() == 1;
        let other = *at_corner.iter().find(apart).unwrap();
        let selected: Vec<bool> = (0..12).map(|t| t == at_corner[0] || t == other).collect();
        let part = Submesh::cut_out(&cube, &selected);
        let t = topology(part.mesh.positions.len(), &part.mesh.triangles);
        assert!(t.is_manifold() && (t.vertices, t.components) == (6, 2), "{t:?}");
        assert_eq!(part.source.iter().filter(|&&v| v == 0).count(), 2);
        assert_eq!(part.interface_vertices(), 6);
    }
}
