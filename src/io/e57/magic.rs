//! How a file is told.

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"ASTM-E57";
