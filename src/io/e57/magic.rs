//! Signature of E57 files.

/// First bytes of a file.
pub(crate) const MAGIC: &[u8] = b"ASTM-E57";
