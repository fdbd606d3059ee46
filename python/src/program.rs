//! The command `remesh` of the package.

use pyo3::prelude::*;
use spectral_remesh::cli;
use std::ffi::OsString;

/// Runs the command and returns its exit status. The first argument is its name.
#[pyfunction]
pub fn main(py: Python, arguments: Vec<OsString>) -> u8 {
    py.detach(|| cli::main(arguments) as u8)
}
