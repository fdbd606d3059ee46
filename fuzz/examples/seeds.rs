//! Writes small complete files of every format into `corpus/`, one folder per format, as seeds for the fuzzer.

use spectral_remesh::io::Format;
use spectral_remesh_fuzz::files::{cloud_files, scan, valid_files};
use std::fs::{create_dir_all, write};
use std::io::{Cursor, Write};
use std::path::Path;

const LIBRARY: &[u8] = b"newmtl a\nKa 0 0 0\nKd 1 .5 0\nKs 1 1 1\nKe 0 0 1\nNs 10\nd .5\nillum 2\nPr .5\nPm 1\nmap_Kd -s 1 2 3 -o 1 1 1 a b.png\nnorm -bm 2 c.png\nbump c.png\nmap_Ke d.jpg\nnewmtl b\nTr .2\nKd xyz 1 1 1\n";

const MODEL: &[u8] = b"<model unit='inch'><resources><basematerials id='3'><base name='a' displaycolor='#FF8000'/></basematerials><m:colorgroup id='4'><m:color color='#FF0000FF'/><m:color color='#00FF00'/></m:colorgroup><object id='1' pid='4' pindex='0'><mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1e1' z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2' pid='4' p1='0' p2='1' p3='0'/></triangles></mesh></object><object id='2'><components><component objectid='1' transform='-1 0 0 0 1 0 0 0 1 0 0 2'/><component objectid='1'/></components></object></resources><build><item objectid='2' transform='1 0 0 0 1 0 0 0 1 5 0 0'/></build></model>";

fn main() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let mut count = 0;
    let mut put = |folder: &str, bytes: &[u8]| {
        for folder in [folder, "any"] {
            create_dir_all(corpus.join(folder)).expect("the folder can be made");
            write(corpus.join(folder).join(format!("seed-{count}")), bytes).expect("the file can be written");
        }
        count += 1;
    };
    for (format, bytes) in valid_files().into_iter().chain(cloud_files()) {
        put(format.extension(), &bytes);
    }
    put(Format::E57.extension(), &e57_file());
    for layout in [0, 1, 2, 3, 6, 7, 8] {
        put(Format::Las.extension(), &laz_file(layout));
    }
    put("any", &packed(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    put("mtl", LIBRARY);
    put("model", MODEL);
    // Any bytes encode a case.
    for seed in 0..64u32 {
        let bytes: Vec<u8> =
            (0..40 + 4 * seed).map(|i| (i * (seed + 7)).wrapping_mul(0x9E37_79B9).to_be_bytes()[0]).collect();
        create_dir_all(corpus.join("remesh")).expect("the folder can be made");
        write(corpus.join("remesh").join(format!("seed-{seed}")), bytes).expect("the file can be written");
    }
}

/// Compresses bytes with gzip.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packer.write_all(bytes).expect("memory does not fail");
    packer.finish().expect("memory does not fail")
}

/// Returns an E57 file with two scans of a few points with colours.
fn e57_file() -> Vec<u8> {
    use e57::{E57Writer, Record, RecordValue};
    let mut bytes = Cursor::new(Vec::new());
    let mut file = E57Writer::new(&mut bytes, "file").expect("memory does not fail");
    let (points, _) = scan();
    for scan in ["a", "b"] {
        let mut prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F32, Record::CARTESIAN_Z_F32];
        prototype.extend([Record::COLOR_RED_U8, Record::COLOR_GREEN_U8, Record::COLOR_BLUE_U8]);
        prototype.extend([Record::INTENSITY_UNIT_F32, Record::CARTESIAN_INVALID_STATE]);
        let mut scan = file.add_pointcloud(scan, prototype).expect("the columns are known");
        for p in points.positions() {
            let [x, y, z] = p.to_array();
            let mut point = vec![RecordValue::Double(x), RecordValue::Single(y as f32), RecordValue::Single(z as f32)];
            point.extend([255, 0, 51].map(RecordValue::Integer));
            point.extend([RecordValue::Single(0.5), RecordValue::Integer(0)]);
            scan.add_point(point).expect("the point is of these columns");
        }
        scan.finalize().expect("memory does not fail");
    }
    file.finalize().expect("memory does not fail");
    drop(file);
    bytes.into_inner()
}

/// Returns a LAZ file with a hundred compressed points of this layout.
fn laz_file(layout: u8) -> Vec<u8> {
    use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr};
    const LENGTHS: [u8; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
    let length = usize::from(LENGTHS[usize::from(layout)]);
    let items = LazItemRecordBuilder::default_for_point_format_id(layout, 0).expect("the layout is known");
    let record = LazVlr::from_laz_items(items);
    let mut data = Vec::new();
    record.write_to(&mut data).expect("memory does not fail");
    let mut head = vec![0; 227 + 54];
    head[..4].copy_from_slice(b"LASF");
    (head[24], head[25], head[94], head[100]) = (1, 2, 227, 1);
    (head[104], head[105], head[107]) = (layout | 0x80, length as u8, 100);
    head[131..155].copy_from_slice(&[0.01f64.to_le_bytes(); 3].concat());
    head[227 + 2..227 + 2 + LazVlr::USER_ID.len()].copy_from_slice(LazVlr::USER_ID.as_bytes());
    head[227 + 18..227 + 20].copy_from_slice(&LazVlr::RECORD_ID.to_le_bytes());
    head[227 + 20..227 + 22].copy_from_slice(&(data.len() as u16).to_le_bytes());
    head.extend(data);
    let start = (head.len() as u32).to_le_bytes();
    head[96..100].copy_from_slice(&start);
    let end = head.len() as u64;
    let mut out = Cursor::new(head);
    out.set_position(end);
    let mut compressor = LasZipCompressor::new(out, record).expect("the record is whole");
    for i in 0..100u32 {
        let row: Vec<u8> = (0..length as u32).map(|k| if k < 20 { (i * (k + 3) / 4) as u8 } else { 0 }).collect();
        compressor.compress_one(&row).expect("memory does not fail");
    }
    compressor.done().expect("memory does not fail");
    compressor.into_inner().into_inner()
}
