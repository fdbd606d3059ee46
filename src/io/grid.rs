//! Points with cells of several dimensions over them, as programs for simulation have them: the faces are read.

use super::bytes::{NO_LINES, malformed};
use super::faces::Faces;
use super::text::{left_out, small_faces};
use crate::base::error::{Place, Result};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// What a file has, while it is read.
#[derive(Default)]
pub(super) struct Grid {
    pub positions: Vec<DVec3>,
    pub faces: Faces,
    /// Cells of one dimension, and of three.
    pub lines: usize,
    pub volumes: usize,
    pub notes: Vec<String>,
}

impl Grid {
    /// Adds a polygon over points that are there.
    pub fn add_face(&mut self, corners: impl IntoIterator<Item = u32>) {
        corners.into_iter().for_each(|v| self.faces.push_corner(v));
        self.faces.end();
    }

    /// The faces as triangles, and notes of what is left out.
    ///
    /// # Errors
    /// `Error::Format` for cells that are lines or volumes only; `remedy` says what to do about volumes.
    pub fn into_mesh(self, remedy: &str) -> Result<(Mesh, Vec<String>)> {
        let Grid { positions, faces, lines, volumes, mut notes } = self;
        if faces.count() == 0 && volumes > 0 {
            let cause = format!("it holds cells of volumes ({volumes}), no faces");
            return Err(malformed(Place::Whole, cause, remedy));
        }
        if faces.count() == 0 && lines > 0 {
            return Err(malformed(Place::Whole, "it holds lines, no faces", NO_LINES));
        }
        small_faces(&mut notes, faces.dropped);
        left_out(&mut notes, lines, "line", "lines");
        left_out(&mut notes, volumes, "cell of a volume", "cells of volumes");
        let triangles = faces.triangles(&positions);
        Ok((Mesh { positions, triangles }, notes))
    }
}
