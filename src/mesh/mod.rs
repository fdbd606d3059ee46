//! Meshes and clouds as data: positions, triangles, connectivity, attributes. No spatial searches here.

pub mod attributes;
pub mod cut;
pub mod half_edge;
pub mod materials;
pub mod normals;
pub mod oriented_manifold;
pub mod parts;
pub mod points;
pub mod provenance;
pub mod refine;
pub(crate) mod sides;
pub mod submesh;
pub mod topology;
pub mod triangle_mesh;
pub mod weld;
