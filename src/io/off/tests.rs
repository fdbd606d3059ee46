use super::*;
use crate::base::error::Place;
use crate::io::bytes::samples;

fn mesh(text: &str) -> Mesh {
    parse(text.as_bytes()).unwrap().mesh
}

#[track_caller]
fn fails_at(text: &str, line: usize, words: &str) {
    samples::fails_at(parse(text.as_bytes()), line, words);
}

fn right_angle() -> Mesh {
    Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] }
}

#[test]
fn headers_in_all_forms() {
    for header in ["OFF\n3 1 3", "OFF 3 1 3", "# a\nOFF # b\n\n# c\r\n3 1 0", "off\n3 1", "3 1 0", "OFF3 1 0"] {
        assert_eq!(mesh(&format!("{header}\n0 0 0\n1 0 0\n# d\n\n0 1 0\n3 0 1 2")), right_angle(), "{header}");
    }
}

#[test]
fn further_values_are_skipped() {
    for header in ["COFF", "NOFF", "STOFF", "CNOFF", "NCOFF", "STCNOFF", "OFF"] {
        let text = format!("{header}\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 nan 1 2 3\n0 1 0 7\n3 0 1 2 0.5 0.5 0.5\n");
        assert_eq!(mesh(&text), right_angle(), "{header}");
    }
}

#[test]
fn polygons_points_and_faces_without_area() {
    let m = mesh("OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3 255 0 0\n3 0 1 4\n");
    assert_eq!(m.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
    assert_eq!(mesh("OFF\n1 0 0\n0 0 0\n").positions.len(), 1);
    let Read { mesh: m, notes, .. } = parse(b"OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n0\n3 0 1 2\nmore").unwrap();
    assert_eq!(m, right_angle());
    assert_eq!(
        notes,
        [
            "2 faces with fewer than three corners are left out",
            "everything after the last face, from line 9 on, is left out",
        ]
    );
}

#[test]
fn errors_name_the_line() {
    fails_at("4OFF\n3 1 0\n", 1, "three-dimensional");
    fails_at("nOFF\n3\n3 1 0\n", 1, "three-dimensional");
    fails_at("C4OFF\n3 1 0\n", 1, "three-dimensional");
    fails_at("OFF\n", 1, "number of vertices is missing");
    fails_at("OFF\n0", 2, "number of faces is missing");
    fails_at("ply\n", 1, "'ply' is not a number of vertices");
    fails_at("OFF\n999999999999 1 0\n0 0 0\n", 2, "declares 999999999999 vertices, but only");
    fails_at("OFF\n1 888888888 0\n0 0 0\n", 2, "declares 888888888 faces");
    fails_at("OFF\n99999999999999999999999 1 0\n0 0 0\n", 2, "not a number of vertices");
    fails_at("OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", 4, "not finite");
    fails_at("OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", 4, "'x' is not a number");
    fails_at("OFF\n3 0 0\n0 0 0\n1 0 0.000000000000\n", 4, "ends after 2 of 3 vertices");
    fails_at("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 6, "ends after 1 of 2 faces");
    fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", 6, "ends within a face");
    fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6, "vertex '3', but vertices go from 0 to 2");
    fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 6, "vertex '-1'");
    fails_at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9999999999 0 1 2\n", 6, "ends within a face");
}

#[test]
fn the_keyword_is_known() {
    assert!(has_keyword(b"# x\n\nCOFF\n1 1 1"));
    assert!(has_keyword(b"4OFF BINARY"));
    assert!(!has_keyword(b"OFFICE 1") && !has_keyword(b"ply\n") && !has_keyword(b"v 1 2 3 OFF"));
}

fn file(keyword: &str, further: &[[f32; 4]]) -> Vec<u8> {
    let mut bytes = keyword.as_bytes().to_vec();
    let ints = |numbers: &[i32]| numbers.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<_>>();
    bytes.extend(ints(&[4, 2, 0]));
    for (v, place) in [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].into_iter().enumerate() {
        bytes.extend(place.iter().chain(further.get(v).into_iter().flatten()).flat_map(|x| x.to_be_bytes()));
    }
    bytes.extend([ints(&[4, 0, 1, 2, 3, 0]), ints(&[3, 0, 1, 2, 1]), 0.5f32.to_be_bytes().to_vec()].concat());
    bytes
}

#[test]
fn binary_files_are_read() {
    for keyword in ["OFF BINARY\n", "# a\nOFF\nBINARY\n"] {
        let bytes = file(keyword, &[]);
        assert!(has_keyword(&bytes));
        let read = parse(&bytes).unwrap();
        assert_eq!(read.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        assert_eq!(read.mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
        assert!(read.notes.is_empty() && read.attributes.is_empty());
    }
    let read = parse(&file("COFF BINARY\n", &[[0.0, 0.25, 0.5, 1.0]; 4])).unwrap();
    assert_eq!(read.attributes.color().unwrap().of(3), [0.0, 0.25, 0.5, 1.0]);
}

#[test]
fn errors_name_the_byte() {
    let good = file("OFF BINARY\n", &[]);
    for end in 0..good.len() - 4 {
        assert!(parse(&good[..end]).is_err(), "{end}");
    }
    for (at, value, words) in [
        (11, -1, "is negative"),
        (11, 99, "99 entries are declared"),
        (15, 99, "99 entries are declared"),
        (75, 4, "uses vertex 4"),
        (71, 1 << 30, "entries are declared"),
        (23, f32::NAN.to_bits() as i32, "not finite"),
    ] {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&i32::to_be_bytes(value));
        let (place, cause) = samples::fault(parse(&bytes));
        assert!(matches!(place, Place::Byte(_)) && cause.contains(words), "{cause}");
    }
}
