//! Converts attributes to arrays, and back.

use crate::arrays::{Number, matrix_of};
use crate::errors::argument;
use glam::DVec2;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_remesh::{Attribute, Scalar};
use std::sync::Arc;

/// Everything that a mesh has besides vertices and faces, in the library's form: vertex attributes, texture coordinates,
/// materials and names of parts.
#[pyclass(frozen)]
pub struct Attributes(pub Arc<spectral_remesh::Attributes>);

#[pymethods]
impl Attributes {
    /// Returns the vertex attributes by name: arrays of shape (vertices,) or (vertices, components), of the type in the file.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arrays = PyDict::new(py);
        for attribute in &self.0.vertex {
            arrays.set_item(&attribute.name, array(py, attribute)?)?;
        }
        Ok(arrays)
    }

    /// Returns the texture coordinates of the corners of faces, of shape (faces, 3, 2), if there are any.
    fn texture(&self, py: Python) -> PyResult<Option<Py<PyAny>>> {
        if self.0.texture.is_empty() {
            return Ok(None);
        }
        let numbers = self.0.texture.iter().flatten().flat_map(|at| at.to_array()).collect();
        matrix_of(py, numbers, 2)?.call_method1(py, "reshape", (-1, 3, 2)).map(Some)
    }
}

/// Returns attributes made of `arrays` and `texture`, with the materials and parts of `base`. An array whose type and
/// stored bytes equal those of its attribute in `base` is replaced by that attribute, which keeps all its digits.
pub fn merged(
    arrays: &Bound<PyDict>,
    texture: Vec<[DVec2; 3]>,
    base: Option<&spectral_remesh::Attributes>,
) -> PyResult<spectral_remesh::Attributes> {
    let attribute = |(name, array): (Bound<PyAny>, Bound<PyAny>)| {
        let given = attribute(name.extract()?, &array)?;
        let old = base.and_then(|base| base.get(&given.name));
        let is_old = |old: &&Attribute| {
            (old.components, old.scalar) == (given.components, given.scalar) && stored(old) == stored(&given)
        };
        Ok(old.filter(is_old).cloned().unwrap_or(given))
    };
    let vertex: PyResult<Vec<Attribute>> = arrays.iter().map(attribute).collect();
    Ok(spectral_remesh::Attributes {
        vertex: vertex?,
        texture,
        materials: base.and_then(|base| base.materials.clone()),
        parts: base.and_then(|base| base.parts.clone()),
    })
}

/// Returns the bytes of an attribute as a file stores them.
fn stored(attribute: &Attribute) -> Vec<u8> {
    let bytes = |&value: &f64| {
        let (bytes, count) = attribute.scalar.bytes(value);
        bytes.into_iter().take(count)
    };
    attribute.values.iter().flat_map(bytes).collect()
}

/// Converts an attribute to an array of its type.
fn array<'py>(py: Python<'py>, attribute: &Attribute) -> PyResult<Bound<'py, PyAny>> {
    let bytes = PyArray1::from_vec(py, stored(attribute)).call_method1("view", (type_name(attribute.scalar),))?;
    if attribute.components == 1 { Ok(bytes) } else { bytes.call_method1("reshape", ((-1, attribute.components),)) }
}

/// Returns numpy's name of the little-endian type.
fn type_name(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::I8 => "i1",
        Scalar::U8 => "u1",
        Scalar::I16 => "<i2",
        Scalar::U16 => "<u2",
        Scalar::I32 => "<i4",
        Scalar::U32 => "<u4",
        Scalar::F32 => "<f4",
        Scalar::F64 => "<f8",
    }
}

/// Converts an array of shape (vertices, components) to an attribute.
fn attribute(name: String, array: &Bound<PyAny>) -> PyResult<Attribute> {
    let found = numbers::<f64>(array, Scalar::F64)
        .or_else(|| numbers::<f32>(array, Scalar::F32))
        .or_else(|| numbers::<u8>(array, Scalar::U8))
        .or_else(|| numbers::<i8>(array, Scalar::I8))
        .or_else(|| numbers::<u16>(array, Scalar::U16))
        .or_else(|| numbers::<i16>(array, Scalar::I16))
        .or_else(|| numbers::<u32>(array, Scalar::U32))
        .or_else(|| numbers::<i32>(array, Scalar::I32));
    let (components, values, scalar) =
        found.ok_or_else(|| argument("attributes", format!("{name} is not a matrix of numbers")))?;
    Ok(Attribute { name, components, values, scalar })
}

/// Returns the number of columns and the numbers of a matrix if it has this type.
fn numbers<T: Number + Element>(array: &Bound<PyAny>, scalar: Scalar) -> Option<(usize, Vec<f64>, Scalar)> {
    let array = array.cast::<PyArray2<T>>().ok()?.readonly();
    let view = array.as_array();
    Some((view.ncols(), view.iter().map(|&number| number.to_f64()).collect(), scalar))
}
