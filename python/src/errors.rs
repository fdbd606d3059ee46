//! Errors of the library as exceptions of Python.

use pyo3::PyErr;
use spectral_remesh::{Error, Fault, Setting};

pyo3::import_exception!(spectral_remesh._errors, SpectralRemeshError);
pyo3::import_exception!(spectral_remesh._errors, ArgumentError);
pyo3::import_exception!(spectral_remesh._errors, FileError);
pyo3::import_exception!(spectral_remesh._errors, FormatError);
pyo3::import_exception!(spectral_remesh._errors, MeshError);

/// The exception for an error. Options are named as arguments of Python; so are arrays that make no mesh.
pub fn exception(error: &Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::File { .. } => FileError::new_err(text),
        Error::Format { .. } => FormatError::new_err(text),
        Error::Mesh { fault: Fault::Coordinates, .. } => argument("vertices", text),
        Error::Mesh { fault: Fault::Indices, .. } => argument("faces", text),
        Error::Mesh { fault: Fault::Lengths, .. } => argument("attributes", text),
        Error::Mesh { .. } => MeshError::new_err(text),
        Error::Option { option, cause, remedy } => argument(&keyword(*option), format!("{cause}; {remedy}")),
        _ => SpectralRemeshError::new_err(text),
    }
}

/// The error for an argument: its name and the cause.
pub fn argument(name: &str, cause: impl Into<String>) -> PyErr {
    ArgumentError::new_err((name.to_owned(), cause.into()))
}

/// The argument that a setting is.
fn keyword(setting: Setting) -> String {
    setting.name().replace('-', "_")
}
