//! Searches in space: hierarchies of boxes over triangles, k-d trees over points, and what is found with them.

pub mod bvh;
pub mod foot;
pub mod groups;
pub mod kdtree;
pub mod knn_graph;
pub mod order;
pub mod self_intersections;
