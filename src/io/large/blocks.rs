//! What the reader of large meshes asks of a format.

use super::places::Places;
use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::geom::polygon::triangulate;
use crate::io::content::Read;
use glam::DVec3;

/// About the bytes of a block.
pub(super) const BLOCK: usize = 1 << 20;

/// A mesh file that can be read in blocks.
pub(super) trait Blocks {
    /// How many faces it has.
    fn faces(&self) -> u64;

    /// Whether vertices have all that it has beside its shape.
    fn keeps_attributes(&self) -> bool;

    /// Where its vertices are.
    fn places(&mut self, monitor: &dyn Monitor) -> Result<Places>;

    /// Shows all triangles, once the places are known.
    fn triangles(
        &mut self,
        places: &Places,
        monitor: &dyn Monitor,
        take: &mut dyn FnMut([u32; 3]) -> Result<()>,
    ) -> Result<()>;

    /// The vertices of these numbers, in ascending order, with their attributes.
    fn vertices(&self, numbers: &[u32], places: &Places) -> Result<Read>;
}

/// Shows the triangles of a face.
pub(super) fn show_triangles(
    corners: &[u32],
    places: &Places,
    take: &mut dyn FnMut([u32; 3]) -> Result<()>,
) -> Result<()> {
    match *corners {
        [] | [_] | [_, _] => Ok(()),
        [a, b, c] => take([a, b, c]),
        _ => {
            let polygon: Vec<DVec3> = corners.iter().map(|&v| places.at(v)).collect();
            triangulate(&polygon).into_iter().try_for_each(|t| take(t.map(|i| corners[i])))
        }
    }
}
