//! What a job gives.

use crate::mesh::attributes::Attributes;
use crate::mesh::provenance::PointOnTriangle;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::Edges;
use crate::report::Report;
use crate::transfer::vertex::Carried;
use std::sync::Arc;

/// Where on the input a vertex of the result lies: the point of the input that is closest to it, of those that face its
/// way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// The triangle of the input; `None` for points without triangles.
    pub triangle: Option<u32>,
    /// The corners of the triangle, or the points that it is between.
    pub vertices: [u32; 3],
    /// The barycentric coordinates of the point, none negative, of sum 1.
    pub weights: [f64; 3],
}

impl Origin {
    /// A point of a mesh with these triangles.
    pub(super) fn on_mesh(point: &PointOnTriangle, triangles: &[[u32; 3]]) -> Origin {
        let PointOnTriangle { triangle, weights } = *point;
        Origin { triangle: Some(triangle), vertices: triangles[triangle as usize], weights }
    }

    /// The same, in terms of the points that the vertices of a mesh through points are.
    pub(super) fn between_points(self, points: &[u32]) -> Origin {
        Origin { triangle: None, vertices: self.vertices.map(|v| points[v as usize]), ..self }
    }
}

/// A remeshed surface with all that is known of it.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The result, in the coordinates of the input.
    pub mesh: Mesh,
    /// Its attributes.
    pub attributes: Attributes,
    /// For each vertex where on the input it lies.
    pub origins: Vec<Origin>,
    /// For each triangle the triangle of the input below its centre; empty for points without triangles.
    pub triangle_origins: Vec<u32>,
    /// Its sharp edges, those of the input that were left out, and the edge lengths wanted.
    pub edges: Edges,
    /// The mesh through the points of a cloud, which was remeshed; `None` for an input with triangles.
    pub of_points: Option<Arc<Mesh>>,
    /// Why the result is not what was asked for, a phrase each; empty for a verified one.
    pub shortcomings: Vec<String>,
    /// Things a user should know, a sentence each; the report has them, too.
    pub notes: Vec<String>,
    /// The notes that say which parts of the input are missing or changed in the result, and why: components, points, noise.
    pub warnings: Vec<String>,
    /// What was done, and how good the result is; `None` if it was not wanted.
    pub report: Option<Report>,
}

impl Outcome {
    /// A `mesh` of a cloud that was made piece by piece, `wanted` with so many vertices, and its attributes: what can be measured
    /// on it alone.
    #[cfg(feature = "fs")]
    pub(super) fn of_pieces(mesh: Mesh, carried: Carried, wanted: Option<usize>) -> Outcome {
        let report = Report::of_pieces(&mesh, &carried, wanted);
        Outcome {
            mesh,
            attributes: carried.attributes,
            origins: Vec::new(),
            triangle_origins: Vec::new(),
            edges: Edges::default(),
            of_points: None,
            shortcomings: report.faults(),
            notes: report.run.notes.clone(),
            warnings: report.run.notes.clone(),
            report: Some(report),
        }
    }

    /// x, y and z of each vertex.
    pub fn positions(&self) -> &[[f64; 3]] {
        bytemuck::cast_slice(&self.mesh.positions)
    }

    /// For each triangle the numbers of its corners.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.mesh.triangles
    }

    /// The largest measured distance between the result and the input, a mesh or points, in the units of the input. `None`
    /// without a report.
    pub fn largest_distance(&self) -> Option<f64> {
        let report = self.report.as_ref()?;
        let of_mesh = report.distance.map(|distance| 0.01 * distance.hausdorff * self.mesh.diagonal());
        let of_points = report.coverage.map(|coverage| coverage.largest);
        of_mesh.into_iter().chain(of_points).reduce(f64::max)
    }

    /// Whether the result is what it should be: an oriented manifold of the topology of the repaired input, without
    /// self-intersections where that has none, without slivers that it does not force, without bridges, and as near to it as was
    /// asked for.
    pub fn verified(&self) -> bool {
        self.shortcomings.is_empty()
    }
}
