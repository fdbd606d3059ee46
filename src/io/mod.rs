//! Mesh files as bytes: readers and writers of the common formats, one a file. Names of files are in [`file`] only.

use crate::base::error::Result;
use crate::surface::mesh::Mesh;

/// A mesh as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// All triangles of the file over all its vertices. A file without faces gives vertices without triangles.
    pub mesh: Mesh,
    pub format: Format,
    /// What a user should know of what was left out, a sentence each.
    pub notes: Vec<String>,
}

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    Obj,
    Ply,
    Stl,
    Off,
    Gltf,
    Glb,
}

/// Fetches an external buffer of a glTF file by its relative address; a sentence says what went wrong.
pub type Resolve<'a> = &'a dyn Fn(&str) -> std::result::Result<Vec<u8>, String>;

/// What a format's reader gives to [`parse`]: the mesh and its notes.
pub(crate) type Parsed = Result<(Mesh, Vec<String>)>;
