//! What the readers of all formats give and their writers take.

use crate::base::error::Result;
use crate::mesh::attributes::Attributes;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// Fetches an external buffer of a glTF file by its relative address; a sentence says what went wrong.
pub type Resolve<'a> = &'a dyn Fn(&str) -> std::result::Result<Vec<u8>, String>;

/// For bytes without a place: glTF files with external buffers are refused.
pub const NO_BUFFERS: Resolve<'static> = &|_| Err("external buffers need the file's folder".into());

/// What a format's reader gives to [`parse`], or the error.
pub(crate) type Parsed = Result<Read>;

/// What a file is read as.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Read {
    pub mesh: Mesh,
    pub attributes: Attributes,
    pub notes: Vec<String>,
}

/// What a format's writer writes.
pub(crate) struct Content<'a> {
    pub positions: &'a [DVec3],
    pub triangles: &'a [[u32; 3]],
    pub attributes: &'a Attributes,
}
