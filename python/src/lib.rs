//! The module `spectral_remesh._native`. It passes Python's arrays and options to the library, and returns results as
//! arrays. The interface for users is the package `spectral_remesh/`, which converts their input to the types expected here.

mod arrays;
mod attributes;
mod errors;
mod files;
mod jobs;
mod mesh;
mod options;
mod picture;
mod program;
mod run;

// Pictures in a notebook use the renderer of the example `render`. Their bits may differ between machines.
#[allow(clippy::disallowed_methods)]
#[path = "../../examples/render/camera.rs"]
mod camera;
#[allow(clippy::disallowed_methods)]
#[path = "../../examples/render/shade.rs"]
mod shade;

/// The compiled half of the package.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use crate::attributes::Attributes;
    #[pymodule_export]
    use crate::files::{read, write};
    #[pymodule_export]
    use crate::jobs::{Reconstructed, Remeshed, Sampled, levels, quality, reconstruct, remesh, sample};
    #[pymodule_export]
    use crate::mesh::{Mesh, split};
    #[pymodule_export]
    use crate::picture::picture;
    #[pymodule_export]
    use crate::program::main;

    #[pymodule_init]
    fn init(_module: &pyo3::Bound<pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        crate::run::remember_process();
        Ok(())
    }
}
