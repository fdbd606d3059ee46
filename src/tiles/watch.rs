//! Runs work on one tile after the other, with a monitor for each of them.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};

/// Monitor of one of many tiles: it only passes on cancellation.
pub(super) struct OfTile<'a>(pub &'a dyn Monitor);

impl Monitor for OfTile<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// Runs `work` for each of `numbers`.
pub(super) fn one_by_one(numbers: &[usize], work: impl Fn(usize) -> Result<()>, monitor: &dyn Monitor) -> Result<()> {
    for (done, &number) in numbers.iter().enumerate() {
        check(monitor)?;
        work(number)?;
        monitor.progress((done + 1) as f64 / numbers.len() as f64);
    }
    Ok(())
}
