//! The report of a run that failed.

use crate::report::run::to_json;
use serde::{Deserialize, Serialize};

/// Name and version of the JSON schema.
pub const FAILURE_SCHEMA: &str = "spectral-remesh/failure/1";

/// The report of a run that failed. Its members are those of the JSON text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// [`FAILURE_SCHEMA`].
    pub schema: String,
    /// Version of the tool that made the report.
    pub version: String,
    /// A single line that says what is wrong, where, and what to do about it.
    pub error: String,
}

impl Failure {
    /// The report of a run that failed with this error.
    pub fn new(error: String) -> Failure {
        Failure { schema: FAILURE_SCHEMA.into(), version: env!("CARGO_PKG_VERSION").into(), error }
    }

    /// Returns the report as indented JSON.
    pub fn to_json(&self) -> String {
        to_json(self)
    }
}
