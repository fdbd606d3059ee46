//! A finished piece of a mesh, and its bytes.

use glam::DVec3;

/// A finished piece of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct MadePiece {
    /// What its vertices are known by in all pieces ([`new_key`]): those that have always been on a rim are nodes.
    pub keys: Vec<u64>,
    /// Where its vertices are.
    pub positions: Vec<DVec3>,
    /// The vertices of its triangles.
    pub triangles: Vec<[u32; 3]>,
    /// The triangles of other pieces whose place it takes, each by the number of the piece and its own.
    pub replaced: Vec<[u32; 2]>,
}

/// The key of vertex or node `v`, made for that piece.
pub(super) fn new_key(piece: usize, v: u32) -> u64 {
    (piece as u64 + 1) << 32 | u64::from(v)
}

/// The piece that the vertex of that key was made for.
pub(super) fn piece_of(key: u64) -> usize {
    (key >> 32) as usize - 1
}

impl MadePiece {
    /// How many vertices, triangles and replaced triangles there are, and then these, all of them little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let counts = [self.keys.len(), self.triangles.len(), self.replaced.len()].map(|count| count as u64);
        let keys = counts.iter().chain(&self.keys).flat_map(|key| key.to_le_bytes());
        let coordinates = self.positions.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes);
        let numbers = self.triangles.as_flattened().iter().chain(self.replaced.as_flattened());
        keys.chain(coordinates).chain(numbers.flat_map(|number| number.to_le_bytes())).collect()
    }

    /// The piece of those bytes; `None` if they are damaged.
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
