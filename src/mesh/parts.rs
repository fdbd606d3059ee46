//! The named parts of a mesh, as plain data.

/// How many characters of a name are kept: many parts may share one.
pub const LONGEST_NAME: usize = 256;

/// Which part each triangle is of.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Parts {
    /// All parts.
    pub list: Vec<Part>,
    /// The number of each triangle's part; [`NONE`](super::topology::NONE) for a triangle of none.
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

/// A name as parts have it.
pub fn part_name(name: &str) -> String {
    name.chars().take(LONGEST_NAME).collect()
}
