//! Converts Python arguments to the library's settings. Each job has a list of its arguments. All members are then named, as
//! for the command line, so a forgotten argument is a compile error.

use crate::errors::{argument, exception};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};
use spectral_remesh::SMOOTHING_SUPPORT;
use spectral_remesh::settings::{NormalSettings, ReconstructSettings, RemeshSettings, SampleSettings};
use spectral_remesh::{
    Density, Features, MaxError, NormalFit, ReconstructOptions, RemeshOptions, SampleDensity, SampleOptions, Selection,
    Signal, Values, words,
};

/// Defines a struct that is read from a dictionary with exactly these arguments.
macro_rules! arguments {
    ($name:ident { $($member:ident: $type:ty,)* }) => {
        struct $name { $($member: $type,)* }

        impl $name {
            fn read(given: &Bound<PyDict>) -> PyResult<$name> {
                refuse_others(given, &[$(stringify!($member)),*])?;
                Ok($name { $($member: member(given, stringify!($member))?,)* })
            }
        }
    };
}

arguments!(RemeshArguments {
    points: Option<Points>,
    edge_length: Option<f64>,
    sigma_p: Option<f64>,
    seed: u64,
    weld: Option<f64>,
    features: Option<SharpEdges>,
    adapt: Option<f64>,
    sigma_n: Option<f64>,
    sigma: Widths,
    sizing: Option<Lengths>,
    smooth: Option<Smoothing>,
    within: Option<[[f64; 3]; 2]>,
    select: Option<Marks>,
    fill_holes: f64,
    terrain: Option<bool>,
    normal_fit: Option<Fit>,
    normal_neighbors: Option<usize>,
    normal_radius: Option<f64>,
    max_error: Option<Bounded>,
    attributes: bool,
    optimize: bool,
    report: bool,
});

arguments!(SampleArguments {
    points: Option<usize>,
    edge_length: Option<f64>,
    sigma_p: Option<f64>,
    sigma_n: f64,
    sigma: Widths,
    within: Option<[[f64; 3]; 2]>,
    smooth: Option<f64>,
    normal_fit: Option<Fit>,
    normal_neighbors: Option<usize>,
    normal_radius: Option<f64>,
    scan_only: bool,
    levels: Option<usize>,
    seed: u64,
    sweeps: usize,
});

arguments!(ReconstructArguments {
    resolution: Option<f64>,
    smooth: Option<f64>,
    normal_fit: Option<Fit>,
    normal_neighbors: Option<usize>,
    normal_radius: Option<f64>,
});

/// Returns the options of `remesh`.
pub fn remeshing(given: &Bound<PyDict>) -> PyResult<RemeshOptions> {
    let RemeshArguments {
        points,
        edge_length,
        sigma_p,
        seed,
        weld,
        features,
        adapt,
        sigma_n,
        sigma,
        sizing,
        smooth,
        within,
        select,
        fill_holes,
        terrain,
        normal_fit,
        normal_neighbors,
        normal_radius,
        max_error,
        attributes,
        optimize,
        report,
    } = RemeshArguments::read(given)?;
    let settings = RemeshSettings {
        points: points.map(|Points(points)| points),
        edge_length,
        sigma_p,
        seed,
        weld,
        features: features.map(|SharpEdges(features)| features),
        adapt,
        sigma_n,
        signals: sigma.0,
        sizing: sizing.map(|Lengths(lengths)| lengths),
        smooth: smooth.map(|Smoothing(support)| support),
        within,
        select: select.map(|Marks(marks)| marks),
        fill_holes,
        terrain,
        normals: normals(normal_fit, normal_neighbors, normal_radius),
        max_error: max_error.map(|Bounded(bound)| bound),
        attributes,
        optimize,
    };
    let options = settings.resolve().map_err(|error| exception(&error))?;
    Ok(RemeshOptions { without_report: !report, ..options })
}

/// Returns the options of `sample`.
pub fn sampling(given: &Bound<PyDict>) -> PyResult<SampleOptions> {
    let SampleArguments {
        points,
        edge_length,
        sigma_p,
        sigma_n,
        sigma,
        within,
        smooth,
        normal_fit,
        normal_neighbors,
        normal_radius,
        scan_only,
        levels,
        seed,
        sweeps,
    } = SampleArguments::read(given)?;
    let settings = SampleSettings {
        points: points.map(SampleDensity::Points),
        edge_length,
        sigma_p,
        sigma_n,
        signals: sigma.0,
        within,
        smooth,
        normals: normals(normal_fit, normal_neighbors, normal_radius),
        scan_only,
        levels,
        seed,
        sweeps,
    };
    settings.resolve().map_err(|error| exception(&error))
}

/// Returns the options of `reconstruct`.
pub fn reconstructing(given: &Bound<PyDict>) -> PyResult<ReconstructOptions> {
    let ReconstructArguments { resolution, smooth, normal_fit, normal_neighbors, normal_radius } =
        ReconstructArguments::read(given)?;
    let normals = normals(normal_fit, normal_neighbors, normal_radius);
    ReconstructSettings { resolution, smooth, normals }.resolve().map_err(|error| exception(&error))
}

fn normals(fit: Option<Fit>, neighbors: Option<usize>, radius: Option<f64>) -> NormalSettings {
    NormalSettings { fit: fit.map(|Fit(fit)| fit), neighbors, radius }
}

/// Extracts one argument.
fn member<'py, T: FromPyObjectOwned<'py>>(given: &Bound<'py, PyDict>, name: &str) -> PyResult<T> {
    let value = given.get_item(name)?.ok_or_else(|| argument(name, "it is missing"))?;
    value.extract().map_err(|error| argument(name, Into::<PyErr>::into(error).value(given.py()).to_string()))
}

/// Refuses arguments that are not among `known`.
fn refuse_others(given: &Bound<PyDict>, known: &[&str]) -> PyResult<()> {
    let names: Vec<String> = given.keys().extract()?;
    let other = names.iter().find(|name| !known.contains(&name.as_str()));
    other.map_or(Ok(()), |name| Err(argument(name, "there is no such argument")))
}

/// Defines types of arguments that are parsed from text as on the command line.
macro_rules! words {
    ($($name:ident($type:ty) = $read:expr;)*) => {
        $(struct $name($type);

        impl<'a, 'py> FromPyObject<'a, 'py> for $name {
            type Error = PyErr;

            fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<$name> {
                let read = $read;
                read(&*value.str()?.to_cow()?).map($name).map_err(PyValueError::new_err)
            }
        })*
    };
}

words! {
    Points(Density) = words::points;
    Bounded(MaxError) = words::max_error;
    Fit(NormalFit) = words::normal_fit;
}

/// Sharp edges: an array of their two vertices, or the angle or word that selects them.
struct SharpEdges(Features);

impl<'a, 'py> FromPyObject<'a, 'py> for SharpEdges {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<SharpEdges> {
        let Ok(edges) = value.extract::<PyReadonlyArray2<u32>>() else {
            return words::features(&value.str()?.to_cow()?).map(SharpEdges).map_err(PyValueError::new_err);
        };
        let edges = edges.as_array();
        Ok(SharpEdges(Features::Edges(edges.rows().into_iter().map(|ends| [ends[0], ends[1]]).collect())))
    }
}

/// Edge lengths at vertices: an array, or the name of an attribute.
struct Lengths(Values);

impl<'a, 'py> FromPyObject<'a, 'py> for Lengths {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Lengths> {
        if value.is_instance_of::<PyString>() {
            return Ok(Lengths(Values::Attribute(value.extract()?)));
        }
        let lengths: PyReadonlyArray1<f64> = value.extract()?;
        Ok(Lengths(Values::Given(lengths.as_array().to_vec())))
    }
}

/// Selected vertices: an array, or the name of an attribute that marks them.
struct Marks(Selection);

impl<'a, 'py> FromPyObject<'a, 'py> for Marks {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Marks> {
        if value.is_instance_of::<PyString>() {
            return words::mark(&value.extract::<String>()?).map(Marks).map_err(PyValueError::new_err);
        }
        let marks: PyReadonlyArray1<bool> = value.extract()?;
        Ok(Marks(Selection::Vertices(marks.as_array().to_vec())))
    }
}

/// A support radius. `True` is the default for smoothing, `False` smooths nothing.
struct Smoothing(f64);

impl<'a, 'py> FromPyObject<'a, 'py> for Smoothing {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Smoothing> {
        match value.cast::<PyBool>() {
            Ok(is_wanted) => Ok(Smoothing(if is_wanted.is_true() { SMOOTHING_SUPPORT } else { 0.0 })),
            Err(_) => value.extract().map(Smoothing),
        }
    }
}

/// Attribute names with the kernel width along each.
struct Widths(Vec<Signal>);

impl<'a, 'py> FromPyObject<'a, 'py> for Widths {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Widths> {
        let signal = |(name, sigma): (Bound<PyAny>, Bound<PyAny>)| {
            Ok(Signal { values: Values::Attribute(name.extract()?), sigma: sigma.extract()? })
        };
        value.cast::<PyDict>()?.iter().map(signal).collect::<PyResult<_>>().map(Widths)
    }
}
