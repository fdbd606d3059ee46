//! Meshes larger than memory, read in blocks and coarsened while they are read.
//!
//! A file is read once for its vertices, whose positions stay in memory; once for its triangles, which are sorted by cell,
//! in memory or in a temporary file; and, if vertices have attributes, once more for the vertices that remain. The triangles
//! are coarsened cell by cell, and finally along the borders between cells.
//!
//! Memory: twelve bytes per vertex of the file, 24 if its coordinates are not in single precision; as much again for the map
//! from positions to vertices of STL; twelve bytes per triangle unless these are in a file; and the coarsened mesh.

mod blocks;
mod facets;
mod lines;
mod places;
mod polygons;
mod sorted;

use crate::base::count::counted;
use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::geom::triangle::area;
use crate::io::dense::PointFile;
use crate::io::format::Format;
use crate::io::opened::Opened;
use crate::io::read::{Loaded, checked};
use crate::io::{ply, stl};
use crate::prepare::coarsen::{Coarseness, Part};
use blocks::Blocks;
use facets::Facets;
use lines::Lines;
use places::Places;
use polygons::Polygons;
use sorted::{OfPlace, ROW, Sorter};
use std::path::Path;

/// Approximate number of triangles that are coarsened together.
const OF_PLACE: usize = 1 << 18;

/// Number of triangles that are sorted together.
const BATCH: usize = 1 << 16;

/// Size of a large mesh, known before it is coarsened.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Total area of the triangles, in square units of the file.
    pub area: f64,
}

/// A mesh in a file that can be read in blocks.
pub(crate) struct LargeMesh {
    blocks: Box<dyn Blocks>,
    format: Format,
    name: String,
}

impl LargeMesh {
    /// Opens the file at `path`. Returns `None` if it cannot be read in blocks, which only works for faces in OBJ, binary
    /// PLY and binary STL, and not from a pipe.
    ///
    /// # Errors
    /// [`Error::File`](crate::Error::File) if there is no such file or it cannot be read.
    pub fn open(path: &Path, format: Option<Format>) -> Result<Option<LargeMesh>> {
        let Some(file) = Opened::open(path, format)? else { return Ok(None) };
        let (format, name) = (file.format, path.display().to_string());
        let blocks: Box<dyn Blocks> = match format {
            Format::Ply => match ply::surface(&file.head, file.length) {
                Some((table, faces)) => Box::new(Polygons { vertices: PointFile { file, table }, faces }),
                None => return Ok(None),
            },
            Format::Stl => match stl::facets(&file.head, file.length) {
                Some(count) => Box::new(Facets { file, count, vertices: Default::default() }),
                None => return Ok(None),
            },
            // With other line ends, there may be no place where a block can end.
            Format::Obj if file.head.contains(&b'\n') => Box::new(Lines { file }),
            _ => return Ok(None),
        };
        Ok(Some(LargeMesh { blocks, format, name }))
    }

    /// Returns the number of faces.
    pub fn faces(&self) -> u64 {
        self.blocks.faces()
    }

    /// Whether all attributes are read. Those of corners and faces are not.
    pub fn keeps_attributes(&self) -> bool {
        self.blocks.keeps_attributes()
    }

    /// Size of its triangles while they are sorted, in bytes.
    pub fn bytes_of_triangles(&self) -> u64 {
        ROW as u64 * self.blocks.faces()
    }

    /// Reads the mesh, made as coarse as the function `coarseness` says, with at most about the number of vertices that it
    /// returns. Returns `None` if no triangle has an area. The triangles are sorted in memory, or in a new file at
    /// `temporary`.
    ///
    /// # Errors
    /// Those of `coarseness`; [`Error::File`](crate::Error::File) and [`Error::Format`](crate::Error::Format), with the
    /// place, if one of the files cannot be read or written; [`Error::Cancelled`](crate::Error::Cancelled) if the monitor
    /// requests it.
    pub fn coarsened(
        mut self,
        temporary: Option<&Path>,
        coarseness: impl FnOnce(Extent) -> Result<(Coarseness, f64)>,
        monitor: &dyn Monitor,
    ) -> Result<Option<Loaded>> {
        let places = self.blocks.places(monitor)?;
        let (sorted, extent) = self.sorted(temporary, &places, monitor)?;
        if extent.area == 0.0 {
            return Ok(None);
        }
        let (coarseness, most) = coarseness(extent)?;
        let densest = most / extent.area;
        monitor.stage("coarsen");
        let coarsened = |of_place: OfPlace| {
            check(monitor)?;
            Ok(Part::new(&of_place.into_triangles()?, |v| places.at(v)).coarsened(coarseness, densest))
        };
        let parts: Vec<Part> = parallel::each(sorted, coarsened).into_iter().collect::<Result<_>>()?;
        let left = Part::joined(&parts, coarseness, densest).in_order();
        drop(parts);
        check(monitor)?;
        let mut read = self.blocks.vertices(&left.numbers, &places)?;
        let strayed = left.farthest_strayed();
        read.mesh.triangles = left.mesh.triangles;
        let mut loaded = checked(read, self.format).map_err(|error| error.in_file(&self.name))?;
        let (before, after) = (counted(extent.triangles, "triangle", "triangles"), loaded.mesh.triangles.len());
        let lost =
            if self.blocks.keeps_attributes() { "" } else { "; any attributes of corners and faces are left out" };
        loaded.notes.push(format!(
            "{before} were coarsened to {after} while they were read; the vertices removed are within about {strayed:.2e} of \
             these, which the report treats as the input{lost}"
        ));
        Ok(Some(loaded))
    }

    /// Returns the triangles, sorted by cell, and the size of the mesh.
    fn sorted(
        &mut self,
        temporary: Option<&Path>,
        places: &Places,
        monitor: &dyn Monitor,
    ) -> Result<(Vec<OfPlace>, Extent)> {
        let mut sorter = Sorter::new(temporary)?;
        let bounds = places.bounds();
        let cell = bounds.map_or(1.0, |bounds| cell_size(bounds, places.len()));
        let origin = bounds.map_or_else(Default::default, |bounds| bounds.lo);
        let mut extent = Extent { vertices: places.len(), triangles: 0, area: 0.0 };
        let look = |triangle: &[u32; 3]| {
            let corners = triangle.map(|v| places.at(v));
            (((corners[0] - origin) / cell).floor().as_ivec3().to_array(), area(corners))
        };
        // Corners of a triangle may be far apart in memory, so all threads share the waiting.
        let mut put = |triangles: &[[u32; 3]]| {
            let looks: Vec<([i32; 3], f64)> = parallel::map(triangles, look);
            extent.triangles += triangles.len();
            triangles.iter().zip(looks).try_for_each(|(&triangle, (place, area))| {
                extent.area += area;
                sorter.push(place, triangle)
            })
        };
        let mut batch = Vec::with_capacity(BATCH);
        self.blocks.triangles(places, monitor, &mut |triangle| {
            batch.push(triangle);
            if batch.len() < BATCH {
                return Ok(());
            }
            put(&std::mem::replace(&mut batch, Vec::with_capacity(BATCH)))
        })?;
        put(&batch)?;
        Ok((sorter.finish()?, extent))
    }
}

/// Returns the width of cells that have about [`OF_PLACE`] triangles each. With n cells along an axis, a surface passes
/// through about 2n² of them, and has twice as many triangles as vertices.
fn cell_size(bounds: Aabb, vertices: usize) -> f64 {
    let along = (vertices as f64 / OF_PLACE as f64).sqrt().ceil().max(1.0);
    // A flat sheet has no extent along one axis.
    (bounds.size().max_element() / along).max(f64::MIN_POSITIVE)
}
