//! How coarse a mesh that is larger than memory may become while it is read for a job.

use crate::base::error::{Error, Fault, Result, Setting};
use crate::io::large::Extent;
use crate::pipeline::{Grading, Options, Values, coarseness_for, spacing_on};
use crate::prepare::coarsen::Coarseness;

/// Vertices left for each square of the shortest length in the area, measured on two models.
const LEFT: f64 = 0.7;

/// Bytes that remeshing takes for each vertex that is left and for each one of the result: 2.65 million and a million take 2.1
/// GB.
const OF_INPUT: f64 = 250.0;
const OF_RESULT: f64 = 1500.0;

/// Where memory is short, edges may be this many times longer than suffices: 0.6 of the spacing.
const MOST_LONGER: f64 = 3.0;

/// Refuses options that need all of the input.
///
/// # Errors
/// [`Error::Option`] with the first of them.
pub fn refuse_coarser(options: &Options) -> Result<()> {
    let setting = match (&options.part, &options.grading) {
        _ if options.max_error.is_some() => Setting::MaxError,
        (Some(part), _) => part.setting(),
        (None, Grading::Field(Values::Given(_))) => Setting::Field,
        _ if spacing_on(1.0, options.density).is_none() => Setting::Field,
        _ => return Ok(()),
    };
    Err(Error::Option {
        option: setting,
        cause: "it needs all of a mesh, which becomes coarser while it is read out of core".into(),
        remedy: "leave it out, or read the mesh as a whole".into(),
    })
}

/// How coarse a mesh of that extent may become: as fine as is useful if `memory`, in bytes, suffices, else coarser.
///
/// # Errors
/// Those of [`refuse_coarser`]; [`Error::Mesh`] if memory does not suffice.
pub fn coarseness_within(memory: u64, extent: Extent, options: &Options) -> Result<Coarseness> {
    refuse_coarser(options)?;
    let spacing = spacing_on(extent.area, options.density).unwrap_or(f64::INFINITY);
    let of_use = coarseness_for(spacing);
    let result = 2.0 * extent.area / (3f64.sqrt() * spacing * spacing);
    let left = |shortest: f64| (LEFT * extent.area / (shortest * shortest)).min(extent.vertices as f64);
    let bytes = |longer: f64| OF_RESULT * result + OF_INPUT * left(longer * of_use.shortest);
    let room = memory as f64 - OF_RESULT * result;
    let needed = bytes(MOST_LONGER);
    if needed > memory as f64 {
        let [needed, memory] = [needed, memory as f64].map(|bytes| (bytes / 1e6).ceil());
        return Err(Error::Mesh {
            fault: Fault::TooLarge,
            cause: format!(
                "{result:.0} vertices of it take about {needed} MB, more than the {memory} MB that are allowed"
            ),
            remedy: "allow more by --memory, or ask for fewer vertices".into(),
        });
    }
    if bytes(1.0) <= memory as f64 {
        return Ok(of_use);
    }
    let longer = (OF_INPUT * LEFT * extent.area / room).sqrt() / of_use.shortest;
    Ok(coarseness_for(longer.min(MOST_LONGER) * spacing))
}
