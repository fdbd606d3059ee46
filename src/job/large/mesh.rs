//! Coarsens meshes while they are read.

use crate::base::error::{Error, Result};
use crate::base::monitor::Monitor;
use crate::io::Loaded;
use crate::io::dense::PointFile;
use crate::io::large::LargeMesh;
use crate::job::large::LargeFile;
use crate::job::large::coarseness::{coarseness_within, is_far_finer, refuse_coarser};
use crate::job::large::workspace::{Workspace, parent};
use crate::pipeline::Options;
use std::path::Path;

/// Triangles that take more than this fraction of the memory are sorted in a file.
const OF_MEMORY: u64 = 10;

/// Reads a mesh in blocks and coarsens it meanwhile, as far as `options` allow. Returns `None` for a mesh that is neither larger
/// than memory nor far finer than the result, unless all files are to be read in this way.
///
/// # Errors
/// [`Error::Option`] if all files are to be read in this way but the options need the whole mesh, or if memory does not suffice;
/// [`Error::File`] if the file cannot be read in blocks.
pub fn read_coarsened(file: &LargeFile, options: &Options, monitor: &dyn Monitor) -> Result<Option<Loaded>> {
    let &LargeFile { path, format, out_of_core, .. } = file;
    match refuse_coarser(options) {
        Err(error) if out_of_core.always => return Err(error),
        Err(_) => return Ok(None),
        Ok(()) => {}
    }
    let Some(mesh) = LargeMesh::open(path, format)? else {
        // Points are thinned while they are read.
        let is_impossible = out_of_core.always && PointFile::open(path, format)?.is_none();
        return if is_impossible { Err(not_in_blocks(path)) } else { Ok(None) };
    };
    let is_finer = mesh.keeps_attributes() && is_far_finer(mesh.faces(), options);
    if !out_of_core.always && !is_finer && !file.is_large() {
        return Ok(None);
    }
    monitor.stage("read");
    let parent = parent(out_of_core)?;
    let memory = out_of_core.memory();
    let coarseness =
        |extent| coarseness_within(memory, extent, options).map_err(|e| e.in_file(&path.display().to_string()));
    let bytes = mesh.bytes_of_triangles();
    let loaded = if bytes <= memory / OF_MEMORY {
        mesh.coarsened(None, coarseness, monitor)?
    } else {
        let workspace = Workspace::passing(&parent)?;
        workspace.announce(bytes, monitor);
        mesh.coarsened(Some(&workspace.path().join("triangles")), coarseness, monitor)?
    };
    if loaded.is_none() && out_of_core.always { Err(not_in_blocks(path)) } else { Ok(loaded) }
}

fn not_in_blocks(path: &Path) -> Error {
    Error::File {
        file: path.display().to_string(),
        cause:
            "it cannot be read in blocks: only faces in OBJ, binary PLY and binary STL, and points in binary PLY, LAS, \
                LAZ, E57 and text (XYZ) can be"
                .into(),
        remedy: "convert it, or read it as a whole".into(),
    }
}
