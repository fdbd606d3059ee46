//! The command `remesh`, which comes with the package.

use pyo3::prelude::*;
use spectral_remesh::cli;
use std::ffi::OsString;

/// The command, from its arguments, of which the first is its name, to its exit status.
#[pyfunction]
pub fn main(py: Python, arguments: Vec<OsString>) -> u8 {
    py.detach(|| cli::main(arguments) as u8)
}
