//! The jobs. Each takes a mesh and a dictionary of arguments, and returns arrays and a report.

use crate::arrays::{matrix_of, of_corners, of_positions};
use crate::attributes::Attributes;
use crate::mesh::Mesh;
use crate::options::{reconstructing, remeshing, sampling};
use crate::run::run;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_remesh::report::samples::SamplesReport;
use spectral_remesh::report::surface::SurfaceReport;
use spectral_remesh::report::{Report, RunSummary};
use spectral_remesh::{Attribute, Input, Monitor, Origin, Outcome, Scalar, Stopwatch};
use std::sync::Arc;

/// A report as JSON, and as a table to read.
type Told = (String, String);

/// A remeshed surface.
#[pyclass(frozen, get_all)]
pub struct Remeshed {
    /// Of shape (vertices, 3).
    vertices: Py<PyAny>,
    /// Of shape (faces, 3).
    faces: Py<PyAny>,
    attributes: Py<Attributes>,
    /// For each vertex: the face of the input that it lies on, -1 for points; the three input vertices around it; their
    /// weights.
    origin: (Py<PyAny>, Py<PyAny>, Py<PyAny>),
    /// For each face, the face of the input below it; empty for points.
    face_origin: Py<PyAny>,
    /// The two vertices of each edge that lies on a sharp edge of the input, of shape (edges, 2).
    sharp_edges: Py<PyAny>,
    report: Option<Told>,
    shortcomings: Vec<String>,
    notes: Vec<String>,
}

/// Points on a surface.
#[pyclass(frozen, get_all)]
pub struct Sampled {
    /// Of shape (points, 3).
    vertices: Py<PyAny>,
    /// Normals, and the input indices of a subset.
    attributes: Py<Attributes>,
    report: Told,
    notes: Vec<String>,
}

/// The surface of a cloud.
#[pyclass(frozen, get_all)]
pub struct Reconstructed {
    /// Of shape (vertices, 3).
    vertices: Py<PyAny>,
    /// Of shape (faces, 3).
    faces: Py<PyAny>,
    report: Told,
}

impl Remeshed {
    fn new(py: Python, outcome: Outcome) -> PyResult<Remeshed> {
        let Outcome {
            mesh,
            attributes,
            origins,
            triangle_origins,
            shortcomings,
            notes,
            warnings: _,
            report,
            edges,
            of_points: _,
        } = outcome;
        let sharp_edges = edges.sharp.iter().flatten().map(|&v| i64::from(v)).collect();
        let face_origin = triangle_origins.into_iter().map(i64::from).collect();
        Ok(Remeshed {
            vertices: of_positions(py, &mesh.positions)?,
            faces: of_corners(py, mesh.triangles.iter())?,
            attributes: Py::new(py, Attributes(Arc::new(attributes)))?,
            origin: arrays_of(py, &origins)?,
            face_origin: PyArray1::<i64>::from_vec(py, face_origin).into_any().unbind(),
            sharp_edges: matrix_of(py, sharp_edges, 2)?,
            report: report.map(|report| told(report.to_json(), &report.to_text())),
            shortcomings,
            notes,
        })
    }
}

#[pyfunction]
#[pyo3(signature = (mesh, arguments, threads, progress))]
pub fn remesh(
    py: Python,
    mesh: &Mesh,
    arguments: &Bound<PyDict>,
    threads: Option<usize>,
    progress: Option<&Bound<PyAny>>,
) -> PyResult<Remeshed> {
    let (options, parts) = (remeshing(arguments)?, Arc::clone(&mesh.0));
    let outcome = run(py, threads, progress, move |monitor| {
        let monitor = &Stopwatch::new(monitor);
        let mut outcome = spectral_remesh::remesh(&parts.input(), &options, monitor)?;
        outcome.report.iter_mut().for_each(|report| measure(&mut report.run, monitor));
        Ok(outcome)
    })?;
    Remeshed::new(py, outcome)
}

#[pyfunction]
#[pyo3(signature = (mesh, arguments, counts, threads, progress))]
pub fn levels(
    py: Python,
    mesh: &Mesh,
    arguments: &Bound<PyDict>,
    counts: Vec<usize>,
    threads: Option<usize>,
    progress: Option<&Bound<PyAny>>,
) -> PyResult<Vec<Remeshed>> {
    let (options, parts) = (remeshing(arguments)?, Arc::clone(&mesh.0));
    let outcomes = run(py, threads, progress, move |monitor| {
        let monitor = &Stopwatch::new(monitor);
        let mut outcomes = Vec::new();
        let keep = &mut |mut outcome: Outcome| {
            outcome.report.iter_mut().for_each(|report| measure(&mut report.run, monitor));
            monitor.restart();
            outcomes.push(outcome);
            Ok(())
        };
        spectral_remesh::remesh_levels(&parts.input(), &options, &counts, keep, monitor)?;
        Ok(outcomes)
    })?;
    outcomes.into_iter().map(|outcome| Remeshed::new(py, outcome)).collect()
}

#[pyfunction]
#[pyo3(signature = (mesh, arguments, threads, progress))]
pub fn sample(
    py: Python,
    mesh: &Mesh,
    arguments: &Bound<PyDict>,
    threads: Option<usize>,
    progress: Option<&Bound<PyAny>>,
) -> PyResult<Sampled> {
    let (options, parts) = (sampling(arguments)?, Arc::clone(&mesh.0));
    let (sampled, report) = run(py, threads, progress, move |monitor| {
        let monitor = &Stopwatch::new(monitor);
        let sampled = spectral_remesh::sample(&parts.input(), &options, monitor)?;
        let mut report = SamplesReport::new(&sampled, &options, String::new(), String::new());
        measure(&mut report.run, monitor);
        Ok((sampled, report))
    })?;
    let mut attributes = sampled.attributes();
    let (positions, normals) = sampled.points.into_parts();
    if !normals.is_empty() {
        let values = normals.iter().flat_map(|normal| normal.to_array()).collect();
        attributes.vertex.insert(0, Attribute { name: "normal".into(), components: 3, values, scalar: Scalar::F64 });
    }
    Ok(Sampled {
        vertices: of_positions(py, &positions)?,
        attributes: Py::new(py, Attributes(Arc::new(attributes)))?,
        report: told(report.to_json(), &report.to_text()),
        notes: sampled.notes,
    })
}

#[pyfunction]
#[pyo3(signature = (mesh, arguments, threads, progress))]
pub fn reconstruct(
    py: Python,
    mesh: &Mesh,
    arguments: &Bound<PyDict>,
    threads: Option<usize>,
    progress: Option<&Bound<PyAny>>,
) -> PyResult<Reconstructed> {
    let (options, parts) = (reconstructing(arguments)?, Arc::clone(&mesh.0));
    let (made, report) = run(py, threads, progress, move |monitor| {
        let monitor = &Stopwatch::new(monitor);
        let made = spectral_remesh::reconstruct(&parts.input(), &options, monitor)?;
        let mut report = SurfaceReport::new(&made, Vec::new(), String::new(), String::new());
        measure(&mut report.run, monitor);
        Ok((made, report))
    })?;
    Ok(Reconstructed {
        faces: of_corners(py, made.mesh.triangles.iter())?,
        vertices: of_positions(py, &made.mesh.positions)?,
        report: told(report.to_json(), &report.to_text()),
    })
}

#[pyfunction]
#[pyo3(signature = (mesh, against, threads))]
pub fn quality(py: Python, mesh: &Mesh, against: Option<&Mesh>, threads: Option<usize>) -> PyResult<Told> {
    let (parts, against) = (Arc::clone(&mesh.0), against.map(|mesh| Arc::clone(&mesh.0)));
    let report: Report = run(py, threads, None, move |monitor| {
        let monitor = &Stopwatch::new(monitor);
        monitor.stage("measure");
        let against: Option<Input> = against.as_ref().map(|parts| parts.input());
        let mut report = spectral_remesh::quality(&parts.input(), against.as_ref())?;
        measure(&mut report.run, monitor);
        Ok(report)
    })?;
    Ok(told(report.to_json(), &report.to_text()))
}

/// Adds the time of a job to its summary. Peak memory is left out, since the process belongs to the user.
fn measure(run: &mut RunSummary, monitor: &Stopwatch) {
    run.measure(&monitor.laps(), None, rayon::current_num_threads());
}

/// Returns a report as JSON and as a table, without the file names that the table begins with, since they are empty here.
fn told(json: String, table: &str) -> Told {
    let table = table.strip_prefix(" -> ").unwrap_or(table).trim_start_matches('\n');
    (json, table.into())
}

fn arrays_of(py: Python, origins: &[Origin]) -> PyResult<(Py<PyAny>, Py<PyAny>, Py<PyAny>)> {
    let faces = origins.iter().map(|origin| origin.triangle.map_or(-1, i64::from)).collect();
    let weights = origins.iter().flat_map(|origin| origin.weights).collect();
    Ok((
        PyArray1::<i64>::from_vec(py, faces).into_any().unbind(),
        of_corners(py, origins.iter().map(|origin| &origin.vertices))?,
        matrix_of::<f64>(py, weights, 3)?,
    ))
}
