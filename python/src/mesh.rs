//! Meshes and clouds passed from Python to the library.

use crate::arrays::{matrix_of, positions, texture, triangles};
use crate::attributes::{Attributes, merged};
use crate::errors::argument;
use numpy::{PyReadonlyArray1, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_remesh::Input;
use spectral_remesh::stages::geom::polygon::triangulate;
use std::sync::Arc;

/// A mesh with attributes, or points if there are no faces. It is a copy that the library owns.
#[pyclass(frozen)]
pub struct Mesh(pub Arc<Parts>);

/// A mesh and its attributes.
pub struct Parts {
    pub mesh: spectral_remesh::Mesh,
    pub attributes: spectral_remesh::Attributes,
}

impl Parts {
    /// Returns the input for a job.
    pub fn input(&self) -> Input<'_> {
        Input::from(&self.mesh).with_attributes(&self.attributes)
    }
}

#[pymethods]
impl Mesh {
    /// The shapes are: `vertices` and `faces` (n, 3), each of `arrays` (n, components), `texture_coordinates` (faces, 3, 2).
    #[new]
    #[pyo3(signature = (vertices, faces, arrays, texture_coordinates, base))]
    fn new(
        vertices: &Bound<PyAny>,
        faces: Option<&Bound<PyAny>>,
        arrays: &Bound<PyDict>,
        texture_coordinates: Option<PyReadonlyArray3<f64>>,
        base: Option<&Attributes>,
    ) -> PyResult<Mesh> {
        let mesh = spectral_remesh::Mesh {
            positions: positions(vertices)?,
            triangles: faces.map(triangles).transpose()?.unwrap_or_default(),
        };
        let texture = texture_coordinates.as_ref().map(texture).unwrap_or_default();
        let attributes = merged(arrays, texture, base.map(|base| &*base.0))?;
        Ok(Mesh(Arc::new(Parts { mesh, attributes })))
    }
}

/// Splits polygons into triangles. `corners` has the vertices of all polygons in order, `sizes` the number of corners of each.
#[pyfunction]
pub fn split(
    py: Python,
    vertices: &Bound<PyAny>,
    corners: PyReadonlyArray1<i64>,
    sizes: PyReadonlyArray1<i64>,
) -> PyResult<Py<PyAny>> {
    let positions = positions(vertices)?;
    let mut rest = corners.as_slice()?;
    let mut all = Vec::new();
    for (face, &size) in sizes.as_slice()?.iter().enumerate() {
        let cut = usize::try_from(size).ok().and_then(|size| rest.split_at_checked(size));
        let (polygon, others) =
            cut.ok_or_else(|| argument("faces", format!("face {face} does not have {size} corners")))?;
        rest = others;
        let refuse = |v| argument("faces", format!("face {face} has the corner {v}, but there is no such vertex"));
        let place = |&v: &i64| usize::try_from(v).ok().and_then(|v| positions.get(v)).copied().ok_or_else(|| refuse(v));
        let places: PyResult<Vec<_>> = polygon.iter().map(place).collect();
        all.extend(triangulate(&places?).into_iter().flatten().map(|k| polygon[k]));
    }
    matrix_of(py, all, 3)
}
