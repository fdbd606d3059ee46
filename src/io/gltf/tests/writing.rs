use super::files::*;
use crate::io::bytes::samples::tetrahedron;
use crate::io::gltf::glb::split;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

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
