//! Tetrahedra written as polygons of four corners, as some programs save a volume: replaced by their outer surface.
//!
//! A quadrilateral of a surface shares no three of its corners with another one. In contrast, three corners of a tetrahedron
//! in a filled volume mostly belong to a second tetrahedron, too.
//!
//! Cost: a sort of the triangles, only if there are half again as many polygons as vertices. A surface of quadrilaterals has
//! as many polygons as vertices.

use crate::io::cells::{Cells, Kind, Outside};
use glam::DVec3;

/// Returns the outer triangles of tetrahedra, each with the index of its tetrahedron and the indices of its corners in
/// `corners`, which has four corners per tetrahedron. Returns `None` if these are not tetrahedra.
pub(super) fn outside_of(corners: &[u32], positions: &[DVec3]) -> Option<Vec<(usize, [usize; 3])>> {
    let count = corners.len() / 4;
    if 2 * count < 3 * positions.len() {
        return None;
    }
    let mut cells = Cells::default();
    corners.chunks_exact(4).for_each(|cell| cells.push(Kind::Tetrahedron, cell.iter().copied()));
    let Outside { sides, shared } = cells.outside(positions);
    if shared < sides.len() || 2 * shared + sides.len() < 4 * count {
        return None;
    }
    Some(sides.into_iter().map(|(cell, places)| (cell, [0, 1, 2].map(|k| places[k]))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::mesh::triangle_mesh::Mesh;
    use glam::dvec3;

    /// Six tetrahedra around a diagonal of each cell of a cube with `n` cells a side. Every other one is turned inside out.
    fn cube_of_tetrahedra(n: u32) -> (Vec<u32>, Vec<DVec3>) {
        let m = n + 1;
        let positions = (0..m * m * m).map(|i| dvec3((i % m).into(), (i / m % m).into(), (i / m / m).into())).collect();
        let steps = [1, m, m * m];
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let cells = (0..n * n * n).map(|i| i % n + i / n % n * m + i / n / n * m * m);
        let of_cell = |first: u32| {
            orders.into_iter().flat_map(move |order: [usize; 3]| {
                let [a, b, c] = order.map(|k| steps[k]);
                [first, first + a, first + a + b, first + a + b + c]
            })
        };
        (cells.flat_map(of_cell).collect(), positions)
    }

    #[test]
    fn the_outside_of_a_cube_is_its_sides() {
        let (corners, positions) = cube_of_tetrahedra(3);
        let outside = outside_of(&corners, &positions).unwrap();
        let triangles: Vec<[u32; 3]> = outside.iter().map(|(_, side)| side.map(|i| corners[i])).collect();
        assert_eq!(triangles.len(), 6 * 9 * 2);
        let found = topology(positions.len(), &triangles);
        assert!(found.is_manifold() && found.is_oriented() && found.boundary_loops == 0);
        let mesh = Mesh { positions, triangles };
        let volume: f64 =
            (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((volume - 27.0).abs() < 1e-9, "{volume}");
    }

    #[test]
    fn quadrilaterals_are_no_tetrahedra() {
        // A square of three by three quadrilaterals, once and then three times.
        let quads: Vec<u32> = (0..9u32).map(|i| i / 3 * 4 + i % 3).flat_map(|v| [v, v + 1, v + 5, v + 4]).collect();
        let positions: Vec<DVec3> = (0..16).map(|i| dvec3((i % 4).into(), (i / 4).into(), 0.0)).collect();
        assert!(outside_of(&quads, &positions).is_none());
        let twice = [quads.clone(), quads.clone(), quads].concat();
        assert!(outside_of(&twice, &positions).is_none(), "copies of one quadrilateral");
    }
}
