//! The named parts of a mesh, as plain data.

/// Maximum number of characters that are kept of a name, which many parts may share.
pub const LONGEST_NAME: usize = 256;

/// The named parts of a mesh and their assignment to triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parts {
    /// All parts.
    pub list: Vec<Part>,
    /// The part number of each triangle; [`NONE`](super::topology::NONE) for a triangle in no part.
    pub of_triangle: Vec<u32>,
}

/// An object, or a group within an object.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Part {
    /// The name of the object; empty if it has none.
    pub object: String,
    /// The name of the group; empty if it has none.
    pub group: String,
}

/// Returns a name, truncated to at most [`LONGEST_NAME`] characters.
pub fn part_name(name: &str) -> String {
    name.chars().take(LONGEST_NAME).collect()
}
