//! Binary PLY, read in blocks.

use super::blocks::{BLOCK, Blocks, show_triangles};
use super::places::Places;
use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::io::content::Read;
use crate::io::dense::PointFile;
use crate::io::table::Faces;
use crate::prepare::thin::Wanted;

/// A file of vertices, which are rows of equal length, followed by faces.
pub(super) struct Polygons {
    pub vertices: PointFile,
    pub faces: Faces,
}

impl Polygons {
    /// Passes the corners of all faces to `show`, in their order.
    fn read(&self, monitor: &dyn Monitor, show: &mut dyn FnMut(&[u32]) -> Result<()>) -> Result<()> {
        let Faces { start, count, rows, .. } = &self.faces;
        let file = &self.vertices.file;
        file.seek(*start)?;
        let (mut at, mut left) = (*start, *count);
        let mut bytes = Vec::new();
        while left > 0 {
            check(monitor)?;
            let kept = bytes.len();
            // A face longer than a block is looked at again each time the buffer has doubled.
            let more = (BLOCK.max(kept) as u64).min(file.length - at - kept as u64) as usize;
            if more == 0 {
                return Err(file.locate(rows.cut_short(file.length)));
            }
            bytes.resize(kept + more, 0);
            file.fill(&mut bytes[kept..])?;
            let (whole, used) = rows.show(&bytes, left, at, show).map_err(|error| file.locate(error))?;
            bytes.drain(..used);
            (left, at) = (left - whole, at + used as u64);
        }
        Ok(())
    }
}

impl Blocks for Polygons {
    fn faces(&self) -> u64 {
        self.faces.count
    }

    fn keeps_attributes(&self) -> bool {
        !self.faces.have_more
    }

    fn places(&mut self, monitor: &dyn Monitor) -> Result<Places> {
        let table = &self.vertices.table;
        let mut places = Places::with_capacity(table.points);
        self.vertices.read(&Wanted::default(), &mut |_, block| {
            check(monitor)?;
            block.chunks_exact(table.row).for_each(|row| places.push(table.rows.look(row).position));
            Ok(())
        })?;
        Ok(places)
    }

    fn triangles(
        &mut self,
        places: &Places,
        monitor: &dyn Monitor,
        take: &mut dyn FnMut([u32; 3]) -> Result<()>,
    ) -> Result<()> {
        self.read(monitor, &mut |corners| show_triangles(corners, places, take))
    }

    fn vertices(&self, numbers: &[u32], _: &Places) -> Result<Read> {
        let table = &self.vertices.table;
        let mut rows = Vec::with_capacity(numbers.len() * table.row);
        let mut wanted = numbers.iter().peekable();
        self.vertices.read(&Wanted::default(), &mut |first, block| {
            let count = block.len() / table.row;
            while let Some(v) = wanted.next_if(|&&v| (v as usize) < first + count) {
                rows.extend_from_slice(&block[(*v as usize - first) * table.row..][..table.row]);
            }
            Ok(())
        })?;
        table.rows.read(&rows).map_err(|error| self.vertices.file.locate(error))
    }
}
