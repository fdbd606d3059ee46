//! Files of the commands: inputs, results and reports.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, Stopwatch, check};
use crate::cli::args::{MeshFile, Run, Voice};
use crate::cli::terminal::{self, Terminal};
use crate::io::{Loaded, file};
use crate::prepare::thin::Wanted;
use crate::report::RunSummary;
use std::path::Path;

/// Rejects targets that cannot be written before the work starts.
pub(super) fn check_targets(output: &Path, run: &Run) -> Result<()> {
    file::check_target(output)?;
    check_report(run)
}

/// Rejects a report that cannot be written before the work for it starts.
pub(super) fn check_report(run: &Run) -> Result<()> {
    run.report.iter().try_for_each(|path| file::check_target(path))
}

/// Returns the content of a file; of a cloud, the wanted points.
pub(super) fn load(from: &MeshFile, wanted: Wanted, monitor: &dyn Monitor) -> Result<Loaded> {
    monitor.stage("read");
    let loaded = file::read_wanted(&from.path, from.format, wanted)?;
    check(monitor)?;
    Ok(loaded)
}

/// Returns the name of a file as it was given.
pub(super) fn name(file: &MeshFile) -> String {
    file.path.display().to_string()
}

/// Calls `work` with a monitor that shows its progress on the terminal and records the durations of its stages.
pub(super) fn watched<T>(voice: Voice, work: impl FnOnce(&Stopwatch) -> Result<T>) -> Result<T> {
    let terminal = Terminal::new(voice);
    work(&Stopwatch::new(&terminal))
}

/// Announces that files are being written from now on.
pub(super) fn now_writing(monitor: &dyn Monitor) {
    monitor.stage("write");
    terminal::now_writing();
}

/// Writes a report to its file.
pub(super) fn write_report(path: &Path, report: &str) -> Result<()> {
    file::replace_file(path, &mut |out| out.write_all(report.as_bytes()))
}

/// Writes a report to its file, as `written`, and prints it as `text` unless the run is quiet.
pub(super) fn hand_out(written: &str, text: &str, run: &Run) -> Result<()> {
    if let Some(path) = &run.report {
        write_report(path, written)?;
    }
    if run.voice == Voice::Quiet { Ok(()) } else { terminal::print(text) }
}

/// Adds the resources that the run has used so far.
pub(super) fn add_run(summary: &mut RunSummary, monitor: &Stopwatch) {
    summary.measure(&monitor.laps(), peak_memory_bytes(), rayon::current_num_threads());
}

/// Returns the peak memory of this process, if Linux reports it.
fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string(Path::new("/proc/self/status")).ok()?;
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix("kB")?;
    kilobytes.trim().parse::<u64>().ok().map(|n| 1024 * n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_has_used_a_megabyte_and_less_than_a_terabyte() {
        let peak = peak_memory_bytes().unwrap();
        assert!((1 << 20..1 << 40).contains(&peak));
    }
}
