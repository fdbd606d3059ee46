//! Individual options, as users set them on the command line and in Python, and what they resolve to. `None` means not set.
//! The conversion names every field, so a forgotten option does not compile.

use crate::base::error::{Error, Result, Setting};
use crate::job::remesh::{Carry, RemeshOptions};
use crate::pipeline::{
    CloudOptions, Density, Grading, MaxError, NormalFit, NormalNeighborhood, Options, ReconstructOptions,
    SampleDensity, SampleOptions, Selection, Signal, Values,
};
use crate::surface::features::Features;

/// Settings of [`remesh`](crate::remesh()).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct RemeshSettings {
    pub points: Option<Density>,
    pub edge_length: Option<f64>,
    pub sigma_p: Option<f64>,
    pub seed: u64,
    pub weld: Option<f64>,
    pub features: Option<Features>,
    pub adapt: Option<f64>,
    pub sigma_n: Option<f64>,
    pub signals: Vec<Signal>,
    /// Also determines the density, if nothing else does.
    pub sizing: Option<Values>,
    pub smooth: Option<f64>,
    pub within: Option<[[f64; 3]; 2]>,
    pub select: Option<Selection>,
    pub fill_holes: f64,
    pub terrain: Option<bool>,
    pub normals: NormalSettings,
    pub max_error: Option<MaxError>,
    /// Whether the result gets the attributes of the input.
    pub attributes: bool,
    pub optimize: bool,
}

/// Settings of [`sample`](crate::sample()).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct SampleSettings {
    pub points: Option<SampleDensity>,
    pub edge_length: Option<f64>,
    pub sigma_p: Option<f64>,
    pub sigma_n: f64,
    pub signals: Vec<Signal>,
    pub within: Option<[[f64; 3]; 2]>,
    pub smooth: Option<f64>,
    pub normals: NormalSettings,
    pub scan_only: bool,
    pub levels: Option<usize>,
    pub seed: u64,
    pub sweeps: usize,
}

/// Settings of [`reconstruct`](crate::reconstruct()).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct ReconstructSettings {
    pub resolution: Option<f64>,
    pub smooth: Option<f64>,
    pub normals: NormalSettings,
}

/// How normals of a cloud are estimated.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs)]
pub struct NormalSettings {
    pub fit: Option<NormalFit>,
    pub neighbors: Option<usize>,
    pub radius: Option<f64>,
}

impl RemeshSettings {
    /// Resolves the settings to the options of remeshing.
    ///
    /// # Errors
    /// [`Error::Option`] for settings that exclude each other, and if none determines the density of the result.
    pub fn resolve(self) -> Result<RemeshOptions> {
        let RemeshSettings {
            points,
            edge_length,
            sigma_p,
            seed,
            weld,
            features,
            adapt,
            sigma_n,
            signals,
            sizing,
            smooth,
            within,
            select,
            fill_holes,
            terrain,
            normals,
            max_error,
            attributes,
            optimize,
        } = self;
        let of_sizing = sizing.as_ref().map(|_| Density::OfField);
        let given = density(points, edge_length.map(Density::EdgeLength), sigma_p.map(Density::SigmaP))?;
        at_most_one([(Setting::PartBox, within.is_some()), (Setting::PartMarks, select.is_some())])?;
        let surface = Options {
            density: given.or(of_sizing).ok_or_else(not_dense)?,
            seed,
            weld,
            features: features.unwrap_or_default(),
            grading: grading(sizing, adapt, sigma_n, signals)?,
            smooth,
            of_points: false,
            part: within.map(Selection::Box).or(select),
            max_error,
            optimize,
            // Not a setting.
            sweeps: Options::default().sweeps,
        };
        let carry = if attributes { Carry::All } else { Carry::Nothing };
        let cloud = CloudOptions { fill_holes, terrain, ..normals.resolve(smooth)? };
        Ok(RemeshOptions { surface, cloud, carry, without_report: false })
    }
}

impl SampleSettings {
    /// Resolves the settings to the options of sampling.
    ///
    /// # Errors
    /// Those of [`RemeshSettings::resolve`].
    pub fn resolve(self) -> Result<SampleOptions> {
        let SampleSettings {
            points,
            edge_length,
            sigma_p,
            sigma_n,
            signals,
            within,
            smooth,
            normals,
            scan_only,
            levels,
            seed,
            sweeps,
        } = self;
        let given = density(points, edge_length.map(SampleDensity::EdgeLength), sigma_p.map(SampleDensity::SigmaP))?;
        if scan_only && smooth.is_some() {
            let cause = "samples that are points of the input cannot be moved".into();
            return Err(Error::Option {
                option: Setting::Smoothing,
                cause,
                remedy: "leave it out, or allow samples that are not points of the input".into(),
            });
        }
        let cloud = normals.resolve(smooth)?;
        let density = given.ok_or_else(not_dense)?;
        Ok(SampleOptions { density, sigma_n, signals, within, scan_only, levels, seed, sweeps, cloud })
    }
}

impl ReconstructSettings {
    /// Resolves the settings to the options of reconstruction.
    ///
    /// # Errors
    /// Those of [`RemeshSettings::resolve`].
    pub fn resolve(self) -> Result<ReconstructOptions> {
        let ReconstructSettings { resolution, smooth, normals } = self;
        Ok(ReconstructOptions { resolution, cloud: normals.resolve(smooth)? })
    }
}

impl NormalSettings {
    /// Resolves the settings to the options of a cloud, with as much smoothing as is given.
    fn resolve(self, smooth: Option<f64>) -> Result<CloudOptions> {
        let NormalSettings { fit, neighbors, radius } = self;
        at_most_one([(Setting::NormalNeighbors, neighbors.is_some()), (Setting::NormalRadius, radius.is_some())])?;
        let neighborhood = neighbors.map(NormalNeighborhood::Count).or(radius.map(NormalNeighborhood::Radius));
        Ok(CloudOptions { fit, neighborhood, smooth, ..CloudOptions::default() })
    }
}

/// Returns the density, which may be given in one of several ways.
fn density<T>(points: Option<T>, edge_length: Option<T>, sigma_p: Option<T>) -> Result<Option<T>> {
    at_most_one([
        (Setting::Points, points.is_some()),
        (Setting::EdgeLength, edge_length.is_some()),
        (Setting::SigmaP, sigma_p.is_some()),
    ])?;
    Ok(points.or(edge_length).or(sigma_p))
}

/// Returns the one thing that edge lengths follow.
fn grading(sizing: Option<Values>, adapt: Option<f64>, sigma_n: Option<f64>, signals: Vec<Signal>) -> Result<Grading> {
    let by_kernel = if sigma_n.is_some() { Setting::SigmaN } else { Setting::Signals };
    let is_by_kernel = sigma_n.is_some() || !signals.is_empty();
    at_most_one([
        (Setting::Field, sizing.is_some()),
        (Setting::Adaptivity, adapt.is_some()),
        (by_kernel, is_by_kernel),
    ])?;
    Ok(match (sizing, adapt) {
        (Some(lengths), _) => Grading::Field(lengths),
        (None, Some(adapt)) => Grading::Curvature(adapt),
        (None, None) if is_by_kernel => Grading::Kernel { sigma_n: sigma_n.unwrap_or(f64::INFINITY), signals },
        (None, None) => Grading::Even,
    })
}

/// Refuses settings that exclude each other.
fn at_most_one<const N: usize>(settings: [(Setting, bool); N]) -> Result<()> {
    let mut given = settings.into_iter().filter(|(_, is_given)| *is_given).map(|(setting, _)| setting);
    match (given.next(), given.next()) {
        (Some(first), Some(option)) => {
            let cause = format!("it cannot be given together with the {first}");
            Err(Error::Option { option, cause, remedy: "give only one of them".into() })
        }
        _ => Ok(()),
    }
}

fn not_dense() -> Error {
    Error::Option {
        option: Setting::Points,
        cause: "no density is given for the result".into(),
        remedy: "give a number of points, an edge length or a kernel width".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> RemeshSettings {
        RemeshSettings {
            points: Some(Density::Points(10_000)),
            edge_length: None,
            sigma_p: None,
            seed: 0,
            weld: None,
            features: None,
            adapt: None,
            sigma_n: None,
            signals: Vec::new(),
            sizing: None,
            smooth: None,
            within: None,
            select: None,
            fill_holes: 0.0,
            terrain: None,
            normals: NormalSettings::default(),
            max_error: None,
            attributes: true,
            optimize: true,
        }
    }

    fn refused(settings: RemeshSettings) -> Option<Setting> {
        match settings.resolve() {
            Err(Error::Option { option, .. }) => Some(option),
            _ => None,
        }
    }

    #[test]
    fn nothing_set_is_the_default() {
        assert_eq!(settings().resolve(), Ok(RemeshOptions::default()));
    }

    #[test]
    fn of_two_settings_that_exclude_each_other_one_is_named() {
        let (a, b) = (Some([[0.0; 3], [1.0; 3]]), Some(Selection::Vertices(vec![])));
        let normals = NormalSettings { fit: None, neighbors: Some(9), radius: Some(1.0) };
        for (settings, option) in [
            (RemeshSettings { points: None, ..settings() }, Setting::Points),
            (RemeshSettings { edge_length: Some(1.0), ..settings() }, Setting::EdgeLength),
            (RemeshSettings { adapt: Some(1.0), sigma_n: Some(1.0), ..settings() }, Setting::SigmaN),
            (RemeshSettings { within: a, select: b, ..settings() }, Setting::PartMarks),
            (RemeshSettings { normals, ..settings() }, Setting::NormalRadius),
        ] {
            assert_eq!(refused(settings), Some(option));
        }
    }
}
