//! Writing glTF and GLB: one node, one mesh, one primitive, one buffer of positions and then indices.

use super::glb;
use crate::io::base64;
use crate::io::bytes::narrow;
use crate::surface::mesh::Mesh;
use serde_json::{Value, json};
use std::io::{self, Write};

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34_962;
const ELEMENT_ARRAY_BUFFER: u32 = 34_963;
const POINTS: u32 = 0;
const TRIANGLES: u32 = 4;

/// Writes glTF 2.0 with its data in the file, in single precision.
///
/// # Errors
/// `InvalidData` for coordinates beyond single precision; else what `out` fails with.
pub(crate) fn write_gltf(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let bin = buffer(mesh)?;
    let mut root = document(mesh, bin.len())?;
    if !bin.is_empty() {
        let uri = format!("data:application/octet-stream;base64,{}", base64::encode(&bin));
        root["buffers"][0]["uri"] = uri.into();
    }
    out.write_all(&serde_json::to_vec(&root)?)
}

/// Writes GLB, in single precision.
///
/// # Errors
/// `InvalidData` for coordinates beyond single precision; else what `out` fails with, or more than 4 GB.
pub(crate) fn write_glb(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let bin = buffer(mesh)?;
    let root = document(mesh, bin.len())?;
    glb::join(serde_json::to_vec(&root)?, &bin, out)
}

/// Positions, then indices: both are multiples of four bytes, so everything is aligned.
fn buffer(mesh: &Mesh) -> io::Result<Vec<u8>> {
    let mut bin = Vec::with_capacity(12 * (mesh.positions.len() + mesh.triangles.len()));
    for &p in &mesh.positions {
        bin.extend_from_slice(narrow(p)?.map(f32::to_le_bytes).as_flattened());
    }
    for t in &mesh.triangles {
        bin.extend_from_slice(t.map(u32::to_le_bytes).as_flattened());
    }
    Ok(bin)
}

/// The JSON that goes with [`buffer`]. A mesh without vertices is a file without scenes, because no list in glTF may be
/// empty; one without triangles is a cloud of points.
fn document(mesh: &Mesh, length: usize) -> io::Result<Value> {
    let asset = json!({ "version": "2.0", "generator": "spectral-remesh" });
    if mesh.positions.is_empty() {
        return Ok(json!({ "asset": asset }));
    }
    let (low, high) = range(mesh)?;
    let split = 12 * mesh.positions.len();
    let mut views = vec![view(0, split, ARRAY_BUFFER)];
    let positions = json!({ "bufferView": 0, "componentType": FLOAT, "count": mesh.positions.len(), "type": "VEC3",
                            "min": low, "max": high });
    let mut accessors = vec![positions];
    let mut primitive = json!({ "attributes": { "POSITION": 0 }, "mode": POINTS });
    if !mesh.triangles.is_empty() {
        views.push(view(split, length - split, ELEMENT_ARRAY_BUFFER));
        accessors.push(json!({ "bufferView": 1, "componentType": UNSIGNED_INT, "count": 3 * mesh.triangles.len(),
                               "type": "SCALAR" }));
        primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1, "mode": TRIANGLES });
    }
    Ok(json!({
        "asset": asset, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [primitive] }], "accessors": accessors, "bufferViews": views,
        "buffers": [{ "byteLength": length }],
    }))
}

fn view(offset: usize, length: usize, target: u32) -> Value {
    json!({ "buffer": 0, "byteOffset": offset, "byteLength": length, "target": target })
}

/// The smallest and largest coordinates as they are in the buffer.
fn range(mesh: &Mesh) -> io::Result<([f32; 3], [f32; 3])> {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &p in &mesh.positions {
        let p = narrow(p)?;
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
        }
    }
    Ok((low, high))
}
