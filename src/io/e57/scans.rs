//! The points of all scans of a file, one scan after the other.

use super::MAGIC;
use crate::base::error::{Place, Result};
use crate::io::bytes::{CUT_SHORT, EXPORT_AGAIN, malformed};
use crate::io::content::{Parsed, Read};
use crate::io::text::left_out;
use crate::mesh::attributes::{Attribute, Attributes, COLOR, Scalar};
use crate::mesh::triangle_mesh::Mesh;
use e57::{CartesianCoordinate, E57Reader};
use glam::DVec3;
use std::io::{self, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Maximum number of points per byte of a file: real points take more than a byte each.
const MOST_PER_BYTE: u64 = 16;

/// Size of the smallest packet of points, in bytes.
const LEAST_PACKET: u64 = 4;

/// Size of the header, in bytes.
const HEADER: usize = 48;

pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let mut cloud = Cloud::default();
    let nowhere = each_point(io::Cursor::new(bytes), &mut |point| {
        cloud.push(point);
        Ok(())
    })?;
    Ok(cloud.finish(nowhere))
}

/// A point that was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    pub position: DVec3,
    /// Red, green and blue, as fractions.
    pub color: Option<[f64; 3]>,
    pub intensity: Option<f64>,
}

/// Returns the number of points that the file promises.
///
/// # Errors
/// An error that says what is damaged.
#[cfg(feature = "fs")]
pub(super) fn promised<R: io::Read + Seek>(source: R) -> Result<u64> {
    guarded(source, |source, length| open(source, length).map(|(_, promised)| promised))
}

/// Passes all points to `show`. Returns the number of directions in which nothing was seen.
///
/// # Errors
/// Those of `show`; an error that says what is damaged.
pub(super) fn each_point<R: io::Read + Seek>(source: R, show: &mut dyn FnMut(Point) -> Result<()>) -> Result<usize> {
    let mut refused = Ok(());
    let nowhere = guarded(source, |source, length| {
        each_valid(source, length, &mut |point| {
            refused = show(point);
            refused.is_ok()
        })
    });
    refused.and(nowhere)
}

/// Returns what `read` makes of a file. `read` gets the file, rewound to its beginning, and its length. Guards against the
/// crate, which reserves as much memory as the file promises, and may panic on damaged data.
fn guarded<R: io::Read + Seek, T>(
    mut source: R,
    read: impl FnOnce(R, u64) -> std::result::Result<T, String>,
) -> Result<T> {
    let damaged = |cause: String| {
        let cause = format!("it cannot be read: {cause}").replace(['\n', '\r'], " ");
        malformed(Place::Whole, cause, EXPORT_AGAIN)
    };
    let length = source.seek(SeekFrom::End(0)).map_err(|e| damaged(e.to_string()))?;
    if !has_sound_header(&mut source, length) {
        return Err(malformed(Place::Byte(0), "it does not begin with the header of an E57 file", CUT_SHORT));
    }
    let read = catch_unwind(AssertUnwindSafe(|| read(source, length)));
    read.map_err(|_| malformed(Place::Whole, "the file is damaged", EXPORT_AGAIN))?.map_err(damaged)
}

/// Opens a file. Returns it with the number of points that it promises, unless its length cannot hold so many.
fn open<R: io::Read + Seek>(source: R, length: u64) -> std::result::Result<(E57Reader<R>, u64), String> {
    let file = E57Reader::new(source).map_err(|e| e.to_string())?;
    let promised = file.pointclouds().iter().fold(0u64, |sum, scan| sum.saturating_add(scan.records));
    if promised / MOST_PER_BYTE > length {
        return Err(format!("it declares {promised} points, more than a file of this size can hold"));
    }
    Ok((file, promised))
}

/// Whether the sizes of the XML section and of pages, for which the crate reserves memory at once, are within the file.
fn has_sound_header<R: io::Read + Seek>(source: &mut R, length: u64) -> bool {
    let mut header = [0; HEADER];
    let is_read = source.rewind().and_then(|()| source.read_exact(&mut header)).and_then(|()| source.rewind()).is_ok();
    let within = |at: usize| {
        let size = crate::io::bytes::array(&header, at).map(u64::from_le_bytes);
        size.is_some_and(|size| size <= length)
    };
    is_read && header.starts_with(MAGIC) && within(32) && within(40)
}

/// Passes points to `show` until there are no more or `show` returns false. Returns the number of points without a valid
/// position.
fn each_valid<R: io::Read + Seek>(
    source: R,
    length: u64,
    show: &mut dyn FnMut(Point) -> bool,
) -> std::result::Result<usize, String> {
    let (mut file, _) = open(source, length)?;
    let mut nowhere = 0;
    for scan in &file.pointclouds() {
        let mut points = file.pointcloud_simple(scan).map_err(|e| e.to_string())?;
        points.normalize_intensity(false);
        let mut packets = 0;
        for point in points {
            let point = match point {
                Ok(point) => seen(point),
                // The crate reports a packet that completes no point as an error; the next call goes on.
                Err(e57::Error::Internal { .. }) if packets < length / LEAST_PACKET => {
                    packets += 1;
                    continue;
                }
                Err(error) => return Err(error.to_string()),
            };
            match point {
                Some(point) if !show(point) => return Ok(nowhere),
                Some(_) => {}
                None => nowhere += 1,
            }
        }
    }
    Ok(nowhere)
}

fn seen(point: e57::Point) -> Option<Point> {
    let CartesianCoordinate::Valid { x, y, z } = point.cartesian else { return None };
    let color = point.color.map(|c| [c.red, c.green, c.blue].map(f64::from));
    let point = Point { position: DVec3::new(x, y, z), color, intensity: point.intensity.map(f64::from) };
    point.position.is_finite().then_some(point)
}

/// The points read so far.
#[derive(Default)]
pub(super) struct Cloud {
    positions: Vec<DVec3>,
    color: Vec<f64>,
    intensity: Vec<f64>,
}

impl Cloud {
    pub(super) fn push(&mut self, point: Point) {
        self.positions.push(point.position);
        self.color.extend(point.color.into_iter().flatten());
        self.intensity.extend(point.intensity);
    }

    /// Returns the points with the attributes that all of them have. `nowhere` is the number of directions in which nothing
    /// was seen.
    pub(super) fn finish(self, nowhere: usize) -> Read {
        let count = self.positions.len();
        let all = [(COLOR, 3, self.color), ("intensity", 1, self.intensity)];
        let known = all.into_iter().filter(|(_, components, values)| values.len() == components * count);
        let attribute = |(name, components, values): (&str, usize, Vec<f64>)| Attribute {
            name: name.into(),
            components,
            values,
            scalar: Scalar::F32,
        };
        let attributes = Attributes { vertex: known.map(attribute).collect(), ..Attributes::default() };
        let mesh = Mesh { positions: self.positions, triangles: Vec::new() };
        let mut notes = Vec::new();
        let what = ["scan direction without a return", "scan directions without a return"];
        left_out(&mut notes, nowhere, what[0], what[1]);
        Read { mesh, attributes, notes }
    }
}
