use super::files::*;
use crate::io::bytes::samples::tetrahedron;
use crate::io::gltf::glb::split;
use glam::DVec3;
use serde_json::{Value, json};

#[test]
fn all_types_of_indices() {
    let numbers = [0u32, 1, 2, 2, 1, 3];
    let bytes = numbers.map(|i| i as u8);
    let shorts = numbers.map(|i| (i as u16).to_le_bytes());
    let ints = numbers.map(u32::to_le_bytes);
    for root in
        [indexed(5121, &bytes, 6), indexed(5123, shorts.as_flattened(), 6), indexed(5125, ints.as_flattened(), 6)]
    {
        assert_eq!(load(&root).unwrap().0.triangles, [[0, 1, 2], [2, 1, 3]]);
    }
    assert_eq!(place(load(&indexed(5120, &bytes, 6))), ", accessor 1");
    assert_eq!(place(load(&indexed(5126, ints.as_flattened(), 6))), ", accessor 1");
    assert_eq!(cause(load(&indexed(5121, &[0, 1, 4], 3))), "index 2 refers to vertex 4, but there are only 4");
}

#[test]
fn compressed_data_are_named() {
    let mut root = with_data(&SQUARE, &[]);
    root["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(cause(load(&root)), "has no data");
    root["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    let error = load(&root).unwrap_err().to_string();
    assert!(
        error.contains("compressed with KHR_draco_mesh_compression") && error.contains("gltf-transform"),
        "{error}"
    );
}

#[test]
fn buffers_beside_the_file() {
    let bytes = glb();
    let bin = split(&bytes).unwrap().bin.unwrap().to_vec();
    let mut root = written();
    root["buffers"][0]["uri"] = "my%20part.bin".into();
    let files = |name: &str| if name == "my%20part.bin" { Ok(bin.clone()) } else { Err(format!("no file {name}")) };
    assert_eq!(parse(root.to_string().as_bytes(), &files).unwrap().0, tetrahedron());
    assert_eq!((place(load(&root)), cause(load(&root))), (", buffer 0".into(), "no files here".into()));
    // Buffers used only by textures are not fetched.
    let mut root = written();
    push(&mut root["buffers"], json!({ "byteLength": 9, "uri": "texture.bin" }));
    assert!(load(&root).is_ok());
}

#[test]
fn rows_with_gaps() {
    let rows = [[0.0, 0.0, 0.0], [9.0; 3], [1.0, 0.0, 0.0], [9.0; 3], [0.0, 1.0, 0.0]];
    let mut root = with_data(&rows, &[]);
    root["bufferViews"][0]["byteStride"] = 24.into();
    root["accessors"][0]["count"] = 3.into();
    assert_eq!(load(&root).unwrap().0.positions, [DVec3::ZERO, DVec3::X, DVec3::Y]);
    root["accessors"][0]["count"] = 4.into();
    assert_eq!(place(load(&root)), ", accessor 0");
    root["accessors"][0]["count"] = 3.into();
    root["bufferViews"][0]["byteStride"] = 8.into();
    assert_eq!(place(load(&root)), ", accessor 0");
}

#[test]
fn quantized_positions() {
    let positions = |component: u32, normalized: bool, bytes: &[u8], stride: usize| {
        let mut root = with_data(&[], bytes);
        root["accessors"][0] = json!({ "bufferView": 1, "componentType": component, "normalized": normalized,
                                       "count": 1, "type": "VEC3" });
        root["bufferViews"][1]["byteStride"] = stride.into();
        load(&root).unwrap().0.positions[0].to_array()
    };
    let shorts = [(-32768i16).to_le_bytes(), 32767i16.to_le_bytes(), 100i16.to_le_bytes(), [0; 2]];
    assert_eq!(positions(5120, false, &[0x80, 0x7f, 1, 0], 4), [-128.0, 127.0, 1.0]);
    assert_eq!(positions(5120, true, &[0x80, 0x7f, 0, 0], 4), [-1.0, 1.0, 0.0]);
    assert_eq!(positions(5121, false, &[0, 255, 51, 0], 4), [0.0, 255.0, 51.0]);
    assert_eq!(positions(5121, true, &[0, 255, 51, 0], 4), [0.0, 1.0, 0.2]);
    assert_eq!(positions(5122, false, shorts.as_flattened(), 8), [-32768.0, 32767.0, 100.0]);
    assert_eq!(positions(5122, true, shorts.as_flattened(), 8), [-1.0, 1.0, 100.0 / 32767.0]);
    assert_eq!(positions(5123, false, shorts.as_flattened(), 8), [32768.0, 32767.0, 100.0]);
    assert_eq!(positions(5123, true, &[255, 255, 0, 0, 0x33, 0x33], 6), [1.0, 0.0, 0.2]);
}

/// Four vertices, the third of which is replaced by a sparse value.
fn sparse(place: u8) -> Value {
    let value = [0.0f32, 7.0, 0.0].map(f32::to_le_bytes);
    let mut root = with_data(&SQUARE, &[value.as_flattened(), &[place]].concat());
    root["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": 1, "byteOffset": 12, "componentType": 5121 },
        "values": { "bufferView": 1 },
    });
    root
}

#[test]
fn sparse_accessors() {
    let mut root = sparse(2);
    let (mesh, _) = load(&root).unwrap();
    assert_eq!(mesh.positions[1..3], [DVec3::X, DVec3::new(0.0, 7.0, 0.0)]);
    root["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let (mesh, _) = load(&root).unwrap();
    assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::ZERO, DVec3::new(0.0, 7.0, 0.0), DVec3::ZERO]);
    for count in [1u64 << 32, 1 << 60] {
        root["accessors"][0]["count"] = count.into();
        assert_eq!(place(load(&root)), ", accessor 0");
    }
    assert_eq!(place(load(&sparse(4))), ", accessor 0");
    for (part, key, value) in [
        ("indices", "componentType", 5126),
        ("indices", "byteOffset", 13),
        ("values", "byteOffset", 4),
        ("values", "bufferView", 2),
    ] {
        let mut root = sparse(2);
        root["accessors"][0]["sparse"][part][key] = value.into();
        assert!(load(&root).is_err(), "{part} {key}");
    }
    let mut root = sparse(2);
    root["accessors"][0]["sparse"]["count"] = u64::MAX.into();
    assert_eq!(place(load(&root)), ", accessor 0");
}
