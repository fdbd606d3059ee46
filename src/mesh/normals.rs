//! Vertex normals of a mesh.

use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// Returns normals with the weights of N. Max, Weights for computing vertex normals from facet normals, 1999, DOI
/// 10.1080/10867651.1999.10487501: exact on a sphere, and without undue weight for slivers.
pub fn vertex_normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let p = mesh.corners(t);
        let area_vector = mesh.area_vector(t);
        for k in 0..3 {
            let (out, back) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let weight = out.length_squared() * back.length_squared();
            if weight > 0.0 {
                normals[corners[k] as usize] += area_vector / weight;
            }
        }
    }
    normals.iter_mut().for_each(|n| *n = n.normalize_or_zero());
    normals
}
