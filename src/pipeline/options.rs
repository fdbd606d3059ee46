//! What can be asked of the pipeline, and what is refused at once.

use crate::base::error::{Error, Result};
use crate::pipeline::cloud::{DEFAULT_SUPPORT, check_smooth};
use crate::pipeline::kernel::{Signal, check_kernel};
use crate::pipeline::within::Selection;
use crate::surface::features::Features;

/// How dense the result shall be. Each says it all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// The number of vertices of the result.
    Points(usize),
    /// The mean edge length, in the units of the input.
    EdgeLength(f64),
    /// The kernel width σp of the sampler, in the units of the input.
    SigmaP(f64),
    /// As many vertices as the lengths of [`Options::sizing`] ask for.
    OfSizing,
    /// As many vertices as [`Options::max_error`] needs, and hardly more: see [`crate::remesh()`].
    Auto,
}

/// How far the result may be from the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaxError {
    /// A length, in the units of the input.
    Length(f64),
    /// A share of the diagonal of the input's bounding box: 0.001 is a tenth of a per cent.
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

/// What to make of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// How dense the result shall be. Default: 10,000 points.
    pub density: Density,
    /// Seed of all random numbers: same seed, same input, same result. Default: 0.
    pub seed: u64,
    /// Boundary vertices as near as this to each other, in the units of the input, become one: closes seams that
    /// rounding left open. Default: `None`, only vertices at exactly the same place.
    pub weld: Option<f64>,
    /// Which edges of the input are kept sharp. Default: decided from the input.
    pub features: Features,
    /// How much the edge lengths follow the shape, from 0 (they are even) to 1 (short where the surface bends or is
    /// thin, in proportion to the root of the radius). Default: 0.
    pub adapt: f64,
    /// The width σn of the kernel along unit normals: with 0.5 to 1 vertices gather where the surface bends (paper,
    /// section 3 and figure 10). Default: infinite, which leaves lengths even.
    pub sigma_n: f64,
    /// Properties of the input that vertices follow: they gather where these change. Default: none.
    pub signals: Vec<Signal>,
    /// The edge length wanted at each vertex of the input, in its units; with a density other than [`Density::OfSizing`]
    /// all are scaled by one factor to meet that. Default: `None`, lengths are even or as `adapt` says.
    pub sizing: Option<Vec<f64>>,
    /// Noise is smoothed away first: vertices move to the implicit surface of all of them, on which each reaches as far as
    /// so many mean distances of neighbouring ones. Default: `None`, they stay where they are.
    pub smooth: Option<f64>,
    /// The input goes through points, as [`crate::mesh_of_points`] makes it: where its edges are longer than those of the
    /// result, what lies between its vertices is their implicit surface, and not the flat triangles. So it is with `smooth`,
    /// too. Default: false.
    pub of_points: bool,
    /// The part that is remeshed; everything else stays as it is, and the density is that of the part: [`Density::Points`]
    /// counts the vertices strictly inside of it, those on its seam with the rest not included. Default: `None`, all.
    pub part: Option<Selection>,
    /// How far any point of the result may be from the repaired input, and any point of that from the result. Default:
    /// `None`, as near as the vertices allow on average.
    pub max_error: Option<MaxError>,
    /// Whether the triangles are optimised after sampling. Default: true. Without, the vertices are where the paper's
    /// gradient ascent leaves them: blue noise.
    pub optimize: bool,
    /// Sweeps of gradient ascent over all samples if nothing is optimised. Default: 10, as in the paper (section 6.3);
    /// more make the triangles a little better.
    pub sweeps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            density: Density::Points(10_000),
            seed: 0,
            weld: None,
            features: Features::Automatic,
            adapt: 0.0,
            sigma_n: f64::INFINITY,
            signals: Vec::new(),
            sizing: None,
            smooth: None,
            of_points: false,
            part: None,
            max_error: None,
            optimize: true,
            sweeps: 10,
        }
    }
}

/// Fewest vertices that can be asked for: those of a triangle.
pub const FEWEST_POINTS: usize = 3;

/// Most vertices that can be asked for: the candidates for so many take some four gigabytes.
pub const MOST_POINTS: usize = 5_000_000;

/// The vertices that the search for as few as needed begins with.
pub(super) const FIRST_POINTS: usize = 2_000;

impl Options {
    /// Refuses what no input can be remeshed with.
    ///
    /// # Errors
    /// [`Error::Option`] for a number of points out of range or a length that is not positive and finite.
    pub fn validate(&self) -> Result<()> {
        self.weld.map_or(Ok(()), |tolerance| check_length("weld", tolerance))?;
        if let Features::Degrees(degrees) = self.features
            && !(degrees > 0.0 && degrees < 180.0)
        {
            let cause = format!("{degrees} is not an angle between faces");
            return Err(Error::Option { option: "features", cause, remedy: "give degrees between 0 and 180".into() });
        }
        if !(0.0..=1.0).contains(&self.adapt) {
            let cause = format!("{} is not a degree of adaptivity", self.adapt);
            return Err(Error::Option { option: "adapt", cause, remedy: "give a number from 0 to 1".into() });
        }
        if self.adapt > 0.0 && self.sizing.is_some() {
            let cause = "edge lengths cannot follow the shape and a field at the same time".into();
            return Err(Error::Option { option: "adapt", cause, remedy: "leave out adapt or sizing".into() });
        }
        check_smooth(self.smooth)?;
        check_kernel(self.sigma_n, &self.signals)?;
        self.part.as_ref().map_or(Ok(()), Selection::validate)?;
        if self.part.is_some() && self.smooth.is_some() {
            let cause = "smoothing would move what is not in the part to remesh".into();
            return Err(Error::Option { option: "smooth", cause, remedy: "smooth all of it first".into() });
        }
        if self.has_kernel() && (self.adapt > 0.0 || self.sizing.is_some()) {
            let cause = "edge lengths cannot follow the kernel and the shape or a field at the same time".into();
            let remedy = "leave out adapt and sizing, or sigma-n and sigma".into();
            return Err(Error::Option { option: "sigma-n", cause, remedy });
        }
        self.sizing.as_deref().map_or(Ok(()), check_lengths)?;
        match self.max_error {
            Some(MaxError::Length(l)) => check_length("max-error", l)?,
            Some(MaxError::OfDiagonal(share)) => check_length("max-error", share)?,
            None => {}
        }
        match self.density {
            Density::OfSizing if self.sizing.is_none() => Err(Error::Option {
                option: "sizing",
                cause: "there are no lengths that say how dense the result shall be".into(),
                remedy: "give lengths or another density".into(),
            }),
            Density::OfSizing => Ok(()),
            Density::Points(n) => check_count("points", n, format!("{n} vertices are asked for")),
            Density::EdgeLength(l) => check_length("edge-length", l),
            Density::SigmaP(s) => check_length("sigma-p", s),
            Density::Auto if self.max_error.is_none() => Err(Error::Option {
                option: "points",
                cause: "nothing says how many are needed".into(),
                remedy: "give a max-error, or a number of points".into(),
            }),
            Density::Auto => Ok(()),
        }
    }
}

impl Options {
    /// How far vertices reach on the implicit surface that lies between them, if one does.
    pub(super) fn reach(&self) -> Option<f64> {
        self.smooth.or(self.of_points.then_some(DEFAULT_SUPPORT))
    }

    /// Whether more than the position counts in the kernel.
    pub(super) fn has_kernel(&self) -> bool {
        self.sigma_n.is_finite() || !self.signals.is_empty()
    }
}

fn check_lengths(lengths: &[f64]) -> Result<()> {
    let is_length = |length: &f64| *length > 0.0 && length.is_finite();
    lengths.iter().position(|length| !is_length(length)).map_or(Ok(()), |v| {
        Err(Error::Option {
            option: "sizing",
            cause: format!("vertex {v} has {}, which is not a length", lengths[v]),
            remedy: "give each vertex a length above zero in the units of the input".into(),
        })
    })
}

/// Refuses lengths that are not one for each of so many vertices.
///
/// # Errors
/// [`Error::Option`] if they are more or fewer.
pub fn check_field(vertices: usize, lengths: &[f64]) -> Result<()> {
    let given = lengths.len();
    if given == vertices {
        return Ok(());
    }
    let cause = format!("{given} lengths for the {vertices} vertices of the input");
    Err(Error::Option { option: "sizing", cause, remedy: "give one length for each vertex".into() })
}

/// Refuses what is no length.
pub(super) fn check_length(option: &'static str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    let remedy = "give a length above zero in the units of the input".into();
    Err(Error::Option { option, cause: format!("{value} is not a length"), remedy })
}

pub(super) fn check_count(option: &'static str, n: usize, cause: String) -> Result<()> {
    if (FEWEST_POINTS..=MOST_POINTS).contains(&n) {
        return Ok(());
    }
    Err(Error::Option { option, cause, remedy: format!("from {FEWEST_POINTS} to {MOST_POINTS} are possible") })
}
