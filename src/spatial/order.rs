//! An order of points in which points near in space are near in memory.

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

/// Returns the numbers of all positions along a Z-order curve, which sorts them by the interleaved bits of their three
/// coordinates, so that neighbours in space are mostly near each other in memory, too.
///
/// Based on: G. M. Morton, A computer oriented geodetic data base and a new technique in file sequencing, 1966.
pub fn spatial_order(positions: &[DVec3]) -> Vec<u32> {
    let Some(bounds) = Aabb::of(positions.iter().copied()) else { return Vec::new() };
    spatial_order_in(bounds, positions.len(), |i| positions[i])
}

/// [`spatial_order`] of `count` positions within `bounds`. The bounds determine which positions are far apart in the order
/// although they are near in space.
pub fn spatial_order_in(bounds: Aabb, count: usize, position: impl Fn(usize) -> DVec3 + Sync) -> Vec<u32> {
    let scale = f64::from(1 << BITS) / bounds.size().max_element().max(f64::MIN_POSITIVE);
    let key = |p: DVec3| {
        let cell = ((p - bounds.lo) * scale).to_array().map(|c| spread((c as u64).min((1 << BITS) - 1)));
        cell[0] | cell[1] << 1 | cell[2] << 2
    };
    let mut keyed: Vec<(u64, u32)> = parallel::map(0..count as u32, |i| (key(position(i as usize)), i));
    keyed.par_sort_unstable();
    keyed.into_iter().map(|k| k.1).collect()
}

/// Number of bits used of each coordinate: three coordinates fill 63.
const BITS: u32 = 21;

/// The lowest 21 bits of `x`, each followed by two zero bits.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_in_space_are_neighbours_in_order() {
        let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let points: Vec<DVec3> = (0..8).rev().flat_map(|i| [corner(i), corner(i) * 0.9 + 0.01]).collect();
        let order = spatial_order(&points);
        // Both points of a corner, then those of the next corner along x, then y, then z.
        let corners: Vec<u32> = order.iter().map(|i| 7 - i / 2).collect();
        assert_eq!(corners, (0..8).flat_map(|i| [i, i]).collect::<Vec<u32>>());
        assert!(spatial_order(&[]).is_empty());
        assert_eq!(spatial_order(&[DVec3::X; 3]), [0, 1, 2]);
    }
}
