//! Converts numpy arrays to the types of the library, and back. Each number is copied at most once either way.

use crate::errors::argument;
use glam::{DVec2, DVec3};
use numpy::ndarray::ArrayView2;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray3};
use pyo3::prelude::*;

/// Calls `$convert` with a view of `$array` if that is a matrix of one of the given types.
macro_rules! matrix {
    ($array:expr, [$($type:ty),*], $convert:ident) => {
        $(if let Ok(array) = $array.cast::<PyArray2<$type>>() {
            $convert(array.readonly().as_array())
        } else)* {
            Err(argument_of_no_type($array))
        }
    };
}

/// Converts rows of x, y and z to positions.
///
/// # Errors
/// `TypeError` for an element type that the Python half should have converted.
pub fn positions(array: &Bound<PyAny>) -> PyResult<Vec<DVec3>> {
    matrix!(array, [f64, f32, i64, i32, i16, i8, u64, u32, u16, u8], vectors)
}

/// Converts rows of three vertex indices to triangles.
///
/// # Errors
/// `ArgumentError` for an index that is negative or does not fit in a `u32`.
pub fn triangles(array: &Bound<PyAny>) -> PyResult<Vec<[u32; 3]>> {
    matrix!(array, [i64, i32, u32, u64, i16, u16, i8, u8], corners)
}

/// Converts texture coordinates of shape (triangles, 3, 2).
pub fn texture(array: &PyReadonlyArray3<f64>) -> Vec<[DVec2; 3]> {
    let array = array.as_array();
    let at = |t: usize, k: usize| DVec2::new(array[[t, k, 0]], array[[t, k, 1]]);
    (0..array.shape()[0]).map(|t| [0, 1, 2].map(|k| at(t, k))).collect()
}

/// Number types that convert to f64, some integers of eight bytes with rounding.
pub trait Number: Element + Copy {
    fn to_f64(self) -> f64;
}

macro_rules! numbers {
    ($($type:ty),*) => { $(impl Number for $type { fn to_f64(self) -> f64 { self as f64 } })* };
}

numbers!(f64, f32, i64, i32, i16, i8, u64, u32, u16, u8);

fn vectors<T: Number>(rows: ArrayView2<T>) -> PyResult<Vec<DVec3>> {
    Ok(rows.rows().into_iter().map(|row| DVec3::new(row[0].to_f64(), row[1].to_f64(), row[2].to_f64())).collect())
}

fn corners<T: Element + Copy + std::fmt::Display>(rows: ArrayView2<T>) -> PyResult<Vec<[u32; 3]>>
where
    u32: TryFrom<T>,
{
    let refuse = |t: usize, corner: T| {
        argument("faces", format!("face {t} has the corner {corner}, but there is no such vertex"))
    };
    let corner = |t: usize, corner: T| u32::try_from(corner).map_err(|_| refuse(t, corner));
    let rows = rows.rows().into_iter().enumerate();
    rows.map(|(t, row)| Ok([corner(t, row[0])?, corner(t, row[1])?, corner(t, row[2])?])).collect()
}

fn argument_of_no_type(array: &Bound<PyAny>) -> PyErr {
    let type_name = array.get_type().name().map_or_else(|_| "this".into(), |name| name.to_string());
    pyo3::exceptions::PyTypeError::new_err(format!("{type_name} is not a matrix of numbers"))
}

/// Returns a matrix with the given number of columns from its numbers in row-major order, without copying them.
pub fn matrix_of<T: Element>(py: Python, numbers: Vec<T>, columns: usize) -> PyResult<Py<PyAny>> {
    let rows = numbers.len() / columns.max(1);
    let array = PyArray1::from_vec(py, numbers).reshape([rows, columns])?;
    Ok(array.into_any().unbind())
}

/// Returns a matrix with a row of x, y and z for each point.
pub fn of_positions(py: Python, positions: &[DVec3]) -> PyResult<Py<PyAny>> {
    matrix_of::<f64>(py, bytemuck::cast_slice(positions).to_vec(), 3)
}

/// Returns a matrix with a row of three vertex indices for each triangle.
pub fn of_corners<'a>(py: Python, corners: impl Iterator<Item = &'a [u32; 3]>) -> PyResult<Py<PyAny>> {
    matrix_of(py, corners.flatten().map(|&v| i64::from(v)).collect(), 3)
}
