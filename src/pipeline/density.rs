//! Density of a result, and the valid ranges of counts and lengths.

use crate::base::error::{Error, Result, Setting};

/// Density of a result. Each variant is complete by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// The number of vertices of the result.
    Points(usize),
    /// The mean edge length, in the units of the input.
    EdgeLength(f64),
    /// The kernel width σp of the sampler, in the units of the input.
    SigmaP(f64),
    /// The number of vertices that the lengths of [`Grading::Field`](super::Grading::Field) require.
    OfField,
    /// The fewest vertices that satisfy [`Options::max_error`](super::Options::max_error), approximately.
    Auto,
}

impl Density {
    /// Returns the number of vertices, if it is given.
    pub fn points(self) -> Option<usize> {
        match self {
            Density::Points(n) => Some(n),
            _ => None,
        }
    }

    /// Returns whether it determines the number of vertices, and this the edge lengths, instead of the other way round.
    pub(super) fn fixes_count(self) -> bool {
        matches!(self, Density::Points(_) | Density::Auto)
    }
}

impl From<SampleDensity> for Density {
    fn from(density: SampleDensity) -> Density {
        match density {
            SampleDensity::Points(n) => Density::Points(n),
            SampleDensity::EdgeLength(length) => Density::EdgeLength(length),
            SampleDensity::SigmaP(sigma) => Density::SigmaP(sigma),
        }
    }
}

/// Density of samples. Each variant is complete by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SampleDensity {
    /// The number of samples.
    Points(usize),
    /// The mean distance of neighbouring samples, in the units of the input.
    EdgeLength(f64),
    /// The kernel width σp, in the units of the input.
    SigmaP(f64),
}

impl SampleDensity {
    /// Returns the number of samples, if it is given.
    pub fn points(self) -> Option<usize> {
        Density::from(self).points()
    }
}

/// Minimum number of vertices: those of a triangle.
pub const FEWEST_POINTS: usize = 3;

/// Maximum number of vertices: the candidates for that many take about four gigabytes.
pub const MOST_POINTS: usize = 5_000_000;

/// Number of vertices at which the search for the fewest necessary ones begins.
pub(super) const FIRST_POINTS: usize = 2_000;

/// Refuses a length that is not positive and finite.
pub(super) fn check_length(option: Setting, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    let remedy = "give a length above zero in the units of the input".into();
    Err(Error::Option { option, cause: format!("{value} is not a length"), remedy })
}

/// Refuses numbers of vertices that are not levels of detail, from fine to coarse.
///
/// # Errors
/// [`Error::Option`] for an empty list, numbers out of range, and numbers that do not decrease.
pub fn check_levels(counts: &[usize]) -> Result<()> {
    let refuse =
        |cause: String, remedy: &str| Err(Error::Option { option: Setting::Levels, cause, remedy: remedy.into() });
    if counts.is_empty() {
        return refuse("no number of vertices is given".into(), "give one for each level");
    }
    counts.iter().try_for_each(|&n| check_count(Setting::Levels, n, format!("{n} vertices are asked for")))?;
    match counts.windows(2).find(|pair| pair[1] >= pair[0]) {
        Some(pair) => refuse(
            format!("{} comes after {}", pair[1], pair[0]),
            "give them from fine to coarse, each smaller than the one before",
        ),
        None => Ok(()),
    }
}

pub(super) fn check_count(option: Setting, n: usize, cause: String) -> Result<()> {
    if (FEWEST_POINTS..=MOST_POINTS).contains(&n) {
        return Ok(());
    }
    Err(Error::Option { option, cause, remedy: format!("the number must be from {FEWEST_POINTS} to {MOST_POINTS}") })
}
