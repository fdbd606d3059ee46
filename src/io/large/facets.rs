//! Binary STL, read in blocks.

use super::blocks::{BLOCK, Blocks};
use super::places::Places;
use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::io::content::Read;
use crate::io::opened::Opened;
use crate::io::stl::{FACET, HEADER, corners};
use crate::mesh::triangle_mesh::Mesh;
use glam::{DVec3, Vec3};
use rustc_hash::FxHashMap;

/// A file of facets. Corners at the same position are one vertex.
pub(super) struct Facets {
    pub file: Opened,
    pub count: usize,
    /// Vertex at each position, by the bits of the position.
    pub vertices: FxHashMap<[u32; 3], u32>,
}

impl Facets {
    /// Passes the corners of all facets to `show`, in their order.
    fn read(&self, monitor: &dyn Monitor, show: &mut dyn FnMut([Vec3; 3]) -> Result<()>) -> Result<()> {
        self.file.seek(HEADER as u64)?;
        let mut block = vec![0; BLOCK / FACET * FACET];
        let mut at = HEADER;
        for first in (0..self.count).step_by(BLOCK / FACET) {
            check(monitor)?;
            let bytes = &mut block[..FACET * (BLOCK / FACET).min(self.count - first)];
            self.file.fill(bytes)?;
            for facet in bytes.chunks_exact(FACET) {
                show(corners(facet, at).map_err(|error| self.file.locate(error))?)?;
                at += FACET;
            }
        }
        Ok(())
    }
}

/// Returns the bits of a position. Positive and negative zero give the same bits.
fn bits(p: Vec3) -> [u32; 3] {
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

impl Blocks for Facets {
    fn faces(&self) -> u64 {
        self.count as u64
    }

    fn keeps_attributes(&self) -> bool {
        true
    }

    fn places(&mut self, monitor: &dyn Monitor) -> Result<Places> {
        let mut places = Places::with_capacity(self.count / 2);
        let mut vertices = std::mem::take(&mut self.vertices);
        self.read(monitor, &mut |corners| {
            for p in corners {
                vertices.entry(bits(p)).or_insert_with(|| {
                    places.push(p.as_dvec3());
                    places.len() as u32 - 1
                });
            }
            Ok(())
        })?;
        self.vertices = vertices;
        Ok(places)
    }

    fn triangles(
        &mut self,
        _: &Places,
        monitor: &dyn Monitor,
        take: &mut dyn FnMut([u32; 3]) -> Result<()>,
    ) -> Result<()> {
        let vertices = std::mem::take(&mut self.vertices);
        // If the file changes meanwhile, it may contain positions that were not there before.
        let number = |p: Vec3| vertices.get(&bits(p)).copied();
        self.read(monitor, &mut |corners| match corners.map(number) {
            [Some(a), Some(b), Some(c)] => take([a, b, c]),
            _ => Ok(()),
        })
    }

    fn vertices(&self, numbers: &[u32], places: &Places) -> Result<Read> {
        let positions: Vec<DVec3> = numbers.iter().map(|&v| places.at(v)).collect();
        Ok(Read { mesh: Mesh { positions, triangles: Vec::new() }, ..Read::default() })
    }
}
