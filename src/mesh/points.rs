//! A point cloud as plain data.

use crate::base::error::{Error, Fault, Result};
use glam::DVec3;

/// Points on a surface, with or without normals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
}

impl Points {
    /// Points at `positions`, each with a normal of any length, or all without.
    ///
    /// # Errors
    /// [`Error::Mesh`] if the number of normals differs from that of the points.
    pub fn new(positions: Vec<DVec3>, normals: Vec<DVec3>) -> Result<Points> {
        if normals.is_empty() || normals.len() == positions.len() {
            return Ok(Points { positions, normals });
        }
        let cause = format!("{} normals for {} points", normals.len(), positions.len());
        Err(Error::Mesh { fault: Fault::Lengths, cause, remedy: "give one normal for each point, or none".into() })
    }

    /// Points at `positions`, without normals.
    pub fn without_normals(positions: Vec<DVec3>) -> Points {
        Points { positions, normals: Vec::new() }
    }

    /// Points with their normals, which may be of any length.
    pub fn from_pairs(pairs: impl IntoIterator<Item = (DVec3, DVec3)>) -> Points {
        let (positions, normals) = pairs.into_iter().unzip();
        Points { positions, normals }
    }

    /// The positions, in the units of the file.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// A normal for each point, of any length; empty if there are none.
    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// The same points with these normals, or with none.
    pub(crate) fn with_normals(self, normals: Vec<DVec3>) -> Points {
        debug_assert!(normals.is_empty() || normals.len() == self.positions.len());
        Points { normals, ..self }
    }

    /// The same points at these positions.
    pub(crate) fn at(self, positions: Vec<DVec3>) -> Points {
        debug_assert_eq!(positions.len(), self.positions.len());
        Points { positions, ..self }
    }

    /// Positions and normals.
    pub fn into_parts(self) -> (Vec<DVec3>, Vec<DVec3>) {
        (self.positions, self.normals)
    }

    /// The points with these numbers, in this order.
    #[must_use]
    pub fn pick(&self, numbers: &[u32]) -> Points {
        let pick = |list: &[DVec3]| match list {
            [] => Vec::new(),
            _ => numbers.iter().map(|&p| list[p as usize]).collect(),
        };
        Points { positions: pick(&self.positions), normals: pick(&self.normals) }
    }
}
