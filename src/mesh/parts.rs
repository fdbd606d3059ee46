//! The named parts of a mesh, as plain data.

/// Most characters that are kept of a name, which many parts may share.
pub const LONGEST_NAME: usize = 256;

/// Which part each triangle belongs to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parts {
    /// All parts.
    pub list: Vec<Part>,
    /// The number of each triangle's part; [`NONE`](super::topology::NONE) for a triangle in none.
    pub of_triangle: Vec<u32>,
}

/// An object, or a group in it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Part {
    /// The name of the object; empty if it has none.
    pub object: String,
    /// The name of the group; empty if it has none.
    pub group: String,
}

/// A name, cut to at most [`LONGEST_NAME`] characters.
pub fn part_name(name: &str) -> String {
    name.chars().take(LONGEST_NAME).collect()
}
