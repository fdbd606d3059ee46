//! A mesh that is known to be an oriented 2-manifold, with its provenance.

use crate::base::error::{Error, Fault, Result};
use crate::mesh::provenance::Provenance;
use crate::mesh::topology::topology;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use std::ops::Deref;

/// An oriented 2-manifold, with or without a boundary: every edge has at most two faces, which are consistently oriented,
/// and every vertex has a single fan. All vertices are used.
///
/// [`repair`](crate::prepare::repair::repair) makes one from any mesh; [`TryFrom`] accepts a mesh that already is one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OrientedManifold {
    mesh: Mesh,
    provenance: Provenance,
}

impl OrientedManifold {
    /// Wraps `mesh`, which is a manifold by construction.
    pub(crate) fn trusted(mesh: Mesh, provenance: Provenance) -> OrientedManifold {
        OrientedManifold { mesh, provenance }
    }

    /// The origins of its vertices and triangles.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// Returns the mesh and its provenance.
    pub fn into_parts(self) -> (Mesh, Provenance) {
        (self.mesh, self.provenance)
    }

    /// The mesh alone.
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }

    /// Its vertex positions, for changes that do not affect the connectivity.
    pub fn positions_mut(&mut self) -> &mut [DVec3] {
        &mut self.mesh.positions
    }

    /// Inserts a vertex on the edge with these ends, at the fraction `along` of the way from the first to the second. The
    /// caller must split the triangles at the edge.
    pub(super) fn insert_on_edge(&mut self, ends: [u32; 2], along: f64) -> u32 {
        let [a, b] = ends.map(|v| self.mesh.positions[v as usize]);
        self.mesh.positions.push((1.0 - along) * a + along * b);
        self.provenance.insert_on_edge(ends, along);
        self.mesh.positions.len() as u32 - 1
    }

    /// Adds a triangle on free sides. It counts as a part of the source triangle that triangle `t` is a part of.
    pub(crate) fn add_beside(&mut self, triangle: [u32; 3], t: u32) {
        let beside = self.mesh.triangles[t as usize];
        let added = self.mesh.triangles.len() as u32;
        self.mesh.triangles.push(triangle);
        self.provenance.insert_part(t);
        let others = triangle.into_iter().filter(|v| !beside.contains(v));
        others.for_each(|v| self.provenance.put_at(added, v, beside[0]));
    }

    /// Replaces triangle `t` by `parts`, which cover it: the first gets its number, the others are appended.
    pub(super) fn split_triangle(&mut self, t: usize, parts: &[[u32; 3]]) {
        self.mesh.triangles[t] = parts[0];
        self.mesh.triangles.extend(&parts[1..]);
        parts[1..].iter().for_each(|_| self.provenance.insert_part(t as u32));
    }
}

impl Deref for OrientedManifold {
    type Target = Mesh;

    fn deref(&self) -> &Mesh {
        &self.mesh
    }
}

impl TryFrom<Mesh> for OrientedManifold {
    type Error = Error;

    fn try_from(mesh: Mesh) -> Result<OrientedManifold> {
        let t = topology(mesh.positions.len(), &mesh.triangles);
        if !t.is_manifold() || !t.is_oriented() || t.vertices < mesh.positions.len() {
            let cause = "the mesh is not an oriented manifold that uses all of its vertices".into();
            return Err(Error::Mesh { fault: Fault::NotManifold, cause, remedy: "repair it first".into() });
        }
        let provenance = Provenance::identity(mesh.positions.len(), mesh.triangles.len());
        Ok(OrientedManifold { mesh, provenance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_oriented_manifolds_are_taken() {
        let mesh = |triangles: &[[u32; 3]]| Mesh {
            positions: [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].into(),
            triangles: triangles.into(),
        };
        assert!(OrientedManifold::try_from(mesh(&[[0, 1, 2], [0, 2, 3]])).is_ok());
        for wrong in [&[[0, 1, 2], [0, 3, 2]][..], &[[0, 1, 2]], &[[0, 1, 2], [0, 2, 3], [2, 0, 1]]] {
            assert!(OrientedManifold::try_from(mesh(wrong)).is_err());
        }
    }
}
