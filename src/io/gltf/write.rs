//! Writing of glTF and GLB: a node and a mesh for each part, and a primitive for each of its materials. One buffer holds the
//! vertices, which all primitives share, then the indices, then the images. Several levels of detail each have these of
//! their own, and the node of the finest one refers to those of the others (MSFT_lod).
//!
//! Vertices on UV seams are written once for each pair of texture coordinates, as the format requires.

use super::glb;
use super::write_materials::Written;
use crate::io::base64;
use crate::io::bytes::narrow;
use crate::io::content::Content;
use crate::mesh::attributes::{Attribute, Attributes, Scalar, Wedges};
use crate::mesh::materials::Materials;
use crate::mesh::topology::NONE;
use glam::DVec3;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Range;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34_962;
const ELEMENT_ARRAY_BUFFER: u32 = 34_963;
const POINTS: u32 = 0;
const TRIANGLES: u32 = 4;

/// Extension for nodes with levels of detail.
const LEVELS: &str = "MSFT_lod";

/// Writes glTF 2.0 with embedded data, in single precision.
///
/// # Errors
/// `InvalidData` for coordinates beyond single precision; else errors of `out`.
pub(crate) fn write_gltf(levels: &[Content], out: &mut dyn Write) -> io::Result<()> {
    let Document { mut root, bin } = document(levels)?;
    if !bin.is_empty() {
        let uri = format!("data:application/octet-stream;base64,{}", base64::encode(&bin));
        root["buffers"][0]["uri"] = uri.into();
    }
    out.write_all(&serde_json::to_vec(&root)?)
}

/// Writes GLB, in single precision.
///
/// # Errors
/// `InvalidData` for coordinates beyond single precision; else errors of `out`, or of a file larger than 4 GB.
pub(crate) fn write_glb(levels: &[Content], out: &mut dyn Write) -> io::Result<()> {
    let Document { root, bin } = document(levels)?;
    glb::join(serde_json::to_vec(&root)?, &bin, out)
}

/// The JSON of a file, and its buffer.
struct Document {
    root: Value,
    bin: Vec<u8>,
}

/// Views and accessors, one of each per list of numbers, and the buffer that holds these lists.
#[derive(Default)]
struct Lists {
    views: Vec<Value>,
    accessors: Vec<Value>,
    bin: Vec<u8>,
}

/// Builds the whole file: one mesh, or its levels of detail from fine to coarse, which must have the same materials. A mesh
/// without vertices becomes a file without scenes, because no list in glTF may be empty; one without triangles becomes a
/// cloud of points.
fn document(levels: &[Content]) -> io::Result<Document> {
    let asset = json!({ "version": "2.0", "generator": "spectral-remesh" });
    if levels.iter().any(|content| content.positions.is_empty()) {
        return Ok(Document { root: json!({ "asset": asset }), bin: Vec::new() });
    }
    let (mut lists, mut has_coordinates) = (Lists::default(), false);
    let (mut nodes, mut all) = (Vec::new(), Vec::new());
    let mut of_level = Vec::new();
    for content in levels {
        let wedges = wedges(content);
        has_coordinates |= wedges.is_some();
        let attributes = vertices(content, wedges.as_ref(), &mut lists)?;
        let corners = wedges.as_ref().map_or(content.triangles, |w| &w.corners);
        let first = nodes.len();
        for (name, list) in meshes(content, corners, &attributes, &mut lists) {
            nodes.push(named(json!({ "mesh": all.len() }), &name));
            all.push(named(json!({ "primitives": list }), &name));
        }
        of_level.push(first..nodes.len());
    }
    let looks = looks(levels, has_coordinates, &mut lists)?;
    let Lists { views, accessors, bin } = lists;
    let scene = match &of_level[..] {
        [one] => one.clone().collect(),
        _ => vec![join_levels(levels, &of_level, &mut nodes)],
    };
    let mut root = json!({
        "asset": asset, "scene": 0, "scenes": [{ "nodes": scene }], "nodes": nodes,
        "meshes": all, "accessors": accessors, "bufferViews": views, "buffers": [{ "byteLength": bin.len() }],
    });
    looks.into_iter().for_each(|looks| looks.put(&mut root));
    if levels.len() > 1 {
        let used = root.as_object_mut().expect("an object").entry("extensionsUsed").or_insert_with(|| json!([]));
        used.as_array_mut().expect("a list").push(LEVELS.into());
    }
    Ok(Document { root, bin })
}

/// Returns the looks of the materials that all levels share, if they have any.
fn looks(levels: &[Content], has_coordinates: bool, lists: &mut Lists) -> io::Result<Option<Written>> {
    let mut materials = levels.iter().map(|content| content.attributes.materials.as_ref());
    let first = materials.next().flatten();
    let is_same =
        |other: Option<&Materials>| other.map(|m| (&m.list, &m.images)) == first.map(|m| (&m.list, &m.images));
    if !materials.all(is_same) {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "the levels have different materials"));
    }
    Ok(first.map(|m| Written::new(m, has_coordinates, |image| lists.image(image))))
}

/// Joins the nodes of all levels to one node of the finest level, and returns its index. The screen coverage of a level is
/// such that its vertices are as dense on the screen as those of the finest level at full coverage.
fn join_levels(levels: &[Content], of_level: &[Range<usize>], nodes: &mut Vec<Value>) -> usize {
    let mut heads = Vec::new();
    for of_level in of_level {
        heads.push(if of_level.len() == 1 { of_level.start } else { nodes.len() });
        if of_level.len() != 1 {
            nodes.push(json!({ "children": of_level.clone().collect::<Vec<_>>() }));
        }
    }
    let finest = levels[0].positions.len() as f64;
    let coverage = levels[1..].iter().map(|level| level.positions.len() as f64 / finest).chain([0.0]);
    let node = &mut nodes[heads[0]];
    node["extensions"] = json!({ LEVELS: { "ids": heads[1..] } });
    node["extras"] = json!({ "MSFT_screencoverage": coverage.collect::<Vec<_>>() });
    heads[0]
}

/// Adds a name to a part of the JSON, unless the name is empty.
fn named(mut value: Value, name: &str) -> Value {
    if !name.is_empty() {
        value["name"] = name.into();
    }
    value
}

/// Returns each part's name and primitives: one per material, all over the same vertices. `corners` has the vertices of the
/// triangles.
fn meshes(
    content: &Content,
    corners: &[[u32; 3]],
    attributes: &Map<String, Value>,
    lists: &mut Lists,
) -> Vec<(String, Vec<Value>)> {
    if corners.is_empty() {
        return vec![(String::new(), vec![json!({ "attributes": attributes, "mode": POINTS })])];
    }
    let Attributes { materials, parts, .. } = content.attributes;
    let mut groups: BTreeMap<(u32, u32), Vec<[u32; 3]>> = BTreeMap::new();
    for (t, corners) in corners.iter().enumerate() {
        let part = parts.as_ref().map_or(NONE, |p| p.of_triangle[t]);
        let material = materials.as_ref().map_or(NONE, |m| m.of_triangle[t]);
        groups.entry((part, material)).or_default().push(*corners);
    }
    let mut meshes: BTreeMap<u32, Vec<Value>> = BTreeMap::new();
    for ((part, material), triangles) in groups {
        let mut primitive = json!({ "attributes": attributes, "mode": TRIANGLES, "indices": lists.accessors.len() });
        if material != NONE {
            primitive["material"] = material.into();
        }
        lists.indices(&triangles);
        meshes.entry(part).or_default().push(primitive);
    }
    let name = |part: u32| {
        let part = parts.as_ref().and_then(|parts| parts.list.get(part as usize));
        part.map_or("", |part| if part.object.is_empty() { &part.group } else { &part.object }).to_owned()
    };
    meshes.into_iter().map(|(part, primitives)| (name(part), primitives)).collect()
}

/// Returns the vertices to write, split where texture coordinates differ. Corners without texture coordinates get zeros.
fn wedges(content: &Content) -> Option<Wedges> {
    let mut texture = Cow::Borrowed(&content.attributes.texture);
    if texture.is_empty() {
        return None;
    }
    if texture.iter().flatten().any(|at| !at.is_finite()) {
        texture.to_mut().iter_mut().flatten().filter(|at| !at.is_finite()).for_each(|at| *at = glam::DVec2::ZERO);
    }
    Some(Wedges::new(content.triangles, &texture))
}

/// Adds positions and attributes. Returns the attributes' names with the indices of their accessors.
fn vertices(content: &Content, wedges: Option<&Wedges>, lists: &mut Lists) -> io::Result<Map<String, Value>> {
    let count = wedges.map_or(content.positions.len(), |w| w.vertices.len());
    let vertex = |i: usize| wedges.map_or(i, |w| w.vertices[i] as usize);
    let mut names = Map::new();
    names.insert("POSITION".into(), lists.accessors.len().into());
    lists.positions((0..count).map(|i| content.positions[vertex(i)]))?;
    for attribute in content.attributes.vertex.iter().filter(|a| a.components <= 4) {
        names.insert(semantic(attribute), lists.accessors.len().into());
        lists.attribute(attribute, (0..count).map(vertex));
    }
    if let Some(wedges) = wedges {
        names.insert("TEXCOORD_0".into(), lists.accessors.len().into());
        // Moves the origin from the lower left of the image to the upper left.
        let values = wedges.coordinates.iter().flat_map(|at| [at.x, 1.0 - at.y]).collect();
        let texture = Attribute { name: String::new(), components: 2, values, scalar: Scalar::F32 };
        lists.attribute(&texture, 0..count);
    }
    Ok(names)
}

/// Returns the glTF name of an attribute: a predefined one, or one that begins with an underscore.
fn semantic(attribute: &Attribute) -> String {
    match attribute.name.as_str() {
        _ if attribute.is_normal() => "NORMAL".into(),
        _ if attribute.is_color() => "COLOR_0".into(),
        name if name.starts_with('_') => name.into(),
        name => format!("_{}", name.to_uppercase()),
    }
}

impl Lists {
    fn positions(&mut self, positions: impl ExactSizeIterator<Item = DVec3>) -> io::Result<()> {
        let (count, start) = (positions.len(), self.bin.len());
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for p in positions {
            let p = narrow(p)?;
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
            }
            self.bin.extend_from_slice(p.map(f32::to_le_bytes).as_flattened());
        }
        let accessor = json!({ "componentType": FLOAT, "count": count, "type": "VEC3", "min": low, "max": high });
        self.end(start, json!({ "target": ARRAY_BUFFER }), accessor);
        Ok(())
    }

    /// Adds an attribute of `vertices`. The values of each vertex are aligned to four bytes.
    fn attribute(&mut self, attribute: &Attribute, vertices: impl ExactSizeIterator<Item = usize>) {
        let (count, start) = (vertices.len(), self.bin.len());
        let (component, scalar) = component(attribute.scalar);
        let full = if attribute.is_color() && attribute.scalar != scalar { attribute.scalar.full() } else { 1.0 };
        let length = attribute.components * scalar.size();
        let stride = length.next_multiple_of(4);
        for v in vertices {
            for &value in attribute.of(v) {
                let finite = if value.is_finite() { value / full } else { 0.0 };
                let (bytes, size) = scalar.bytes(finite);
                self.bin.extend_from_slice(&bytes[..size]);
            }
            self.bin.resize(self.bin.len() + stride - length, 0);
        }
        let shape = ["SCALAR", "VEC2", "VEC3", "VEC4"][attribute.components - 1];
        let normalized = attribute.is_color() && scalar.is_integer();
        let mut view = json!({ "target": ARRAY_BUFFER });
        if stride != length {
            view["byteStride"] = stride.into();
        }
        let mut accessor = json!({ "componentType": component, "count": count, "type": shape });
        if normalized {
            accessor["normalized"] = true.into();
        }
        self.end(start, view, accessor);
    }

    fn indices(&mut self, triangles: &[[u32; 3]]) {
        let start = self.bin.len();
        for t in triangles {
            self.bin.extend_from_slice(t.map(u32::to_le_bytes).as_flattened());
        }
        let accessor = json!({ "componentType": UNSIGNED_INT, "count": 3 * triangles.len(), "type": "SCALAR" });
        self.end(start, json!({ "target": ELEMENT_ARRAY_BUFFER }), accessor);
    }

    /// Adds the content of an image, padded to a multiple of four bytes. Returns the index of its view.
    fn image(&mut self, bytes: &[u8]) -> usize {
        let start = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() }));
        self.views.len() - 1
    }

    /// Ends a list of numbers: adds the view and the accessor for the bytes from `start` on.
    fn end(&mut self, start: usize, mut view: Value, mut accessor: Value) {
        view["buffer"] = 0.into();
        view["byteOffset"] = start.into();
        view["byteLength"] = (self.bin.len() - start).into();
        accessor["bufferView"] = self.views.len().into();
        self.views.push(view);
        self.accessors.push(accessor);
    }
}

/// Returns the glTF component type in which numbers are written: their own if glTF has it, else float.
fn component(scalar: Scalar) -> (u32, Scalar) {
    match scalar {
        Scalar::I8 => (5120, Scalar::I8),
        Scalar::U8 => (5121, Scalar::U8),
        Scalar::I16 => (5122, Scalar::I16),
        Scalar::U16 => (5123, Scalar::U16),
        Scalar::I32 | Scalar::U32 | Scalar::F32 | Scalar::F64 => (FLOAT, Scalar::F32),
    }
}
