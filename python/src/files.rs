//! Reads and writes files in every format of the program.

use crate::arrays::{of_corners, of_positions};
use crate::attributes::Attributes;
use crate::errors::exception;
use crate::mesh::{Mesh, Parts};
use crate::run::{detached, run};
use pyo3::prelude::*;
use spectral_remesh::io::{Format, Loaded, file};
use spectral_remesh::{Points, Result};
use std::path::PathBuf;
use std::sync::Arc;

/// Vertices, faces, attributes and notes.
type Read = (Py<PyAny>, Py<PyAny>, Attributes, Vec<String>);

/// Reads a file.
#[pyfunction]
#[pyo3(signature = (path, format))]
pub fn read(py: Python, path: PathBuf, format: Option<&str>) -> PyResult<Read> {
    let format = known(format)?;
    let Loaded { mesh, attributes, notes, .. } = run(py, None, None, move |_| file::read_file(&path, format))?;
    let faces = of_corners(py, mesh.triangles.iter())?;
    Ok((of_positions(py, &mesh.positions)?, faces, Attributes(Arc::new(attributes)), notes))
}

/// Writes a mesh to a file, or points if it has no faces.
#[pyfunction]
#[pyo3(signature = (path, mesh, format))]
pub fn write(py: Python, path: PathBuf, mesh: &Mesh, format: Option<&str>) -> PyResult<()> {
    let format = known(format)?;
    let parts = Arc::clone(&mesh.0);
    // Once begun, a file is written to its end: signals do not interrupt it.
    detached(py, || write_parts(&path, &parts, format))?.map_err(|error| exception(&error))
}

fn write_parts(path: &std::path::Path, Parts { mesh, attributes }: &Parts, format: Option<Format>) -> Result<()> {
    if mesh.triangles.is_empty() {
        let points = Points::new(mesh.positions.clone(), attributes.normals())?;
        return file::write_points_file(path, &points, attributes, format);
    }
    file::write_file(path, mesh, attributes, format)
}

fn known(format: Option<&str>) -> PyResult<Option<Format>> {
    format.map(str::parse).transpose().map_err(|error| exception(&error))
}
