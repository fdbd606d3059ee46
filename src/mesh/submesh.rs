//! A part of a mesh, cut out to be worked on, and sewn in again.
//!
//! What is cut out has an open boundary along the interface. Its vertices there are those of the whole; whatever else becomes
//! of the part, as long as it keeps the edges of the interface it fits in again, and the rest is as it was.
//!
//! Where the part touches itself at a vertex, that becomes one vertex for each fan of its triangles, so that the part of a
//! manifold is a manifold.
//!
//! Cost: linear in the triangles of the whole.

use crate::mesh::cut::cut;
use crate::mesh::half_edge::next;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;

/// A part of an oriented manifold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Submesh {
    /// The part as a mesh of its own, its triangles and vertices in the order of the whole.
    pub mesh: Mesh,
    /// For each of its vertices the one of the whole.
    pub source: Vec<u32>,
    /// The ends of each edge along which it is cut out, in increasing order; the part is on the left of the way between
    /// them.
    pub interface: Vec<[u32; 2]>,
}

/// What of a mesh is still there in another one made from it, as the first vertices and triangles of that.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Kept {
    /// For each of these vertices the one that it was; [`NONE`] for one that was not there.
    pub vertices: Vec<u32>,
    /// For each of these triangles the one that it was; [`NONE`] for one that was not there.
    pub triangles: Vec<u32>,
}

impl Submesh {
    /// The triangles of `whole`, an oriented manifold, that are `selected`.
    pub fn cut_out(whole: &Mesh, selected: &[bool]) -> Submesh {
        let twin = twins(&whole.triangles);
        let is_selected = |side: u32| selected[side as usize / 3];
        let on_interface =
            |side: u32| twin[side as usize] != NONE && is_selected(side) != is_selected(twin[side as usize]);
        let on_interface: Vec<bool> = (0..twin.len() as u32).map(on_interface).collect();
        let cut = cut(whole.clone(), twin, &on_interface);
        let sides = (0..on_interface.len() as u32).filter(|&s| on_interface[s as usize] && is_selected(s));
        let corner = |side: u32| cut.mesh.triangles[side as usize / 3][side as usize % 3];
        let interface: Vec<[u32; 2]> = sides.map(|s| [corner(s), corner(next(s))]).collect();
        let triangles = cut.mesh.triangles.into_iter().zip(selected).filter(|t| *t.1).map(|t| t.0).collect();
        Submesh { mesh: Mesh { positions: cut.mesh.positions, triangles }, source: cut.original, interface }
            .numbered_anew()
    }

    /// The part with the vertices that it uses only. Of the copies of a vertex the first has the lowest number.
    fn numbered_anew(self) -> Submesh {
        let mut is_used = vec![false; self.source.len()];
        self.mesh.triangles.iter().flatten().for_each(|&v| is_used[v as usize] = true);
        let mut used: Vec<u32> = (0..is_used.len() as u32).filter(|&v| is_used[v as usize]).collect();
        used.sort_by_key(|&v| (self.source[v as usize], v));
        let mut number = vec![NONE; is_used.len()];
        used.iter().zip(0..).for_each(|(&v, n)| number[v as usize] = n);
        let anew = |v: u32| number[v as usize];
        let mut interface: Vec<[u32; 2]> = self.interface.into_iter().map(|ends| ends.map(anew)).collect();
        interface.sort_unstable();
        let positions = used.iter().map(|&v| self.mesh.positions[v as usize]).collect();
        let triangles = self.mesh.triangles.into_iter().map(|t| t.map(anew)).collect();
        let source = used.iter().map(|&v| self.source[v as usize]).collect();
        Submesh { mesh: Mesh { positions, triangles }, source, interface }
    }

    /// How many of its vertices are on the interface.
    pub fn interface_vertices(&self) -> usize {
        let mut ends: Vec<u32> = self.interface.iter().flatten().copied().collect();
        ends.sort_unstable();
        ends.dedup();
        ends.len()
    }
}

/// `whole` with `piece` in the place of its triangles that are `selected`. `joined` has for each vertex of `piece` the one
/// of the whole that it is, or [`NONE`] for a new one.
///
/// The vertices that other triangles use come first, and these triangles, each in the order of the whole.
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
        // Two faces of the cube across from each other at the corner 0: a triangle of each, without a common edge.
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
