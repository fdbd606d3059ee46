//! Determines how many points of a cloud a job can use, and thins a cloud to that many.

use crate::job::input::Input;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Density, Grading, Options, SampleDensity, SampleOptions, Signal, Values};
use crate::prepare::thin::{Seen, Thinned, Thinner};
use glam::DVec3;
use std::borrow::Cow;

/// Number of useful points of a cloud: this many per vertex of the result, and a fixed number more, so that small results do
/// not lose the details to which they are fitted.
const OF_VERTEX: usize = 3;
const OF_RESULT: usize = 300_000;

/// Returns the number of useful points for a result of `points` vertices.
fn for_points(points: usize) -> usize {
    OF_VERTEX * points + OF_RESULT
}

/// Returns how many points of a cloud are useful for remeshing it; `None` if that is not known in advance, if each point has
/// a value of its own, or if the result is measured against all points.
pub fn of_use_for_remeshing(options: &Options) -> Option<usize> {
    let is_given = match &options.grading {
        Grading::Field(values) => is_given(values),
        Grading::Kernel { signals, .. } => has_given(signals),
        Grading::Even | Grading::Curvature(_) => false,
    };
    match options.density {
        Density::Points(points) if !is_given && options.max_error.is_none() => Some(for_points(points)),
        _ => None,
    }
}

/// Like [`of_use_for_remeshing`], for sampling.
pub fn of_use_for_sampling(options: &SampleOptions) -> Option<usize> {
    match options.density {
        SampleDensity::Points(points) if !has_given(&options.signals) => Some(for_points(points)),
        _ => None,
    }
}

fn has_given(signals: &[Signal]) -> bool {
    signals.iter().any(|signal| is_given(&signal.values))
}

fn is_given(values: &Values) -> bool {
    matches!(values, Values::Given(_))
}

impl<'a> Input<'a> {
    /// Returns a cloud with at most about `wanted` points; any other input, and one that was thinned before, as it is.
    pub(super) fn thinned_to(&'a self, wanted: Option<usize>) -> Cow<'a, Input<'a>> {
        let (positions, attributes) = (&self.as_mesh().positions, self.attributes());
        let Some(wanted) = wanted.filter(|&wanted| self.is_cloud() && wanted < positions.len()) else {
            return Cow::Borrowed(self);
        };
        if self.thinning().is_some() {
            return Cow::Borrowed(self);
        }
        let thinned = thinned(positions, &attributes.normals(), wanted);
        let mesh =
            Mesh { positions: thinned.numbers.iter().map(|&p| positions[p as usize]).collect(), triangles: Vec::new() };
        Cow::Owned(Input::thinned(mesh, attributes.of_vertices(&thinned.numbers), thinned))
    }
}

/// Chooses about `wanted` of the points at `positions`, with normals or without.
fn thinned(positions: &[DVec3], normals: &[DVec3], wanted: usize) -> Thinned {
    let look = |row: &[u8]| {
        let point = row.first_chunk().map_or(0, |bytes| u32::from_ne_bytes(*bytes)) as usize;
        Seen { position: positions[point], normal: normals.get(point).copied().unwrap_or_default() }
    };
    let mut thinner = Thinner::new(wanted, size_of::<u32>(), look);
    let numbers: Vec<u32> = (0..positions.len() as u32).collect();
    thinner.push(bytemuck::cast_slice(&numbers));
    thinner.finish().0
}

/// Returns the note on a cloud that was thinned.
pub(super) fn note(thinned: &Thinned) -> String {
    let Thinned { points, cell, numbers } = thinned;
    let kept = numbers.len();
    format!(
        "{points} points are more than needed and were thinned to {kept}, one for each cell of width {cell:.4e}; each removed \
         point is within {:.4e} of one that was kept",
        thinned.reach()
    )
}
