//! Parses options that are single words, for both the command line and Python. The options themselves check the range of
//! numbers.

use crate::pipeline::{Density, MaxError, NormalFit, Selection};
use crate::surface::features::Features;

/// Parses a number of vertices, or `auto`.
///
/// # Errors
/// A description of what it must be.
pub fn points(word: &str) -> Result<Density, String> {
    let count = || word.parse().ok().filter(|&n| n > 0).map(Density::Points);
    let density = if word == "auto" { Some(Density::Auto) } else { count() };
    density.ok_or_else(|| "it must be a whole number of at least 1, or auto".into())
}

/// Parses a length, or a percentage of the diagonal: `0.5%`.
///
/// # Errors
/// A description of what it must be.
pub fn max_error(word: &str) -> Result<MaxError, String> {
    let share = |number: &str| positive(number).map(|percent| MaxError::OfDiagonal(percent / 100.0));
    let error = word.strip_suffix('%').map_or_else(|| positive(word).map(MaxError::Length), share);
    error.map_err(|_| "it must be a positive length, or a positive number with a %".into())
}

/// Parses which edges are sharp: an angle in degrees, `auto` or `none`.
///
/// # Errors
/// A description of what it must be.
pub fn features(word: &str) -> Result<Features, String> {
    match word {
        "auto" => Ok(Features::Automatic),
        "none" => Ok(Features::Smooth),
        _ => positive(word).map(Features::Degrees).map_err(|_| "it must be an angle in degrees, auto or none".into()),
    }
}

/// Parses a selection of vertices: those with a given value of a property, `NAME=VALUE`, or with any value but zero, `NAME`.
/// The name may contain an = itself.
///
/// # Errors
/// A description of what it must be.
pub fn mark(word: &str) -> Result<Selection, String> {
    let parts = word.rsplit_once('=').and_then(|(property, value)| Some((property, value.parse().ok()?)));
    let (attribute, value) = parts.map_or((word, None), |(property, value)| (property, Some(value)));
    if attribute.is_empty() {
        Err("it must be the name of a property".into())
    } else {
        Ok(Selection::Marked { attribute: attribute.into(), value })
    }
}

/// Parses what is fitted to find normals: `plane` or `sphere`.
///
/// # Errors
/// A description of what it must be.
pub fn normal_fit(word: &str) -> Result<NormalFit, String> {
    let fit = NormalFit::ALL.into_iter().find(|fit| fit.name() == word);
    fit.ok_or_else(|| format!("it must be {}", NormalFit::ALL.map(NormalFit::name).join(" or ")))
}

/// Parses a positive number.
///
/// # Errors
/// A description of what it must be.
pub fn positive(word: &str) -> Result<f64, String> {
    let positive = word.parse().ok().filter(|&x: &f64| x > 0.0 && x.is_finite());
    positive.ok_or_else(|| "it must be a positive number".into())
}
