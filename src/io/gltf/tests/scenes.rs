use super::files::*;
use crate::io::bytes::samples::{signed_volume, tetrahedron};
use glam::DVec3;
use serde_json::{Value, json};

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
        assert!(cause(load(&root)).contains("it has lines but no faces"));
        let lines = root["meshes"][0]["primitives"][0].clone();
        root["meshes"][0]["primitives"][0]["mode"] = 4.into();
        root["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
        let (_, notes) = load(&root).unwrap();
        assert!(notes.contains(&"1 line primitives are left out".into()));
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
    // First scaled, then rotated by 90 degrees around z, then translated.
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
fn nodes_are_trees() {
    for nodes in [
        json!([{ "mesh": 0, "children": [0] }]),
        json!([{ "children": [1] }, { "children": [0] }]),
        json!([{ "children": [1, 1] }, { "mesh": 0 }]),
    ] {
        assert!(place_with("/nodes", nodes).starts_with(", node "));
    }
    // Deep nesting is no danger.
    let mut root = written();
    let chain = (1..100_000).map(|child| json!({ "children": [child] }));
    root["nodes"] = chain.chain([json!({ "mesh": 0 })]).collect();
    assert_eq!(load(&root).unwrap().0, tetrahedron());
}

#[test]
fn many_copies_are_refused() {
    let mut root = with_data(&[[0.5; 3]; 3000], &[]);
    root["scenes"] = json!([{ "nodes": (0..30_000).collect::<Vec<_>>() }]);
    root["nodes"] = (0..30_000).map(|_| json!({ "mesh": 0 })).collect();
    assert!(cause(load(&root)).contains("too many"));
}
