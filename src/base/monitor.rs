//! Progress and cancelling, as one argument. The library never prints and never reads a clock on its own: callers who
//! want a progress bar, a log or the time of each stage pass in a [`Monitor`].

use crate::base::error::{Error, Result};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// What a long call tells its caller, and asks it. `&()` is the monitor that does nothing.
pub trait Monitor: Sync {
    /// The stage with this name begins; the one before it is over.
    fn stage(&self, _name: &'static str) {}
    /// The share of the call that is done, in 0..=1, never falling.
    fn progress(&self, _done: f64) {}
    /// Whether the call should end with [`Error::Cancelled`]. Once true it stays true.
    fn cancelled(&self) -> bool {
        false
    }
    /// Temporary files of about so many bytes go into `folder`. It is removed when the call ends, unless it is kept until a call
    /// comes to its end.
    fn temporary_files(&self, _folder: &Path, _bytes: u64, _is_kept: bool) {}
}

impl Monitor for () {}

/// [`Error::Cancelled`] if the monitor asks to stop.
pub fn check(monitor: &dyn Monitor) -> Result<()> {
    if monitor.cancelled() { Err(Error::Cancelled) } else { Ok(()) }
}

/// A monitor for calls that are stages of a larger one: turns the share done of each into that of the whole.
///
/// The plan says what share of the time each stage takes. A stage that comes before the current one in the plan begins
/// another attempt, which gets what is left, so that the share never falls.
pub struct Overall<'a> {
    inner: &'a dyn Monitor,
    /// The end of each stage, as a share of an attempt.
    ends: Vec<(&'static str, f64)>,
    state: Mutex<State>,
}

/// How far a call is.
#[derive(Default)]
struct State {
    /// The share that was done when the current attempt began.
    before: f64,
    /// Begin and end of the current stage, as shares of the attempt.
    stage: [f64; 2],
    done: f64,
}

impl<'a> Overall<'a> {
    /// A monitor that reports the whole to `inner`; `plan` has the stages in their order and about how long each takes.
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

    /// Begin and end of a stage; `None` for one that is not planned.
    fn planned(&self, name: &str) -> Option<[f64; 2]> {
        let place = self.ends.iter().position(|stage| stage.0 == name)?;
        let begin = if place == 0 { 0.0 } else { self.ends[place - 1].1 };
        Some([begin, self.ends[place].1])
    }

    /// Applies `change` to the state and reports the share.
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

/// A monitor for a call that is a part of a larger one, from one share of the whole to another.
pub struct Part<'a> {
    inner: &'a dyn Monitor,
    from: f64,
    to: f64,
}

impl<'a> Part<'a> {
    /// A monitor that reports the whole to `inner`.
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

/// A monitor that records how long each stage took and passes everything on to another one.
pub struct Stopwatch<'a> {
    inner: &'a dyn Monitor,
    starts: Mutex<Vec<(&'static str, Instant)>>,
}

impl<'a> Stopwatch<'a> {
    /// A stopwatch around `inner`.
    pub fn new(inner: &'a dyn Monitor) -> Self {
        Stopwatch { inner, starts: Mutex::new(Vec::new()) }
    }

    /// Each stage so far and its duration, in order; the last one runs until now.
    pub fn laps(&self) -> Vec<(&'static str, Duration)> {
        let starts = self.starts.lock().unwrap_or_else(|e| e.into_inner());
        let ends = starts.iter().skip(1).map(|s| s.1).chain([Instant::now()]);
        starts.iter().zip(ends).map(|(s, end)| (s.0, end - s.1)).collect()
    }

    /// Forgets all stages so far.
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

    /// Records all shares that are reported to it.
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
