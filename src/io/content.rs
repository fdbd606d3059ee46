//! Input and output types of all formats' readers and writers.

use crate::base::error::Result;
use crate::mesh::attributes::Attributes;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// Fetches an external buffer of a glTF file by its relative address. The error is a sentence that says what went wrong.
pub type Resolve<'a> = &'a dyn Fn(&str) -> std::result::Result<Vec<u8>, String>;

/// Refuses external buffers: for glTF bytes without a folder.
pub const NO_BUFFERS: Resolve<'static> = &|_| Err("external buffers need the file's folder".into());

/// Result of a format's reader, which [`parse`] passes on.
pub(crate) type Parsed = Result<Read>;

/// Content read from a file.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Read {
    pub mesh: Mesh,
    pub attributes: Attributes,
    pub notes: Vec<String>,
}

/// Content that a format's writer writes.
pub(crate) struct Content<'a> {
    pub positions: &'a [DVec3],
    pub triangles: &'a [[u32; 3]],
    pub attributes: &'a Attributes,
}
