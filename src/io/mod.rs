//! Mesh files as bytes: readers and writers of the common formats, one module each. Only `io::file` accesses files on disk.
//!
//! ```
//! use spectral_remesh::io::{self, Format};
//!
//! let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
//! let loaded = io::parse(text, Format::Obj, io::NO_BUFFERS)?;
//! assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
//!
//! let mut bytes = Vec::new();
//! io::write(&loaded.mesh, Format::Off, &mut bytes).expect("memory does not fail");
//! assert_eq!(Format::sniff(&bytes), Some(Format::Off));
//! # Ok::<(), spectral_remesh::Error>(())
//! ```

mod address;
pub(crate) mod base64;
#[cfg(feature = "fs")]
mod beside;
mod bytes;
mod cells;
mod columns;
mod companions;
mod content;
#[cfg(feature = "fs")]
pub(crate) mod dense;
#[cfg(feature = "fs")]
mod disk;
mod e57;
mod faces;
#[cfg(feature = "fs")]
pub mod file;
mod foreign;
mod format;
mod gltf;
mod gmsh;
mod grid;
mod gzip;
#[cfg(feature = "fs")]
pub(crate) mod large;
mod las;
mod line_blocks;
mod medit;
mod mixed;
mod named;
mod numbers;
mod obj;
mod off;
#[cfg(feature = "fs")]
pub(crate) mod opened;
mod pcd;
mod ply;
mod read;
#[cfg(feature = "fs")]
pub(crate) mod spill;
mod stl;
#[cfg(feature = "fs")]
pub(crate) mod table;
mod tetrahedra;
mod text;
mod threemf;
#[cfg(feature = "fs")]
mod tileset;
mod vtk;
mod write;
mod xml;
mod xyz;

pub use companions::{Companions, companions};
pub use content::{NO_BUFFERS, Resolve};
pub use format::Format;
pub use named::{Folder, read_named};
pub use read::{Loaded, parse};
pub use write::{write, write_levels, write_points, write_with_attributes};
