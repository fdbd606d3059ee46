//! A point cloud as plain data.

use glam::DVec3;

/// Points of a surface, with or without normals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    /// Where they are, in the units of the file.
    pub positions: Vec<DVec3>,
    /// A normal for each point, of any length, or none at all: then this is empty.
    pub normals: Vec<DVec3>,
}
