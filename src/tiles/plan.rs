//! The plan: what all tiles have in common, and the list of tiles.

use crate::io::Format;
use crate::io::spill::Chunk;
use crate::pipeline::{SampleOptions, TileOptions};
use crate::spectral::lattice::BlockBox;
use glam::IVec3;
use serde::{Deserialize, Serialize};

/// Number of blocks of a bucket along each axis. The points of a bucket are together in the file.
pub(super) const BUCKET: i32 = 8;

/// Options of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// How to sample.
    pub sample: SampleOptions,
    /// Approximate memory that a tile may take, in bytes.
    pub memory: u64,
    /// Minimum number of tiles, if there can be as many.
    pub tiles: usize,
    /// Whether to look for sharp edges, which meshes keep.
    pub sharp_edges: bool,
}

/// How a cloud is sampled tile by tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The file that the points come from, as given.
    pub input: String,
    /// The number of points.
    pub points: usize,
    /// Number of samples wanted; `None` if the kernel width decides.
    pub wanted: Option<usize>,
    /// Whether the noise of the points is larger than their spacing. Samples can be drawn nevertheless, but a mesh in pieces
    /// would be torn.
    pub is_thick: bool,
    /// How each tile is sampled.
    pub sampling: TileOptions,
    /// The tiles, each given by its place in a lattice of tiles.
    pub tiles: Vec<[i32; 3]>,
    /// Number of buckets of a tile along each axis, and the lowest bucket of the lattice of tiles.
    pub(super) tile: i32,
    pub(super) lowest: [i32; 3],
    /// Format of the file that the rows come from, and its length.
    pub(super) format: Format,
    pub(super) length: u64,
    /// Notes on the points of the file that were left out.
    pub(crate) notes: Vec<String>,
    /// Where the points are stored, in the order of their buckets.
    pub(super) chunks: Vec<Chunk>,
}

impl Plan {
    /// Returns the blocks of a tile.
    pub(super) fn tile_box(&self, number: usize) -> BlockBox {
        let side = BUCKET * self.tile;
        let lo = BUCKET * IVec3::from(self.lowest) + side * IVec3::from(self.tiles[number]);
        BlockBox { lo, hi: lo + side }
    }

    /// Iterates over the chunks of each bucket.
    pub(super) fn buckets(&self) -> impl Iterator<Item = &[Chunk]> {
        self.chunks.chunk_by(|a, b| a.place == b.place)
    }

    /// Returns the number of bytes that the points take in the folder.
    pub fn bytes(&self) -> u64 {
        self.chunks.iter().map(|chunk| u64::from(chunk.length)).sum()
    }
}
