//! Determines how coarse a mesh larger than memory may become while it is read for a job.

use crate::base::error::{Error, Result, Setting};
use crate::geom::packing::count_on;
use crate::io::large::Extent;
use crate::pipeline::{Grading, Options, Values, coarseness_for, spacing_on};
use crate::prepare::coarsen::Coarseness;

/// Number of vertices left per area of one shortest length squared, measured on two models.
const LEFT: f64 = 0.7;

/// Bytes that remeshing takes for each remaining vertex and for each vertex of the result: 2.65 million and one million take
/// 2.1 GB.
const OF_INPUT: f64 = 250.0;
const OF_RESULT: f64 = 1500.0;

/// Maximum factor by which edges may exceed the sufficient length where memory is short: up to 0.6 of the spacing.
const MOST_LONGER: f64 = 3.0;

/// Minimum number of faces, and of vertices per wanted one, for which reading a mesh in blocks saves time: its edges are
/// then a tenth as long as those of the result.
const MANY: u64 = 1_000_000;
const TIMES_FINER: u64 = 100;

/// Returns whether a mesh of this many faces is so much finer than the result that it may become coarser while it is read.
pub fn is_far_finer(faces: u64, options: &Options) -> bool {
    // A triangle mesh has about twice as many faces as vertices.
    options.density.points().is_some_and(|points| faces >= MANY.max(2 * TIMES_FINER * points as u64))
}

/// Refuses options that need all of the input.
///
/// # Errors
/// [`Error::Option`] for the first of them.
pub fn refuse_coarser(options: &Options) -> Result<()> {
    let setting = match (&options.part, &options.grading) {
        _ if options.max_error.is_some() => Setting::MaxError,
        // The reach of smoothing depends on the spacing of the input's vertices.
        _ if options.smoothing().is_some() => Setting::Smoothing,
        (Some(part), _) => part.setting(),
        (None, Grading::Field(Values::Given(_))) => Setting::Field,
        _ if spacing_on(1.0, options.density).is_none() => Setting::Field,
        _ => return Ok(()),
    };
    Err(Error::Option {
        option: setting,
        cause: "it needs the whole mesh, but a mesh is coarsened while it is read out of core".into(),
        remedy: "leave it out, or read the mesh as a whole".into(),
    })
}

/// Returns how coarse a mesh of this extent may become, and how many vertices may be left: as fine as is useful if `memory`,
/// in bytes, suffices, otherwise coarser.
///
/// # Errors
/// Those of [`refuse_coarser`]; [`Error::Option`] if memory does not suffice.
pub fn coarseness_within(memory: u64, extent: Extent, options: &Options) -> Result<(Coarseness, f64)> {
    refuse_coarser(options)?;
    let spacing = spacing_on(extent.area, options.density).unwrap_or(f64::INFINITY);
    let of_use = coarseness_for(spacing);
    let result = count_on(extent.area, spacing);
    let left = |shortest: f64| (LEFT * extent.area / (shortest * shortest)).min(extent.vertices as f64);
    let bytes = |longer: f64| OF_RESULT * result + OF_INPUT * left(longer * of_use.shortest);
    let room = memory as f64 - OF_RESULT * result;
    let needed = bytes(MOST_LONGER);
    if needed > memory as f64 {
        let [needed, memory] = [needed, memory as f64].map(|bytes| (bytes / 1e6).ceil());
        return Err(Error::Option {
            option: Setting::Memory,
            cause: format!(
                "remeshing to {result:.0} vertices takes about {needed} MB, more than the {memory} MB that are allowed"
            ),
            remedy: "allow more memory, or ask for fewer vertices".into(),
        });
    }
    if bytes(1.0) <= memory as f64 {
        return Ok((of_use, room / OF_INPUT));
    }
    let longer = (OF_INPUT * LEFT * extent.area / room).sqrt() / of_use.shortest;
    Ok((coarseness_for(longer.min(MOST_LONGER) * spacing), room / OF_INPUT))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::MaxError;

    #[test]
    fn only_what_is_large_and_far_finer_becomes_coarser_by_itself() {
        let of = |faces, points| is_far_finer(faces, &Options::points(points));
        assert!(of(6_400_000, 13_000) && of(1_000_000, 5_000));
        assert!(!of(6_400_000, 300_000) && !of(900_000, 100));
    }

    #[test]
    fn the_less_memory_the_coarser_and_at_last_an_error() {
        let extent = Extent { vertices: 25_000_000, triangles: 50_000_000, area: 1.0 };
        let shortest = |memory| {
            coarseness_within(memory, extent, &Options::points(1_000_000)).map(|(coarseness, _)| coarseness.shortest)
        };
        let [most, less] = [100_000_000_000, 2_000_000_000].map(|memory| shortest(memory).unwrap());
        assert!(2.0 * most < less && less <= MOST_LONGER * most, "{most} {less}");
        let error = shortest(1_000_000_000).unwrap_err().to_string();
        assert!(error.contains("more than the 1000 MB that are allowed"), "{error}");
        let bounded = Options { max_error: Some(MaxError::Length(0.1)), ..Options::points(100) };
        assert!(refuse_coarser(&bounded).is_err() && refuse_coarser(&Options::default()).is_ok());
    }
}
