//! A finished piece of a mesh, and its conversion to and from bytes.

use glam::DVec3;

/// A finished piece of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct MadePiece {
    /// Keys that identify its vertices in all pieces ([`new_key`]); vertices that have always been on a rim have the keys of
    /// nodes.
    pub keys: Vec<u64>,
    /// Positions of its vertices.
    pub positions: Vec<DVec3>,
    /// Vertices of its triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles of other pieces that it replaces, each given by the number of its piece and its own number there.
    pub replaced: Vec<[u32; 2]>,
}

/// Returns the key of vertex or node `v` that is made for this piece.
pub(super) fn new_key(piece: usize, v: u32) -> u64 {
    (piece as u64 + 1) << 32 | u64::from(v)
}

/// Returns the piece for which the vertex with this key was made.
pub(super) fn piece_of(key: u64) -> usize {
    (key >> 32) as usize - 1
}

impl MadePiece {
    /// Returns the numbers of vertices, triangles and replaced triangles, and then their data, all little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let counts = [self.keys.len(), self.triangles.len(), self.replaced.len()].map(|count| count as u64);
        let keys = counts.iter().chain(&self.keys).flat_map(|key| key.to_le_bytes());
        let coordinates = self.positions.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes);
        let numbers = self.triangles.as_flattened().iter().chain(self.replaced.as_flattened());
        keys.chain(coordinates).chain(numbers.flat_map(|number| number.to_le_bytes())).collect()
    }

    /// Returns the piece that these bytes hold; `None` if they are damaged.
    pub fn from_bytes(mut bytes: &[u8]) -> Option<MadePiece> {
        let mut counts = [0; 3];
        for count in &mut counts {
            *count = usize::try_from(u64::from_le_bytes(*bytes.split_off(..8)?.first_chunk()?)).ok()?;
        }
        let [vertices, triangles, replaced] = counts;
        let mut take = |count: usize, size: usize| bytes.split_off(..count.checked_mul(size)?);
        let [keys, positions] = [take(vertices, 8)?, take(vertices, 24)?].map(|bytes| bytes.as_chunks::<8>().0);
        let [triangles, replaced] = [take(triangles, 12)?, take(replaced, 8)?].map(numbers);
        let whole = MadePiece {
            keys: keys.iter().map(|key| u64::from_le_bytes(*key)).collect(),
            positions: positions.as_chunks::<3>().0.iter().map(|p| DVec3::from(p.map(f64::from_le_bytes))).collect(),
            triangles: triangles.as_chunks::<3>().0.to_vec(),
            replaced: replaced.as_chunks::<2>().0.to_vec(),
        };
        let is_sound = bytes.is_empty() && whole.triangles.as_flattened().iter().all(|&v| (v as usize) < vertices);
        is_sound.then_some(whole)
    }
}

fn numbers(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks::<4>().0.iter().map(|number| u32::from_le_bytes(*number)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_is_read_as_it_was_written() {
        let piece = MadePiece {
            keys: vec![new_key(0, 7), new_key(2, 1), new_key(2, 2)],
            positions: vec![DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 1, 2]],
            replaced: vec![[1, 5], [0, 9]],
        };
        let bytes = piece.to_bytes();
        assert_eq!(MadePiece::from_bytes(&bytes), Some(piece));
        let damaged = [&bytes[..bytes.len() - 1], &bytes[..20], &[bytes.as_slice(), &[0]].concat(), &[255; 64]];
        assert!(damaged.iter().all(|bytes| MadePiece::from_bytes(bytes).is_none()));
    }
}
