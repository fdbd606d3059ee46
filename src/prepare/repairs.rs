//! What repair did to an input.

use serde::{Deserialize, Serialize};

/// What was done to an input to make it an oriented manifold. All zero if nothing had to be done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repairs {
    /// Vertices merged with another one (texture and normal seams).
    pub welded_vertices: usize,
    /// Vertices merged with one at a different place: seams that rounding opened, or cracks within a tolerance.
    #[serde(default)]
    pub seam_vertices: usize,
    /// Vertices that no triangle uses.
    pub unused_vertices: usize,
    /// Triangles with two corners at the same place, or in a component without area.
    pub degenerate_triangles: usize,
    /// Triangles between two cells of a volume, both of which list them: only the outside is kept.
    #[serde(default)]
    pub faces_between_cells: usize,
    /// Triangles with almost no height, made by rounding: needles were collapsed, caps flipped.
    #[serde(default)]
    pub needles: usize,
    /// Triangles with the same three corners as another one.
    pub duplicate_triangles: usize,
    /// Triangles turned over so that neighbours are consistently oriented.
    pub flipped_triangles: usize,
    /// Edges with three or more faces that were separated into sheets.
    pub cut_edges: usize,
    /// Edges along which a surface that cannot be oriented (a Möbius strip) was cut open.
    pub unorientable_edges: usize,
    /// Vertices duplicated so that each has a single fan of faces.
    pub split_vertices: usize,
}
