//! Welded triangles and their sides edge by edge: the input of repair and of the search for seams.
//!
//! Cost: one sort of the sides.

use crate::mesh::sides::{Side, sorted_sides};
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::weld::representatives;
use crate::prepare::repairs::Repairs;

/// Triangles of a mesh after welding vertices, without those that lose a corner by it.
pub struct Welded {
    /// For each vertex of the mesh, the first of the vertices that it is welded to.
    pub representatives: Vec<u32>,
    /// What was done: unused and welded vertices, and dropped triangles.
    pub(super) repairs: Repairs,
    /// Triangles over the representatives.
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each triangle, its number in the mesh.
    pub(super) sources: Vec<u32>,
    /// The [`sorted_sides`] of the triangles.
    pub(super) sides: Vec<Side>,
}

impl Welded {
    /// Welds the vertices of `mesh` to their `representatives`.
    pub fn new(mesh: &Mesh, representatives: Vec<u32>) -> Welded {
        let welded = mesh.triangles.iter().map(|t| t.map(|v| representatives[v as usize]));
        let kept = welded.zip(0u32..).filter(|([a, b, c], _)| a != b && b != c && c != a);
        let (triangles, sources): (Vec<_>, Vec<_>) = kept.unzip();
        let degenerate_triangles = mesh.triangles.len() - triangles.len();
        let repairs = Repairs { degenerate_triangles, ..vertex_repairs(mesh, &representatives) };
        let sides = sorted_sides(&triangles);
        Welded { representatives, repairs, triangles, sources, sides }
    }

    /// Welds all vertices of `mesh` at exactly the same place.
    pub fn at_places(mesh: &Mesh) -> Welded {
        Welded::new(mesh, representatives(&mesh.positions))
    }

    /// Drops the marked triangles, if any. Returns how many there were.
    pub(super) fn drop_marked(&mut self, marked: &[bool]) -> usize {
        let count = marked.iter().filter(|is| **is).count();
        if count > 0 {
            retain(&mut self.triangles, |t| !marked[t]);
            retain(&mut self.sources, |t| !marked[t]);
            self.sides = sorted_sides(&self.triangles);
        }
        count
    }
}

/// Counts the unused and welded vertices of `mesh`.
fn vertex_repairs(mesh: &Mesh, representatives: &[u32]) -> Repairs {
    let used = mesh.used_vertices();
    let unused_vertices = used.iter().filter(|&&u| !u).count();
    // An unused vertex may be the representative of used ones.
    let mut stands = vec![false; used.len()];
    representatives.iter().zip(&used).filter(|v| *v.1).for_each(|(&first, _)| stands[first as usize] = true);
    let places = stands.iter().filter(|stands| **stands).count();
    let is_moved = |(v, &to): (usize, &u32)| used[v] && mesh.positions[v] != mesh.positions[to as usize];
    Repairs {
        unused_vertices,
        welded_vertices: used.len() - unused_vertices - places,
        seam_vertices: representatives.iter().enumerate().filter(|&v| is_moved(v)).count(),
        ..Repairs::default()
    }
}

/// Keeps the entries for whose index `keeps` holds.
fn retain<T>(list: &mut Vec<T>, keeps: impl Fn(usize) -> bool) {
    let mut numbers = 0..;
    list.retain(|_| numbers.next().is_some_and(&keeps));
}
