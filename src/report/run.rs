//! The part shared by the reports of all runs.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Notes, duration and resources of a run: the last members of every report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// Notes for the user, one sentence each.
    pub notes: Vec<String>,
    /// Duration of each stage in seconds, in the order in which they ran.
    pub stages: Vec<Lap>,
    /// Peak memory of the process in bytes, if the system reports it.
    pub peak_memory_bytes: Option<u64>,
    /// Number of threads that the run could use.
    pub threads: usize,
}

/// A stage and its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lap {
    /// The stage's name, as shown by the progress bar.
    pub name: String,
    /// Its wall-clock time in seconds.
    pub seconds: f64,
}

impl RunSummary {
    /// The summary of a run that was not measured: these notes, one thread.
    pub fn of_notes(notes: Vec<String>) -> RunSummary {
        RunSummary { notes, stages: Vec::new(), peak_memory_bytes: None, threads: 1 }
    }

    /// Adds the times, the memory and the number of threads of the run.
    pub fn measure(&mut self, laps: &[(&str, Duration)], peak_memory_bytes: Option<u64>, threads: usize) {
        let lap = |&(name, time): &(&str, Duration)| Lap { name: name.into(), seconds: time.as_secs_f64() };
        self.stages = laps.iter().map(lap).collect();
        (self.peak_memory_bytes, self.threads) = (peak_memory_bytes, threads);
    }

    /// Returns one line per note.
    pub(super) fn note_lines(&self) -> String {
        self.notes.iter().map(|note| format!("note: {note}\n")).collect()
    }
}

/// Returns a report as indented JSON that ends with a line break.
pub(super) fn to_json(report: &impl Serialize) -> String {
    serde_json::to_string_pretty(report).expect("a report is plain data with text keys") + "\n"
}
