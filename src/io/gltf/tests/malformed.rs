use super::files::*;
use crate::io::bytes::samples::tetrahedron;
use serde_json::{Value, json};

#[test]
fn ranges_are_checked() {
    for huge in [97u64, 1 << 32, u64::MAX] {
        assert_eq!(place_with("/buffers/0/byteLength", huge.into()), ", buffer 0");
        assert_eq!(place_with("/bufferViews/0/byteLength", huge.into()), ", buffer view 0");
        assert_eq!(place_with("/bufferViews/0/byteOffset", huge.into()), ", buffer view 0");
        assert_eq!(place_with("/accessors/0/count", huge.into()), ", accessor 0");
        assert_eq!(place_with("/accessors/0/byteOffset", huge.into()), ", accessor 0");
        assert_eq!(place_with("/accessors/1/count", huge.into()), ", accessor 1");
    }
    assert_eq!(place_with("/buffers/0/byteLength", 95.into()), ", buffer view 1");
    assert_eq!(place_with("/bufferViews/0/buffer", 1.into()), ", buffer 1");
    assert_eq!(place_with("/accessors/0/bufferView", 2.into()), ", buffer view 2");
    assert_eq!(place_with("/meshes/0/primitives", json!([{ "attributes": { "POSITION": 2 } }])), ", accessor 2");
    assert_eq!(place_with("/nodes", json!([{ "mesh": 1 }])), ", mesh 1");
    assert_eq!(place_with("/scenes", json!([{ "nodes": [1] }])), ", node 1");
    assert_eq!(place_with("/nodes", json!([{ "children": [1] }])), ", node 1");
    assert_eq!(place_with("/buffers", json!([{ "byteLength": 96 }])), ", buffer 0");
    assert_eq!(place_with("/buffers", json!([{ "byteLength": 96, "uri": "data:text/plain,what" }])), ", buffer 0");
    assert_eq!(place_with("/buffers", json!([{ "byteLength": 96, "uri": "data:;base64,???" }])), ", buffer 0");
    assert_eq!(
        place_with("/accessors", json!([{ "componentType": 5126, "count": 4, "type": "VEC3" }])),
        ", accessor 0"
    );
}

#[test]
fn types_are_checked() {
    let change = |key: &str, value: Value| {
        let mut root = written();
        root["accessors"][0][key] = value;
        place(load(&root))
    };
    assert_eq!(change("type", "VEC2".into()), ", accessor 0");
    assert_eq!(change("type", "WHAT".into()), ", accessor 0");
    assert_eq!(change("componentType", 5125.into()), ", accessor 0");
    assert_eq!(change("componentType", 1.into()), ", accessor 0");
    assert_eq!(change("count", (-1).into()), "");
}

#[test]
fn positions_are_finite() {
    let mut positions = SQUARE;
    positions[2][1] = f32::NAN;
    assert_eq!(place(load(&with_data(&positions, &[]))), ", accessor 0");
    assert_eq!(place_with("/nodes", json!([{ "mesh": 0, "translation": [1e300, 0, 0] }])), ", node 0");
    assert_eq!(place_with("/nodes", json!([{ "mesh": 0, "rotation": [0, 0, 0, 0] }])), ", node 0");
}

#[test]
fn malformed_json_has_a_line() {
    assert_eq!(place(parse(b"{\n\"asset\": }", &no_files)), ":2");
    assert_eq!(place(parse(b"", &no_files)), ":1");
    assert_eq!(place(parse(b"[1]", &no_files)), ", asset");
    assert_eq!(place(parse(b"{}", &no_files)), ", asset");
    assert!(cause(parse(br#"{"asset":{"version":"1.0"}}"#, &no_files)).contains("version 1.0"));
    assert_eq!(place_with("/nodes", json!({ "a": 1 })), "");
}

#[test]
fn containers_are_checked() {
    let good = glb();
    let change = |at: usize, bytes: &[u8]| {
        let mut changed = good.clone();
        changed[at..at + bytes.len()].copy_from_slice(bytes);
        place(parse(&changed, &no_files))
    };
    assert_eq!(change(4, &[1]), ", byte 4");
    assert_eq!(change(8, &[255; 4]), format!(", byte {}", good.len()));
    assert_eq!(change(8, &[0; 4]), ", byte 12");
    assert_eq!(change(12, &[255; 4]), ", byte 12");
    assert_eq!(change(16, b"WHAT"), ", byte 12");
    assert_eq!(change(20, b"?"), ", JSON chunk");
    let bin = good.len() - 96 - 8;
    assert_eq!(change(bin, &[255; 4]), format!(", byte {bin}"));
    assert_eq!(change(bin + 4, b"WHAT"), ", buffer 0");
    let (mesh, notes) = parse(&[&good[..], &[0; 3]].concat(), &no_files).unwrap();
    assert_eq!((mesh, notes.len()), (tetrahedron(), 1));
}

#[test]
fn cut_anywhere() {
    let bytes = glb();
    for end in 0..bytes.len() {
        assert!(parse(&bytes[..end], &no_files).is_err(), "{end}");
    }
    // Also with a header whose length fits the cut file.
    for end in 12..bytes.len() {
        let mut cut = bytes[..end].to_vec();
        cut[8..12].copy_from_slice(&(end as u32).to_le_bytes());
        assert!(parse(&cut, &no_files).is_err(), "{end}");
    }
    let text = written().to_string();
    for end in 0..text.len() {
        assert!(parse(&text.as_bytes()[..end], &no_files).is_err(), "{end}");
    }
}

#[test]
fn any_one_byte_changed_is_no_panic() {
    let bytes = glb();
    for at in 0..bytes.len() {
        for value in [0, 1, b'9', 0x7f, 0xff] {
            let mut changed = bytes.clone();
            changed[at] = value;
            let _ = parse(&changed, &no_files);
        }
    }
}
