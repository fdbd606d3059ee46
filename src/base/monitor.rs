//! Progress and cancelling as one argument. The library never prints and never reads a clock on its own: callers who want a
//! progress bar, a log or the time of each stage pass in a [`Monitor`].

use crate::base::error::{Error, Result};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Receives the progress of a long call, and tells the call whether to stop. `&()` is the monitor that does nothing.
pub trait Monitor: Sync {
    /// Called when the stage with this name begins; the previous one is then over.
    fn stage(&self, _name: &'static str) {}
    /// Receives the fraction of the call that is done, in 0..=1; it never decreases.
    fn progress(&self, _done: f64) {}
    /// Returns whether the call should end with [`Error::Cancelled`]. Once true, it stays true.
    fn cancelled(&self) -> bool {
        false
    }
    /// Temporary files of about `bytes` bytes go into `folder`. The call removes the folder however it ends, or, if the folder
    /// is kept, only when it succeeds.
    fn temporary_files(&self, _folder: &Path, _bytes: u64, _is_kept: bool) {}
}

impl Monitor for () {}

/// Returns [`Error::Cancelled`] if the monitor asks to stop.
pub fn check(monitor: &dyn Monitor) -> Result<()> {
    if monitor.cancelled() { Err(Error::Cancelled) } else { Ok(()) }
}

/// A monitor for the stages of a larger call: converts the progress of each stage into that of the whole.
///
/// The plan gives the fraction of the time that each stage takes. A stage that precedes the current one in the plan begins
/// another attempt. The attempt gets the fraction that is left, so that the progress never decreases.
pub struct Overall<'a> {
    inner: &'a dyn Monitor,
    /// The end of each stage, as a fraction of an attempt.
    ends: Vec<(&'static str, f64)>,
    state: Mutex<State>,
}

/// Progress of a call.
#[derive(Default)]
struct State {
    /// The fraction that was done when the current attempt began.
    before: f64,
    /// Beginning and end of the current stage, as fractions of the attempt.
    stage: [f64; 2],
    done: f64,
}

impl<'a> Overall<'a> {
    /// A monitor that reports the progress of the whole to `inner`; `plan` lists the stages in order with their approximate
    /// durations.
    pub fn new(inner: &'a dyn Monitor, plan: &[(&'static str, f64)]) -> Self {
        let mut sum = 0.0;
        let sums: Vec<f64> = plan
            .iter()
            .map(|stage| stage.1)
            .map(|share| {
                sum += share;
                sum
            })
            .collect();
        let ends = plan.iter().zip(sums).map(|(&(name, _), end)| (name, end / sum));
        Overall { inner, ends: ends.collect(), state: Mutex::default() }
    }

    /// Returns beginning and end of a stage; `None` if it is not planned.
    fn planned(&self, name: &str) -> Option<[f64; 2]> {
        let place = self.ends.iter().position(|stage| stage.0 == name)?;
        let begin = if place == 0 { 0.0 } else { self.ends[place - 1].1 };
        Some([begin, self.ends[place].1])
    }

    /// Applies `change` to the state and reports the progress.
    fn update(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.state.lock().unwrap_or_else(|e| e.into_inner());
        change(&mut state);
        self.inner.progress(state.done);
    }
}

impl Monitor for Overall<'_> {
    fn stage(&self, name: &'static str) {
        self.inner.stage(name);
        let Some(stage) = self.planned(name) else { return };
        self.update(|state| {
            if stage[0] < state.stage[0] {
                state.before = state.done;
            }
            state.stage = stage;
        });
        self.progress(0.0);
    }
    fn progress(&self, done: f64) {
        self.update(|state| {
            let [begin, end] = state.stage;
            let of_attempt = begin + (end - begin) * done.clamp(0.0, 1.0);
            let left = 1.0 - of_attempt;
            state.done = state.done.max(1.0 - (1.0 - state.before) * left);
        });
    }
    fn cancelled(&self) -> bool {
        self.inner.cancelled()
    }
    fn temporary_files(&self, folder: &Path, bytes: u64, is_kept: bool) {
        self.inner.temporary_files(folder, bytes, is_kept);
    }
}

/// A monitor for a part of a larger call, which covers the range between two fractions of the whole.
pub struct Part<'a> {
    inner: &'a dyn Monitor,
    from: f64,
    to: f64,
}

impl<'a> Part<'a> {
    /// A monitor that reports the progress of the whole to `inner`.
    pub fn new(inner: &'a dyn Monitor, from: f64, to: f64) -> Self {
        Part { inner, from, to }
    }
}

impl Monitor for Part<'_> {
    fn stage(&self, name: &'static str) {
        self.inner.stage(name);
    }
    fn progress(&self, done: f64) {
        self.inner.progress(self.from + (self.to - self.from) * done);
    }
    fn cancelled(&self) -> bool {
        self.inner.cancelled()
    }
    fn temporary_files(&self, folder: &Path, bytes: u64, is_kept: bool) {
        self.inner.temporary_files(folder, bytes, is_kept);
    }
}

/// A monitor that records the duration of each stage and passes everything on to another monitor.
pub struct Stopwatch<'a> {
    inner: &'a dyn Monitor,
    starts: Mutex<Vec<(&'static str, Instant)>>,
}

impl<'a> Stopwatch<'a> {
    /// A stopwatch around `inner`.
    pub fn new(inner: &'a dyn Monitor) -> Self {
        Stopwatch { inner, starts: Mutex::new(Vec::new()) }
    }

    /// Returns the stages so far and their durations, in order; the last one lasts until now.
    pub fn laps(&self) -> Vec<(&'static str, Duration)> {
        let starts = self.starts.lock().unwrap_or_else(|e| e.into_inner());
        let ends = starts.iter().skip(1).map(|s| s.1).chain([Instant::now()]);
        starts.iter().zip(ends).map(|(s, end)| (s.0, end - s.1)).collect()
    }

    /// Discards all stages so far.
    pub fn restart(&self) {
        self.starts.lock().unwrap_or_else(|e| e.into_inner()).clear();
    }
}

impl Monitor for Stopwatch<'_> {
    fn stage(&self, name: &'static str) {
        self.starts.lock().unwrap_or_else(|e| e.into_inner()).push((name, Instant::now()));
        self.inner.stage(name);
    }
    fn progress(&self, done: f64) {
        self.inner.progress(done);
    }
    fn cancelled(&self) -> bool {
        self.inner.cancelled()
    }
    fn temporary_files(&self, folder: &Path, bytes: u64, is_kept: bool) {
        self.inner.temporary_files(folder, bytes, is_kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Records all progress reported to it.
    #[derive(Default)]
    struct Shares(Mutex<Vec<f64>>);

    impl Monitor for Shares {
        fn progress(&self, done: f64) {
            self.0.lock().unwrap().push(done);
        }
    }

    #[test]
    fn the_share_of_the_whole_never_falls_whatever_is_tried_again() {
        let shares = Shares::default();
        let overall = Overall::new(&shares, &[("sample", 1.0), ("relax", 3.0)]);
        for _ in 0..3 {
            overall.stage("sample");
            overall.progress(0.5);
            overall.stage("not planned");
            overall.stage("relax");
            overall.progress(1.0);
            overall.progress(0.2);
        }
        let shares = shares.0.into_inner().unwrap();
        assert!(shares.is_sorted() && shares.contains(&0.125) && shares.contains(&1.0), "{shares:?}");
    }

    #[test]
    fn parts_follow_each_other() {
        let shares = Shares::default();
        for (from, to) in [(0.0, 0.75), (0.75, 1.0)] {
            let overall = &Part::new(&shares, from, to);
            [0.0, 0.5, 1.0].iter().for_each(|&done| overall.progress(done));
        }
        assert_eq!(shares.0.into_inner().unwrap(), [0.0, 0.375, 0.75, 0.75, 0.875, 1.0]);
    }
}
