//! The points of a cloud with their neighbours, and where these lie in their tangent planes.

use crate::spatial::kdtree::Neighbors;
use crate::spatial::knn_graph::NeighborGraph;
use crate::triangulate::unfold::along_bend;
use glam::{DQuat, DVec2, DVec3};

/// Least cosine between the normals of two points of one layer: sharp edges are part of it, the two sides of a thin wall
/// are not.
const LEAST_AGREEMENT: f64 = -0.2;

/// The largest sine between the way to a neighbour that faces the same way and the plane of both. Within a layer it is near
/// zero, towards another layer of a fold it is large; across an edge it may be anything up to the sine of half the angle.
const STEEPEST: f64 = 0.5;

/// Points, with what is known of their neighbours.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// The points.
    pub positions: &'a [DVec3],
    /// Their unit normals.
    pub normals: &'a [DVec3],
    /// The points, to be asked for neighbours.
    pub near: &'a Neighbors,
    /// The nearest neighbours of each.
    pub graph: &'a NeighborGraph,
    /// How far apart the points are around each.
    pub spacings: &'a [f64],
}

impl Surroundings<'_> {
    /// The circumradius of a triangle in spacings of its corners.
    pub(super) fn relative_circumradius(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|p| self.positions[p as usize]);
        let sides = (b - a).length() * (c - b).length() * (a - c).length();
        let spacing = triangle.iter().map(|&p| self.spacings[p as usize]).fold(0.0, f64::max);
        sides / (2.0 * (b - a).cross(c - a).length() * spacing)
    }

    /// Where point `b` lies in the tangent plane of `a`; `None` if they do not belong to one layer.
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
        // Seen from half-way the bend is the same on both sides, also from a point that has the normal of one side of a
        // sharp edge only: straight below it there is a direction, too.
        let half_way = DQuat::from_rotation_arc((here + there).normalize_or(here), here);
        Some(along_bend(here, there, half_way * offset))
    }
}
