//! The monitor of one tile of many.

use crate::base::monitor::Monitor;

/// A monitor of one tile of many: it passes on cancelling only.
pub(super) struct OfTile<'a>(pub &'a dyn Monitor);

impl Monitor for OfTile<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
