//! The command line: what was typed ([`args`]), what it does ([`run`],
//! [`sample`], [`reconstruct`]), and how it talks to a terminal ([`terminal`]).

pub mod args;
pub mod reconstruct;
pub mod run;
pub mod sample;
pub mod terminal;

use crate::base::error::Error;
use std::process::ExitCode;

/// How the process ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// What was asked for is done; a result is verified.
    Done = 0,
    /// A file cannot be read or written, or holds no mesh that can be worked on.
    File = 1,
    /// The command line makes no sense.
    Usage = 2,
    /// The result is written, but is not an oriented manifold of the input's topology.
    Unverified = 3,
    /// Interrupted, by Ctrl-C or a signal to end.
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

/// The whole program, from its arguments to its exit status.
pub fn main() -> ExitCode {
    let outcome = match args::parse(std::env::args_os()) {
        Ok(job) => run::run(&job),
        Err(args::Stop::Shown(text)) => terminal::print(&text).map(|()| Status::Done),
        Err(args::Stop::Wrong(cause)) => {
            terminal::complain(&cause);
            Ok(Status::Usage)
        }
    };
    outcome.unwrap_or_else(|error| terminal::failed(&error)).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_status_has_its_documented_number() {
        let all = [Status::Done, Status::File, Status::Usage, Status::Unverified, Status::Interrupted];
        assert_eq!(all.map(|s| s as u8), [0, 1, 2, 3, 130]);
        for status in all {
            let line = format!("\n  {:<4}", status as u8);
            assert!(args::AFTER_HELP.contains(&line), "{status:?} is not in the help");
        }
    }

    #[test]
    fn each_error_has_its_status() {
        let (cause, remedy) = (String::new(), String::new());
        let file = Error::File { file: String::new(), cause: cause.clone(), remedy: remedy.clone() };
        let mesh = Error::Mesh { cause: cause.clone(), remedy: remedy.clone() };
        let option = Error::Option { option: "points", cause, remedy };
        let found = [file, mesh.clone(), mesh.in_file("x"), option, Error::Cancelled].map(|e| Status::of(&e));
        assert_eq!(found, [Status::File, Status::File, Status::File, Status::Usage, Status::Interrupted]);
    }
}
