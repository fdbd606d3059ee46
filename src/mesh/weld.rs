//! Welding: merges vertices at exactly the same position. Files of separate triangles need it.
//!
//! Cost: one sort of the vertices.

use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

/// Returns a key that identifies a position exactly. Zeros of either sign are equal.
pub(crate) fn place_key(p: DVec3) -> [u64; 3] {
    // Adding zero gives -0.0 and 0.0 the same bits.
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Returns the representative of each position: for those in `numbers`, the lowest of them at exactly the same position; for
/// all others, the position itself. Zeros of either sign are equal.
pub fn first_at_place(positions: &[DVec3], mut numbers: Vec<u32>) -> Vec<u32> {
    let key = |v: u32| place_key(positions[v as usize]);
    numbers.par_sort_unstable_by_key(|&v| (key(v), v));
    let mut first: Vec<u32> = (0..positions.len() as u32).collect();
    for place in numbers.chunk_by(|&a, &b| key(a) == key(b)) {
        place.iter().for_each(|&v| first[v as usize] = place[0]);
    }
    first
}

/// Returns for each position the number of the first one at exactly the same position.
pub fn representatives(positions: &[DVec3]) -> Vec<u32> {
    first_at_place(positions, (0..positions.len() as u32).collect())
}

/// Returns the same triangles over vertices at distinct positions, in the order of the first vertex at each position.
/// Nothing else changes, so triangles may end up with equal corners.
pub fn weld(mesh: &Mesh) -> Mesh {
    let first = representatives(&mesh.positions);
    let mut positions = Vec::new();
    // The first vertex at a position gets its number before any other vertex there needs it.
    let mut number = vec![0; first.len()];
    for v in 0..first.len() {
        number[v] = number[first[v] as usize];
        if first[v] as usize == v {
            number[v] = positions.len() as u32;
            positions.push(mesh.positions[v]);
        }
    }
    Mesh { positions, triangles: mesh.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separate_triangles_become_a_surface() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(-0.0, 0.0, -0.0), DVec3::Y, DVec3::NEG_X];
        let welded = weld(&Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [3, 4, 5]] });
        assert_eq!(welded.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(welded.positions, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_X]);
        assert_eq!(weld(&welded), welded);
        assert_eq!(weld(&Mesh::default()), Mesh::default());
    }
}
