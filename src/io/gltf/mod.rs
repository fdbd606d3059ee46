//! glTF 2.0 and GLB.
//!
//! The JSON is read with the types of the gltf crate. Buffers, views and accessors are read here, because every range in a
//! file has to be checked (`store`). `scene` walks the nodes, `materials` reads the looks of triangles. Parts that
//! contribute to neither (animations, cameras) are dropped before the JSON is converted to these types, so that errors in
//! them do not matter.
//!
//! Read are points, triangles, strips and fans, indexed or not, positions in floats or quantized (KHR_mesh_quantization),
//! sparse accessors, data in GLB chunks, in base64 URIs and in files beside. Of the vertex attributes, NORMAL, COLOR_0,
//! TEXCOORD_0 and those whose names begin with an underscore are read, if all primitives have them. Colours keep their
//! values: nothing is converted between formats with linear colours, such as glTF, and others.
//!
//! Limits: compressed meshes (Draco, meshopt) are not read; lines are left out; skins and morph targets are not applied. A
//! mirroring transform of a node reverses its triangles, so that the outside stays outside.

mod glb;
mod materials;
mod scene;
mod store;
mod vertices;
mod write;
mod write_materials;

pub(crate) use write::{write_glb, write_gltf};

use crate::base::error::{Place, Result};
use crate::io::bytes::{EXPORT_AGAIN, malformed, without_mark};
use crate::io::content::{Parsed, Resolve};
use ::gltf::json::Root;
use materials::Lists;
use serde_json::Value;
use store::{COMPRESSIONS, DECOMPRESS, Store};

/// Parts of the JSON that are not read.
const UNUSED: [&str; 5] = ["animations", "cameras", "extensions", "extras", "skins"];
/// Prefixes of required extensions that can be ignored, because they do not affect geometry, or that are read.
const HARMLESS: [&str; 9] = [
    "EXT_lights_",
    "EXT_texture_",
    "KHR_animation_pointer",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_mesh_quantization",
    "KHR_texture_",
    "KHR_xmp",
    "MSFT_texture_",
];

/// Reads the triangles and points of the default scene (of the first one if none is the default, of all meshes if there are
/// no scenes). `resolve` gets the addresses of buffers in other files as they are in the JSON.
///
/// # Errors
/// `Error::Format` with the line, byte or part that is malformed or not supported.
pub(crate) fn parse(bytes: &[u8], resolve: Resolve) -> Parsed {
    if !bytes.starts_with(glb::MAGIC) {
        return read(bytes, None, resolve, Place::Line);
    }
    let chunks = glb::split(bytes)?;
    let mut all = read(chunks.json, chunks.bin, resolve, |_| Place::Part("JSON chunk".into()))?;
    if chunks.extra > 0 {
        all.notes.push(format!("{} bytes after the end of the GLB are left out", chunks.extra));
    }
    Ok(all)
}

fn read(json: &[u8], bin: Option<&[u8]>, resolve: Resolve, place: impl Fn(usize) -> Place) -> Parsed {
    let (root, looks) = document(json, place)?;
    let harmless = |name: &String| HARMLESS.iter().any(|prefix| name.starts_with(prefix));
    if let Some(name) = root.extensions_required.iter().find(|name| !harmless(name)) {
        let cause = format!("requires the extension {name}, which is not supported");
        let remedy =
            if COMPRESSIONS.contains(&name.as_str()) { DECOMPRESS } else { "export it without that extension" };
        return Err(malformed(Place::Part("extensionsRequired".into()), cause, remedy));
    }
    scene::collect(&root, &Store::new(&root, bin, resolve), &looks)
}

/// Parses the JSON to the gltf crate's types, and to the raw lists of looks. Indices in both are unchecked.
fn document(json: &[u8], place: impl Fn(usize) -> Place) -> Result<(Root, Lists)> {
    let mut value: Value = serde_json::from_slice(without_mark(json)).map_err(|e| {
        let cause = format!("neither GLB nor JSON: {e}");
        malformed(place(e.line()), cause, "check that this is a complete glTF file")
    })?;
    let version = value["asset"]["version"].as_str().unwrap_or("none");
    if !version.starts_with("2.") {
        let cause = format!("glTF version {version} is not supported, only 2.0 is");
        return Err(malformed(Place::Part("asset".into()), cause, "export it as glTF 2.0"));
    }
    let mut take = |key: &str| value.as_object_mut().and_then(|object| object.remove(key)).unwrap_or_default();
    let (materials, textures) = (take("materials"), take("textures"));
    let looks = Lists { materials, textures, samplers: take("samplers"), images: take("images") };
    if let Some(object) = value.as_object_mut() {
        UNUSED.iter().for_each(|key| drop(object.remove(*key)));
    }
    for scene in value.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        // An empty scene need not have a list of nodes, but the gltf crate's type requires one.
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
        }
    }
    let root = serde_json::from_value(value);
    let root = root.map_err(|e| malformed(Place::Whole, format!("not glTF: {e}"), EXPORT_AGAIN))?;
    Ok((root, looks))
}

#[cfg(test)]
mod tests;
