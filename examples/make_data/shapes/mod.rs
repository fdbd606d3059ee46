//! The models of `data/`, with the properties that they must have.

mod blob;
mod bracket;
mod build;
mod isosurface;
mod noisy;
mod shell;
mod terrain;

use spectral_remesh::Mesh;
use spectral_remesh::io::{Format, write};
use spectral_remesh::stages::mesh::topology::topology;

/// A model and its guaranteed properties.
pub struct Model {
    /// Its file in `data/`, whose ending determines the format.
    pub file: &'static str,
    pub mesh: Mesh,
    /// Number of handles of the surface: none for a sphere or a disk, one for a torus.
    pub genus: i64,
    /// Number of boundary loops; zero if the surface is closed.
    pub boundary_loops: usize,
}

/// Returns all models, sorted by name.
pub fn all() -> Vec<Model> {
    vec![
        Model { file: "blob.obj", mesh: blob::blob(), genus: 3, boundary_loops: 0 },
        Model { file: "bracket.stl", mesh: bracket::bracket(), genus: 2, boundary_loops: 0 },
        Model { file: "noisy.ply", mesh: noisy::noisy(), genus: 0, boundary_loops: 0 },
        Model { file: "shell.off", mesh: shell::shell(), genus: 0, boundary_loops: 0 },
        Model { file: "terrain.ply", mesh: terrain::terrain(), genus: 0, boundary_loops: 1 },
    ]
}

impl Model {
    /// Panics unless the mesh is a single oriented manifold with the expected topology, without degenerate triangles, whose
    /// normals point outwards (of a closed surface) or upwards (of an open one).
    pub fn audit(&self) {
        let t = topology(self.mesh.positions.len(), &self.mesh.triangles);
        assert!(t.is_manifold() && t.is_oriented(), "{}: {t:?}", self.file);
        assert_eq!((t.vertices, t.components), (self.mesh.positions.len(), 1), "{}: {t:?}", self.file);
        assert_eq!(t.boundary_loops, self.boundary_loops, "{}: {t:?}", self.file);
        assert_eq!(t.euler, 2 - 2 * self.genus - self.boundary_loops as i64, "{}: {t:?}", self.file);
        let areas = || (0..self.mesh.triangles.len()).map(|f| self.mesh.area_vector(f));
        assert!(areas().all(|n| n.length() > 0.0), "{}: a triangle without area", self.file);
        if self.boundary_loops == 0 {
            assert!(signed_volume(&self.mesh) > 0.0, "{}: inside out", self.file);
        } else {
            assert!(areas().all(|n| n.z > 0.0), "{}: folded over", self.file);
        }
    }

    /// Returns the content of the file.
    pub fn bytes(&self) -> std::io::Result<Vec<u8>> {
        let format = match self.file.rsplit('.').next() {
            Some("obj") => Format::Obj,
            Some("stl") => Format::Stl,
            Some("ply") => Format::Ply,
            _ => Format::Off,
        };
        let mut bytes = Vec::new();
        write(&self.mesh, format, &mut bytes)?;
        Ok(bytes)
    }
}

/// Returns the volume inside a closed surface, which is negative if the surface is inside out.
fn signed_volume(mesh: &Mesh) -> f64 {
    let six_times = |t| {
        let [a, b, c] = mesh.corners(t);
        a.dot(b.cross(c))
    };
    (0..mesh.triangles.len()).map(six_times).sum::<f64>() / 6.0
}
