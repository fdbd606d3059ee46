//! Counts and lengths that a PLY file claims, compared with its size, and elements that are left out.

use super::header::{Element, Kind, Property};
use super::source::Source;
use crate::base::error::Result;
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use crate::mesh::attributes::Scalar;

/// Returns the element's count, if the remaining bytes can hold it.
pub(super) fn checked_count<S: Source>(source: &S, element: &Element) -> Result<usize> {
    let least = |p: &Property| match p.kind {
        Kind::Scalar(scalar) => S::least(scalar),
        Kind::List { count, .. } => S::least(count),
    };
    let row: usize = element.properties.iter().map(least).sum();
    if row == 0 {
        return Ok(0);
    }
    let most = source.remaining() / row;
    if element.count > most as u64 {
        let Element { name, count, .. } = element;
        let cause = format!("the header declares {count} elements '{name}', but there are bytes for at most {most}");
        return Err(malformed(source.end(), cause, CUT_SHORT));
    }
    if element.count > u64::from(u32::MAX) {
        return Err(element.error(format!("more than {} elements '{}'", u32::MAX, element.name), "split the file"));
    }
    Ok(element.count as usize)
}

/// Reads the length of the next list, if the remaining bytes can hold it.
#[inline]
pub(super) fn list_length<S: Source>(source: &mut S, count: Scalar, item: Scalar) -> Result<usize> {
    let length = source.value(count)?;
    let most = source.remaining() / S::least(item);
    whole_length(length, most).map_err(|cause| malformed(source.place(), cause, EXPORT_AGAIN))
}

/// Converts the length of a list to an integer that is at most `most`. The error says what is wrong with it.
#[inline]
pub(super) fn whole_length(length: f64, most: usize) -> std::result::Result<usize, String> {
    let whole = length as usize;
    if whole as f64 == length && whole <= most {
        return Ok(whole);
    }
    Err(format!("a list has {length} values, but there are bytes for at most {most}"))
}

#[inline]
pub(super) fn skip<S: Source>(source: &mut S, kind: Kind) -> Result<()> {
    match kind {
        Kind::Scalar(scalar) => source.skip(scalar, 1),
        Kind::List { count, item } => {
            let length = list_length(source, count, item)?;
            source.skip(item, length)
        }
    }
}

pub(super) fn skip_element<S: Source>(source: &mut S, element: &Element) -> Result<()> {
    for _ in 0..checked_count(source, element)? {
        element.properties.iter().try_for_each(|p| skip(source, p.kind))?;
    }
    Ok(())
}
