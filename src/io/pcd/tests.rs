use super::*;
use crate::io::bytes::samples;
use crate::io::content::Content;

const HEAD: &str = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb label hist _\nSIZE 4 4 4 4 2 4 1\nTYPE F F F F U F U\n\
                    COUNT 1 1 1 1 1 2 3\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";

fn text() -> String {
    format!("{HEAD}DATA ascii\n0 1 2 4210752 7 .5 .25 0 0 0\n3 4 5 2.3418052e-38 8 1 2 0 0 0\n")
}

/// The two points of `text` in bytes.
fn rows() -> [Vec<u8>; 2] {
    let row = |p: [f32; 3], rgb: u32, label: u16, hist: [f32; 2]| {
        let mut row = p.map(f32::to_le_bytes).concat();
        row.extend(rgb.to_le_bytes());
        row.extend(label.to_le_bytes());
        row.extend(hist.map(f32::to_le_bytes).concat());
        row.extend([0; 3]);
        row
    };
    [row([0.0, 1.0, 2.0], 0x40_4040, 7, [0.5, 0.25]), row([3.0, 4.0, 5.0], 0xFF_0000, 8, [1.0, 2.0])]
}

fn binary() -> Vec<u8> {
    [format!("{HEAD}DATA binary\n").as_bytes(), &rows().concat()].concat()
}

fn compressed() -> Vec<u8> {
    let mut columns = Vec::new();
    let [a, b] = rows();
    let mut at = 0;
    for size in [4, 4, 4, 4, 2, 8, 3] {
        columns.extend([&a[at..at + size], &b[at..at + size]].concat());
        at += size;
    }
    // Literal runs only.
    let packed: Vec<u8> = columns.chunks(32).flat_map(|run| [&[run.len() as u8 - 1], run].concat()).collect();
    let sizes = [packed.len() as u32, columns.len() as u32].map(u32::to_le_bytes).concat();
    [format!("{HEAD}DATA binary_compressed\n").as_bytes(), &sizes, &packed].concat()
}

#[test]
fn all_encodings_are_the_same() {
    for bytes in [text().into_bytes(), binary(), compressed()] {
        assert!(has_signature(&bytes));
        let read = parse(&bytes).unwrap();
        assert_eq!(read.mesh.positions, [DVec3::new(0.0, 1.0, 2.0), DVec3::new(3.0, 4.0, 5.0)]);
        assert_eq!(read.attributes.names(), ["color", "label", "hist"]);
        assert_eq!(read.attributes.color().unwrap().of(0), [64.0; 3]);
        // The decimals of the text are rounded, so its last byte may be off.
        assert_eq!(read.attributes.color().unwrap().of(1)[0], 255.0);
        assert_eq!(read.attributes.vertex[1].values, [7.0, 8.0]);
        assert_eq!(read.attributes.vertex[2].values, [0.5, 0.25, 1.0, 2.0]);
        assert!(read.notes.is_empty());
    }
}

#[test]
fn places_where_nothing_was_seen_are_left_out() {
    let text = "VERSION .7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\nWIDTH 3\nHEIGHT 1\n\
                DATA ascii\n1 2 3 0 0 1\nnan nan nan nan nan nan\n4 5 6 nan nan nan\n";
    assert!(has_signature(text.as_bytes()));
    let read = parse(text.as_bytes()).unwrap();
    assert_eq!(read.notes, ["1 point without a position is left out"]);
    assert_eq!(read.mesh.positions, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]);
    assert_eq!(read.attributes.normals(), [DVec3::Z, DVec3::ZERO]);
}

#[test]
fn opacity_and_further_numbers_are_written() {
    let attribute = |name: &str, components, values: &[f64], scalar| Attribute {
        name: name.into(),
        components,
        values: values.to_vec(),
        scalar,
    };
    let vertex = vec![
        attribute("color", 4, &[1.0, 0.5, 0.0, 1.0], Scalar::F32),
        attribute("two words", 2, &[0.1, 0.2], Scalar::F64),
        attribute("_", 1, &[3.0], Scalar::I8),
    ];
    let attributes = Attributes { vertex, ..Attributes::default() };
    let mut bytes = Vec::new();
    write(&Content { positions: &[DVec3::ONE], triangles: &[], attributes: &attributes }, &mut bytes).unwrap();
    let read = parse(&bytes).unwrap();
    assert_eq!(read.attributes.names(), ["color", "two_words"]);
    assert_eq!(read.attributes.vertex[0].values, [255.0, 128.0, 0.0, 255.0]);
    assert_eq!(read.attributes.vertex[1].values, [0.1, 0.2]);
}

#[test]
fn errors_have_a_place() {
    let changed = |from: &str, to: &str| text().replace(from, to).into_bytes();
    for (bytes, line, words) in [
        (changed("FIELDS x y z", "FIELDS x y q"), 11, "no field z"),
        (changed("SIZE 4", "SIZE 3"), 11, "TYPE F with SIZE 3"),
        (changed("COUNT 1 1", "COUNT 1"), 11, "differ in length"),
        (changed("COUNT 1 1 1 1 1 2", "COUNT 1 1 1 1 1 99999999999"), 11, "is not a valid count"),
        (changed("POINTS 2", "POINTS x"), 10, "not a whole number"),
        (changed("POINTS 2", "POINTS 99999999"), 12, "declares 99999999 points"),
        (changed("POINTS 2", "POINTS 3"), 13, "ends after 2 of 3 points"),
        (changed("DATA ascii", "DATA roman"), 11, "'roman'"),
        (changed("VERSION", "REVISION"), 2, "'REVISION' is not a line"),
        (changed("3 4 5", "3 x 5"), 13, "'x' is not a number"),
        (b"VERSION 0.7\n".to_vec(), 2, "no DATA line"),
    ] {
        samples::fails_at(parse(&bytes), line, words);
    }
    for whole in [binary(), compressed()] {
        for end in HEAD.len()..whole.len() {
            assert!(parse(&whole[..end]).is_err());
        }
    }
}
