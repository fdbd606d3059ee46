//! Options of remeshing, and validation of their values.

use crate::base::error::{Error, Result, Setting};
use crate::pipeline::cloud::options::{INTERPOLATING_SUPPORT, check_smooth, smoothing};
use crate::pipeline::density::{Density, check_count, check_length};
use crate::pipeline::kernel::{Signal, check_kernel, check_signals};
use crate::pipeline::selection::Selection;
use crate::pipeline::values::Values;
use crate::surface::features::Features;

/// Criterion that edge lengths follow.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Grading {
    /// Even lengths.
    #[default]
    Even,
    /// The shape: edges are short where the surface is curved or thin. From 0 to 1: with 1, in proportion to the square root
    /// of the radius; with less, less so.
    Curvature(f64),
    /// A field: the target edge length at each vertex of the input, in its units. With a density other than
    /// [`Density::OfField`], all lengths are scaled by one factor to meet it.
    Field(Values),
    /// A kernel in which more than the position counts: vertices gather where the other features change.
    Kernel {
        /// Width σn along unit normals (paper, section 3 and figure 10): with 0.5 to 1, vertices gather where the surface
        /// bends. Infinite: normals do not count.
        sigma_n: f64,
        /// Properties of the input that count.
        signals: Vec<Signal>,
    },
}

/// Maximum distance of the result from the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaxError {
    /// Length, in the units of the input.
    Length(f64),
    /// Share of the diagonal of the input's bounding box: 0.001 is a tenth of a per cent.
    OfDiagonal(f64),
}

impl MaxError {
    pub(super) fn length(self, diagonal: f64) -> f64 {
        match self {
            MaxError::Length(length) => length,
            MaxError::OfDiagonal(share) => share * diagonal,
        }
    }
}

/// Options for remeshing a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Density of the result. Default: 10,000 points.
    pub density: Density,
    /// Seed of all random numbers: same seed, same input, same result. Default: 0.
    pub seed: u64,
    /// Distance, in the units of the input, within which boundary vertices are welded, which closes cracks. With zero, only
    /// vertices at exactly the same place are welded. Default: `None`, which also welds those that rounding separated along
    /// a seam, by at most a millionth of the bounding-box diagonal.
    pub weld: Option<f64>,
    /// Which edges of the input are kept sharp. Default: decided from the input.
    pub features: Features,
    /// Criterion that edge lengths follow. Default: none.
    pub grading: Grading,
    /// Support radius, in mean distances of neighbouring vertices, for smoothing noise away first: vertices move to the
    /// implicit surface of all of them. Default: `None`, which leaves them where they are, as zero does.
    pub smooth: Option<f64>,
    /// Whether the input interpolates points, as made by [`mesh_of_points`](crate::stages::pipeline::mesh_of_points): where
    /// its edges are longer than those of the result, the surface between its vertices is their implicit surface, not the
    /// flat triangles. The same holds with `smooth`. Default: false.
    pub of_points: bool,
    /// Part to be remeshed; everything else stays as it is, and the density is that of the part: [`Density::Points`] counts
    /// the vertices strictly inside it, without those on its interface with the rest. Default: `None`, everything.
    pub part: Option<Selection>,
    /// Maximum distance of any point of the result from the repaired input, and vice versa. Default: `None`, as close as the
    /// vertices allow on average.
    pub max_error: Option<MaxError>,
    /// Whether the triangles are optimised after sampling. Default: true. Otherwise the vertices stay where the paper's
    /// gradient ascent leaves them: blue noise.
    pub optimize: bool,
    /// Sweeps of gradient ascent over all samples if nothing is optimised. Default: 10, as in the paper (section 6.3); more
    /// make the triangles slightly better.
    pub sweeps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            density: Density::Points(10_000),
            seed: 0,
            weld: None,
            features: Features::Automatic,
            grading: Grading::Even,
            smooth: None,
            of_points: false,
            part: None,
            max_error: None,
            optimize: true,
            sweeps: 10,
        }
    }
}

impl Options {
    /// Returns the default options with `n` vertices.
    pub fn points(n: usize) -> Options {
        Options { density: Density::Points(n), ..Options::default() }
    }

    /// Refuses options that suit no input.
    ///
    /// # Errors
    /// [`Error::Option`] for a number of points out of range or a length that is not positive and finite.
    pub fn validate(&self) -> Result<()> {
        let distance = self.weld.filter(|&distance| distance != 0.0);
        distance.map_or(Ok(()), |distance| check_length(Setting::Weld, distance))?;
        if let Features::Degrees(degrees) = self.features
            && !(degrees > 0.0 && degrees < 180.0)
        {
            let cause = format!("{degrees} is not an angle between faces");
            return Err(Error::Option {
                option: Setting::Features,
                cause,
                remedy: "give an angle between 0 and 180 degrees".into(),
            });
        }
        check_smooth(self.smooth)?;
        self.grading.validate()?;
        self.part.as_ref().map_or(Ok(()), Selection::validate)?;
        if self.part.is_some() && self.smoothing().is_some() {
            let cause = "smoothing would also move the surface outside the part to remesh".into();
            return Err(Error::Option {
                option: Setting::Smoothing,
                cause,
                remedy: "smooth the whole surface first".into(),
            });
        }
        match self.max_error {
            Some(MaxError::Length(l)) => check_length(Setting::MaxError, l)?,
            Some(MaxError::OfDiagonal(share)) => check_length(Setting::MaxError, share)?,
            None => {}
        }
        match self.density {
            Density::OfField if !matches!(self.grading, Grading::Field(_)) => Err(Error::Option {
                option: Setting::Field,
                cause: "there are no lengths from which to take the density of the result".into(),
                remedy: "give lengths or another density".into(),
            }),
            Density::OfField => Ok(()),
            Density::Points(n) => check_count(Setting::Points, n, format!("{n} vertices are asked for")),
            Density::EdgeLength(l) => check_length(Setting::EdgeLength, l),
            Density::SigmaP(s) => check_length(Setting::SigmaP, s),
            Density::Auto if self.max_error.is_none() => Err(Error::Option {
                option: Setting::Points,
                cause: "without an error bound, the number needed is not known".into(),
                remedy: "give an error bound, or a number of points".into(),
            }),
            Density::Auto => Ok(()),
        }
    }
}

impl Options {
    /// Support radius of the implicit surface onto which vertices are moved, if any.
    pub(crate) fn smoothing(&self) -> Option<f64> {
        smoothing(self.smooth)
    }

    /// Support radius of the implicit surface between the vertices, if there is one.
    pub(super) fn support(&self) -> Option<f64> {
        self.smoothing().or(self.of_points.then_some(INTERPOLATING_SUPPORT))
    }
}

impl Grading {
    fn validate(&self) -> Result<()> {
        match self {
            Grading::Even => Ok(()),
            Grading::Curvature(adapt) if (0.0..=1.0).contains(adapt) => Ok(()),
            Grading::Curvature(adapt) => {
                let cause = format!("{adapt} is out of range");
                Err(Error::Option { option: Setting::Adaptivity, cause, remedy: "give a number from 0 to 1".into() })
            }
            Grading::Field(Values::Given(lengths)) => check_lengths(lengths),
            Grading::Field(Values::Attribute(_)) => Ok(()),
            Grading::Kernel { sigma_n, signals } => check_kernel(*sigma_n, signals),
        }
    }

    /// Returns the same grading with the values that `of` makes of its own, which belong to the given setting.
    ///
    /// # Errors
    /// Those of `of`.
    pub(crate) fn with_values(&self, of: impl Fn(Setting, &Values) -> Result<Values>) -> Result<Grading> {
        Ok(match self {
            Grading::Field(lengths) => Grading::Field(of(Setting::Field, lengths)?),
            Grading::Kernel { sigma_n, signals } => {
                let changed = |signal: &Signal| signal.with_values(|values| of(Setting::Signals, values));
                Grading::Kernel { sigma_n: *sigma_n, signals: signals.iter().map(changed).collect::<Result<_>>()? }
            }
            other => other.clone(),
        })
    }

    /// Refuses a field or a signal whose number of values differs from `vertices`.
    pub(crate) fn check(&self, vertices: usize) -> Result<()> {
        match self {
            Grading::Even | Grading::Curvature(_) => Ok(()),
            Grading::Field(lengths) => lengths.check(Setting::Field, vertices),
            Grading::Kernel { signals, .. } => check_signals(signals, vertices),
        }
    }

    /// Returns the lengths of a field.
    pub(super) fn field(&self) -> Option<&[f64]> {
        match self {
            Grading::Field(lengths) => lengths.given(),
            _ => None,
        }
    }
}

fn check_lengths(lengths: &[f64]) -> Result<()> {
    let is_length = |length: &f64| *length > 0.0 && length.is_finite();
    lengths.iter().position(|length| !is_length(length)).map_or(Ok(()), |v| {
        Err(Error::Option {
            option: Setting::Field,
            cause: format!("vertex {v} has the value {}, which is not a length", lengths[v]),
            remedy: "give each vertex a length above zero in the units of the input".into(),
        })
    })
}
