//! Joins the pieces of a mesh.

use crate::geom::triangle::smallest_angle;
use crate::mesh::triangle_mesh::Mesh;
use crate::tiles::made::{MadePiece, piece_of};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// Number of rings of triangles around rims that are made anew. Six do as well where the surface is smooth: the mean of the
/// smallest angles along rims is 58.92 degrees with six and 58.94 with ten.
const RINGS: usize = 10;

/// Angle, in degrees, below which a triangle is made anew: triangles along rims could not be improved before.
const SMALL: f64 = 40.0;

/// Pieces of a mesh, joined by the keys of their vertices.
#[derive(Default)]
pub(super) struct Joined {
    pub mesh: Mesh,
    /// The key of each vertex.
    pub keys: Vec<u64>,
    /// For each triangle, the number of its piece, and its own number in that piece.
    pub sources: Vec<[u32; 2]>,
}

impl Joined {
    /// Joins the pieces, given with their numbers; those that replace triangles of others come after these.
    pub fn new(pieces: &[(usize, MadePiece)]) -> Joined {
        let replaced: FxHashSet<[u32; 2]> = pieces.iter().flat_map(|(_, piece)| &piece.replaced).copied().collect();
        let mut joined = Joined::default();
        let mut vertices = FxHashMap::default();
        for (number, piece) in pieces {
            for (t, corners) in (0..).zip(&piece.triangles) {
                let source = [*number as u32, t];
                if replaced.contains(&source) {
                    continue;
                }
                let vertex = |v: u32| {
                    let key = piece.keys[v as usize];
                    *vertices.entry(key).or_insert_with(|| joined.add(key, piece.positions[v as usize]))
                };
                let corners = corners.map(vertex);
                joined.mesh.triangles.push(corners);
                joined.sources.push(source);
            }
        }
        joined
    }

    /// Adds a vertex and returns its number.
    fn add(&mut self, key: u64, position: DVec3) -> u32 {
        self.keys.push(key);
        self.mesh.positions.push(position);
        self.keys.len() as u32 - 1
    }

    /// Returns, for each vertex, whether it is a corner of a triangle with a small angle.
    pub fn at_small_angles(&self) -> Vec<bool> {
        let mut are_there = vec![false; self.keys.len()];
        let is_small = |t: &usize| smallest_angle(self.mesh.corners(*t)) < SMALL;
        let small = (0..self.mesh.triangles.len()).filter(is_small).flat_map(|t| self.mesh.triangles[t]);
        small.for_each(|v| are_there[v as usize] = true);
        are_there
    }

    /// Returns, for each triangle, whether it is to be made anew: near a small angle, or near a vertex that was on a rim
    /// whenever a piece was made and so is still the node of a piece before the `first` one with triangles.
    pub fn to_be_made_anew(&self, first: usize) -> Vec<bool> {
        let mut near = self.at_small_angles();
        near.iter_mut().zip(&self.keys).for_each(|(near, &key)| *near |= piece_of(key) < first);
        self.mesh.grow(&mut near, RINGS - 1);
        self.mesh.triangles.iter().map(|t| t.iter().any(|&v| near[v as usize])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::grid;
    use crate::tiles::made::new_key;

    /// A flat grid of 60 by 60 even cells as piece 1, whose middle vertex is a node of piece 0.
    fn piece() -> MadePiece {
        let Mesh { positions, triangles } = grid(60, 60, |u, v| DVec3::new(u, v, 0.0));
        let middle = positions.iter().position(|p| p.distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-9).unwrap();
        let key = |v: usize| new_key(usize::from(v != middle), v as u32);
        MadePiece { keys: (0..positions.len()).map(key).collect(), positions, triangles, replaced: Vec::new() }
    }

    #[test]
    fn a_piece_takes_the_place_of_triangles_of_others() {
        let first = piece();
        // The first triangle, split at a vertex in its middle.
        let corners = first.triangles[0];
        let middle = corners.map(|v| first.positions[v as usize]).iter().sum::<DVec3>() / 3.0;
        let of_first = |values: &[u64]| corners.map(|v| values[v as usize]);
        let second = MadePiece {
            keys: [of_first(&first.keys).as_slice(), &[new_key(2, 3)]].concat(),
            positions: corners.map(|v| first.positions[v as usize]).into_iter().chain([middle]).collect(),
            triangles: vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
            replaced: vec![[1, 0]],
        };
        let joined = Joined::new(&[(1, first), (2, second)]);
        assert_eq!((joined.mesh.positions.len(), joined.mesh.triangles.len()), (61 * 61 + 1, 2 * 60 * 60 + 2));
        assert!((joined.mesh.area() - 1.0).abs() < 1e-9);
        assert!(!joined.sources.contains(&[1, 0]) && joined.sources.contains(&[2, 2]));
    }

    #[test]
    fn what_is_within_some_rings_of_a_node_or_a_small_angle_is_made_anew() {
        let anew = |piece: MadePiece, from: DVec3| {
            let joined = Joined::new(&[(1, piece)]);
            let cells = |t: usize| {
                let far = |p: DVec3| (60.0 * (p - from)).abs().max_element();
                joined.mesh.corners(t).map(far).into_iter().fold(f64::INFINITY, f64::min)
            };
            let anew = joined.to_be_made_anew(1);
            // A ring is a cell wide along the axes and along one diagonal, and half a cell along the other diagonal.
            let near = (0..anew.len()).filter(|&t| anew[t]).map(cells).fold(0.0, f64::max);
            let far = (0..anew.len()).filter(|&t| !anew[t]).map(cells).fold(f64::INFINITY, f64::min);
            (near, far)
        };
        let (near, far) = anew(piece(), DVec3::new(0.5, 0.5, 0.0));
        assert!((near - RINGS as f64).abs() < 1.1 && far >= 0.5 * RINGS as f64 - 1.1, "{near} {far}");
        let mut pinched = piece();
        pinched.keys.iter_mut().zip(0..).for_each(|(key, v)| *key = new_key(1, v));
        let spoilt = pinched.positions.iter().position(|p| p.distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-9).unwrap();
        pinched.positions[spoilt].x += 0.7 / 60.0;
        let (near, far) = anew(pinched, DVec3::new(0.5, 0.5, 0.0));
        assert!((near - RINGS as f64).abs() < 2.1 && far >= 0.5 * RINGS as f64 - 1.1, "{near} {far}");
    }
}
