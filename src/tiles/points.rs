//! Selects the points of a part of a cloud that may become samples: one per cell of a lattice.
//!
//! A cell keeps the point nearest to its centre, and among equally near ones the first in the input; where points face
//! opposite ways, it keeps one per side. So the result does not depend on which other points are read, or in which order.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::io::spill::Chunk;
use crate::io::table::Table;
use crate::pipeline::TilePoint;
use crate::spectral::lattice::{BlockBox, place_of};
use crate::tiles::folder::TileFolder;
use crate::tiles::plan::{BUCKET, Plan};
use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;

/// Number of cells of a block along each axis: on a surface, four to five points for each sample.
pub(super) const CELLS: i32 = 16;

/// Number of cells of a block where sharp edges are restored, which takes about nine points for each sample.
pub(super) const FINE_CELLS: i32 = 32;

/// Number of bytes of the point number before each row.
pub(super) const NUMBER: usize = 4;

/// Direction along which the sign of normals tells the two sides of a thin wall apart, however the wall is turned, and
/// splits few of the other cells.
const ACROSS: DVec3 = DVec3::new(0.48, 0.6, 0.64);

/// Returns the bucket of a block.
pub(super) fn bucket_of(block: IVec3) -> IVec3 {
    block.div_euclid(IVec3::splat(BUCKET))
}

/// Returns the blocks of a bucket.
pub(super) fn blocks_of(bucket: IVec3) -> BlockBox {
    BlockBox { lo: BUCKET * bucket, hi: BUCKET * (bucket + 1) }
}

/// Returns the points of some blocks, of which each has `cells` cells along each axis. Any two of them are in the same order
/// wherever they are read.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if they cannot be read; [`Error::Cancelled`](crate::Error::Cancelled) if the
/// monitor asks for it.
pub(super) fn points_of(
    folder: &TileFolder,
    plan: &Plan,
    blocks: BlockBox,
    cells: i32,
    monitor: &dyn Monitor,
) -> Result<Vec<TilePoint>> {
    kept_in(folder, plan, blocks, cells, monitor, |point, _| point)
}

/// Returns what `keep` makes of the points of some blocks and their rows, in the order of [`points_of`].
///
/// # Errors
/// Those of [`points_of`].
pub(super) fn kept_in<T: Send>(
    folder: &TileFolder,
    plan: &Plan,
    blocks: BlockBox,
    cells: i32,
    monitor: &dyn Monitor,
    keep: impl Fn(TilePoint, &[u8]) -> T + Sync,
) -> Result<Vec<T>> {
    let table = folder.table(plan)?;
    let is_touched = |chunks: &&[Chunk]| blocks_of(chunks[0].place.into()).touches(blocks);
    let buckets: Vec<&[Chunk]> = plan.buckets().filter(is_touched).collect();
    let of_bucket = |chunks: &[Chunk]| {
        check(monitor)?;
        let rows = folder.rows(chunks)?;
        let kept = thinned(&rows, chunks[0].place.into(), blocks, (plan.sampling.block(), cells), &table);
        Ok(kept.into_iter().map(|(point, row)| keep(point, row)).collect())
    };
    let kept: Vec<Vec<T>> = parallel::each(buckets, of_bucket).into_iter().collect::<Result<_>>()?;
    Ok(kept.into_iter().flatten().collect())
}

/// Returns the points in `blocks` that the cells of a bucket keep, and their rows, in the order of the cells along a curve.
fn thinned<'a>(
    rows: &'a [u8],
    bucket: IVec3,
    blocks: BlockBox,
    (block, cells): (f64, i32),
    table: &Table,
) -> Vec<(TilePoint, &'a [u8])> {
    let cell = block / f64::from(cells);
    let mut kept: FxHashMap<u32, (f64, TilePoint, &[u8])> = FxHashMap::default();
    for row in rows.chunks_exact(NUMBER + table.row) {
        let (number, row) = row.split_at(NUMBER);
        let seen = table.rows.look(row);
        if !blocks.contains(place_of(seen.position, block)) {
            continue;
        }
        let place = place_of(seen.position, cell);
        let off_centre = seen.position.distance_squared(cell * (place.as_dvec3() + 0.5));
        let number = u32::from_le_bytes(number.try_into().expect("four bytes"));
        let point = TilePoint { number, position: seen.position, normal: seen.normal };
        let key = 2 * morton(place - BUCKET * cells * bucket) + u32::from(seen.normal.dot(ACROSS) < 0.0);
        let best = kept.entry(key).or_insert((off_centre, point, row));
        if (off_centre, number) < (best.0, best.1.number) {
            *best = (off_centre, point, row);
        }
    }
    let mut kept: Vec<_> = kept.into_iter().collect();
    kept.sort_unstable_by_key(|k| k.0);
    kept.into_iter().map(|(_, (_, point, row))| (point, row)).collect()
}

/// Number of bits of a place of a cell in its bucket, along each axis.
const BITS: u32 = 8;
const _: () = assert!(BUCKET * FINE_CELLS <= 1 << BITS);

/// Returns the place of a cell of a bucket along a Z-order curve.
fn morton(cell: IVec3) -> u32 {
    let spread = |x: i32| (0..BITS).fold(0, |sum, bit| sum | (x as u32 >> bit & 1) << (3 * bit));
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_of_a_bucket_has_its_place_on_the_curve() {
        let mut places: Vec<u32> =
            (0..128 * 128 * 128).map(|i| morton(IVec3::new(i % 128, i / 128 % 128, i / 16384))).collect();
        places.sort_unstable();
        assert!(places.into_iter().eq(0..128 * 128 * 128));
        // With fine cells, a bucket has 256 of them along each axis.
        let last = IVec3::splat(BUCKET * FINE_CELLS - 1);
        assert_eq!([last, 128 * IVec3::Z, last - 128].map(morton), [(1 << 24) - 1, 1 << 23, (1 << 21) - 1]);
    }
}
