//! The one error of the library. Every variant names where, what is wrong, and what to do about it.

use std::fmt;

/// What can go wrong between a mesh as it is found and a mesh as it is wanted.
///
/// Outcomes that are not failures (a missed count, a result whose topology differs) are fields of the result instead.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be opened, read, created, written or renamed.
    #[error("{file}: {cause}; {remedy}")]
    File {
        /// The file's name, as it was given.
        file: String,
        /// What is wrong.
        cause: String,
        /// What to do about it.
        remedy: String,
    },
    /// The content of a file is not what its format says.
    #[error("{file}{place}: {cause}; {remedy}")]
    Format {
        /// The file's name, as it was given; empty from readers that see bytes only.
        file: String,
        /// Where in the file.
        place: Place,
        /// What is wrong.
        cause: String,
        /// What to do about it.
        remedy: String,
    },
    /// A mesh that no stage can work on: no triangles, no area, coordinates that are not finite.
    #[error("{cause}; {remedy}")]
    Mesh {
        /// What is wrong.
        cause: String,
        /// What to do about it.
        remedy: String,
    },
    /// An option outside of its range, or two that exclude each other.
    #[error("{option}: {cause}; {remedy}")]
    Option {
        /// The option's name on the command line, without dashes.
        option: &'static str,
        /// What is wrong.
        cause: String,
        /// What to do about it.
        remedy: String,
    },
    /// The caller's monitor asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl Error {
    /// The same error with `file` as its file, for readers that see bytes and not names.
    #[must_use]
    pub fn in_file(self, name: &str) -> Self {
        match self {
            Error::Format { place, cause, remedy, .. } => Error::Format { file: name.into(), place, cause, remedy },
            Error::Mesh { cause, remedy } => Error::Format { file: name.into(), place: Place::Whole, cause, remedy },
            other => other,
        }
    }
}

/// Where in a file something is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// No one place: the file as a whole.
    Whole,
    /// A line of a text file, from 1.
    Line(usize),
    /// A byte offset in a binary file, from 0.
    Byte(usize),
    /// A named part, such as `accessor 3`.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Whole => Ok(()),
            Place::Line(n) => write!(f, ":{n}"),
            Place::Byte(n) => write!(f, ", byte {n}"),
            Place::Part(name) => write!(f, ", {name}"),
        }
    }
}

/// A result with the library's error.
pub type Result<T> = std::result::Result<T, Error>;
