//! Spatial searches: bounding-volume hierarchies over triangles, k-d trees over points, and what is built on them.

pub mod bvh;
pub mod foot;
pub mod groups;
pub mod kdtree;
pub mod knn_graph;
pub mod order;
pub mod passing_faces;
pub mod self_intersections;
