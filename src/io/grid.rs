//! Points with cells of several dimensions over them, as simulation programs write them. The faces are read, or, if there
//! are none, the outer surface of the volume cells.

use super::bytes::{NO_LINES, malformed};
use super::cells::Cells;
use super::faces::Faces;
use super::text::{left_out, small_faces};
use crate::base::count::counted;
use crate::base::error::{Place, Result};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// The content of a file while it is read.
#[derive(Default)]
pub(super) struct Grid {
    pub positions: Vec<DVec3>,
    pub faces: Faces,
    /// Number of cells of dimension one.
    pub lines: usize,
    /// Cells of dimension three, and the number of such cells whose kind is not supported.
    pub cells: Cells,
    pub other_cells: usize,
    pub notes: Vec<String>,
}

impl Grid {
    /// Adds a polygon over points that were added before.
    pub fn add_face(&mut self, corners: impl IntoIterator<Item = u32>) {
        corners.into_iter().for_each(|v| self.faces.push_corner(v));
        self.faces.end();
    }

    /// Returns the faces as triangles, and notes on what is left out.
    ///
    /// # Errors
    /// `Error::Format` if there are only lines.
    pub fn into_mesh(mut self) -> Result<(Mesh, Vec<String>)> {
        let volumes = self.cells.count() + self.other_cells;
        let is_outside = self.faces.count() == 0 && volumes > 0;
        if is_outside {
            self.add_outside();
        }
        let Grid { positions, faces, lines, mut notes, .. } = self;
        if faces.count() == 0 && lines > 0 {
            return Err(malformed(Place::Whole, "it has lines but no faces", NO_LINES));
        }
        small_faces(&mut notes, faces.dropped);
        left_out(&mut notes, lines, "line", "lines");
        if is_outside {
            let cells = counted(volumes, "cell fills", "cells fill");
            notes.push(format!("{cells} a volume: only its outer surface is used"));
        } else {
            left_out(&mut notes, volumes, "volume cell", "volume cells");
        }
        let triangles = faces.triangles(&positions);
        Ok((Mesh { positions, triangles }, notes))
    }

    /// Adds the outer surface of the volume cells.
    fn add_outside(&mut self) {
        let cells = std::mem::take(&mut self.cells);
        for (_, places) in cells.outside(&self.positions).sides {
            self.add_face(places.into_iter().map(|i| cells.corner_list()[i]));
        }
    }
}
