//! Reasons why a command line leaves nothing to do.

use crate::base::error::Error;
use crate::cli::flags::worded;

/// The reason why there is nothing to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// Help or version was requested; this is its text.
    Shown(String),
    /// The arguments are invalid; one line that says why.
    Wrong(String),
}

/// Reports invalid arguments to the user.
pub(super) fn wrong(cause: &str) -> Stop {
    Stop::Wrong(format!("{cause}; see remesh --help"))
}

/// Reports options that the library rejects to the user.
pub(super) fn refused(error: &Error) -> Stop {
    wrong(&worded(error))
}

/// Converts clap's answer: help texts are kept, errors become a single line without the usage.
pub(super) fn stop(error: &clap::Error) -> Stop {
    let text = error.to_string();
    if !error.use_stderr() {
        return Stop::Shown(text);
    }
    let paragraphs = text.split("\n\n").take_while(|p| !p.starts_with("Usage:") && !p.starts_with("For more"));
    let lines: Vec<String> = paragraphs.map(|p| p.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    wrong(lines.join("; ").trim_start_matches("error: "))
}
