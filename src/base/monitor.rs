//! Progress and cancelling, as one argument. The library never prints and never reads a clock on its own:
//! whoever wants a bar, a log or seconds per stage hands in a [`Monitor`].

use crate::base::error::{Error, Result};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// What a long call tells its caller, and asks of it. `&()` is the monitor that does nothing.
pub trait Monitor: Sync {
    /// A stage of that name begins; the one before it is over.
    fn stage(&self, _name: &'static str) {}
    /// The share of the current stage that is done, in 0..=1, never falling within a stage.
    fn progress(&self, _done: f64) {}
    /// Whether the call shall end with [`Error::Cancelled`]. Once true it stays true.
    fn cancelled(&self) -> bool {
        false
    }
}

impl Monitor for () {}

/// [`Error::Cancelled`] if the monitor asks to stop.
pub fn check(monitor: &dyn Monitor) -> Result<()> {
    if monitor.cancelled() { Err(Error::Cancelled) } else { Ok(()) }
}

/// A monitor that notes how long each stage took and passes everything on to another one.
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
}
