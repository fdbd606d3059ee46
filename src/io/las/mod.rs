//! LAS and LAZ, the formats of laser scanners: points with intensity, class and colour.
//!
//! A file has a header, records of variable length, and the points in one of eleven layouts, with integers that are scaled
//! and shifted to coordinates. The points of LAZ are compressed; the crate `laz` decompresses them, with the feature of that
//! name. An attribute that is zero at all points is taken as missing. 16-bit colours that use only eight bits, which some
//! programs write, are taken as bytes.
//!
//! Of COPC, which is LAZ with an octree, the wanted part can be read without the rest.
//!
//! Versions 1.0 to 1.4 are read. Returns, times, angles, waveforms and extra bytes are left out.
//!
//! Cost: one pass. A header that promises more points than the file can hold is refused before memory is reserved. LAZ,
//! which can hold any number of equal points in a few bytes, is limited to sixteen points per byte.
//!
//! Limits: the crate detects damage inside of compressed points, and may panic; the panic is caught, but a panic hook is
//! still called.

#[cfg(feature = "laz")]
mod copc;
#[cfg(all(test, feature = "laz"))]
mod copc_tests;
mod header;
#[cfg(feature = "laz")]
mod packed;
#[cfg(not(feature = "laz"))]
#[path = "unpackable.rs"]
mod packed;
#[cfg(feature = "fs")]
mod rows;
#[cfg(feature = "laz")]
mod window;

pub(crate) use header::MAGIC;
#[cfg(feature = "fs")]
pub(crate) use rows::table;

use self::header::{Header, LAYOUTS, WIDE, header};
use crate::base::error::{Error, Place};
use crate::io::bytes::{CUT_SHORT, array, malformed, nowhere};
use crate::io::content::{Parsed, Read};
use crate::mesh::attributes::{Attribute, Attributes, COLOR, Scalar};
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::thin::Wanted;
use glam::DVec3;

pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    let header = header(bytes)?;
    let mut cloud = Cloud::default();
    if header.compressed {
        packed::unpack(std::io::Cursor::new(bytes), &header, &Wanted::default(), &mut |_, row| {
            cloud.push(&header, row);
            Ok(())
        })?;
    } else {
        let points = bytes.get(header.start..).unwrap_or_default();
        if points.len() / header.length < header.count {
            return Err(ends_early(header.count, points.len() / header.length, bytes.len()));
        }
        points.chunks_exact(header.length).take(header.count).for_each(|row| cloud.push(&header, row));
    }
    cloud.finish()
}

/// Returns the integer coordinates of a point.
fn position(row: &[u8]) -> DVec3 {
    let long = |at: usize| f64::from(array(row, at).map_or(0, i32::from_le_bytes));
    DVec3::new(long(0), long(4), long(8))
}

/// Returns the error that the file ends before its points do.
fn ends_early(count: usize, found: usize, end: usize) -> Error {
    let cause = format!("the header declares {count} points, but the file ends after {found}");
    malformed(Place::Byte(end), cause, CUT_SHORT)
}

/// The points read so far.
#[derive(Default)]
struct Cloud {
    positions: Vec<DVec3>,
    intensity: Vec<f64>,
    class: Vec<f64>,
    color: Vec<f64>,
}

impl Cloud {
    /// Adds the point in `row`, which is as long as the header says.
    fn push(&mut self, header: &Header, row: &[u8]) {
        let short = |at: usize| f64::from(array(row, at).map_or(0, u16::from_le_bytes));
        self.positions.push(position(row) * header.scale + header.offset);
        self.intensity.push(short(12));
        self.class.push(f64::from(if header.layout < WIDE { row[15] & 0x1F } else { row[16] }));
        if let Some(at) = LAYOUTS[header.layout].1 {
            self.color.extend([short(at), short(at + 2), short(at + 4)]);
        }
    }

    fn finish(self) -> Parsed {
        let Cloud { positions, intensity, class, color } = self;
        if let Some(v) = positions.iter().position(|p| !p.is_finite()) {
            return Err(nowhere(v));
        }
        let depth = if color.iter().all(|&c| c <= Scalar::U8.full()) { Scalar::U8 } else { Scalar::U16 };
        let all = [
            ("intensity", 1, intensity, Scalar::U16),
            ("classification", 1, class, Scalar::U8),
            (COLOR, 3, color, depth),
        ];
        let used = all.into_iter().filter(|(_, _, values, _)| values.iter().any(|&x| x != 0.0));
        let attribute = |(name, components, values, scalar): (&str, usize, Vec<f64>, Scalar)| Attribute {
            name: name.into(),
            components,
            values,
            scalar,
        };
        let attributes = Attributes { vertex: used.map(attribute).collect(), ..Attributes::default() };
        Ok(Read { mesh: Mesh { positions, triangles: Vec::new() }, attributes, notes: Vec::new() })
    }
}

#[cfg(test)]
mod tests {
    use super::header::HEADERS;
    use super::*;

    pub(super) const COUNT: usize = 300;

    /// Points of layout 2 on a grid, without a header.
    fn rows() -> Vec<[u8; 26]> {
        let row = |i: usize| {
            let mut row = [0; 26];
            for (k, x) in [i % 20, i / 20, 7].into_iter().enumerate() {
                row[4 * k..4 * k + 4].copy_from_slice(&(x as i32 - 5).to_le_bytes());
            }
            row[12..14].copy_from_slice(&(i as u16).to_le_bytes());
            row[15] = 0xE0 | (i % 3) as u8;
            row[20..22].copy_from_slice(&(100 * i as u16).to_le_bytes());
            row
        };
        (0..COUNT).map(row).collect()
    }

    fn with_header(layout: u8, record: &[u8], points: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0; HEADERS[0]];
        bytes[..4].copy_from_slice(MAGIC);
        bytes[24..26].copy_from_slice(&[1, 2]);
        bytes[94..96].copy_from_slice(&(HEADERS[0] as u16).to_le_bytes());
        bytes[96..100].copy_from_slice(&((HEADERS[0] + record.len()) as u32).to_le_bytes());
        bytes[100] = u8::from(!record.is_empty());
        bytes[104] = layout;
        bytes[105] = 26;
        bytes[107..111].copy_from_slice(&(COUNT as u32).to_le_bytes());
        for k in 0..3 {
            bytes[131 + 8 * k..139 + 8 * k].copy_from_slice(&0.5f64.to_le_bytes());
            bytes[155 + 8 * k..163 + 8 * k].copy_from_slice(&(1000.0 * k as f64).to_le_bytes());
        }
        [&bytes, record, points].concat()
    }

    pub(super) fn las() -> Vec<u8> {
        with_header(2, &[], rows().as_flattened())
    }

    fn check(read: Read) {
        assert_eq!(read.mesh.positions[21], DVec3::new(-2.0, 998.0, 2001.0));
        assert_eq!((read.mesh.positions.len(), read.mesh.triangles.len()), (COUNT, 0));
        assert_eq!(read.attributes.names(), ["intensity", "classification", "color"]);
        assert_eq!(read.attributes.vertex[0].values[21], 21.0);
        assert_eq!(read.attributes.vertex[1].values[..3], [0.0, 1.0, 2.0]);
        assert_eq!((read.attributes.color().unwrap().scalar, read.attributes.vertex[2].of(3)[0]), (Scalar::U16, 300.0));
    }

    #[test]
    fn points_are_scaled_and_shifted() {
        check(parse(&las()).unwrap());
    }

    #[test]
    fn numbers_that_nobody_wrote_are_no_attributes() {
        let mut rows = rows();
        rows.iter_mut().for_each(|row| row[12..].fill(0));
        rows[5][22] = 200;
        let read = parse(&with_header(2, &[], rows.as_flattened())).unwrap();
        assert_eq!(read.attributes.names(), ["color"]);
        assert_eq!(read.attributes.color().unwrap().scalar, Scalar::U8);
    }

    #[test]
    fn what_is_wrong_has_a_place() {
        let place = |bytes: &[u8]| match parse(bytes).unwrap_err() {
            Error::Format { place, .. } => place,
            other => panic!("{other}"),
        };
        let good = las();
        for end in 0..good.len() {
            assert!(parse(&good[..end]).is_err());
        }
        let change = |at: usize, with: &[u8]| {
            let mut bytes = good.clone();
            bytes[at..at + with.len()].copy_from_slice(with);
            place(&bytes)
        };
        assert_eq!(change(104, &[11]), Place::Byte(104));
        assert_eq!(change(105, &[25]), Place::Byte(105));
        assert_eq!(change(107, &[255; 4]), Place::Byte(good.len()));
        assert_eq!(change(131, &f64::NAN.to_le_bytes()), Place::Byte(131));
        assert_eq!(change(131, &f64::MAX.to_le_bytes()), Place::Part("point 0".into()));
    }

    #[cfg(feature = "laz")]
    pub(super) fn laz() -> Vec<u8> {
        compressed(2, &rows(), 50_000)
    }

    /// Chunk size that stands for chunks of different sizes.
    #[cfg(feature = "laz")]
    const VARIABLE: u32 = u32::MAX;

    /// Compressed points of a layout, in chunks of `chunk` points.
    #[cfg(feature = "laz")]
    fn compressed<const N: usize>(layout: u8, rows: &[[u8; N]], chunk: u32) -> Vec<u8> {
        use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr, LazVlrBuilder};
        let items = LazItemRecordBuilder::default_for_point_format_id(layout, 0).unwrap();
        let record = LazVlrBuilder::new(items).with_fixed_chunk_size(chunk).build();
        let mut data = Vec::new();
        record.write_to(&mut data).unwrap();
        let mut head = vec![0; 54];
        head[2..2 + LazVlr::USER_ID.len()].copy_from_slice(LazVlr::USER_ID.as_bytes());
        head[18..20].copy_from_slice(&LazVlr::RECORD_ID.to_le_bytes());
        head[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
        head.extend(data);
        let mut before = with_header(layout | header::COMPRESSED, &head, &[]);
        before[105] = N as u8;
        let mut out = std::io::Cursor::new(before.clone());
        out.set_position(before.len() as u64);
        let mut compressor = LasZipCompressor::new(out, record).unwrap();
        for (i, row) in rows.iter().enumerate() {
            if chunk == VARIABLE && i % 70 == 69 {
                compressor.finish_current_chunk().unwrap();
            }
            compressor.compress_one(row).unwrap();
        }
        compressor.done().unwrap();
        compressor.into_inner().into_inner()
    }

    #[cfg(feature = "laz")]
    #[test]
    fn compressed_points_are_the_same() {
        let bytes = laz();
        assert!(bytes.len() < las().len() / 2);
        check(parse(&bytes).unwrap());
    }

    #[cfg(feature = "laz")]
    #[test]
    fn damaged_ones_are_no_panic_and_take_no_memory() {
        let good = laz();
        for end in 0..good.len() - 60 {
            let _ = parse(&good[..end]);
        }
        for at in 0..good.len() {
            for value in [0, 1, 0x7f, 0xff] {
                let mut bytes = good.clone();
                bytes[at] = value;
                let _ = parse(&bytes);
            }
        }
        let mut bytes = good.clone();
        bytes[107..111].copy_from_slice(&[255; 4]);
        assert!(parse(&bytes).unwrap_err().to_string().contains("more than a file of this size can hold"));
    }

    #[cfg(feature = "laz")]
    #[test]
    fn layers_that_are_not_in_the_file_take_no_memory() {
        let rows: Vec<[u8; 30]> = rows()
            .iter()
            .map(|row| {
                let mut layered = [0; 30];
                layered[..14].copy_from_slice(&row[..14]);
                layered
            })
            .collect();
        for chunk in [100, VARIABLE] {
            let good = compressed(6, &rows, chunk);
            let read = parse(&good).unwrap();
            assert_eq!((read.mesh.positions.len(), read.mesh.positions[21]), (COUNT, DVec3::new(-2.0, 998.0, 2001.0)));
            let start = crate::io::bytes::u32_at(&good, 96).unwrap() as usize;
            let first_layer = start + 8 + 30 + 4;
            let mut bytes = good.clone();
            bytes[first_layer..first_layer + 4].fill(0xFF);
            assert!(parse(&bytes).unwrap_err().to_string().contains("a chunk of points is longer than the file"));
            // More points than the chunks hold: the bytes after the chunks must not be taken for one.
            let mut bytes = good;
            bytes[107..111].copy_from_slice(&(COUNT as u32 + 200).to_le_bytes());
            assert!(parse(&bytes).is_err());
        }
    }
}
