//! Polygons with any number of corners, gathered while a file is read and triangulated at its end.

use crate::base::count::counted;
use crate::geom::polygon;
use crate::io::tetrahedra::outside_of;
use glam::DVec3;

/// Polygons over the vertices of a file.
#[derive(Debug, Default)]
pub(crate) struct Faces {
    corners: Vec<u32>,
    /// End of each polygon in `corners`.
    ends: Vec<usize>,
    /// Number of polygons with fewer than three corners.
    pub dropped: usize,
    /// If the polygons are tetrahedra, the triangles of their outer surface: the polygon, and corner indices as in
    /// [`Self::each`].
    outside: Option<Vec<(usize, [usize; 3])>>,
}

impl Faces {
    /// Reserves room for `faces` triangles.
    pub fn with_capacity(faces: usize) -> Self {
        Faces { corners: Vec::with_capacity(faces * 3), ends: Vec::with_capacity(faces), ..Faces::default() }
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

    /// Number of corners so far.
    #[inline]
    pub fn corners(&self) -> usize {
        self.corners.len()
    }

    /// Vertex of each corner.
    pub fn corner_list(&self) -> &[u32] {
        &self.corners
    }

    /// Number of polygons so far.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    /// Keeps only the outer surface if the polygons are the tetrahedra of a volume, with a note. The corners must be indices
    /// of `positions`.
    pub fn keep_outside(&mut self, positions: &[DVec3], notes: &mut Vec<String>) {
        if self.ends.iter().zip(1..).all(|(&end, n)| end == 4 * n) {
            self.outside = outside_of(&self.corners, positions);
        }
        if self.outside.is_some() {
            let number = counted(self.ends.len(), "polygon is", "polygons are");
            notes.push(format!("{number} the tetrahedra of a volume: only its outer surface is used"));
        }
    }

    /// Returns all triangles, polygon by polygon. The corners must be indices of `positions`.
    pub fn triangles(&self, positions: &[DVec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.corners.len() - 2 * self.ends.len());
        self.each(positions, |_, t| triangles.push(t.map(|i| self.corners[i])));
        triangles
    }

    /// Calls `visit` for all triangles in the order of [`Self::triangles`], with the index of the polygon and the indices of
    /// the corners, counted over all polygons.
    pub fn each(&self, positions: &[DVec3], mut visit: impl FnMut(usize, [usize; 3])) {
        if let Some(outside) = &self.outside {
            return outside.iter().for_each(|&(polygon, corners)| visit(polygon, corners));
        }
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
