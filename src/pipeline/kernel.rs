//! Kernel features besides the position: as they are requested, and as a domain has them.

use crate::base::error::{Error, Result, Setting};
use crate::geom::triangle::barycentric;
use crate::pipeline::values::Values;
use crate::spectral::scan::Kernel;
use crate::surface::domain::{Domain, Sample};
use crate::surface::lift::{Lift, MOST_SIGNALS, Signals};

/// Property of the input that samples follow.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Value at each vertex of the input.
    pub values: Values,
    /// Width σc of the kernel along the property, in its own units: samples are denser where it changes by more than this
    /// within a spacing.
    pub sigma: f64,
}

impl Signal {
    /// Returns the signal with the values that `of` makes of its own.
    ///
    /// # Errors
    /// Those of `of`.
    pub(crate) fn with_values(&self, of: impl FnOnce(&Values) -> Result<Values>) -> Result<Signal> {
        Ok(Signal { values: of(&self.values)?, sigma: self.sigma })
    }

    fn in_sigmas(&self) -> Vec<f64> {
        self.values.given().unwrap_or_default().iter().map(|value| value / self.sigma).collect()
    }
}

/// Refuses widths that are not positive, values that are not finite, and too many signals.
pub(super) fn check_kernel(sigma_n: f64, signals: &[Signal]) -> Result<()> {
    let error = |option, cause, remedy: &str| Err(Error::Option { option, cause, remedy: remedy.into() });
    if sigma_n.is_nan() || sigma_n <= 0.0 {
        let remedy = "give a number above zero, such as 0.75, or inf";
        return error(Setting::SigmaN, format!("{sigma_n} is not a kernel width"), remedy);
    }
    if signals.len() > MOST_SIGNALS {
        let cause = format!("{} properties are given", signals.len());
        return error(Setting::Signals, cause, &format!("up to {MOST_SIGNALS} are possible"));
    }
    for signal in signals {
        if !(signal.sigma > 0.0 && signal.sigma.is_finite()) {
            let cause = format!("{} is not a kernel width", signal.sigma);
            return error(Setting::Signals, cause, "give a number above zero in the units of the property");
        }
        let values = signal.values.given().unwrap_or_default();
        if let Some(v) = values.iter().position(|value| !value.is_finite()) {
            let cause = format!("vertex {v} has the value {}", values[v]);
            return error(Setting::Signals, cause, "correct the values, or leave the property out");
        }
    }
    Ok(())
}

/// Refuses signals whose number of values differs from `vertices`.
pub(super) fn check_signals(signals: &[Signal], vertices: usize) -> Result<()> {
    signals.iter().try_for_each(|signal| signal.values.check(Setting::Signals, vertices))
}

/// Number of dimensions of a kernel with signals.
pub(super) const MOST_DIMENSIONS: usize = 6 + MOST_SIGNALS;

/// Evaluates an expression with the constant `$d`: the number of dimensions of the kernel with `$features`.
macro_rules! with_dimensions {
    ($features:expr, $d:ident => $value:expr) => {
        match $features.dimensions() {
            3 => {
                const $d: usize = 3;
                $value
            }
            6 => {
                const $d: usize = 6;
                $value
            }
            _ => {
                const $d: usize = $crate::pipeline::kernel::MOST_DIMENSIONS;
                $value
            }
        }
    };
}
pub(super) use with_dimensions;

/// Kernel features besides the position, over a domain or over bare points.
pub(super) struct KernelFeatures<'a> {
    sigma_n: f64,
    domain: Option<&'a Domain>,
    /// For each signal, its value at each vertex of the domain, or at each point, in units of its σ.
    signals: Vec<Vec<f64>>,
}

impl<'a> KernelFeatures<'a> {
    /// Evaluates `signals` over a domain that was made from the mesh whose vertices have them.
    pub(super) fn over(domain: &'a Domain, sigma_n: f64, signals: &[Signal]) -> Self {
        let over_domain = |signal: &Signal| domain.values(&signal.in_sigmas());
        KernelFeatures { sigma_n, domain: Some(domain), signals: signals.iter().map(over_domain).collect() }
    }

    /// Evaluates `signals` at bare points. For these, [`Sample::triangle`] is the number of the point.
    pub(super) fn of_points(sigma_n: f64, signals: &[Signal]) -> Self {
        KernelFeatures { sigma_n, domain: None, signals: signals.iter().map(Signal::in_sigmas).collect() }
    }

    /// Number of dimensions of the kernel: 3, 6 or [`MOST_DIMENSIONS`].
    pub(super) fn dimensions(&self) -> usize {
        match (self.sigma_n.is_infinite(), self.signals.is_empty()) {
            (true, true) => 3,
            (false, true) => 6,
            (_, false) => MOST_DIMENSIONS,
        }
    }

    /// Returns whether anything besides the position counts.
    pub(super) fn is_lifted(&self) -> bool {
        self.dimensions() > 3
    }

    /// Calls `work` with the kernel of width `sigma`.
    pub(super) fn with_kernel<T>(&self, sigma: f64, work: impl FnOnce(Kernel) -> T) -> T {
        let fill = |sample: &Sample, values: &mut [f64]| {
            let (corners, weights) = self.place(sample);
            for (value, signal) in values.iter_mut().zip(&self.signals) {
                *value = sigma * (0..3).map(|k| weights[k] * signal[corners[k] as usize]).sum::<f64>();
            }
        };
        let signals = (!self.signals.is_empty()).then_some(&fill as Signals);
        work(Kernel { sigma, lift: Lift { normals: sigma / self.sigma_n, signals } })
    }

    /// Returns the vertices around `sample` and their weights.
    fn place(&self, sample: &Sample) -> ([u32; 3], [f64; 3]) {
        let t = sample.triangle;
        match self.domain {
            Some(Domain { mesh, .. }) => {
                (mesh.triangles[t as usize], barycentric(sample.position, mesh.corners(t as usize)))
            }
            None => ([t; 3], [1.0, 0.0, 0.0]),
        }
    }
}
