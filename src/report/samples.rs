//! Reports on runs that only sample, as JSON with a fixed schema and as a few lines for a terminal.

use crate::pipeline::{CloudSummary, SampleLevel, SampleOptions, Sampled};
use crate::report::rows::significant;
use crate::report::run::{RunSummary, to_json};
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Name and version of the JSON schema.
pub const SAMPLES_SCHEMA: &str = "spectral-remesh/samples/1";

/// A report on samples. Its members are those of the JSON text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SamplesReport {
    /// [`SAMPLES_SCHEMA`].
    pub schema: String,
    /// Version of the tool that made the report.
    pub version: String,
    /// The name of the file that was sampled, as it was given.
    pub input: String,
    /// The name of the file that the samples were written to, as it was given.
    pub output: String,
    /// Number of samples.
    pub samples: usize,
    /// Target number of samples; `None` if the kernel width was given instead.
    pub wanted: Option<usize>,
    /// Number of points of the input, or of candidates on its surface, that were considered.
    pub candidates: usize,
    /// Whether the samples are a subset of the input's points.
    pub scan_only: bool,
    /// Kernel width σp, in the units of the input.
    pub sigma_p: f64,
    /// Kernel width σn along unit normals; `None` if it is infinite.
    pub sigma_n: Option<f64>,
    /// The levels, from coarse to fine, each a prefix of the samples; empty if none were requested.
    #[serde(default)]
    pub levels: Vec<SampleLevel>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of gradient ascent sweeps that were made.
    pub sweeps: usize,
    /// How the points of a cloud were used; `None` for a mesh, or for points that do not form a surface.
    pub cloud: Option<CloudSummary>,
    /// Notes, times, memory and threads.
    #[serde(flatten)]
    pub run: RunSummary,
}

impl SamplesReport {
    /// The report on samples of the file `input` that were written to the file `output`.
    pub fn new(sampled: &Sampled, options: &SampleOptions, input: String, output: String) -> SamplesReport {
        SamplesReport {
            schema: SAMPLES_SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            input,
            output,
            samples: sampled.points.positions().len(),
            wanted: sampled.wanted,
            candidates: sampled.candidates,
            scan_only: sampled.indices.is_some(),
            sigma_p: sampled.sigma_p,
            sigma_n: options.sigma_n.is_finite().then_some(options.sigma_n),
            levels: sampled.levels.clone(),
            seed: options.seed,
            sweeps: if sampled.indices.is_some() { 0 } else { options.sweeps },
            cloud: sampled.cloud.clone(),
            run: RunSummary::of_notes(sampled.notes.clone()),
        }
    }

    /// Returns the report as indented JSON that ends with a line break.
    pub fn to_json(&self) -> String {
        to_json(self)
    }

    /// Returns the report as a few lines of text.
    pub fn to_text(&self) -> String {
        let of = if self.scan_only { "points" } else { "candidates" };
        let mut out = format!(
            "{} -> {}\n{} samples of {} {of}, σp {}",
            self.input,
            self.output,
            self.samples,
            self.candidates,
            significant(self.sigma_p)
        );
        if let Some(sigma_n) = self.sigma_n {
            let _ = write!(out, ", σn {sigma_n}");
        }
        out.push('\n');
        for (i, SampleLevel { points, spacing, smallest_distance }) in (1..).zip(&self.levels) {
            let (spacing, smallest) = (significant(*spacing), significant(*smallest_distance));
            let _ = writeln!(
                out,
                "level {i}: the first {points}, distance to the nearest {spacing} on average, {smallest} at least"
            );
        }
        out + &self.run.note_lines()
    }
}
