//! The plan: what all tiles have in common, and the list of tiles.

use crate::io::Format;
use crate::io::spill::Chunk;
use crate::pipeline::{SampleOptions, TileOptions};
use crate::spectral::lattice::BlockBox;
use glam::IVec3;
use serde::{Deserialize, Serialize};

/// Blocks of a bucket along each axis. The points of a bucket are together in the file.
pub(super) const BUCKET: i32 = 8;

/// What a plan can be asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// How to sample.
    pub sample: SampleOptions,
    /// About how much memory a tile may take, in bytes.
    pub memory: u64,
    /// The fewest tiles wanted, if there can be as many.
    pub tiles: usize,
}

/// How a cloud is sampled tile by tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The file that the points come from, as it was given.
    pub input: String,
    /// The number of points.
    pub points: usize,
    /// Samples wanted; `None` if the width of the kernel decides.
    pub wanted: Option<usize>,
    /// Whether the noise of the points is larger than their distance. Samples are drawn even so, but a mesh in pieces would be torn.
    pub is_thick: bool,
    /// How each tile is sampled.
    pub sampling: TileOptions,
    /// The tiles, each by its place in a lattice of them.
    pub tiles: Vec<[i32; 3]>,
    /// Buckets of a tile along each axis, and the lowest bucket of the lattice of tiles.
    pub(super) tile: i32,
    pub(super) lowest: [i32; 3],
    /// What kind of file the rows come from, and its length.
    pub(super) format: Format,
    pub(super) length: u64,
    /// Where the points are, in the order of their buckets.
    pub(super) chunks: Vec<Chunk>,
}

impl Plan {
    /// The blocks of a tile.
    pub(super) fn tile_box(&self, number: usize) -> BlockBox {
        let side = BUCKET * self.tile;
        let lo = BUCKET * IVec3::from(self.lowest) + side * IVec3::from(self.tiles[number]);
        BlockBox { lo, hi: lo + side }
    }

    /// The chunks of each bucket.
    pub(super) fn buckets(&self) -> impl Iterator<Item = &[Chunk]> {
        self.chunks.chunk_by(|a, b| a.place == b.place)
    }

    /// The bytes that the points take in the folder.
    pub fn bytes(&self) -> u64 {
        self.chunks.iter().map(|chunk| u64::from(chunk.length)).sum()
    }
}
