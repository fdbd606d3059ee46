//! The exit status of the process.

use crate::base::error::Error;
use std::process::ExitCode;

/// The outcome of the process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The job is done; a result is verified.
    Done = 0,
    /// A file cannot be read or written, or contains no mesh that can be processed.
    File = 1,
    /// The command line is invalid.
    Usage = 2,
    /// The result is written, but fails one of the checks.
    Unverified = 3,
    /// Interrupted by Ctrl-C or a termination signal.
    Interrupted = 130,
}

impl Status {
    /// The status of a run that failed.
    pub fn of(error: &Error) -> Status {
        match error {
            Error::File { .. } | Error::Format { .. } | Error::Mesh { .. } => Status::File,
            Error::Option { .. } => Status::Usage,
            Error::Cancelled => Status::Interrupted,
        }
    }
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> ExitCode {
        ExitCode::from(status as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::error::{Fault, Setting};

    #[test]
    fn each_error_has_its_status() {
        let (cause, remedy) = (String::new(), String::new());
        let file = Error::File { file: String::new(), cause: cause.clone(), remedy: remedy.clone() };
        let mesh = Error::Mesh { fault: Fault::NoArea, cause: cause.clone(), remedy: remedy.clone() };
        let option = Error::Option { option: Setting::Points, cause, remedy };
        let found = [file, mesh.clone(), mesh.in_file("x"), option, Error::Cancelled].map(|e| Status::of(&e));
        assert_eq!(found, [Status::File, Status::File, Status::File, Status::Usage, Status::Interrupted]);
    }
}
