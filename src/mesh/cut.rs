//! Cuts a mesh open along edges: its smooth patches are separated, and each edge of the cut becomes two boundary sides.
//!
//! A cut that ends within a patch leaves a slit there, at whose end the vertex is not split.
//!
//! Cost: linear in the triangles.

use crate::base::union_find::UnionFind;
use crate::mesh::half_edge::next;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;

/// A number for some of the sides of a mesh. Takes no memory if no side has one, as in meshes without sharp edges.
#[derive(Debug, Clone, Default)]
pub struct OfSides {
    numbers: Vec<u32>,
}

impl OfSides {
    /// Returns the number of a side, or [`NONE`].
    #[inline]
    pub fn get(&self, side: u32) -> u32 {
        if self.numbers.is_empty() { NONE } else { self.numbers[side as usize] }
    }

    /// Assigns a number to one of `sides` sides.
    pub fn set(&mut self, side: u32, number: u32, sides: usize) {
        if self.numbers.is_empty() {
            self.numbers = vec![NONE; sides];
        }
        self.numbers[side as usize] = number;
    }
}

/// A mesh that was cut open, and the correspondence across the cut.
pub struct Cut {
    /// The mesh with duplicated vertices along the cut; its triangles correspond one to one to those before.
    pub mesh: Mesh,
    /// The twin of each side that is still joined to another, else [`NONE`].
    pub twin: Vec<u32>,
    /// The twin of each side before the cut if it was cut there, else [`NONE`].
    pub across: OfSides,
    /// The original of each vertex; the first copy of a vertex keeps its number.
    pub original: Vec<u32>,
}

/// Cuts `mesh` along the sides marked in `sharp`, in which both sides of an edge must be marked. `twin` is the result of
/// [`twins`](crate::mesh::topology::twins).
pub fn cut(mut mesh: Mesh, mut twin: Vec<u32>, sharp: &[bool]) -> Cut {
    let mut across = OfSides::default();
    let sides = twin.len();
    for side in (0..sides).filter(|&s| sharp[s]) {
        across.set(side as u32, std::mem::replace(&mut twin[side], NONE), sides);
    }
    // Corners around a vertex that are still joined form a fan.
    let mut fans = UnionFind::new(twin.len());
    for side in 0..twin.len() as u32 {
        let other = twin[side as usize];
        if other != NONE {
            fans.join(side, next(other));
        }
    }
    let mut original: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let mut first_fan = vec![NONE; mesh.positions.len()];
    let mut copy_of_fan = vec![NONE; twin.len()];
    for corner in 0..twin.len() as u32 {
        let fan = fans.find(corner) as usize;
        let vertex = &mut mesh.triangles[corner as usize / 3][corner as usize % 3];
        if copy_of_fan[fan] == NONE {
            let first = &mut first_fan[*vertex as usize];
            if *first == NONE {
                *first = fan as u32;
                copy_of_fan[fan] = *vertex;
            } else {
                copy_of_fan[fan] = original.len() as u32;
                original.push(*vertex);
                mesh.positions.push(mesh.positions[*vertex as usize]);
            }
        }
        *vertex = copy_of_fan[fan];
    }
    Cut { mesh, twin, across, original }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::{topology, twins};
    use crate::testing::grid;
    use glam::DVec3;

    /// A grid of n by n squares in the plane.
    fn sheet(n: u32) -> Mesh {
        grid(n, n, |u, v| f64::from(n) * DVec3::new(v, u, 0.0))
    }

    /// The sheet of 4 by 4 squares cut along the vertical line x = 2 between these heights.
    fn cut_sheet(from: f64, to: f64) -> Cut {
        let mesh = sheet(4);
        let twin = twins(&mesh.triangles);
        let on_line = |v: u32| {
            let p = mesh.positions[v as usize];
            p.x == 2.0 && (from..=to).contains(&p.y)
        };
        let sharp = (0..twin.len() as u32).map(|s| mesh.ends(s).into_iter().all(on_line)).collect::<Vec<_>>();
        cut(mesh.clone(), twin, &sharp)
    }

    #[test]
    fn a_cut_from_side_to_side_makes_two_pieces() {
        let halves = cut_sheet(0.0, 4.0);
        let t = topology(halves.mesh.positions.len(), &halves.mesh.triangles);
        assert_eq!((t.components, t.boundary_loops, t.vertices), (2, 2, 30));
        assert_eq!((0..halves.twin.len() as u32).filter(|&s| halves.across.get(s) != NONE).count(), 8);
        assert_eq!(halves.twin, twins(&halves.mesh.triangles));
        for v in 0..30 {
            assert_eq!(halves.mesh.positions[v], halves.mesh.positions[halves.original[v] as usize]);
        }
    }

    #[test]
    fn a_cut_that_ends_inside_makes_a_slit() {
        let inside = cut_sheet(1.0, 3.0);
        let t = topology(inside.mesh.positions.len(), &inside.mesh.triangles);
        assert_eq!((t.components, t.boundary_loops, t.vertices, t.euler), (1, 2, 26, 0));
        let from_the_rim = cut_sheet(0.0, 2.0);
        let t = topology(from_the_rim.mesh.positions.len(), &from_the_rim.mesh.triangles);
        assert_eq!((t.components, t.boundary_loops, t.vertices), (1, 1, 27));
    }

    #[test]
    fn nothing_is_cut_where_nothing_is_sharp() {
        let mesh = sheet(3);
        let twin = twins(&mesh.triangles);
        let whole = cut(mesh.clone(), twin.clone(), &vec![false; twin.len()]);
        assert_eq!((whole.mesh, whole.twin), (mesh, twin));
    }
}
