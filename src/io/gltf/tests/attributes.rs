use super::files::*;
use crate::io::bytes::samples::tetrahedron;
use crate::io::content::Read;
use crate::io::gltf;
use crate::mesh::attributes::{Attribute, Attributes, Scalar};
use crate::mesh::triangle_mesh::Mesh;
use serde_json::{Value, json};

#[test]
fn attributes_of_vertices() {
    let values: Vec<u8> = [0.5f32, 0.25, 2.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut root = with_data(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &values);
    let read = |root: &Value| gltf::parse(root.to_string().as_bytes(), &no_files).unwrap();
    let numbers = |root: &Value, name: &str| read(root).attributes.numbers(name);
    let accessor = json!({ "bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR" });
    root["accessors"].as_array_mut().unwrap().push(accessor);
    root["meshes"][0]["primitives"][0]["attributes"]["_SIZE"] = json!(1);
    assert_eq!(numbers(&root, "_SIZE"), Ok(vec![0.5, 0.25, 2.0]));
    for missing in ["_WIDTH", "SIZE", ""] {
        assert!(numbers(&root, missing).unwrap_err().to_string().ends_with("use one of _SIZE"), "{missing}");
    }
    // A mesh that is used twice contributes its values twice.
    root["scenes"] = json!([{ "nodes": [0, 1] }]);
    root["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [5.0, 0.0, 0.0] }]);
    assert_eq!(numbers(&root, "_SIZE"), Ok(vec![0.5, 0.25, 2.0, 0.5, 0.25, 2.0]));
    // Errors in attributes do not make the mesh unreadable.
    root["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(1);
    for (key, value, cause) in [
        ("count", json!(2), "_SIZE is left out: accessor 1 has 2 values for 3 vertices"),
        ("count", json!(4), "_SIZE is left out: accessor 1: 4 elements are more than buffer view 1 holds"),
        ("type", json!("MAT2"), "_SIZE is left out: accessor 1: these are not values of up to four"),
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
    // Validation by the gltf crate itself.
    let gltf = ::gltf::Gltf::from_slice(&bytes).unwrap();
    assert_eq!(gltf.accessors().next().unwrap().count(), 12);
    let read = gltf::parse(&bytes, &no_files).unwrap();
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
