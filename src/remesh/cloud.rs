//! From a point cloud to a mesh through its points.

use crate::base::error::Result;
use crate::base::progress::Monitor;
use crate::surface::graph::NeighborGraph;
use crate::surface::mesh::Mesh;
use crate::surface::neighbors::Neighbors;
use crate::surface::normals::{plane_normals, sphere_normals};
use crate::surface::orient::{disagreement, orient};
use crate::surface::points::Points;
use crate::triangulate::points::{Surroundings, triangulate_points};

const NEIGHBORS: usize = 16;
const FIT_NEIGHBORS: usize = 12;

/// The mesh through all points.
pub fn surface_of(points: &Points, monitor: &dyn Monitor) -> Result<Mesh> {
    monitor.stage("normals");
    let positions = &points.positions;
    let near = Neighbors::new(positions);
    let graph = NeighborGraph::new(positions, &near, NEIGHBORS);
    let mut normals = points.normals.clone();
    if normals.is_empty() {
        normals = plane_normals(positions, &NeighborGraph::new(positions, &near, std::env::var("KK").map_or(8, |p| p.parse().unwrap())));
        monitor.stage("orient");
        orient(positions, &mut normals, &graph);
    }
    eprintln!("disagree {}", disagreement(positions, &normals, &graph));
    monitor.stage("connect");
    let spacings = graph.spacings(positions);
    let surroundings = Surroundings { positions, normals: &normals, near: &near, graph: &graph, spacings: &spacings };
    let triangles = triangulate_points(surroundings, 0.0, monitor)?;
    Ok(Mesh { positions: positions.clone(), triangles })
}
