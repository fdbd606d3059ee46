//! Options for sampling.

use crate::base::error::{Error, Result, Setting};
use crate::geom::aabb::Aabb;
use crate::pipeline::cloud::options::CloudOptions;
use crate::pipeline::density::{SampleDensity, check_count, check_length};
use crate::pipeline::kernel::{Signal, check_kernel};
use crate::pipeline::selection::check_box;

/// Options of sampling.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleOptions {
    /// Density of the samples. An edge length means the number of samples that have it at hexagonal packing on the input's
    /// area; with [`Self::scan_only`] it means the kernel width that would result in it. Default: 10,000 points.
    pub density: SampleDensity,
    /// Kernel width σn along unit normals: samples gather where the surface turns by more than this within a spacing.
    /// Default: infinite, samples are even.
    pub sigma_n: f64,
    /// Properties of the input that samples follow. Default: none.
    pub signals: Vec<Signal>,
    /// Lowest and highest x, y and z of a box, in the units of the input: only the points of a cloud inside it or on its faces
    /// are used. A mesh is refused. Default: none, all points are used.
    pub within: Option<[[f64; 3]; 2]>,
    /// Whether the samples are a subset of the input's points, as the scan leaves them. Default: false.
    pub scan_only: bool,
    /// Number of levels. If given, samples are in progressive order, such that every first part of them is a good sampling
    /// of the whole, too, and each level has a quarter of the samples of the next one. Default: none, no such order.
    pub levels: Option<usize>,
    /// Seed of all random numbers. Default: 0.
    pub seed: u64,
    /// Sweeps of gradient ascent. Default: 10, as in the paper (section 6.3).
    pub sweeps: usize,
    /// How to treat a cloud: its normals, and the support radius of the implicit surface on which samples move, which is
    /// [`INTERPOLATING_SUPPORT`](crate::pipeline::INTERPOLATING_SUPPORT) if nothing is smoothed. Options on holes have no effect.
    pub cloud: CloudOptions,
}

impl Default for SampleOptions {
    fn default() -> Self {
        SampleOptions {
            density: SampleDensity::Points(10_000),
            sigma_n: f64::INFINITY,
            signals: Vec::new(),
            within: None,
            scan_only: false,
            levels: None,
            seed: 0,
            sweeps: 10,
            cloud: CloudOptions::default(),
        }
    }
}

impl SampleOptions {
    /// Returns the box inside which points are used.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        self.within.map(Aabb::from)
    }

    /// Refuses a box, which is only possible for clouds.
    ///
    /// # Errors
    /// [`Error::Option`] if there is one.
    pub(crate) fn refuse_box(&self) -> Result<()> {
        if self.within.is_none() {
            return Ok(());
        }
        let cause = "the input is a mesh, and only the samples of a cloud can be limited to a box".into();
        let remedy = "leave it out, or cut the mesh first".into();
        Err(Error::Option { option: Setting::PartBox, cause, remedy })
    }

    /// Refuses options that suit no input.
    ///
    /// # Errors
    /// [`Error::Option`] for a number of samples out of range, or a length or a width that is not positive.
    pub fn validate(&self) -> Result<()> {
        check_kernel(self.sigma_n, &self.signals)?;
        self.cloud.validate()?;
        self.bounds().map_or(Ok(()), check_box)?;
        if self.levels == Some(0) {
            let (cause, remedy) = ("there must be at least one level".into(), "give 1 or more".into());
            return Err(Error::Option { option: Setting::Levels, cause, remedy });
        }
        match self.density {
            SampleDensity::Points(n) => check_count(Setting::Points, n, format!("{n} samples are asked for")),
            SampleDensity::EdgeLength(l) => check_length(Setting::EdgeLength, l),
            SampleDensity::SigmaP(s) => check_length(Setting::SigmaP, s),
        }
    }
}
