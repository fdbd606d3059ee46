use super::*;
use crate::io::base64;
use crate::io::bytes::samples::{fault, signed_volume, tetrahedron};
use crate::io::content::Read;
use crate::mesh::attributes::{Attribute, Attributes, Scalar};
use crate::mesh::materials::{Alpha, Image, Look, REPEAT, Sampler};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use serde_json::json;

fn no_files(_: &str) -> std::result::Result<Vec<u8>, String> {
    Err("no files here".into())
}

/// The mesh and the notes.
type Parsed = Result<(Mesh, Vec<String>)>;

fn parse(bytes: &[u8], resolve: Resolve) -> Parsed {
    super::parse(bytes, resolve).map(|read| (read.mesh, read.notes))
}

fn write_glb(mesh: &Mesh, out: &mut Vec<u8>) -> std::io::Result<()> {
    crate::io::write(mesh, crate::io::Format::Glb, out)
}

fn load(root: &Value) -> Parsed {
    parse(root.to_string().as_bytes(), &no_files)
}

fn place(result: Parsed) -> String {
    fault(result).0.to_string()
}

fn cause(result: Parsed) -> String {
    fault(result).1
}

fn glb() -> Vec<u8> {
    let mut bytes = Vec::new();
    write_glb(&tetrahedron(), &mut bytes).unwrap();
    bytes
}

/// What the writer makes of a tetrahedron, to be changed.
fn written() -> Value {
    let mut bytes = Vec::new();
    crate::io::write(&tetrahedron(), crate::io::Format::Gltf, &mut bytes).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

fn address(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", base64::encode(bytes))
}

/// A file with these positions (view and accessor 0) and, in view 1, `extra`.
fn with_data(positions: &[[f32; 3]], extra: &[u8]) -> Value {
    let bytes: Vec<u8> = positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len() + extra.len(), "uri": address(&[&bytes, extra].concat()) }],
        "bufferViews": [{ "buffer": 0, "byteLength": bytes.len() },
                        { "buffer": 0, "byteOffset": bytes.len(), "byteLength": extra.len() }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": positions.len(), "type": "VEC3" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
    })
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

/// A square whose primitive has `indices` of a type.
fn indexed(component: u32, indices: &[u8], count: usize) -> Value {
    let mut root = with_data(&SQUARE, indices);
    let accessor = json!({ "bufferView": 1, "componentType": component, "count": count, "type": "SCALAR" });
    push(&mut root["accessors"], accessor);
    root["meshes"][0]["primitives"][0]["indices"] = 1.into();
    root
}

/// Adds `value` to a JSON array.
fn push(array: &mut Value, value: Value) {
    array.as_array_mut().unwrap().push(value);
}

#[test]
fn writing_and_reading_gives_the_same() {
    assert_eq!(load(&written()).unwrap(), (tetrahedron(), Vec::new()));
    assert_eq!(parse(&glb(), &no_files).unwrap(), (tetrahedron(), Vec::new()));
}

#[test]
fn what_is_written_is_valid() {
    let bytes = glb();
    assert_eq!(bytes.len() % 4, 0);
    let chunks = glb::split(&bytes).unwrap();
    assert_eq!((chunks.json.len() % 4, chunks.bin.unwrap().len()), (0, 4 * 12 + 4 * 12));
    // The gltf crate's own validation.
    let gltf = ::gltf::Gltf::from_slice(&bytes).unwrap();
    let primitive = gltf.meshes().next().unwrap().primitives().next().unwrap();
    assert_eq!(primitive.bounding_box(), ::gltf::mesh::Bounds { min: [0.0; 3], max: [1.0; 3] });
    assert_eq!(written()["bufferViews"][1]["target"], 34_963);
}

#[test]
fn clouds_and_nothing_are_valid_too() {
    for positions in [vec![], vec![DVec3::X]] {
        let mut bytes = Vec::new();
        write_glb(&Mesh { positions: positions.clone(), triangles: Vec::new() }, &mut bytes).unwrap();
        let (mesh, notes) = parse(&bytes, &no_files).unwrap();
        assert_eq!((mesh.positions, notes.len()), (positions, 0));
    }
}

#[test]
fn coordinates_beyond_single_precision_are_not_written() {
    let mut mesh = tetrahedron();
    mesh.positions[1].x = 1e200;
    assert_eq!(write_glb(&mesh, &mut Vec::new()).unwrap_err().kind(), std::io::ErrorKind::InvalidData);
}

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
    assert_eq!(cause(load(&indexed(5121, &[0, 1, 4], 3))), "index 2 is vertex 4, of only 4");
}

#[test]
fn strips_fans_and_lists() {
    let triangles = |mode: u32, indices: &[u8]| {
        let mut root = indexed(5121, indices, indices.len());
        root["meshes"][0]["primitives"][0]["mode"] = mode.into();
        let (mesh, _) = load(&root).unwrap();
        assert!((0..mesh.triangles.len()).all(|t| mesh.area_vector(t).z > 0.0));
        mesh.triangles
    };
    assert_eq!(triangles(5, &[0, 1, 2, 3]), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(triangles(5, &[0, 1, 2, 2, 2, 1, 3]).len(), 2);
    assert_eq!(triangles(6, &[0, 1, 3, 2]), [[1, 3, 0], [3, 2, 0]]);
    assert!(triangles(6, &[]).is_empty());
    assert!(triangles(5, &[0, 1]).is_empty());
    let mut root = with_data(&SQUARE, &[]);
    let (mesh, notes) = load(&root).unwrap();
    assert_eq!((mesh.triangles, notes.len()), (vec![[0, 1, 2]], 1));
    root["meshes"][0]["primitives"][0]["mode"] = 5.into();
    assert_eq!(load(&root).unwrap().0.triangles.len(), 2);
}

#[test]
fn lines_are_noted_and_points_read() {
    for mode in 1..4 {
        let mut root = with_data(&SQUARE, &[]);
        root["meshes"][0]["primitives"][0]["mode"] = mode.into();
        assert!(cause(load(&root)).contains("it holds lines, no faces"));
        let lines = root["meshes"][0]["primitives"][0].clone();
        root["meshes"][0]["primitives"][0]["mode"] = 4.into();
        root["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
        let (_, notes) = load(&root).unwrap();
        assert!(notes.contains(&"1 primitives of lines are left out".into()));
    }
    let mut root = with_data(&SQUARE, &[]);
    root["meshes"][0]["primitives"][0]["mode"] = 0.into();
    let (mesh, notes) = load(&root).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len(), notes.len()), (4, 0, 0));
    let mut root = with_data(&SQUARE, &[]);
    root["meshes"][0]["primitives"][0]["mode"] = 7.into();
    assert_eq!(place(load(&root)), ", mesh 0");
}

#[test]
fn primitives_share_vertices() {
    let mut root = indexed(5121, &[0, 1, 2, 2, 1, 3], 3);
    push(
        &mut root["accessors"],
        json!({ "bufferView": 1, "byteOffset": 3, "componentType": 5121, "count": 3, "type": "SCALAR" }),
    );
    push(&mut root["meshes"][0]["primitives"], json!({ "attributes": { "POSITION": 0 }, "indices": 2 }));
    let (mesh, _) = load(&root).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles), (4, vec![[0, 1, 2], [2, 1, 3]]));
}

#[test]
fn transforms_nest() {
    let mut root = written();
    root["nodes"] = json!([
        { "translation": [10, 0, 0], "children": [1, 2] },
        { "rotation": [0, 0, std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2], "scale": [2, 3, 4], "mesh": 0 },
        { "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], "mesh": 0 },
    ]);
    let (mesh, _) = load(&root).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 8));
    // First scaled, then turned by 90 degrees around z, then moved.
    for (v, p) in [(1, DVec3::new(10.0, 2.0, 0.0)), (2, DVec3::new(7.0, 0.0, 0.0)), (3, DVec3::new(10.0, 0.0, 4.0))] {
        assert!(mesh.positions[v].distance(p) < 1e-12);
    }
    assert_eq!(
        mesh.positions[4..],
        tetrahedron().positions.iter().map(|&p| p + DVec3::new(10.0, 0.0, 5.0)).collect::<Vec<_>>()
    );
    assert_eq!(mesh.triangles[4], [4, 6, 5]);
}

#[test]
fn mirrors_keep_the_outside() {
    for scale in [json!([-1, 1, 1]), json!([-2, -1, -1]), json!([-1, -1, 1])] {
        let mut root = written();
        root["nodes"][0]["scale"] = scale;
        assert!(signed_volume(&load(&root).unwrap().0) > 0.0);
    }
}

#[test]
fn which_scene_is_read() {
    let mut root = written();
    root["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [1, 0, 0] }, { "mesh": 0 }]);
    root["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }, {}]);
    let first = |root: &Value| load(root).unwrap().0.positions.first().copied();
    root["scene"] = 1.into();
    assert_eq!(first(&root), Some(DVec3::X));
    assert_eq!(load(&root).unwrap().1, ["only one of 3 scenes is read"]);
    root["scene"] = 2.into();
    assert_eq!(first(&root), None);
    root["scene"] = 3.into();
    assert_eq!(place(load(&root)), ", scene 3");
    root.as_object_mut().unwrap().remove("scene");
    assert_eq!(first(&root), Some(DVec3::ZERO));
    root.as_object_mut().unwrap().remove("scenes");
    assert_eq!(load(&root).unwrap().0, tetrahedron());
}

#[test]
fn what_has_no_part_in_geometry_may_be_anything() {
    let mut root = written();
    root["textures"] = json!([{ "sampler": -7 }]);
    root["materials"] = json!("none");
    root["images"] = json!([{ "uri": 5 }]);
    root["extensionsRequired"] = json!(["KHR_materials_unlit", "KHR_mesh_quantization"]);
    assert_eq!(load(&root).unwrap().0, tetrahedron());
}

#[test]
fn extensions_that_are_not_supported() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "X_new"] {
        let mut root = written();
        root["extensionsRequired"] = json!(["KHR_materials_unlit", name]);
        assert!(cause(load(&root)).contains(name));
        assert_eq!(load(&root).unwrap_err().to_string().contains("gltf-transform copy"), name != "X_new");
    }
}

#[test]
fn compressed_data_are_named() {
    let mut root = with_data(&SQUARE, &[]);
    root["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(cause(load(&root)), "has no data");
    root["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    let error = load(&root).unwrap_err().to_string();
    assert!(error.contains("compressed by KHR_draco_mesh_compression") && error.contains("gltf-transform"), "{error}");
}

#[test]
fn buffers_beside_the_file() {
    let bytes = glb();
    let bin = glb::split(&bytes).unwrap().bin.unwrap().to_vec();
    let mut root = written();
    root["buffers"][0]["uri"] = "my%20part.bin".into();
    let files = |name: &str| if name == "my%20part.bin" { Ok(bin.clone()) } else { Err(format!("no file {name}")) };
    assert_eq!(parse(root.to_string().as_bytes(), &files).unwrap().0, tetrahedron());
    assert_eq!((place(load(&root)), cause(load(&root))), (", buffer 0".into(), "no files here".into()));
    // Buffers of textures are not asked for.
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

/// Four vertices of which the sparse values replace the third.
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

/// The place of the error after the value at `pointer` has become `value`.
fn place_with(pointer: &str, value: Value) -> String {
    let mut root = written();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    root.pointer_mut(parent).unwrap()[key] = value;
    place(load(&root))
}

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
fn nodes_are_trees() {
    for nodes in [
        json!([{ "mesh": 0, "children": [0] }]),
        json!([{ "children": [1] }, { "children": [0] }]),
        json!([{ "children": [1, 1] }, { "mesh": 0 }]),
    ] {
        assert!(place_with("/nodes", nodes).starts_with(", node "));
    }
    // Depth is no danger.
    let mut root = written();
    let chain = (1..100_000).map(|child| json!({ "children": [child] }));
    root["nodes"] = chain.chain([json!({ "mesh": 0 })]).collect();
    assert_eq!(load(&root).unwrap().0, tetrahedron());
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
fn many_copies_are_refused() {
    let mut root = with_data(&[[0.5; 3]; 3000], &[]);
    root["scenes"] = json!([{ "nodes": (0..30_000).collect::<Vec<_>>() }]);
    root["nodes"] = (0..30_000).map(|_| json!({ "mesh": 0 })).collect();
    assert!(cause(load(&root)).contains("too many"));
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
    // Also with a header that admits the cut.
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

#[test]
fn attributes_of_vertices() {
    let values: Vec<u8> = [0.5f32, 0.25, 2.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut root = with_data(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &values);
    let read = |root: &Value| super::parse(root.to_string().as_bytes(), &no_files).unwrap();
    let numbers = |root: &Value, name: &str| read(root).attributes.numbers(name);
    let accessor = json!({ "bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR" });
    root["accessors"].as_array_mut().unwrap().push(accessor);
    root["meshes"][0]["primitives"][0]["attributes"]["_SIZE"] = json!(1);
    assert_eq!(numbers(&root, "_SIZE"), Ok(vec![0.5, 0.25, 2.0]));
    for missing in ["_WIDTH", "SIZE", ""] {
        assert!(numbers(&root, missing).unwrap_err().to_string().ends_with("use one of _SIZE"), "{missing}");
    }
    // A mesh that is used twice has its values twice.
    root["scenes"] = json!([{ "nodes": [0, 1] }]);
    root["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [5.0, 0.0, 0.0] }]);
    assert_eq!(numbers(&root, "_SIZE"), Ok(vec![0.5, 0.25, 2.0, 0.5, 0.25, 2.0]));
    // What is wrong with them is no reason to refuse the mesh.
    root["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(1);
    for (key, value, cause) in [
        ("count", json!(2), "_SIZE is left out: accessor 1 has 2 values for 3 vertices"),
        ("count", json!(4), "_SIZE is left out: accessor 1: 4 elements are more than buffer view 1 holds"),
        ("type", json!("MAT2"), "_SIZE is left out: accessor 1: values are up to four"),
    ] {
        let mut root = root.clone();
        root["accessors"][1][key] = value;
        let Read { mesh, attributes, notes } = read(&root);
        assert_eq!((mesh.positions.len(), attributes.is_empty(), notes.len()), (6, true, 2));
        assert_eq!(notes[0], "attribute TANGENT is left out");
        assert!(notes[1].contains(cause), "{notes:?}");
    }
}

#[test]
fn attributes_are_written_in_their_types() {
    let attribute = |name: &str, components, scalar| Attribute {
        name: name.into(),
        components,
        values: (0..4 * components).map(|i| i as f64).collect(),
        scalar,
    };
    let vertex = vec![
        Attribute { values: [0.0, 0.0, 1.0].repeat(4), ..attribute("normal", 3, Scalar::F32) },
        attribute("color", 3, Scalar::U8),
        attribute("_LABEL", 1, Scalar::U16),
        attribute("_FLOW", 2, Scalar::F32),
    ];
    let texture = (0..4).map(|t| [0.0, 0.25, 0.5].map(|x| glam::dvec2(x, f64::from(t) / 4.0))).collect();
    let attributes = Attributes { vertex, texture, ..Attributes::default() };
    let mut bytes = Vec::new();
    crate::io::write_with_attributes(&tetrahedron(), &attributes, crate::io::Format::Glb, &mut bytes).unwrap();
    // The gltf crate's own validation.
    let gltf = ::gltf::Gltf::from_slice(&bytes).unwrap();
    assert_eq!(gltf.accessors().next().unwrap().count(), 12);
    let read = super::parse(&bytes, &no_files).unwrap();
    assert!(read.notes.is_empty(), "{:?}", read.notes);
    assert_eq!(read.attributes.texture, attributes.texture);
    let corners = |mesh: &Mesh| (0..4).map(|t| mesh.corners(t)).collect::<Vec<_>>();
    assert_eq!(corners(&read.mesh), corners(&tetrahedron()));
    for of_file in &read.attributes.vertex {
        let written = attributes.get(&of_file.name).unwrap();
        assert_eq!((of_file.scalar, of_file.components), (written.scalar, written.components));
        for (t, triangle) in tetrahedron().triangles.iter().enumerate() {
            for (v, w) in read.mesh.triangles[t].into_iter().zip(*triangle) {
                assert_eq!(of_file.of(v as usize), written.of(w as usize), "{}", of_file.name);
            }
        }
    }
    assert_eq!(read.attributes.vertex.len(), 4);
}

/// The start of a PNG file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n1234";

/// A square of two triangles in two primitives, the first of which has texture coordinates, and a material with all
/// there is.
fn dressed() -> Value {
    let uv = [0.0f32, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes);
    let mut root = with_data(&SQUARE, &[uv.as_flattened(), &[0, 1, 2, 2, 1, 3, 0, 0], PNG].concat());
    root["bufferViews"] = json!([
        { "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
        { "buffer": 0, "byteOffset": 80, "byteLength": 6 }, { "buffer": 0, "byteOffset": 88, "byteLength": 12 },
    ]);
    push(&mut root["accessors"], json!({ "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" }));
    for start in [0, 3] {
        let indices =
            json!({ "bufferView": 2, "byteOffset": start, "componentType": 5121, "count": 3, "type": "SCALAR" });
        push(&mut root["accessors"], indices);
    }
    root["meshes"] = json!([{ "name": "square", "primitives": [
        { "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 2 },
        { "attributes": { "POSITION": 0 }, "indices": 3, "material": 0 },
    ] }]);
    root["images"] = json!([{ "bufferView": 3, "mimeType": "image/png" }, { "uri": address(b"not an image") }]);
    root["samplers"] = json!([{ "wrapS": 33_071, "magFilter": 9728 }]);
    root["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 1 }, { "sampler": 0 }]);
    let change = json!({ "KHR_texture_transform": { "offset": [0.5, 0.25], "scale": [2, 2] } });
    root["materials"] = json!([
        { "name": "plain", "pbrMetallicRoughness": { "baseColorFactor": [1, 0, 0, 0.5] }, "alphaMode": "BLEND" },
        { "name": "unused", "emissiveTexture": { "index": 77 } },
        {
            "name": "wood", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25, "emissiveFactor": [0, 0, 1],
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0.25, "roughnessFactor": 0.75 },
            "normalTexture": { "index": 0, "scale": 2, "extensions": change },
            "extensions": { "KHR_materials_unlit": {} },
        },
    ]);
    root
}

fn look(attributes: &Attributes, material: usize) -> &Look {
    attributes.materials.as_ref().unwrap().list[material].look.as_ref().unwrap()
}

#[test]
fn materials_come_back_as_they_were() {
    let read = |bytes: &[u8]| super::parse(bytes, &no_files).unwrap();
    let first = read(dressed().to_string().as_bytes());
    assert!(first.notes.is_empty(), "{:?}", first.notes);
    let materials = first.attributes.materials.as_ref().unwrap();
    assert_eq!(materials.list.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["plain", "wood"]);
    assert_eq!((&materials.of_triangle[..], &materials.images[..]), (&[1, 0][..], &[Image::Bytes(PNG.into())][..]));
    let (plain, wood) = (look(&first.attributes, 0), look(&first.attributes, 1));
    assert_eq!((plain.base_color, plain.alpha), ([1.0, 0.0, 0.0, 0.5], Alpha::Blend));
    assert_eq!((wood.metallic, wood.roughness, wood.emissive), (0.25, 0.75, [0.0, 0.0, 1.0]));
    assert_eq!((wood.alpha, wood.double_sided, wood.unlit), (Alpha::Mask(0.25), true, true));
    assert_eq!(wood.textures.iter().map(|t| t.strength).collect::<Vec<_>>(), [1.0, 2.0]);
    assert_eq!(wood.textures[0].sampler, Sampler { mag_filter: Some(9728), min_filter: None, wrap: [33_071, REPEAT] });
    assert!(first.attributes.texture[0].iter().all(|at| at.is_finite()));
    // The primitive without coordinates has none.
    assert!(first.attributes.texture[1][2].is_nan());
    assert_eq!(first.attributes.parts.as_ref().unwrap().list[0].object, "square");
    for format in [crate::io::Format::Glb, crate::io::Format::Gltf] {
        let mut bytes = Vec::new();
        crate::io::write_with_attributes(&first.mesh, &first.attributes, format, &mut bytes).unwrap();
        let second = read(&bytes);
        let of = |read: &Read| read.attributes.materials.clone().unwrap();
        assert_eq!((of(&second).list, of(&second).images), (of(&first).list, of(&first).images));
        let looks = |read: &Read| {
            let mut seen: Vec<_> =
                (0..2).map(|t| (of(read).of_triangle[t], read.mesh.corners(t).map(|p| p.to_array()))).collect();
            seen.sort_by_key(|(material, _)| *material);
            seen
        };
        assert_eq!(looks(&second), looks(&first));
        assert_eq!(second.attributes.parts.unwrap().list[0].object, "square");
    }
}

#[test]
fn parts_of_materials_that_are_left_out_are_noted() {
    let mut root = dressed();
    root["materials"][2]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1.into();
    root["materials"][2]["normalTexture"]["index"] = 1.into();
    root["materials"][2]["emissiveTexture"] = json!({ "index": 2 });
    root["materials"][0]["extensions"] = json!({ "KHR_materials_clearcoat": {} });
    let read = super::parse(root.to_string().as_bytes(), &no_files).unwrap();
    assert_eq!(
        read.notes,
        [
            "image 1 is left out: it is neither PNG nor JPEG",
            "textures by TEXCOORD_1 are left out",
            "textures without a PNG or JPEG image are left out",
            "the extension KHR_materials_clearcoat of materials is left out",
        ]
    );
    assert!(look(&read.attributes, 1).textures.is_empty());
    let mut root = dressed();
    root["images"][0] = json!({ "uri": "gone.png" });
    assert_eq!(load(&root).unwrap().1, ["image 0 is left out: no files here"]);
}

#[test]
fn numbers_in_materials_are_checked() {
    for (pointer, value, expected) in [
        ("/meshes/0/primitives/0/material", json!(3), (", mesh 0", "a primitive has material 3, of only 3")),
        ("/materials/2/normalTexture/index", json!(9), (", material 2", "uses texture 9, of only 3")),
        ("/textures/0/source", json!(2), (", texture 0", "uses image 2, of only 2")),
        ("/textures/0/sampler", json!(-1), (", texture 0", "uses sampler -1, of only 1")),
        ("/images/0/bufferView", json!(4), (", buffer view 4", "does not exist")),
        ("/materials/2/alphaMode", json!("X"), (", material 2", "has the unknown alpha mode 'X'")),
        ("/materials/2/emissiveFactor", json!([1]), (", material 2", "has a factor that is not 3 numbers")),
        ("/materials/2", json!(5), (", material 2", "is no object")),
        ("/images/0", json!({}), (", image 0", "has no data")),
    ] {
        let mut root = dressed();
        *root.pointer_mut(pointer).unwrap() = value;
        let result = load(&root);
        assert_eq!((place(result.clone()).as_str(), cause(result).as_str()), expected);
    }
}

#[test]
fn many_names_of_one_image_are_one_image() {
    let mut root = dressed();
    root["images"] = json!([{ "uri": address(PNG) }, { "uri": address(PNG) }]);
    let read = super::parse(root.to_string().as_bytes(), &no_files).unwrap();
    assert_eq!(read.attributes.materials.unwrap().images.len(), 1);
    let mut root = dressed();
    root["nodes"] = json!([{ "mesh": 0, "name": "a".repeat(1000) }]);
    root["scenes"] = json!([{ "nodes": [0] }]);
    let parts = super::parse(root.to_string().as_bytes(), &no_files).unwrap().attributes.parts.unwrap();
    assert_eq!(parts.list[0].object.len(), crate::mesh::parts::LONGEST_NAME);
}

#[test]
fn images_that_share_a_view_are_bounded() {
    let mut root = dressed();
    let image = [PNG, &vec![0; 1 << 20]].concat();
    root["buffers"][0] = json!({ "byteLength": 100 + image.len(), "uri": address(&[&[0; 100][..], &image].concat()) });
    root["bufferViews"][3] = json!({ "buffer": 0, "byteOffset": 100, "byteLength": image.len() });
    root["meshes"][0]["primitives"][0]["material"] = 0.into();
    root["meshes"][0]["primitives"] =
        (0..70).map(|m| json!({ "attributes": { "POSITION": 0 }, "material": m })).collect();
    root["images"] = (0..70).map(|_| json!({ "bufferView": 3 })).collect();
    root["textures"] = (0..70).map(|image| json!({ "source": image })).collect();
    root["materials"] = (0..70).map(|texture| json!({ "normalTexture": { "index": texture } })).collect();
    assert_eq!(place(load(&root)), ", image 63");
}
