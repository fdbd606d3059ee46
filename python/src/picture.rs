//! Draws a picture of a mesh for a notebook.

use crate::camera::{Camera, Panel};
use crate::errors::SpectralRemeshError;
use crate::mesh::Mesh;
use crate::run::detached;
use crate::shade;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use spectral_remesh::stages::picture::raster::draw;

/// Samples along each side of a pixel.
const SAMPLES: usize = 3;

/// Direction to the camera: degrees around z, and above the horizon.
const VIEW: (f64, f64) = (30.0, 20.0);

/// Draws a mesh as a PNG whose longer side has `size` pixels.
#[pyfunction]
pub fn picture<'py>(py: Python<'py>, mesh: &Mesh, size: usize) -> PyResult<Bound<'py, PyBytes>> {
    let mesh = &mesh.0.mesh;
    let drawn = detached(py, || {
        let camera = Camera::new(mesh, VIEW);
        let panel = Panel::new(&camera, mesh, size, 1.0);
        let view = camera.project(mesh, &panel, SAMPLES);
        let hits = draw(view.projected(), panel.width * SAMPLES, panel.height * SAMPLES);
        encoded(&shade::resolve(&view, &hits, &panel, SAMPLES, 1.0), &panel)
    })?;
    Ok(PyBytes::new(py, &drawn.map_err(|error| SpectralRemeshError::new_err(error.to_string()))?))
}

fn encoded(pixels: &[[u8; 3]], panel: &Panel) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, panel.width as u32, panel.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(pixels.as_flattened())?;
    Ok(bytes)
}
