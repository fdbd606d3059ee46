//! The one error of the library. Every variant says where and what is wrong, and what to do about it.

use std::fmt;

/// What can go wrong between a given mesh and a wanted one.
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
        /// The kind of fault.
        fault: Fault,
        /// What is wrong.
        cause: String,
        /// What to do about it.
        remedy: String,
    },
    /// An option outside of its range, or two that exclude each other.
    #[error("{option}: {cause}; {remedy}")]
    Option {
        /// Which option.
        option: Setting,
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
    /// The same error with `name` as its file, for readers that see bytes and not names.
    #[must_use]
    pub fn in_file(self, name: &str) -> Self {
        match self {
            Error::Format { place, cause, remedy, .. } => Error::Format { file: name.into(), place, cause, remedy },
            Error::Mesh { cause, remedy, .. } => {
                Error::Format { file: name.into(), place: Place::Whole, cause, remedy }
            }
            other => other,
        }
    }
}

/// What is wrong with a mesh or with points, for programs that match on an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// It has no triangles, or there are no points.
    Empty,
    /// All of it is on a line or at one place.
    NoArea,
    /// A coordinate is not finite, or too large.
    Coordinates,
    /// A triangle has a corner that does not exist.
    Indices,
    /// Lists that belong together differ in length.
    Lengths,
    /// It is not an oriented manifold.
    NotManifold,
    /// The wanted vertices would be too near to each other.
    TooNarrow,
    /// No surface goes through the points, or the faces do not form one: cells of a volume, say.
    NoSurface,
    /// It does not have an attribute that was asked for.
    NoAttribute,
    /// So many vertices of it take more memory than there is to be.
    TooLarge,
}

/// What can be set, for programs that match on an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Setting {
    /// The number of vertices or samples.
    Points,
    /// The mean edge length.
    EdgeLength,
    /// The kernel width σp.
    SigmaP,
    /// The kernel width σn along normals.
    SigmaN,
    /// The properties that samples follow, and the kernel widths along these.
    Signals,
    /// How much edge lengths follow the shape.
    Adaptivity,
    /// The field of wanted edge lengths.
    Field,
    /// The distance within which boundary vertices are welded.
    Weld,
    /// Which edges are sharp.
    Features,
    /// The support radius of smoothing.
    Smoothing,
    /// The box around the part that is remeshed.
    PartBox,
    /// The marked vertices of the part that is remeshed.
    PartMarks,
    /// The bound of the error.
    MaxError,
    /// What normals are fitted to.
    NormalFit,
    /// How many neighbours normals are fitted to.
    NormalNeighbors,
    /// The radius within which normals are fitted.
    NormalRadius,
    /// The size of holes that are closed.
    FillHoles,
    /// The edge length of cells.
    Resolution,
    /// The format of a file.
    Format,
    /// The levels, from fine to coarse or by their number.
    Levels,
    /// The number of threads.
    Threads,
    /// The memory for files that are larger.
    Memory,
}

impl Setting {
    /// All of them.
    pub const ALL: [Setting; 22] = [
        Setting::Points,
        Setting::EdgeLength,
        Setting::SigmaP,
        Setting::SigmaN,
        Setting::Signals,
        Setting::Adaptivity,
        Setting::Field,
        Setting::Weld,
        Setting::Features,
        Setting::Smoothing,
        Setting::PartBox,
        Setting::PartMarks,
        Setting::MaxError,
        Setting::NormalFit,
        Setting::NormalNeighbors,
        Setting::NormalRadius,
        Setting::FillHoles,
        Setting::Resolution,
        Setting::Format,
        Setting::Levels,
        Setting::Threads,
        Setting::Memory,
    ];

    /// The name of the option that sets it, in words joined by hyphens: on the command line `--` stands before it, in
    /// Python underscores join the words.
    pub fn name(self) -> &'static str {
        match self {
            Setting::Points => "points",
            Setting::EdgeLength => "edge-length",
            Setting::SigmaP => "sigma-p",
            Setting::SigmaN => "sigma-n",
            Setting::Signals => "sigma",
            Setting::Adaptivity => "adapt",
            Setting::Field => "sizing",
            Setting::Weld => "weld",
            Setting::Features => "features",
            Setting::Smoothing => "smooth",
            Setting::PartBox => "within",
            Setting::PartMarks => "select",
            Setting::MaxError => "max-error",
            Setting::NormalFit => "normal-fit",
            Setting::NormalNeighbors => "normal-neighbors",
            Setting::NormalRadius => "normal-radius",
            Setting::FillHoles => "fill-holes",
            Setting::Resolution => "resolution",
            Setting::Format => "format",
            Setting::Levels => "levels",
            Setting::Threads => "threads",
            Setting::Memory => "memory",
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Setting::Points => "number of points",
            Setting::EdgeLength => "edge length",
            Setting::SigmaP => "kernel width σp",
            Setting::SigmaN => "kernel width σn",
            Setting::Signals => "signals",
            Setting::Adaptivity => "adaptivity",
            Setting::Field => "field of edge lengths",
            Setting::Weld => "weld distance",
            Setting::Features => "feature angle",
            Setting::Smoothing => "support radius of smoothing",
            Setting::PartBox => "box of the part",
            Setting::PartMarks => "marks of the part",
            Setting::MaxError => "error bound",
            Setting::NormalFit => "fit of normals",
            Setting::NormalNeighbors => "neighbours for normals",
            Setting::NormalRadius => "radius for normals",
            Setting::FillHoles => "size of holes to fill",
            Setting::Resolution => "resolution",
            Setting::Format => "format",
            Setting::Levels => "levels",
            Setting::Threads => "number of threads",
        })
    }
}

/// Where in a file something is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// No single place: the file as a whole.
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
