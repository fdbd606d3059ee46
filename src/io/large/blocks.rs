//! What the reader of large meshes asks of a format.

use super::places::Places;
use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::io::content::Read;
use crate::io::disk::read_error;
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;

/// About the bytes of a block.
pub(super) const BLOCK: usize = 1 << 20;

/// A mesh file that can be read in blocks.
pub(super) trait Blocks {
    /// How many faces it has.
    fn faces(&self) -> u64;

    /// Whether vertices have all that it has beside its shape.
    fn keeps_attributes(&self) -> bool;

    /// Where its vertices are.
    fn places(&mut self, monitor: &dyn Monitor) -> Result<Places>;

    /// Shows all triangles, once the places are known.
    fn triangles(
        &mut self,
        places: &Places,
        monitor: &dyn Monitor,
        take: &mut dyn FnMut([u32; 3]) -> Result<()>,
    ) -> Result<()>;

    /// The vertices of these numbers, in ascending order, with their attributes.
    fn vertices(&self, numbers: &[u32], places: &Places) -> Result<Read>;
}

/// Fills `bytes` from the file.
pub(super) fn read_block(path: &Path, mut file: &File, bytes: &mut [u8]) -> Result<()> {
    file.read_exact(bytes).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => Error::File {
            file: path.display().to_string(),
            cause: "it became shorter while it was read".into(),
            remedy: "let no other program write it meanwhile".into(),
        },
        _ => read_error(path, &error),
    })
}
