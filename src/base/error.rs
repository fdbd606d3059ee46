//! The library's single error type. Every variant says where and what is wrong, and what to do about it.

use std::fmt;

/// Everything that can go wrong between an input mesh and its result.
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
    /// The content of a file violates its format.
    #[error("{file}{place}: {cause}; {remedy}")]
    Format {
        /// The file's name, as it was given; empty if the reader sees only bytes.
        file: String,
        /// The place in the file.
        place: Place,
        /// What is wrong.
        cause: String,
        /// What to do about it.
        remedy: String,
    },
    /// A mesh that no stage can process: it has no triangles, no area, or coordinates that are not finite.
    #[error("{cause}; {remedy}")]
    Mesh {
        /// The kind of fault.
        fault: Fault,
        /// What is wrong.
        cause: String,
        /// What to do about it.
        remedy: String,
    },
    /// An option that is out of range, or two that exclude each other.
    #[error("{option}: {cause}; {remedy}")]
    Option {
        /// The option.
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
    /// Returns the same error with `name` as its file, for readers that see bytes but no names.
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

/// Kind of fault of a mesh or of points, for programs that match on an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// There are no triangles, or no points.
    Empty,
    /// Everything lies on a line or at a single place.
    NoArea,
    /// A coordinate is too large or not finite.
    Coordinates,
    /// A triangle refers to a vertex that does not exist.
    Indices,
    /// Lists that belong together differ in length.
    Lengths,
    /// The mesh is not an oriented manifold.
    NotManifold,
    /// The requested vertices would be too close together.
    TooNarrow,
    /// No surface passes through the points, or the faces do not form a surface: for example, cells of a volume.
    NoSurface,
    /// An attribute that was asked for is missing.
    NoAttribute,
    /// Processing this many vertices takes more memory than is allowed.
    TooLarge,
}

/// An option, for programs that match on an error.
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
    /// The properties that samples follow, and the kernel widths along them.
    Signals,
    /// How strongly edge lengths adapt to the shape.
    Adaptivity,
    /// The field of target edge lengths.
    Field,
    /// The distance within which boundary vertices are welded.
    Weld,
    /// The choice of sharp edges.
    Features,
    /// The support radius of smoothing.
    Smoothing,
    /// The box around the part to remesh.
    PartBox,
    /// The marked vertices of the part to remesh.
    PartMarks,
    /// The error bound.
    MaxError,
    /// The surface that is fitted for normals.
    NormalFit,
    /// The number of neighbours to which normals are fitted.
    NormalNeighbors,
    /// The radius within which normals are fitted.
    NormalRadius,
    /// The size of holes to close.
    FillHoles,
    /// The edge length of grid cells.
    Resolution,
    /// The format of a file.
    Format,
    /// The levels of detail, from fine to coarse or by number.
    Levels,
    /// The number of threads.
    Threads,
    /// The memory for files that are larger.
    Memory,
}

impl Setting {
    /// All settings.
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

    /// Returns the name of the option, in words joined by hyphens. The command line puts `--` before it; Python joins the
    /// words by underscores.
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
            Setting::Field => "sizing field",
            Setting::Weld => "weld distance",
            Setting::Features => "feature angle",
            Setting::Smoothing => "support radius of smoothing",
            Setting::PartBox => "box of the part to remesh",
            Setting::PartMarks => "selection of the part to remesh",
            Setting::MaxError => "error bound",
            Setting::NormalFit => "shape fitted for normals",
            Setting::NormalNeighbors => "number of neighbours for normals",
            Setting::NormalRadius => "radius for normals",
            Setting::FillHoles => "size of holes to fill",
            Setting::Resolution => "resolution",
            Setting::Format => "format",
            Setting::Levels => "levels",
            Setting::Threads => "number of threads",
            Setting::Memory => "memory limit",
        })
    }
}

/// The place of a fault in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// No single place: the file as a whole.
    Whole,
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A byte offset in a binary file, counted from 0.
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
