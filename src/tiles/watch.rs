//! Work on one tile after the other, and the monitor of one of many.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};

/// A monitor of one tile of many: it passes on cancelling only.
pub(super) struct OfTile<'a>(pub &'a dyn Monitor);

impl Monitor for OfTile<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// Does `work` for each of the `numbers`, or without any for all that are `missing`.
pub(super) fn one_by_one(
    numbers: &[usize],
    missing: Vec<usize>,
    work: impl Fn(usize) -> Result<()>,
    monitor: &dyn Monitor,
) -> Result<()> {
    let numbers = if numbers.is_empty() { &missing } else { numbers };
    for (done, &number) in numbers.iter().enumerate() {
        check(monitor)?;
        work(number)?;
        monitor.progress((done + 1) as f64 / numbers.len() as f64);
    }
    Ok(())
}
