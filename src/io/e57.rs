//! E57, a format of laser scanners: points with colour and intensity, in several scans.
//!
//! The crate `e57` reads it, with the feature of that name. All scans are read, each put into its place; directions in
//! which nothing was seen are left out. Colours are fractions of the range that the scan gives them.
//!
//! Cost: one pass. A file that promises more points than [`MOST_PER_BYTE`] a byte is refused before any is read.
//!
//! Limits: normals, times, rows and columns, and pictures are left out. What is damaged is found by the crate, mostly by
//! its check sums; should it panic, that is caught, but a panic hook still hears of it.

use super::bytes::malformed;
use crate::base::error::Place;
use crate::io::content::Parsed;

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"ASTM-E57";

#[cfg(not(feature = "e57"))]
pub(crate) fn parse(_: &[u8]) -> Parsed {
    let cause = "it is an E57 file, and this program was built without the feature e57";
    Err(malformed(Place::Whole, cause, "convert it to LAZ or PLY, or build with that feature"))
}

#[cfg(feature = "e57")]
pub(crate) fn parse(bytes: &[u8]) -> Parsed {
    use super::bytes::{CUT_SHORT, EXPORT_AGAIN};
    if !has_sound_header(bytes) {
        return Err(malformed(Place::Byte(0), "it does not begin with the header of an E57 file", CUT_SHORT));
    }
    // The crate reserves memory for what the file promises, and may panic at what is damaged.
    let read = std::panic::catch_unwind(|| scans(bytes));
    let cloud = read.map_err(|_| malformed(Place::Whole, "the file is damaged", EXPORT_AGAIN))?;
    let cloud = cloud.map_err(|cause| {
        let cause = format!("it cannot be read: {cause}").replace(['\n', '\r'], " ");
        malformed(Place::Whole, cause, EXPORT_AGAIN)
    })?;
    Ok(cloud.finish())
}

/// Points for each byte of a file: real ones take more than a byte each.
#[cfg(feature = "e57")]
const MOST_PER_BYTE: u64 = 16;

/// The bytes of the smallest packet of points.
#[cfg(feature = "e57")]
const LEAST_PACKET: usize = 4;

/// Whether the sizes of the XML section and of pages, for which the crate reserves memory at once, are within the file.
#[cfg(feature = "e57")]
fn has_sound_header(bytes: &[u8]) -> bool {
    let within = |at: usize| {
        let size = super::bytes::array(bytes, at).map(u64::from_le_bytes);
        size.is_some_and(|size| size <= bytes.len() as u64)
    };
    bytes.starts_with(MAGIC) && within(32) && within(40)
}

/// The points read so far.
#[cfg(feature = "e57")]
#[derive(Default)]
struct Cloud {
    positions: Vec<glam::DVec3>,
    color: Vec<f64>,
    intensity: Vec<f64>,
    nowhere: usize,
}

#[cfg(feature = "e57")]
fn scans(bytes: &[u8]) -> std::result::Result<Cloud, String> {
    let mut file = e57::E57Reader::new(std::io::Cursor::new(bytes)).map_err(|e| e.to_string())?;
    let scans = file.pointclouds();
    let promised = scans.iter().fold(0u64, |sum, scan| sum.saturating_add(scan.records));
    if promised / MOST_PER_BYTE > bytes.len() as u64 {
        return Err(format!("it promises {promised} points, more than so few bytes can hold"));
    }
    let mut cloud = Cloud::default();
    for scan in &scans {
        let mut points = file.pointcloud_simple(scan).map_err(|e| e.to_string())?;
        points.normalize_intensity(false);
        let mut packets = 0;
        for point in points {
            match point {
                Ok(point) => cloud.push(point),
                // The crate reports a packet that completes no point as an error; the next call goes on.
                Err(e57::Error::Internal { .. }) if packets < bytes.len() / LEAST_PACKET => packets += 1,
                Err(error) => return Err(error.to_string()),
            }
        }
    }
    Ok(cloud)
}

#[cfg(feature = "e57")]
impl Cloud {
    fn push(&mut self, point: e57::Point) {
        let e57::CartesianCoordinate::Valid { x, y, z } = point.cartesian else {
            self.nowhere += 1;
            return;
        };
        let position = glam::DVec3::new(x, y, z);
        if !position.is_finite() {
            self.nowhere += 1;
            return;
        }
        self.positions.push(position);
        self.color.extend(point.color.iter().flat_map(|c| [c.red, c.green, c.blue]).map(f64::from));
        self.intensity.extend(point.intensity.map(f64::from));
    }

    /// The points, with what all of them have.
    fn finish(self) -> crate::io::content::Read {
        use crate::mesh::attributes::{Attribute, Attributes, COLOR, Scalar};
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
        let mesh = crate::mesh::triangle_mesh::Mesh { positions: self.positions, triangles: Vec::new() };
        let mut notes = Vec::new();
        super::text::left_out(
            &mut notes,
            self.nowhere,
            "direction in which nothing was seen",
            "directions in which nothing was seen",
        );
        crate::io::content::Read { mesh, attributes, notes }
    }
}

#[cfg(all(test, feature = "e57"))]
mod tests {
    use super::*;
    use e57::{E57Writer, Record, RecordValue};
    use glam::DVec3;
    use std::io::Cursor;

    /// Two scans, one of them moved, with a direction in which nothing was seen.
    fn file() -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let mut file = E57Writer::new(&mut bytes, "file").unwrap();
        for (guid, shift) in [("a", 0.0), ("b", 10.0)] {
            let mut prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F64, Record::CARTESIAN_Z_F64];
            prototype.extend([Record::COLOR_RED_U8, Record::COLOR_GREEN_U8, Record::COLOR_BLUE_U8]);
            prototype.extend([Record::INTENSITY_UNIT_F32, Record::CARTESIAN_INVALID_STATE]);
            let mut scan = file.add_pointcloud(guid, prototype).unwrap();
            scan.set_transform(Some(e57::Transform {
                rotation: e57::Quaternion { w: 1.0, x: 0.0, y: 0.0, z: 0.0 },
                translation: e57::Translation { x: shift, y: 0.0, z: 0.0 },
            }));
            for (x, state) in [(1.0, 0), (2.0, 2), (3.0, 0)] {
                let mut point: Vec<_> = [x, 0.5, 0.25].map(RecordValue::Double).to_vec();
                point.extend([255, 0, 51].map(RecordValue::Integer));
                point.extend([RecordValue::Single(0.5), RecordValue::Integer(state)]);
                scan.add_point(point).unwrap();
            }
            scan.finalize().unwrap();
        }
        file.finalize().unwrap();
        drop(file);
        bytes.into_inner()
    }

    #[test]
    fn scans_are_put_into_their_places() {
        let read = parse(&file()).unwrap();
        let places = [1.0, 3.0, 11.0, 13.0].map(|x| DVec3::new(x, 0.5, 0.25));
        assert_eq!(read.mesh.positions, places);
        assert_eq!(read.notes, ["2 directions in which nothing was seen are left out"]);
        let color = read.attributes.color().unwrap();
        assert!((color.of(3)[0] - 1.0).abs() < 1e-6 && (color.of(3)[2] - 0.2).abs() < 1e-6);
        assert_eq!(read.attributes.get("intensity").unwrap().values, [0.5; 4]);
    }

    #[test]
    fn damaged_files_are_refused() {
        let good = file();
        for end in (0..good.len()).step_by(7) {
            assert!(parse(&good[..end]).is_err());
        }
        for at in (0..good.len()).step_by(5) {
            for value in [0, 0xFF] {
                let mut bytes = good.clone();
                bytes[at] = value;
                let _ = parse(&bytes);
            }
        }
        let mut bytes = good;
        bytes[32..40].fill(0xFF);
        assert!(parse(&bytes).unwrap_err().to_string().contains("does not begin with the header"));
    }
}
