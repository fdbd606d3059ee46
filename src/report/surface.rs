//! Reports on reconstructions, as JSON with a fixed schema and as a few lines for a terminal.

use crate::base::count::{counted, counts};
use crate::mesh::topology::Topology;
use crate::pipeline::{CloudSummary, Reconstructed};
use crate::report::noise;
use crate::report::run::{RunSummary, to_json};
use serde::{Deserialize, Serialize};

/// Name and version of the JSON schema.
pub const SURFACE_SCHEMA: &str = "spectral-remesh/surface/1";

/// A report on a surface that was reconstructed from points. Its members are those of the JSON text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfaceReport {
    /// [`SURFACE_SCHEMA`].
    pub schema: String,
    /// Version of the tool that made the report.
    pub version: String,
    /// The name of the file with the points, as it was given.
    pub input: String,
    /// The name of the file that the surface was written to, as it was given.
    pub output: String,
    /// How the points were used.
    pub cloud: CloudSummary,
    /// The topology of the surface.
    pub surface: Topology,
    /// Mean spacing of the points, in the units of the input.
    pub spacing: f64,
    /// Edge length of the cells, in the units of the input.
    pub resolution: f64,
    /// Support radius of the points, in their spacings.
    pub reach: f64,
    /// Notes, times, memory and threads.
    #[serde(flatten)]
    pub run: RunSummary,
}

impl SurfaceReport {
    /// The report on the surface of the points in the file `input`, whose reading gave `notes`; the surface was written to
    /// the file `output`.
    pub fn new(made: &Reconstructed, mut notes: Vec<String>, input: String, output: String) -> SurfaceReport {
        notes.extend(noise(&made.cloud));
        SurfaceReport {
            schema: SURFACE_SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            input,
            output,
            cloud: made.cloud.clone(),
            surface: made.topology,
            spacing: made.spacing,
            resolution: made.resolution,
            reach: made.support,
            run: RunSummary::of_notes(notes),
        }
    }

    /// Returns the report as indented JSON that ends with a line break.
    pub fn to_json(&self) -> String {
        to_json(self)
    }

    /// Returns the report as a few lines of text.
    pub fn to_text(&self) -> String {
        let (s, cloud) = (&self.surface, &self.cloud);
        let points = counts(&[
            (cloud.points, "point", "points"),
            (cloud.duplicates, "duplicate", "duplicates"),
            (cloud.outliers, "outlier", "outliers"),
            (cloud.estimated_normals, "normal estimated", "normals estimated"),
            (cloud.turned_normals, "normal turned over", "normals turned over"),
        ]);
        let surface = [
            counted(s.vertices, "vertex", "vertices"),
            counted(s.faces, "face", "faces"),
            format!("Euler characteristic {}", s.euler),
            counted(s.components, "component", "components"),
            counted(s.boundary_loops, "boundary loop", "boundary loops"),
        ];
        let (points, surface) = (points.join(", "), surface.join(", "));
        let lengths = format!(
            "cell size {:.6}, point spacing {:.6}, support radius {} spacings",
            self.resolution, self.spacing, self.reach
        );
        format!("{} -> {}\n{points}\n{surface}\n{lengths}\n{}", self.input, self.output, self.run.note_lines())
    }
}
