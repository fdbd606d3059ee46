//! From triangles as they are found to an oriented 2-manifold.

use serde::{Deserialize, Serialize};

/// What was done to an input so that it became an oriented manifold. All zero: nothing had to be done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Repairs {
    /// Vertices merged with another one at exactly the same place (texture and normal seams).
    pub welded_vertices: usize,
    /// Vertices that no triangle uses.
    pub unused_vertices: usize,
    /// Triangles without area, or with two equal corners.
    pub degenerate_triangles: usize,
    /// Triangles with the same three corners as another one.
    pub duplicate_triangles: usize,
    /// Triangles turned over so that neighbours agree on the outside.
    pub flipped_triangles: usize,
    /// Edges with three faces or more that were taken apart into sheets.
    pub cut_edges: usize,
    /// Edges along which a surface that cannot be oriented (a Möbius strip) was cut open.
    pub unorientable_edges: usize,
    /// Vertices doubled so that each has one fan of faces.
    pub split_vertices: usize,
}
