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

    /// Corners so far.
    #[inline]
    pub fn corners(&self) -> usize {
        self.corners.len()
    }

    /// The vertex of each corner.
    pub fn corner_list(&self) -> &[u32] {
        &self.corners
    }

    /// Polygons so far.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    /// All triangles, polygon by polygon. The corners must be indices of `positions`.
    pub fn triangles(&self, positions: &[DVec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.corners.len() - 2 * self.ends.len());
        self.each(positions, |_, t| triangles.push(t.map(|i| self.corners[i])));
        triangles
    }

    /// Calls `visit` for all triangles in the order of [`Self::triangles`], with the number of the polygon and those of
    /// the corners, counted over all polygons.
    pub fn each(&self, positions: &[DVec3], mut visit: impl FnMut(usize, [usize; 3])) {
        let mut start = 0;
        for (polygon, &end) in self.ends.iter().enumerate() {
            if end - start == 3 {
                visit(polygon, [start, start + 1, start + 2]);
            } else {
                let places: Vec<DVec3> = self.corners[start..end].iter().map(|&v| positions[v as usize]).collect();
                for t in polygon::triangulate(&places) {
                    visit(polygon, t.map(|i| start + i));
                }
            }
            start = end;
        }
    }
}
