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

impl Points {
    /// The points of these numbers, in their order.
    #[must_use]
    pub fn pick(&self, numbers: &[u32]) -> Points {
        let pick = |list: &[DVec3]| match list {
            [] => Vec::new(),
            _ => numbers.iter().map(|&p| list[p as usize]).collect(),
        };
        Points { positions: pick(&self.positions), normals: pick(&self.normals) }
    }
}
