use super::files::*;
use crate::io::bytes::samples::tetrahedron;
use crate::io::gltf::{self, glb::split};
use crate::io::{Format, write_levels};
use crate::mesh::attributes::Attributes;
use crate::mesh::materials::{Look, Material, Materials};
use crate::mesh::parts::{Part, Parts};
use crate::mesh::triangle_mesh::Mesh;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

#[test]
fn writing_and_reading_gives_the_same() {
    assert_eq!(load(&written()).unwrap(), (tetrahedron(), Vec::new()));
    assert_eq!(parse(&glb(), &no_files).unwrap(), (tetrahedron(), Vec::new()));
}

#[test]
fn what_is_written_is_valid() {
    let bytes = glb();
    assert_eq!(bytes.len() % 4, 0);
    let chunks = split(&bytes).unwrap();
    assert_eq!((chunks.json.len() % 4, chunks.bin.unwrap().len()), (0, 4 * 12 + 4 * 12));
    // Validation by the gltf crate itself.
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

/// Triangles in parts with these names, with one material and texture coordinates.
fn textured(parts: &[&str], of_triangle: Vec<u32>) -> Attributes {
    let look = Look { base_color: [1.0, 0.5, 0.0, 1.0], ..Look::default() };
    let list = vec![Material { name: "paint".into(), look: Some(look) }];
    let count = of_triangle.len();
    let materials = Some(Materials { list, of_triangle: vec![0; count], ..Materials::default() });
    let list = parts.iter().map(|&name| Part { object: name.into(), group: String::new() }).collect();
    let texture = vec![[DVec2::ZERO, DVec2::X, DVec2::Y]; count];
    Attributes { texture, materials, parts: Some(Parts { list, of_triangle }), ..Attributes::default() }
}

#[test]
fn levels_are_nodes_that_the_finest_one_names() {
    let fine = tetrahedron();
    let coarse = Mesh { positions: fine.positions[..3].to_vec(), triangles: vec![[0, 1, 2]] };
    let (of_fine, of_coarse) = (textured(&["a", "b"], vec![0, 1, 1, 1]), textured(&["a", "b"], vec![1]));
    let write = |levels: &[(&Mesh, &Attributes)]| {
        let mut bytes = Vec::new();
        write_levels(levels, Format::Gltf, &mut bytes).map(|()| bytes)
    };
    let bytes = write(&[(&fine, &of_fine), (&coarse, &of_coarse)]).unwrap();
    let root: Value = serde_json::from_slice(&bytes).unwrap();
    let nodes = root["nodes"].as_array().unwrap();
    let finest = &nodes[root["scenes"][0]["nodes"][0].as_u64().unwrap() as usize];
    let named = |indices: &Value| -> Vec<Value> {
        indices.as_array().unwrap().iter().map(|i| nodes[i.as_u64().unwrap() as usize]["name"].clone()).collect()
    };
    assert_eq!(root["scenes"][0]["nodes"].as_array().unwrap().len(), 1);
    assert_eq!(named(&finest["children"]), ["a", "b"]);
    assert_eq!(named(&finest["extensions"]["MSFT_lod"]["ids"]), ["b"]);
    assert_eq!(finest["extras"]["MSFT_screencoverage"], json!([0.75, 0.0]));
    assert_eq!((&root["extensionsUsed"], root["materials"].as_array().unwrap().len()), (&json!(["MSFT_lod"]), 1));
    // Readers that do not know levels of detail read the finest one, with its parts and materials.
    let read = gltf::parse(&bytes, &no_files).unwrap();
    assert_eq!((read.mesh.triangles.len(), read.attributes.names()), (4, of_fine.names()));
    ::gltf::Gltf::from_slice(&bytes).unwrap();

    let other = Attributes { materials: None, ..of_coarse };
    assert!(write(&[(&fine, &of_fine), (&coarse, &other)]).unwrap_err().to_string().contains("different materials"));
    let into_obj = write_levels(&[(&fine, &of_fine)], Format::Obj, &mut Vec::new());
    assert!(into_obj.unwrap_err().to_string().contains("OBJ can hold only one mesh"));
}

#[test]
fn coordinates_beyond_single_precision_are_not_written() {
    let mut mesh = tetrahedron();
    mesh.positions[1].x = 1e200;
    assert_eq!(write_glb(&mesh, &mut Vec::new()).unwrap_err().kind(), std::io::ErrorKind::InvalidData);
}
