//! What counts in the kernel beside the position, as it is asked for, and as a domain has it.

use crate::base::error::{Error, Result};
use crate::geom::triangle::barycentric;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::unit::Unit;
use crate::spectral::scan::Kernel;
use crate::surface::domain::{Domain, Sample};
use crate::surface::lift::{Lift, MOST_SIGNALS, Signals};
use crate::surface::sizing::transferred;

/// A property of the input that samples follow.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Its value at each vertex of the input.
    pub values: Vec<f64>,
    /// The width σc of the kernel along it, in its own units: samples come denser where it changes by more than this
    /// within a spacing.
    pub sigma: f64,
}

impl Signal {
    /// The signal at some of the points.
    pub(super) fn of(&self, points: &[u32]) -> Signal {
        Signal { values: points.iter().map(|&p| self.values[p as usize]).collect(), sigma: self.sigma }
    }

    fn in_sigmas(&self) -> Vec<f64> {
        self.values.iter().map(|value| value / self.sigma).collect()
    }
}

/// Refuses widths that are none, values that are not finite, and more signals than there is room for.
pub(super) fn check_kernel(sigma_n: f64, signals: &[Signal]) -> Result<()> {
    let error = |option, cause, remedy: &str| Err(Error::Option { option, cause, remedy: remedy.into() });
    if sigma_n.is_nan() || sigma_n <= 0.0 {
        let remedy = "give a number above zero, such as 0.75, or inf";
        return error("sigma-n", format!("{sigma_n} is not a width of the kernel"), remedy);
    }
    if signals.len() > MOST_SIGNALS {
        let cause = format!("{} properties are given", signals.len());
        return error("sigma", cause, &format!("up to {MOST_SIGNALS} are possible"));
    }
    for signal in signals {
        if !(signal.sigma > 0.0 && signal.sigma.is_finite()) {
            let cause = format!("{} is not a width of the kernel", signal.sigma);
            return error("sigma", cause, "give a number above zero in the units of the property");
        }
        if let Some(v) = signal.values.iter().position(|value| !value.is_finite()) {
            let cause = format!("vertex {v} has the value {}", signal.values[v]);
            return error("sigma", cause, "mend the values, or leave the property out");
        }
    }
    Ok(())
}

/// Refuses a signal of another number of values than there are `vertices`.
pub(super) fn check_signals(signals: &[Signal], vertices: usize) -> Result<()> {
    let Some(wrong) = signals.iter().find(|signal| signal.values.len() != vertices) else { return Ok(()) };
    let cause = format!("{} values for the {vertices} vertices of the input", wrong.values.len());
    Err(Error::Option { option: "sigma", cause, remedy: "give one value for each vertex".into() })
}

/// What counts beside the position over a domain, or over bare points.
pub(super) struct Beside<'a> {
    sigma_n: f64,
    domain: Option<&'a Domain>,
    /// For each signal its value at each vertex of the domain, or at each point, in units of its σ.
    signals: Vec<Vec<f64>>,
}

impl<'a> Beside<'a> {
    /// `signals` at the vertices of `input`, which repairs number anew, so values are looked up by place.
    pub(super) fn new(sigma_n: f64, signals: &[Signal], input: &Mesh, unit: &Unit, domain: &'a Domain) -> Self {
        let from = if signals.is_empty() { Mesh::default() } else { unit.inwards(input) };
        let over_domain = |signal: &Signal| transferred(&signal.in_sigmas(), &from, &domain.mesh.positions);
        Beside { sigma_n, domain: Some(domain), signals: signals.iter().map(over_domain).collect() }
    }

    /// `signals` at bare points. What is [`Sample::triangle`] elsewhere is the number of the point for them.
    pub(super) fn of_points(sigma_n: f64, signals: &[Signal]) -> Self {
        Beside { sigma_n, domain: None, signals: signals.iter().map(Signal::in_sigmas).collect() }
    }

    /// The dimensions that the kernel needs: 3, 6, or 6 + [`MOST_SIGNALS`].
    pub(super) fn dimensions(&self) -> usize {
        match (self.sigma_n.is_infinite(), self.signals.is_empty()) {
            (true, true) => 3,
            (false, true) => 6,
            (_, false) => 6 + MOST_SIGNALS,
        }
    }

    /// Whether anything counts.
    pub(super) fn counts(&self) -> bool {
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

    /// The vertices that `sample` is between, and their weights.
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
