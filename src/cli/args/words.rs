//! Parsers of single words of the command line.

use crate::cli::args::stop::{Stop, wrong};
use crate::io::Format;
use crate::job::words::positive;
use crate::pipeline::{SampleDensity, Signal, Values};
use clap::ValueEnum;
use clap::builder::PossibleValue;
use std::path::PathBuf;

/// The source of the target edge lengths.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sizing {
    /// The input's property of this name.
    Property(String),
    /// A JSON file.
    File(PathBuf),
}

/// A property of the input's vertices and the width of the kernel along it.
#[derive(Debug, Clone, PartialEq)]
pub struct PropertyWidth {
    /// The name of the property.
    pub name: String,
    /// The width, in its units.
    pub sigma: f64,
}

impl From<PropertyWidth> for Signal {
    fn from(PropertyWidth { name, sigma }: PropertyWidth) -> Signal {
        Signal { values: Values::Attribute(name), sigma }
    }
}

impl Sizing {
    /// Returns the lengths; still empty for those in a file.
    pub(super) fn values(&self) -> Values {
        match self {
            Sizing::Property(name) => Values::Attribute(name.clone()),
            Sizing::File(_) => Values::Given(Vec::new()),
        }
    }
}

impl ValueEnum for Format {
    fn value_variants<'a>() -> &'a [Format] {
        &Format::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.extension()))
    }
}

impl From<String> for Sizing {
    fn from(word: String) -> Sizing {
        let path = PathBuf::from(&word);
        let is_json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        if is_json { Sizing::File(path) } else { Sizing::Property(word) }
    }
}

/// The error if no density was given.
pub(super) fn no_density() -> Stop {
    wrong("no density is given; give one of --points N, --edge-length L and --sigma-p S")
}

/// Parses a number of samples; the library decides what is too few or too many for a surface.
pub(super) fn samples(word: &str) -> Result<SampleDensity, String> {
    let count = word.parse().ok().filter(|&n| n > 0).map(SampleDensity::Points);
    count.ok_or_else(|| "it must be a whole number of at least 1".into())
}

/// Parses a box given by its lowest and highest corner; the library decides which boxes are valid.
pub(super) fn within(word: &str) -> Result<[[f64; 3]; 2], String> {
    let numbers: Option<Vec<f64>> = word.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, z0, x1, y1, z1]) => Ok([[x0, y0, z0], [x1, y1, z1]]),
        _ => Err("it must be six numbers: the lowest x, y and z of a box, then the highest".into()),
    }
}

/// Parses `NAME=VALUE`, in which the name may contain `=`.
pub(super) fn property_width(word: &str) -> Result<PropertyWidth, String> {
    let parts = word.rsplit_once('=').filter(|(name, _)| !name.is_empty());
    let (name, sigma) = parts.ok_or("it must be the name of a property, = and a width, as in quality=0.5")?;
    Ok(PropertyWidth { name: name.into(), sigma: positive(sigma)? })
}

/// Parses a positive length, or zero for none.
pub(super) fn positive_or_zero(word: &str) -> Result<f64, String> {
    let is_zero = word.parse::<f64>() == Ok(0.0);
    if is_zero { Ok(0.0) } else { positive(word).map_err(|_| "it must be a positive number, or 0".into()) }
}

/// Parses a number of bytes, as in `400M` or `2G`; each unit is a thousand times the previous one.
pub(super) fn bytes(word: &str) -> Result<u64, String> {
    let digits = word.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match word[digits.len()..].to_ascii_uppercase().trim_end_matches('B') {
        "" => 1.0,
        "K" => 1e3,
        "M" => 1e6,
        "G" => 1e9,
        "T" => 1e12,
        _ => f64::NAN,
    };
    let count = digits.parse::<f64>().map_or(f64::NAN, |number| number * unit);
    if count >= 1.0 && count.is_finite() {
        Ok(count as u64)
    } else {
        Err("it must be a size such as 400M or 2G".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        assert_eq!(
            ["7", "400M", "2G", "1.5kB", "3t"].map(bytes),
            [7, 400_000_000, 2_000_000_000, 1500, 3_000_000_000_000].map(Ok)
        );
        assert!(["", "M", "-4G", "4X", "0", "nan"].iter().all(|word| bytes(word).is_err()));
    }
}
