//! Options for turning a cloud into a mesh.

use crate::base::error::{Error, Result, Setting};

/// Number of neighbours to which planes are fitted where there is no noise: as few as possible, to preserve sharp features.
pub const FEW_NEIGHBORS: usize = 8;

/// Support radius of the implicit surface of points without noise, in their spacings: just large enough to leave no holes
/// between them.
pub const INTERPOLATING_SUPPORT: f64 = 2.3;

/// Support radius that smooths away the noise of a typical scan, in spacings of its points.
pub const SMOOTHING_SUPPORT: f64 = 2.7;

/// Options for turning a cloud into a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudOptions {
    /// Shape fitted to estimate missing normals. Default: planes, or spheres if noise is smoothed.
    pub fit: Option<NormalFit>,
    /// Neighbours to which it is fitted. Default: the nearest eight, or the nearest sixteen if noise is smoothed.
    pub neighborhood: Option<NormalNeighborhood>,
    /// Support radius of the implicit surface onto which points are projected, in mean distances of neighbouring points: the
    /// larger, the smoother. With zero, points stay where they are. Default: `None`, which is [`SMOOTHING_SUPPORT`] if there
    /// is noise and zero otherwise.
    pub smooth: Option<f64>,
    /// Largest bounding-box diagonal of holes that are closed, in the units of the input. Default: 0, which keeps all holes
    /// larger than the gaps between points.
    pub fill_holes: f64,
    /// Whether the points are of terrain: those visible from above become a sheet with one height at each place; z is up.
    /// Default: `None`, which means yes if they look like terrain and many would otherwise be left out.
    pub terrain: Option<bool>,
}

impl Default for CloudOptions {
    fn default() -> Self {
        CloudOptions { fit: None, neighborhood: None, smooth: None, fill_holes: 0.0, terrain: None }
    }
}

impl CloudOptions {
    /// Refuses options that suit no cloud.
    ///
    /// # Errors
    /// [`Error::Option`] for fewer than three neighbours, or a length that is not positive and finite.
    pub fn validate(&self) -> Result<()> {
        check_smooth(self.smooth)?;
        let refuse = |option, cause: String, remedy: &str| Err(Error::Option { option, cause, remedy: remedy.into() });
        match self.neighborhood {
            Some(NormalNeighborhood::Count(n)) if n < 3 => {
                refuse(Setting::NormalNeighbors, format!("{n} neighbours are too few for a normal"), "give at least 3")
            }
            Some(NormalNeighborhood::Radius(r)) if !(r > 0.0 && r.is_finite()) => {
                refuse(Setting::NormalRadius, format!("{r} is not a length"), "give a length above zero")
            }
            _ if !(self.fill_holes >= 0.0 && self.fill_holes.is_finite()) => {
                let cause = format!("{} is not the size of a hole", self.fill_holes);
                refuse(Setting::FillHoles, cause, "give a length of zero or more")
            }
            _ => Ok(()),
        }
    }

    /// Returns the support radius of smoothing, in spacings of the points, if the options ask for any.
    pub fn smoothing(&self) -> Option<f64> {
        smoothing(self.smooth)
    }

    /// Returns the same options for points whose coordinates were divided by `size`.
    pub(in crate::pipeline) fn within_unit(&self, size: f64) -> CloudOptions {
        let neighborhood = self.neighborhood.map(|neighborhood| match neighborhood {
            NormalNeighborhood::Radius(radius) => NormalNeighborhood::Radius(radius / size),
            count => count,
        });
        CloudOptions { neighborhood, fill_holes: self.fill_holes / size, ..*self }
    }
}

/// Refuses a support radius that is out of range.
pub(in crate::pipeline) fn check_smooth(support: Option<f64>) -> Result<()> {
    let refuse = |support: f64| {
        let cause = format!("{support} spacings are out of range");
        Err(Error::Option {
            option: Setting::Smoothing,
            cause,
            remedy: "give a number from 1.5 to 20, or 0 for none".into(),
        })
    };
    smoothing(support).filter(|r| !(1.5..=20.0).contains(r)).map_or(Ok(()), refuse)
}

/// Returns the support radius of smoothing, if anything is smoothed: zero means no smoothing.
pub(in crate::pipeline) fn smoothing(support: Option<f64>) -> Option<f64> {
    support.filter(|&support| support != 0.0)
}

/// Shape that is fitted to estimate normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalFit {
    /// Planes: the sharpest choice where there is little noise.
    Plane,
    /// Algebraic spheres, after planes: smoother, and exact where the surface bends evenly.
    Sphere,
}

impl NormalFit {
    /// All variants.
    pub const ALL: [NormalFit; 2] = [NormalFit::Plane, NormalFit::Sphere];

    /// Name of the variant as an option.
    pub fn name(self) -> &'static str {
        match self {
            NormalFit::Plane => "plane",
            NormalFit::Sphere => "sphere",
        }
    }
}

/// Neighbours of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalNeighborhood {
    /// This number of nearest points.
    Count(usize),
    /// All points within this distance, in the units of the input.
    Radius(f64),
}
