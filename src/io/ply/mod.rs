//! PLY: ASCII and binary of both byte orders.
//!
//! A file is a header and a table for every element it declares. Read are the `x`, `y`, `z` of `vertex`, the polygons
//! of `face` (`vertex_indices` or `vertex_index`) and the strips of `tristrips`, in whatever order and types; all other
//! elements and properties are skipped. A count in the header is compared with the bytes that are left before memory is
//! reserved for it.
//!
//! A strip is a row of vertices, three in succession a triangle, the second of which winds the other way, and so on; -1
//! starts afresh. Triangles with a vertex twice only join strips and are left out.
//!
//! Limits: 64-bit integers, which some programs write, are no part of the format and refused.

mod header;
mod source;
mod write;

pub(crate) use write::write;

use crate::base::error::{Error, Place, Result};
use crate::geom::polygon::triangulate;
use crate::io::Parsed;
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use crate::io::text::{quote, small_faces};
use crate::surface::mesh::Mesh;
use glam::DVec3;
use header::{Element, Encoding, Header, Kind, Property, Scalar};
use source::{Binary, Source, Text};

/// The mesh in a PLY file. A file without faces gives vertices only.
///
/// # Errors
/// `Error::Format` with the line or byte of what is malformed.
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let header = header::parse(bytes)?;
    match header.encoding {
        Encoding::Text => read(Text::new(&bytes[header.body..], header.line), &header),
        Encoding::Little => read(Binary::<false>::new(bytes, header.body), &header),
        Encoding::Big => read(Binary::<true>::new(bytes, header.body), &header),
    }
}

/// The property `name` of all vertices of a PLY file, a number each.
///
/// # Errors
/// `Error::Format` if the vertices have none, and with the line or byte of what is malformed.
pub(crate) fn property(bytes: &[u8], name: &str) -> Result<Vec<f64>> {
    let header = header::parse(bytes)?;
    match header.encoding {
        Encoding::Text => read_property(Text::new(&bytes[header.body..], header.line), &header, name),
        Encoding::Little => read_property(Binary::<false>::new(bytes, header.body), &header, name),
        Encoding::Big => read_property(Binary::<true>::new(bytes, header.body), &header, name),
    }
}

fn read_property<S: Source>(mut source: S, header: &Header, name: &str) -> Result<Vec<f64>> {
    for element in &header.elements {
        if element.name == "vertex" {
            let scalars = element.properties.iter().filter(|p| matches!(p.kind, Kind::Scalar(_)));
            let names: Vec<&str> = scalars.map(|p| p.name.as_str()).collect();
            if !names.contains(&name) {
                let cause = format!("a vertex has no property {}", quote(name.as_bytes()));
                return Err(element.error(cause, &format!("use one of {}", names.join(", "))));
            }
            let rows = read_columns(&mut source, element, [name], S::value)?;
            return Ok(rows.into_iter().map(|[value]| value).collect());
        }
        skip_element(&mut source, element)?;
    }
    Err(no_vertices(header))
}

fn no_vertices(header: &Header) -> Error {
    malformed(Place::Line(header.line - 1), "no element 'vertex' in the header", EXPORT_AGAIN)
}

/// Reads all elements. Faces that come before the vertices are skipped first and read at the end.
fn read<S: Source>(mut source: S, header: &Header) -> Parsed {
    let Some(vertex) = header.elements.iter().position(|e| e.name == "vertex") else {
        return Err(no_vertices(header));
    };
    let mut faces = Faces { positions: Vec::new(), triangles: Vec::new(), small: 0 };
    let mut notes = Vec::new();
    let mut early = Vec::new();
    for (i, element) in header.elements.iter().enumerate() {
        let surface = matches!(element.name.as_str(), "face" | "tristrips");
        if i == vertex {
            let rows = read_columns(&mut source, element, ["x", "y", "z"], coordinate)?;
            faces.positions = rows.into_iter().map(DVec3::from_array).collect();
        } else if surface && i > vertex {
            faces.read(&mut source, element)?;
        } else {
            if surface {
                early.push((source.clone(), element));
            } else if element.count > 0 {
                notes.push(format!("{} elements '{}' are left out", element.count, element.name));
            }
            skip_element(&mut source, element)?;
        }
    }
    for (mut source, element) in early {
        faces.read(&mut source, element)?;
    }
    small_faces(&mut notes, faces.small);
    if source.has_more() {
        notes.push("what comes after the last element is left out".into());
    }
    Ok((Mesh { positions: faces.positions, triangles: faces.triangles }, notes))
}

/// The element's count, if the bytes that are left can hold it.
fn checked_count<S: Source>(source: &S, element: &Element) -> Result<usize> {
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
        let cause = format!("the header says {count} elements '{name}', but there are bytes for at most {most}");
        return Err(malformed(source.end(), cause, CUT_SHORT));
    }
    if element.count > u64::from(u32::MAX) {
        return Err(element.error(format!("more than {} elements '{}'", u32::MAX, element.name), "split the file"));
    }
    Ok(element.count as usize)
}

/// The length of the list that comes next, if the bytes that are left can hold it.
#[inline]
fn list_length<S: Source>(source: &mut S, count: Scalar, item: Scalar) -> Result<usize> {
    let length = source.value(count)?;
    let most = source.remaining() / S::least(item);
    let whole = length as usize;
    if whole as f64 == length && whole <= most {
        return Ok(whole);
    }
    let cause = format!("a list of {length} values, where there are bytes for at most {most}");
    Err(malformed(source.place(), cause, EXPORT_AGAIN))
}

#[inline]
fn skip<S: Source>(source: &mut S, kind: Kind) -> Result<()> {
    match kind {
        Kind::Scalar(scalar) => source.skip(scalar, 1),
        Kind::List { count, item } => {
            let length = list_length(source, count, item)?;
            source.skip(item, length)
        }
    }
}

fn skip_element<S: Source>(source: &mut S, element: &Element) -> Result<()> {
    for _ in 0..checked_count(source, element)? {
        element.properties.iter().try_for_each(|p| skip(source, p.kind))?;
    }
    Ok(())
}

/// The properties `names` of all rows of a table, each read by `value`; all others are skipped.
fn read_columns<S: Source, const N: usize>(
    source: &mut S,
    element: &Element,
    names: [&str; N],
    value: impl Fn(&mut S, Scalar) -> Result<f64>,
) -> Result<Vec<[f64; N]>> {
    let plan = columns(element, names)?;
    let count = checked_count(source, element)?;
    let mut rows = Vec::with_capacity(count);
    for _ in 0..count {
        let mut row = [0.0; N];
        for &(kind, column) in &plan {
            match (kind, column) {
                (Kind::Scalar(scalar), Some(column)) => row[column] = value(source, scalar)?,
                _ => skip(source, kind)?,
            }
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Which of `names` each property of an element is.
fn columns<const N: usize>(element: &Element, names: [&str; N]) -> Result<Vec<(Kind, Option<usize>)>> {
    let mut plan: Vec<_> = element.properties.iter().map(|p| (p.kind, None)).collect();
    for (column, name) in names.into_iter().enumerate() {
        let found = element.properties.iter().position(|p| p.name == name && matches!(p.kind, Kind::Scalar(_)));
        let i = found.ok_or_else(|| element.error(format!("a vertex has no property '{name}'"), EXPORT_AGAIN))?;
        plan[i].1 = Some(column);
    }
    Ok(plan)
}

#[inline]
fn coordinate<S: Source>(source: &mut S, kind: Scalar) -> Result<f64> {
    let value = source.value(kind)?;
    if value.is_finite() {
        return Ok(value);
    }
    Err(not_finite(value, source.place()))
}

#[cold]
fn not_finite(value: f64, place: Place) -> Error {
    malformed(place, format!("the coordinate {value} is not finite"), "replace or remove this vertex")
}

/// The faces that were read so far, over the vertices of the file.
struct Faces {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// How many faces had fewer than three corners.
    small: usize,
}

impl Faces {
    fn read<S: Source>(&mut self, source: &mut S, element: &Element) -> Result<()> {
        let list = |p: &Property| {
            matches!(p.name.as_str(), "vertex_indices" | "vertex_index") && matches!(p.kind, Kind::List { .. })
        };
        let Some(list) = element.properties.iter().position(list) else {
            let cause = format!("the element '{}' has no list 'vertex_indices'", element.name);
            return Err(element.error(cause, EXPORT_AGAIN));
        };
        let (before, after) = element.properties.split_at(list);
        let strips = element.name == "tristrips";
        let mut corners = Vec::new();
        let count = checked_count(source, element)?;
        self.triangles.reserve(count);
        for _ in 0..count {
            before.iter().try_for_each(|p| skip(source, p.kind))?;
            if let Kind::List { count, item } = after[0].kind {
                let length = list_length(source, count, item)?;
                if strips { self.strips(source, length, item)? } else { self.face(source, length, item, &mut corners)? }
            }
            after[1..].iter().try_for_each(|p| skip(source, p.kind))?;
        }
        Ok(())
    }

    /// Reads a polygon; `corners` is working space.
    #[inline]
    fn face<S: Source>(&mut self, source: &mut S, length: usize, item: Scalar, corners: &mut Vec<u32>) -> Result<()> {
        corners.clear();
        for _ in 0..length {
            let index = source.value(item)?;
            corners.push(self.checked_index(source, index)?);
        }
        match corners[..] {
            [a, b, c] => self.triangles.push([a, b, c]),
            [_, _, _, ..] => {
                let places: Vec<DVec3> = corners.iter().map(|&v| self.positions[v as usize]).collect();
                self.triangles.extend(triangulate(&places).into_iter().map(|t| t.map(|i| corners[i])));
            }
            _ => self.small += 1,
        }
        Ok(())
    }

    /// Reads one list of strips.
    fn strips<S: Source>(&mut self, source: &mut S, length: usize, item: Scalar) -> Result<()> {
        let mut last: [Option<u32>; 2] = [None; 2];
        let mut odd = false;
        for _ in 0..length {
            let index = source.value(item)?;
            // In an unsigned list, -1 is the largest number.
            if index == -1.0 || index == f64::from(u32::MAX) {
                (last, odd) = ([None; 2], false);
                continue;
            }
            let c = self.checked_index(source, index)?;
            if let [Some(a), Some(b)] = last {
                if a != b && b != c && c != a {
                    self.triangles.push(if odd { [b, a, c] } else { [a, b, c] });
                }
                odd = !odd;
            }
            last = [last[1], Some(c)];
        }
        Ok(())
    }

    #[inline]
    fn checked_index<S: Source>(&self, source: &S, index: f64) -> Result<u32> {
        // The conversion saturates, so only a whole number in range comes back as it was.
        let whole = index as u32;
        if f64::from(whole) == index && (whole as usize) < self.positions.len() {
            return Ok(whole);
        }
        Err(self.no_vertex(index, source.place()))
    }

    #[cold]
    fn no_vertex(&self, index: f64, place: Place) -> Error {
        malformed(place, format!("there is no vertex {index}, the file has {}", self.positions.len()), EXPORT_AGAIN)
    }
}

#[cfg(test)]
mod tests;
