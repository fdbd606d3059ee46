//! Whatever the bytes, a reader gives a mesh or an error; what a writer writes is read as the same mesh.

use glam::DVec3;
use proptest::prelude::*;
use spectral_remesh::io::{self, Format, NO_BUFFERS};
use spectral_remesh::{Error, Mesh};

/// An octahedron, in coordinates that f32 holds exactly.
fn octahedron() -> Mesh {
    let positions =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.25], [0.0, 0.0, -3.0]];
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Mesh { positions: positions.map(DVec3::from).to_vec(), triangles: triangles.to_vec() }
}

fn written(mesh: &Mesh, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    io::write(mesh, format, &mut bytes).unwrap();
    bytes
}

/// Files of every format and its variants, none of them broken.
fn valid_files() -> Vec<(Format, Vec<u8>)> {
    let mut files: Vec<_> = Format::ALL.map(|format| (format, written(&octahedron(), format))).to_vec();
    let texts = [
        (Format::Obj, "# a\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\ng b\nf 1/1 2/1/1 \\\n 3//1 -1\nl 1 2\n"),
        (Format::Off, "CNOFF\n4 2 0\n0 0 0 0 0 1 9 9 9 9\n1 0 0 1\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n2 0 1\n"),
        (
            Format::Stl,
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n",
        ),
        (
            Format::Ply,
            "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n4 0 1 2 3\n5 0 1 2 -1 3\n",
        ),
        (
            Format::Gltf,
            r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1],"scale":[1,2,3]},{"mesh":0,"translation":[1,0,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}}}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":1}],"buffers":[{"byteLength":37,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAQ=="}]}"#,
        ),
    ];
    files.extend(texts.map(|(format, text)| (format, text.as_bytes().to_vec())));
    files
}

/// Reads as every format, also after the wrong ones: an error or a mesh that is sound.
fn read_as_anything(bytes: &[u8]) {
    let _ = Format::sniff(bytes);
    for format in Format::ALL {
        match io::parse(bytes, format, NO_BUFFERS) {
            Ok(loaded) => audit(&loaded.mesh),
            Err(error) => audit_error(error),
        }
    }
}

fn audit(mesh: &Mesh) {
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
}

fn audit_error(error: Error) {
    assert!(matches!(error, Error::Format { .. }), "{error:?}");
    let message = error.in_file("name").to_string();
    assert!(message.starts_with("name") && message.contains("; "), "{message}");
    assert!(!message.contains(['\n', '\r']), "{message:?}");
}

#[test]
fn every_format_comes_back() {
    let mesh = octahedron();
    for format in Format::ALL {
        let bytes = written(&mesh, format);
        assert_eq!(Format::sniff(&bytes), Some(format));
        let loaded = io::parse(&bytes, format, NO_BUFFERS).unwrap();
        assert!(loaded.notes.is_empty(), "{:?}", loaded.notes);
        assert_eq!(
            (0..8).map(|t| loaded.mesh.corners(t)).collect::<Vec<_>>(),
            (0..8).map(|t| mesh.corners(t)).collect::<Vec<_>>()
        );
        // STL alone has no vertices of its own.
        assert_eq!(loaded.mesh == mesh, format != Format::Stl);
    }
}

#[test]
fn valid_files_are_read() {
    for (format, bytes) in valid_files() {
        let loaded = io::parse(&bytes, format, NO_BUFFERS).unwrap();
        assert!(!loaded.mesh.triangles.is_empty());
        assert_eq!(Format::sniff(&bytes), Some(format));
    }
}

#[test]
fn files_may_end_anywhere() {
    for (_, bytes) in valid_files() {
        (0..bytes.len()).for_each(|end| read_as_anything(&bytes[..end]));
    }
}

#[test]
fn binary_files_that_end_early_are_refused() {
    for format in [Format::Ply, Format::Stl, Format::Glb] {
        let bytes = written(&octahedron(), format);
        for end in 0..bytes.len() {
            assert!(io::parse(&bytes[..end], format, NO_BUFFERS).is_err(), "{format} {end}");
        }
    }
}

#[test]
fn files_without_sense() {
    for bytes in [vec![0; 1000], vec![0xFF; 1000], vec![b'\n'; 1000], vec![b'['; 100_000], b"f ".repeat(10_000)] {
        read_as_anything(&bytes);
    }
}

/// A valid file with some bytes put in place of others.
fn mutated() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        4 => any::<u8>().prop_map(|b| vec![b]),
        2 => (b'0'..=b'9').prop_map(|b| vec![b]),
        1 => Just(b"-1".to_vec()),
        1 => Just(b"nan".to_vec()),
        1 => Just(b"99999999999999999999".to_vec()),
        1 => Just(b"4294967295".to_vec()),
        1 => Just(b"1e39".to_vec()),
        1 => Just(vec![0xFF; 4]),
        1 => Just(Vec::new()),
        1 => Just(b"\n".to_vec()),
    ];
    let change = (any::<prop::sample::Index>(), 0usize..5, piece);
    (prop::sample::select(valid_files()), prop::collection::vec(change, 1..6)).prop_map(|((_, mut bytes), changes)| {
        for (at, removed, piece) in changes {
            let at = at.index(bytes.len() + 1);
            let end = (at + removed).min(bytes.len());
            bytes.splice(at..end, piece);
        }
        bytes
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn changed_files_are_read_or_refused(bytes in mutated()) {
        read_as_anything(&bytes);
    }

    #[test]
    fn random_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read_as_anything(&bytes);
        for start in [&b"ply\n"[..], b"solid a\n", b"OFF\n", b"glTF\x02\0\0\0", b"v 0 0 0\nf "] {
            read_as_anything(&[start, &bytes].concat());
        }
    }
}
