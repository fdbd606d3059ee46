//! Files to read, made of JSON, and the results of reading them.

use crate::base::error::Result;
use crate::io::base64;
use crate::io::bytes::samples::{fault, tetrahedron};
use crate::io::content::Resolve;
use crate::io::gltf;
use crate::mesh::triangle_mesh::Mesh;
use serde_json::{Value, json};

pub(super) fn no_files(_: &str) -> std::result::Result<Vec<u8>, String> {
    Err("no files here".into())
}

/// The mesh and the notes.
pub(super) type Parsed = Result<(Mesh, Vec<String>)>;

pub(super) fn parse(bytes: &[u8], resolve: Resolve) -> Parsed {
    gltf::parse(bytes, resolve).map(|read| (read.mesh, read.notes))
}

pub(super) fn write_glb(mesh: &Mesh, out: &mut Vec<u8>) -> std::io::Result<()> {
    crate::io::write(mesh, crate::io::Format::Glb, out)
}

pub(super) fn load(root: &Value) -> Parsed {
    parse(root.to_string().as_bytes(), &no_files)
}

pub(super) fn place(result: Parsed) -> String {
    fault(result).0.to_string()
}

pub(super) fn cause(result: Parsed) -> String {
    fault(result).1
}

pub(super) fn glb() -> Vec<u8> {
    let mut bytes = Vec::new();
    write_glb(&tetrahedron(), &mut bytes).unwrap();
    bytes
}

/// The written file of a tetrahedron, to be modified.
pub(super) fn written() -> Value {
    let mut bytes = Vec::new();
    crate::io::write(&tetrahedron(), crate::io::Format::Gltf, &mut bytes).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

pub(super) fn address(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", base64::encode(bytes))
}

/// A file with these positions (view 0, accessor 0) and, in view 1, `extra`.
pub(super) fn with_data(positions: &[[f32; 3]], extra: &[u8]) -> Value {
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

pub(super) const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

/// A square whose primitive has `indices` of the given component type.
pub(super) fn indexed(component: u32, indices: &[u8], count: usize) -> Value {
    let mut root = with_data(&SQUARE, indices);
    let accessor = json!({ "bufferView": 1, "componentType": component, "count": count, "type": "SCALAR" });
    push(&mut root["accessors"], accessor);
    root["meshes"][0]["primitives"][0]["indices"] = 1.into();
    root
}

/// Adds `value` to a JSON array.
pub(super) fn push(array: &mut Value, value: Value) {
    array.as_array_mut().unwrap().push(value);
}

/// Returns the place of the error after the value at `pointer` was replaced by `value`.
pub(super) fn place_with(pointer: &str, value: Value) -> String {
    let mut root = written();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    root.pointer_mut(parent).unwrap()[key] = value;
    place(load(&root))
}
