//! What a run that only samples did: as JSON of a fixed schema, and as a few lines for a terminal.

use crate::pipeline::{CloudSummary, SampleLevel, SampleOptions, Sampled};
use crate::report::rows::significant;
use crate::report::run::{RunSummary, to_json};
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Name and version of the JSON schema.
pub const SAMPLES_SCHEMA: &str = "spectral-remesh/samples/1";

/// A report on samples. The members are those of the JSON text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SamplesReport {
    /// [`SAMPLES_SCHEMA`].
    pub schema: String,
    /// Version of the tool that made the report.
    pub version: String,
    /// The file that was sampled, as it was named.
    pub input: String,
    /// The file that the samples went to, as it was named.
    pub output: String,
    /// The samples.
    pub samples: usize,
    /// Samples wanted; `None` if the width of the kernel was to decide.
    pub wanted: Option<usize>,
    /// Points of the input, or candidates on its surface, that were looked at.
    pub candidates: usize,
    /// Whether the samples are a subset of the input's points.
    pub scan_only: bool,
    /// Kernel width σp, in the units of the input.
    pub sigma_p: f64,
    /// Kernel width σn along unit normals; `None` if it is infinite.
    pub sigma_n: Option<f64>,
    /// The levels, from coarse to fine, each the first so many samples; empty if none were asked for.
    #[serde(default)]
    pub levels: Vec<SampleLevel>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Sweeps of ascent that were made.
    pub sweeps: usize,
    /// What became of the points of a cloud; `None` for a mesh, or for points that are no surface.
    pub cloud: Option<CloudSummary>,
    /// Notes, times, memory and threads.
    #[serde(flatten)]
    pub run: RunSummary,
}

impl SamplesReport {
    /// The report on samples of the file `input` that went to the file `output`.
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

    /// The report as indented JSON that ends with a line break.
    pub fn to_json(&self) -> String {
        to_json(self)
    }

    /// The report as a few lines for people.
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
            let _ =
                writeln!(out, "level {i}: the first {points}, nearest at {spacing} in the mean, {smallest} at least");
        }
        out + &self.run.note_lines()
    }
}
