//! Elementary geometry: properties of a few points, without a mesh.

pub mod aabb;
pub mod crossing_segment;
pub mod eigen;
pub mod intersection;
pub mod packing;
pub mod polygon;
pub mod symmetric;
pub mod triangle;
pub mod vector;
