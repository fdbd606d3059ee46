//! The outcome of a job.

use crate::mesh::attributes::Attributes;
use crate::mesh::provenance::PointOnTriangle;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::Edges;
use crate::report::Report;
use crate::transfer::vertex::Carried;
use std::sync::Arc;

/// Where on the input a vertex of the result lies: at the point of the input closest to it, among those that face the same
/// way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// The triangle of the input; `None` for points without triangles.
    pub triangle: Option<u32>,
    /// The corners of the triangle, or the points between which it lies.
    pub vertices: [u32; 3],
    /// Barycentric coordinates of the point, none negative, with sum 1.
    pub weights: [f64; 3],
}

impl Origin {
    /// Makes the origin of a point on a mesh with these triangles.
    pub(super) fn on_mesh(point: &PointOnTriangle, triangles: &[[u32; 3]]) -> Origin {
        let PointOnTriangle { triangle, weights } = *point;
        Origin { triangle: Some(triangle), vertices: triangles[triangle as usize], weights }
    }

    /// Returns the origin in terms of the input points at the vertices of the mesh through them.
    pub(super) fn between_points(self, points: &[u32]) -> Origin {
        Origin { triangle: None, vertices: self.vertices.map(|v| points[v as usize]), ..self }
    }
}

/// A remeshed surface with all that is known about it.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The result, in the coordinates of the input.
    pub mesh: Mesh,
    /// Its attributes.
    pub attributes: Attributes,
    /// For each vertex, where on the input it lies.
    pub origins: Vec<Origin>,
    /// For each triangle, the triangle of the input below its centre; empty for points without triangles.
    pub triangle_origins: Vec<u32>,
    /// Its sharp edges, those of the input that were left out, and the wanted edge lengths.
    pub edges: Edges,
    /// The mesh through the points of a cloud, which was remeshed; `None` for an input with triangles.
    pub of_points: Option<Arc<Mesh>>,
    /// Why the result is not what was asked for, one phrase each; empty for a verified result.
    pub shortcomings: Vec<String>,
    /// What a user should know, one sentence each; the report has these notes, too.
    pub notes: Vec<String>,
    /// Those notes that say which parts of the input are missing or changed in the result, and why: components, points,
    /// noise.
    pub warnings: Vec<String>,
    /// What was done, and how good the result is; `None` if no report was wanted.
    pub report: Option<Report>,
}

impl Outcome {
    /// Makes the outcome for the `mesh` of a cloud that was made piece by piece, with its attributes and the `wanted` number
    /// of vertices, and notes on the cloud. It has what can be measured on the mesh alone.
    #[cfg(feature = "fs")]
    pub(super) fn of_pieces(mesh: Mesh, carried: Carried, wanted: Option<usize>, notes: Vec<String>) -> Outcome {
        let mut report = Report::of_pieces(&mesh, &carried, wanted);
        let warnings = report.run.notes.clone();
        report.run.notes.splice(0..0, notes);
        Outcome {
            mesh,
            attributes: carried.attributes,
            origins: Vec::new(),
            triangle_origins: Vec::new(),
            edges: Edges::default(),
            of_points: None,
            shortcomings: report.faults(),
            notes: report.run.notes.clone(),
            warnings,
            report: Some(report),
        }
    }

    /// Returns x, y and z of each vertex.
    pub fn positions(&self) -> &[[f64; 3]] {
        bytemuck::cast_slice(&self.mesh.positions)
    }

    /// Returns the corner numbers of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.mesh.triangles
    }

    /// Returns the largest measured distance between the result and the input, a mesh or points, in the units of the input;
    /// `None` without a report.
    pub fn largest_distance(&self) -> Option<f64> {
        let report = self.report.as_ref()?;
        let of_mesh = report.distance.map(|distance| 0.01 * distance.hausdorff * self.mesh.diagonal());
        let of_points = report.coverage.map(|coverage| coverage.largest);
        of_mesh.into_iter().chain(of_points).reduce(f64::max)
    }

    /// Returns whether the result is what it should be: an oriented manifold of the topology of the repaired input, without
    /// self-intersections unless the input has some, without slivers that the input does not force, without bridges, and as
    /// close to the input as was asked for.
    pub fn verified(&self) -> bool {
        self.shortcomings.is_empty()
    }
}
