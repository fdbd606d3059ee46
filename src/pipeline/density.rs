//! How dense a result shall be, and what numbers and lengths make sense.

use crate::base::error::{Error, Result, Setting};

/// How dense the result shall be. Each variant says it all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// The number of vertices of the result.
    Points(usize),
    /// The mean edge length, in the units of the input.
    EdgeLength(f64),
    /// The kernel width σp of the sampler, in the units of the input.
    SigmaP(f64),
    /// As many vertices as the lengths of [`Grading::Field`](super::Grading::Field) ask for.
    OfField,
    /// As many vertices as [`Options::max_error`](super::Options::max_error) needs, and hardly more.
    Auto,
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

/// How dense samples shall be. Each variant says it all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SampleDensity {
    /// The number of samples.
    Points(usize),
    /// The mean distance of neighbouring samples, in the units of the input.
    EdgeLength(f64),
    /// The kernel width σp, in the units of the input.
    SigmaP(f64),
}

/// Fewest vertices that can be asked for: those of a triangle.
pub const FEWEST_POINTS: usize = 3;

/// Most vertices that can be asked for: the candidates for so many take some four gigabytes.
pub const MOST_POINTS: usize = 5_000_000;

/// The vertices that the search for as few as needed begins with.
pub(super) const FIRST_POINTS: usize = 2_000;

/// Refuses a length that is not positive and finite.
pub(super) fn check_length(option: Setting, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    let remedy = "give a length above zero in the units of the input".into();
    Err(Error::Option { option, cause: format!("{value} is not a length"), remedy })
}

/// Refuses numbers of vertices that are no levels of detail, from fine to coarse.
///
/// # Errors
/// [`Error::Option`] for no numbers, ones out of range, and ones that do not fall.
pub fn check_levels(counts: &[usize]) -> Result<()> {
    let refuse =
        |cause: String, remedy: &str| Err(Error::Option { option: Setting::Levels, cause, remedy: remedy.into() });
    if counts.is_empty() {
        return refuse("no number of vertices is given".into(), "give one for each level");
    }
    counts.iter().try_for_each(|&n| check_count(Setting::Levels, n, format!("{n} vertices are asked for")))?;
    match counts.windows(2).find(|pair| pair[1] >= pair[0]) {
        Some(pair) => refuse(format!("{} follows {}", pair[1], pair[0]), "give them from fine to coarse, each smaller"),
        None => Ok(()),
    }
}

pub(super) fn check_count(option: Setting, n: usize, cause: String) -> Result<()> {
    if (FEWEST_POINTS..=MOST_POINTS).contains(&n) {
        return Ok(());
    }
    Err(Error::Option { option, cause, remedy: format!("from {FEWEST_POINTS} to {MOST_POINTS} are possible") })
}
