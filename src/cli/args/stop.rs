//! Why a command line leaves nothing to do.

use crate::base::error::Error;
use crate::cli::flags::worded;

/// Why there is nothing to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// Help or version was asked for: this is it.
    Shown(String),
    /// The arguments make no sense: one line that says why.
    Wrong(String),
}

/// What a person is told who typed what makes no sense.
pub(super) fn wrong(cause: &str) -> Stop {
    Stop::Wrong(format!("{cause}; see remesh --help"))
}

/// What a person is told whose options the library refuses.
pub(super) fn refused(error: &Error) -> Stop {
    wrong(&worded(error))
}

/// Clap's answer: what it shows as it is, what is wrong as one line without the usage.
pub(super) fn stop(error: &clap::Error) -> Stop {
    let text = error.to_string();
    if !error.use_stderr() {
        return Stop::Shown(text);
    }
    let paragraphs = text.split("\n\n").take_while(|p| !p.starts_with("Usage:") && !p.starts_with("For more"));
    let lines: Vec<String> = paragraphs.map(|p| p.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    wrong(lines.join("; ").trim_start_matches("error: "))
}
