//! The surface that everything is measured against: a triangle mesh, its topology, what was wrong with it.

mod atlas;
pub mod attributes;
pub mod bvh;
pub mod connectivity;
pub mod crossings;
pub mod curves;
pub mod cut;
pub mod domain;
pub mod features;
pub mod graph;
pub mod lift;
pub mod manifold;
pub mod mesh;
pub mod motion;
pub mod neighbors;
pub mod normals;
pub mod orient;
pub mod points;
pub mod refine;
pub mod repair;
pub mod seams;
pub mod sizing;
pub mod submanifold;
pub mod topology;
pub mod transfer;
pub mod weld;
