//! Determines which points of a cloud a job can use, and leaves out the others.

use crate::base::error::{Result, Setting};
use crate::job::input::Input;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Grading, Options, SampleOptions, Selection, Signal, Values};
use crate::prepare::thin::{Seen, Thinned, Thinner, Wanted};
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

/// Returns which points of a cloud are wanted for remeshing it: those inside the box of the part, and about as many as are
/// useful. All may be useful, or each has a value of its own, or the result is measured against all of them.
pub fn wanted_for_remeshing(options: &Options) -> Wanted {
    Wanted { points: of_use_for_remeshing(options), within: options.part.as_ref().and_then(Selection::bounds) }
}

/// Returns which points of a cloud are wanted for sampling it, like [`wanted_for_remeshing`].
pub fn wanted_for_sampling(options: &SampleOptions) -> Wanted {
    let points = options.density.points().filter(|_| !has_given(&options.signals));
    Wanted { points: points.map(for_points), within: options.bounds() }
}

fn of_use_for_remeshing(options: &Options) -> Option<usize> {
    let is_given = match &options.grading {
        Grading::Field(values) => is_given(values),
        Grading::Kernel { signals, .. } => has_given(signals),
        Grading::Even | Grading::Curvature(_) => false,
    };
    options.density.points().filter(|_| !is_given && options.max_error.is_none()).map(for_points)
}

fn has_given(signals: &[Signal]) -> bool {
    signals.iter().any(|signal| is_given(&signal.values))
}

fn is_given(values: &Values) -> bool {
    matches!(values, Values::Given(_))
}

impl<'a> Input<'a> {
    /// Returns the values at the points that thinning kept, with an attribute looked up.
    ///
    /// # Errors
    /// [`Error::Option`](crate::Error::Option) unless one value is given for each point before thinning;
    /// [`Error::Mesh`](crate::Error::Mesh) for an attribute that does not exist.
    pub(super) fn values(&self, option: Setting, values: &Values) -> Result<Values> {
        match self.thinning() {
            Some(thinned) => values.picked(option, &thinned.numbers, thinned.points)?.resolved(self.attributes()),
            None => values.resolved(self.attributes()),
        }
    }

    /// Returns the wanted points of a cloud; any other input, and one that was thinned before, as it is.
    ///
    /// # Errors
    /// [`Error::Option`](crate::Error::Option) if no point is inside the wanted box.
    pub(super) fn thinned_to(&'a self, wanted: Wanted) -> Result<Cow<'a, Input<'a>>> {
        let (positions, attributes) = (&self.as_mesh().positions, self.attributes());
        if !self.is_cloud() || self.thinning().is_some() || wanted.is_all_of(positions.len()) {
            return Ok(Cow::Borrowed(self));
        }
        let thinned = thinned(positions, &attributes.normals(), wanted);
        thinned.refuse_empty(&wanted)?;
        let mesh =
            Mesh { positions: thinned.numbers.iter().map(|&p| positions[p as usize]).collect(), triangles: Vec::new() };
        Ok(Cow::Owned(Input::thinned(mesh, attributes.of_vertices(&thinned.numbers), thinned)))
    }
}

/// Chooses the wanted points among those at `positions`, with normals or without.
fn thinned(positions: &[DVec3], normals: &[DVec3], wanted: Wanted) -> Thinned {
    let look = |row: &[u8]| {
        let point = row.first_chunk().map_or(0, |bytes| u32::from_ne_bytes(*bytes)) as usize;
        Seen { position: positions[point], normal: normals.get(point).copied().unwrap_or_default() }
    };
    let mut thinner = Thinner::new(wanted, size_of::<u32>(), look);
    let numbers: Vec<u32> = (0..positions.len() as u32).collect();
    thinner.push(0, bytemuck::cast_slice(&numbers));
    thinner.finish().0
}
