//! Converts the library's errors to Python exceptions.

use pyo3::PyErr;
use spectral_remesh::{Error, Fault, Setting};

pyo3::import_exception!(spectral_remesh._errors, SpectralRemeshError);
pyo3::import_exception!(spectral_remesh._errors, ArgumentError);
pyo3::import_exception!(spectral_remesh._errors, FileError);
pyo3::import_exception!(spectral_remesh._errors, FormatError);
pyo3::import_exception!(spectral_remesh._errors, MeshError);

/// Returns the exception for an error. Errors in options and in the arrays of a mesh name the Python argument.
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

/// Returns the `ArgumentError` for the argument `name`.
pub fn argument(name: &str, cause: impl Into<String>) -> PyErr {
    ArgumentError::new_err((name.to_owned(), cause.into()))
}

/// Returns the name of a setting's Python argument.
fn keyword(setting: Setting) -> String {
    setting.name().replace('-', "_")
}
