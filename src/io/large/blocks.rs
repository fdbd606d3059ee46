//! What a format must provide to the reader of large meshes.

use super::places::Places;
use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::geom::polygon::triangulate;
use crate::io::content::Read;
use glam::DVec3;

/// Approximate size of a block, in bytes.
pub(super) const BLOCK: usize = 1 << 20;

/// A mesh file that can be read in blocks.
pub(super) trait Blocks {
    /// Number of faces.
    fn faces(&self) -> u64;

    /// Whether all attributes that the file has belong to vertices, so that none is lost.
    fn keeps_attributes(&self) -> bool;

    /// Reads the positions of the vertices.
    fn places(&mut self, monitor: &dyn Monitor) -> Result<Places>;

    /// Passes all triangles to `take`, once the positions are known.
    fn triangles(
        &mut self,
        places: &Places,
        monitor: &dyn Monitor,
        take: &mut dyn FnMut([u32; 3]) -> Result<()>,
    ) -> Result<()>;

    /// Reads the vertices of these indices, in ascending order, with their attributes.
    fn vertices(&self, numbers: &[u32], places: &Places) -> Result<Read>;
}

/// Triangulates a face and passes its triangles to `take`.
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
