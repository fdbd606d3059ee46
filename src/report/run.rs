//! The part that the reports of all runs share.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// What a run has to say, how long it took, and with which resources: the last members of every report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// Things a user should know, a sentence each.
    pub notes: Vec<String>,
    /// Seconds of each stage, in the order in which they ran.
    pub stages: Vec<Lap>,
    /// Most memory that the process had at once, in bytes, where the system tells.
    pub peak_memory_bytes: Option<u64>,
    /// Threads that the run could use.
    pub threads: usize,
}

/// A stage and its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lap {
    /// The stage's name, as the progress bar shows it.
    pub name: String,
    /// How long it took by the clock, in seconds.
    pub seconds: f64,
}

impl RunSummary {
    /// The summary of a run that has not been measured: these notes, one thread.
    pub fn of_notes(notes: Vec<String>) -> RunSummary {
        RunSummary { notes, stages: Vec::new(), peak_memory_bytes: None, threads: 1 }
    }

    /// Adds the times, the memory and the threads of the run.
    pub fn measure(&mut self, laps: &[(&str, Duration)], peak_memory_bytes: Option<u64>, threads: usize) {
        let lap = |&(name, time): &(&str, Duration)| Lap { name: name.into(), seconds: time.as_secs_f64() };
        self.stages = laps.iter().map(lap).collect();
        (self.peak_memory_bytes, self.threads) = (peak_memory_bytes, threads);
    }

    /// A line for each note.
    pub(super) fn note_lines(&self) -> String {
        self.notes.iter().map(|note| format!("note: {note}\n")).collect()
    }
}

/// A report as indented JSON that ends with a line break.
pub(super) fn to_json(report: &impl Serialize) -> String {
    serde_json::to_string_pretty(report).expect("a report is plain data with text keys") + "\n"
}
