//! Sets of vertices of a manifold, such as those that are locked, dense, or in narrow patches.

use crate::base::parallel;
use crate::manifold::Manifold;
use std::ops::{BitOr, Not};

/// A set of vertices, by number. Vertices created later are not in it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct VertexSet {
    has: Vec<bool>,
}

impl VertexSet {
    /// The empty set.
    pub const EMPTY: VertexSet = VertexSet { has: Vec::new() };

    /// Returns the vertices of `mesh` for which `is_in` holds; it is not called for removed vertices.
    pub fn new(mesh: &Manifold, is_in: impl Fn(u32) -> bool + Sync) -> VertexSet {
        let c = &mesh.connectivity;
        parallel::map(0..c.vertex_bound(), |v| c.has_vertex(v) && is_in(v)).into()
    }

    /// All vertices of `mesh`.
    pub fn all(mesh: &Manifold) -> VertexSet {
        VertexSet::new(mesh, |_| true)
    }

    /// Returns whether vertex `v` is in the set.
    #[inline]
    pub fn contains(&self, v: u32) -> bool {
        self.has.get(v as usize).copied().unwrap_or(false)
    }

    /// Adds vertex `v`.
    pub fn insert(&mut self, v: u32) {
        self.has.resize(self.has.len().max(v as usize + 1), false);
        self.has[v as usize] = true;
    }

    /// The number of vertices in the set.
    pub fn len(&self) -> usize {
        self.has.iter().filter(|has| **has).count()
    }

    /// Returns whether the set has no vertices.
    pub fn is_empty(&self) -> bool {
        !self.has.contains(&true)
    }

    /// Returns the set extended by `rings` rings of vertices of `mesh` around it.
    pub fn with_rings(self, mesh: &Manifold, rings: usize) -> VertexSet {
        let ring = |set: &VertexSet| {
            VertexSet::new(mesh, |v| set.contains(v) || mesh.connectivity.ring(v).any(|w| set.contains(w)))
        };
        (0..rings).fold(self, |set, _| ring(&set))
    }

    /// Returns the set after the vertices are renumbered; `old` holds the former number of each.
    pub fn renumbered(&self, old: &[u32]) -> VertexSet {
        old.iter().map(|&v| self.contains(v)).collect::<Vec<bool>>().into()
    }
}

impl From<Vec<bool>> for VertexSet {
    fn from(has: Vec<bool>) -> VertexSet {
        VertexSet { has }
    }
}

impl FromIterator<u32> for VertexSet {
    fn from_iter<I: IntoIterator<Item = u32>>(vertices: I) -> VertexSet {
        let mut set = VertexSet::EMPTY;
        vertices.into_iter().for_each(|v| set.insert(v));
        set
    }
}

/// The vertices in either set.
impl BitOr for &VertexSet {
    type Output = VertexSet;

    fn bitor(self, other: &VertexSet) -> VertexSet {
        let count = self.has.len().max(other.has.len()) as u32;
        (0..count).map(|v| self.contains(v) || other.contains(v)).collect::<Vec<bool>>().into()
    }
}

/// The vertices that are not in the set, among those that it was chosen from.
impl Not for &VertexSet {
    type Output = VertexSet;

    fn not(self) -> VertexSet {
        self.has.iter().map(|has| !has).collect::<Vec<bool>>().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_joined_inverted_and_renumbered() {
        let (low, high) = (VertexSet::from(vec![true, false, false]), VertexSet::from_iter([3, 1]));
        let both = &low | &high;
        assert_eq!((0..5).map(|v| both.contains(v)).collect::<Vec<_>>(), [true, true, false, true, false]);
        assert_eq!((both.len(), (!&both).len(), VertexSet::EMPTY.is_empty()), (3, 1, true));
        assert_eq!(both.renumbered(&[2, 3]), VertexSet::from(vec![false, true]));
    }
}
