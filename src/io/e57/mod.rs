//! E57, a format of laser scanners: points with colour and intensity, in several scans.
//!
//! The crate `e57` reads it, with the feature of that name. All scans are read, each transformed to its pose; directions in
//! which nothing was seen are left out. Colours are fractions of the range that the scan declares.
//!
//! Cost: one pass. A file that promises more than sixteen points per byte is refused before any point is read.
//!
//! Limits: normals, times, rows, columns and pictures are left out. The crate detects damage, mostly by checksums. Should it
//! panic, the panic is caught, but a panic hook is still called.

mod magic;
#[cfg(all(feature = "e57", feature = "fs"))]
mod rows;
#[cfg(feature = "e57")]
mod scans;

#[cfg(all(feature = "e57", feature = "fs"))]
pub(crate) use rows::table;

#[cfg(feature = "e57")]
pub(crate) use scans::parse;

pub(crate) use magic::MAGIC;

#[cfg(not(feature = "e57"))]
pub(crate) fn parse(_: &[u8]) -> crate::io::content::Parsed {
    let cause = "it is an E57 file, and this program was built without the feature e57";
    let remedy = "convert it to LAZ or PLY, or build with that feature";
    Err(crate::io::bytes::malformed(crate::base::error::Place::Whole, cause, remedy))
}

#[cfg(all(not(feature = "e57"), feature = "fs"))]
pub(crate) fn table(_: &[u8]) -> Option<crate::io::table::Table> {
    None
}

#[cfg(all(test, feature = "e57"))]
mod tests {
    use super::parse;
    use e57::{E57Writer, Record, RecordValue};
    use glam::DVec3;
    use std::io::Cursor;

    /// Two scans, one of them translated, each with a direction in which nothing was seen.
    pub(super) fn file() -> Vec<u8> {
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
        assert_eq!(read.notes, ["2 scan directions without a return are left out"]);
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
