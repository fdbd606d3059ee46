//! Polygons of any number of corners, gathered while a file is read and made into triangles at its end.

use crate::geom::polygon;
use glam::DVec3;

/// Polygons over the vertices of a file.
#[derive(Debug, Default)]
pub(crate) struct Faces {
    corners: Vec<u32>,
    /// Where in `corners` each polygon ends.
    ends: Vec<usize>,
    /// Polygons with fewer than three corners.
    pub dropped: usize,
}

impl Faces {
    /// Room for `faces` triangles.
    pub fn with_capacity(faces: usize) -> Self {
        Faces { corners: Vec::with_capacity(faces * 3), ends: Vec::with_capacity(faces), dropped: 0 }
    }

    #[inline]
    pub fn push_corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    /// Ends the polygon of the corners pushed since the last one.
    #[inline]
    pub fn end(&mut self) {
        let start = self.ends.last().copied().unwrap_or(0);
        if self.corners.len() < start + 3 {
            self.corners.truncate(start);
            self.dropped += 1;
        } else {
            self.ends.push(self.corners.len());
        }
    }

    /// All triangles, polygon by polygon. The corners must be indices of `positions`.
    pub fn triangles(&self, positions: &[DVec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.corners.len() - 2 * self.ends.len());
        let mut start = 0;
        for &end in &self.ends {
            match self.corners[start..end] {
                [a, b, c] => triangles.push([a, b, c]),
                ref corners => split(corners, positions, &mut triangles),
            }
            start = end;
        }
        triangles
    }
}

fn split(corners: &[u32], positions: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    let places: Vec<DVec3> = corners.iter().map(|&v| positions[v as usize]).collect();
    triangles.extend(polygon::triangulate(&places).into_iter().map(|t| t.map(|i| corners[i])));
}
