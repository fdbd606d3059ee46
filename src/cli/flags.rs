//! Names of the library's settings on the command line.

use crate::base::error::{Error, Setting};

/// Returns an error in the terms of the command line.
pub(super) fn worded(error: &Error) -> String {
    match error {
        Error::Cancelled => "interrupted; no file was changed".into(),
        Error::Option { option, cause, remedy } => format!("{}: {cause}; {remedy}", flag(*option)),
        other => other.to_string(),
    }
}

pub(super) fn flag(setting: Setting) -> String {
    format!("--{}", setting.name())
}
