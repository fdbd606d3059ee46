//! The points of a cloud with their neighbours, and the places of these in the tangent planes.

use crate::spatial::kdtree::Neighbors;
use crate::spatial::knn_graph::NeighborGraph;
use crate::triangulate::unfold::along_bend;
use glam::{DQuat, DVec2, DVec3};

/// Minimum cosine between the normals of two points of the same layer, which may have sharp edges. The two sides of a thin
/// wall have less.
const LEAST_AGREEMENT: f64 = -0.2;

/// Largest sine of the angle between the offset to a neighbour that faces the same way and the plane of both. It is near
/// zero within a layer, and large towards another layer of a fold; across an edge, it may be as large as the sine of half
/// the angle.
const STEEPEST: f64 = 0.5;

/// Points and data on their neighbours.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// Positions of the points.
    pub positions: &'a [DVec3],
    /// Their unit normals.
    pub normals: &'a [DVec3],
    /// Index of the points, for neighbour queries.
    pub near: &'a Neighbors,
    /// The nearest neighbours of each point.
    pub graph: &'a NeighborGraph,
    /// Local spacing at each point.
    pub spacings: &'a [f64],
}

impl Surroundings<'_> {
    /// Circumradius of a triangle, in spacings of its corners.
    pub(super) fn relative_circumradius(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|p| self.positions[p as usize]);
        let sides = (b - a).length() * (c - b).length() * (a - c).length();
        let spacing = triangle.iter().map(|&p| self.spacings[p as usize]).fold(0.0, f64::max);
        sides / (2.0 * (b - a).cross(c - a).length() * spacing)
    }

    /// Returns the place of point `b` in the tangent plane of `a`; `None` if they do not belong to the same layer.
    pub(super) fn place(&self, a: u32, b: u32) -> Option<DVec2> {
        let (a, b) = (a as usize, b as usize);
        let offset = self.positions[b] - self.positions[a];
        let (here, there) = (self.normals[a], self.normals[b]);
        let cosine = here.dot(there);
        let half_sine = (0.5 - 0.5 * cosine).max(0.0).sqrt();
        let steepness = offset.dot((here + there).normalize_or_zero()).abs();
        let is_steep = steepness > (STEEPEST + (1.0 - STEEPEST) * half_sine) * offset.length();
        if cosine < LEAST_AGREEMENT || is_steep {
            return None;
        }
        // Seen from the mean normal, the bend is the same on both sides. So there is a direction even for a point straight
        // below one that only has the normal of one side of a sharp edge.
        let half_way = DQuat::from_rotation_arc((here + there).normalize_or(here), here);
        Some(along_bend(here, there, half_way * offset))
    }
}
