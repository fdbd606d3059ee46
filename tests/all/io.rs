//! For any bytes, a reader gives a mesh or an error; what a writer writes is read back as the same mesh.

use crate::common::{annulus, moved, together, torus};
use crate::files::{cloud_files, octahedron, read_as_anything, scan, valid_files, written};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use spectral_remesh::io::{self, Format, Loaded, NO_BUFFERS};
use spectral_remesh::stages::mesh::attributes::{Attribute, Attributes, Scalar};
use spectral_remesh::stages::mesh::materials::{Material, Materials};
use spectral_remesh::{Input, Mesh, Options, Points, remesh};

#[test]
fn every_format_comes_back() {
    let mesh = octahedron();
    for format in Format::OF_MESHES {
        let bytes = written(&mesh, format);
        assert_eq!(Format::sniff(&bytes), Some(format));
        let loaded = io::parse(&bytes, format, NO_BUFFERS).unwrap();
        assert!(loaded.notes.is_empty(), "{:?}", loaded.notes);
        assert_eq!(
            (0..8).map(|t| loaded.mesh.corners(t)).collect::<Vec<_>>(),
            (0..8).map(|t| mesh.corners(t)).collect::<Vec<_>>()
        );
        // Only STL has no shared vertices.
        assert_eq!(loaded.mesh == mesh, format != Format::Stl);
    }
}

#[test]
fn a_mesh_is_remeshed_alike_from_every_format() {
    // A body and a sheet, with coordinates that are exact in single precision; STL stores each corner separately.
    let bodies = together(&[torus(20, 12, 1.0, 0.3), moved(annulus(12, 3, 0.5), |p| p + 2.0 * DVec3::Z)]);
    let mesh = moved(bodies, |p| p.as_vec3().as_dvec3());
    let of_format = |format| {
        let mesh = io::parse(&written(&mesh, format), format, NO_BUFFERS).unwrap().mesh;
        let positions: Vec<_> = mesh.positions.iter().map(|p| p.to_array()).collect();
        let outcome = remesh(&Input::mesh(&positions, &mesh.triangles), &Options::points(300).into(), &()).unwrap();
        assert!(outcome.verified(), "{format}");
        outcome.mesh
    };
    let [first, others @ ..] = &Format::OF_MESHES[..] else { panic!("there are formats") };
    let expected = of_format(*first);
    others.iter().for_each(|&format| assert_eq!(of_format(format), expected, "{format}"));
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
fn points_come_back_from_every_format_that_has_them() {
    let (points, attributes) = scan();
    for format in Format::OF_POINTS {
        let mut bytes = Vec::new();
        io::write_points(&points, &attributes, format, &mut bytes).unwrap();
        assert_eq!(Format::sniff(&bytes), Some(format));
        let loaded = io::parse(&bytes, format, NO_BUFFERS).unwrap();
        let holds = |name: &str| !format.cannot_hold(&attributes).iter().any(|lost| lost.name == name);
        assert_eq!(loaded.attributes.color().is_some(), holds("color"));
        if let Some(color) = loaded.attributes.color() {
            let written = attributes.color().unwrap();
            let off = |v: usize| (0..3).map(|k| (color.color(v)[k] - written.color(v)[k]).abs()).fold(0.0, f64::max);
            assert!((0..6).all(|v| off(v) < 1e-12), "{format}");
        }
        let label = loaded.attributes.vertex.iter().find(|a| a.components == 1);
        assert_eq!(label.map(|a| a.values.clone()), holds("_LABEL").then(|| attributes.vertex[1].values.clone()));
        assert!(label.is_none_or(|a| a.name == "_LABEL"), "{format}");
        let back = points_of(loaded);
        assert_eq!(back.positions(), points.positions(), "{format}");
        assert!((0..6).all(|v| back.normals()[v].distance(points.normals()[v]) < 1e-6), "{format}");
    }
}

/// Returns the vertices as points, with their normals if the file has them.
fn points_of(loaded: Loaded) -> Points {
    Points::new(loaded.mesh.positions, loaded.attributes.normals()).unwrap()
}

#[test]
fn clouds_are_read_from_all_that_holds_them() {
    let normals = [DVec3::Z; 3];
    for (format, text, with_normals) in [
        (Format::Obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\np 1 2 3\n", true),
        (Format::Obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n", false),
        (Format::Off, "NOFF\n3 0 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n", true),
        (Format::Off, "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", false),
        (Format::Xyz, "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n", true),
    ] {
        let loaded = io::parse(text.as_bytes(), format, NO_BUFFERS).unwrap();
        assert_eq!(loaded.mesh.triangles.len(), 0);
        let points = points_of(loaded);
        assert_eq!(points.positions(), [DVec3::ZERO, DVec3::X, DVec3::Y], "{format}");
        assert_eq!(points.normals(), &normals[..if with_normals { 3 } else { 0 }], "{format}");
    }
}

/// Returns an octahedron with all attributes: normals, colours, labels, textured faces of two materials.
fn dressed() -> (Mesh, Attributes) {
    let (points, mut attributes) = scan();
    let values = points.normals().iter().flat_map(|n| n.to_array()).collect();
    attributes.vertex.insert(0, Attribute { name: "normal".into(), components: 3, values, scalar: Scalar::F64 });
    attributes.texture = (0..8).map(|t| [0.0, 0.25, 0.5].map(|x| DVec2::new(x, f64::from(t / 4) / 2.0))).collect();
    let of_triangle = (0..8).map(|t| t / 4).collect();
    let list = ["red", "a blue one"].map(Material::named).to_vec();
    attributes.materials = Some(Materials { list, of_triangle, ..Materials::default() });
    (octahedron(), attributes)
}

#[test]
fn attributes_come_back_from_every_format_that_has_them() {
    let (mesh, attributes) = dressed();
    for format in Format::OF_MESHES {
        let mut bytes = Vec::new();
        io::write_with_attributes(&mesh, &attributes, format, &mut bytes).unwrap();
        let loaded = io::parse(&bytes, format, NO_BUFFERS).unwrap();
        assert!(loaded.notes.is_empty(), "{format} {:?}", loaded.notes);
        let mut expected = attributes.clone();
        format.cannot_hold(&attributes).iter().for_each(|lost| expected.remove(&lost.name));
        let mut names = [loaded.attributes.names(), expected.names()];
        names.iter_mut().for_each(|names| names.sort());
        assert_eq!(names[0], names[1], "{format}");
        assert_eq!(loaded.attributes.texture, expected.texture, "{format}");
        let materials = |attributes: &Attributes| {
            let names = |m: Materials| (m.list.into_iter().map(|m| m.name).collect::<Vec<_>>(), m.of_triangle);
            attributes.materials.clone().map(names)
        };
        assert_eq!(materials(&loaded.attributes), materials(&expected), "{format}");
        if format == Format::Ply {
            assert_eq!(loaded.attributes, expected);
        }
    }
}

#[test]
fn clouds_are_read_and_known_by_their_content() {
    for (format, bytes) in cloud_files() {
        let loaded = io::parse(&bytes, format, NO_BUFFERS).unwrap();
        assert!(loaded.mesh.triangles.is_empty() && loaded.mesh.positions.len() >= 3);
        assert_eq!(Format::sniff(&bytes), Some(format));
    }
}

#[test]
fn files_may_end_anywhere() {
    for (_, bytes) in valid_files().into_iter().chain(cloud_files()) {
        (0..bytes.len()).for_each(|end| read_as_anything(&bytes[..end]));
    }
}

#[test]
fn binary_files_that_end_early_are_refused() {
    for format in [Format::Ply, Format::Stl, Format::Glb, Format::ThreeMf] {
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

/// Generates valid files in which some bytes are replaced.
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
    (prop::sample::select([valid_files(), cloud_files()].concat()), prop::collection::vec(change, 1..6)).prop_map(
        |((_, mut bytes), changes)| {
            for (at, removed, piece) in changes {
                let at = at.index(bytes.len() + 1);
                let end = (at + removed).min(bytes.len());
                bytes.splice(at..end, piece);
            }
            bytes
        },
    )
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
        for start in [
            &b"ply\n"[..],
            b"solid a\n",
            b"OFF\n",
            b"OFF BINARY\n",
            b"glTF\x02\0\0\0",
            b"v 0 0 0\nf ",
            b"# vtk DataFile Version 3.0\na\nBINARY\nDATASET POLYDATA\nPOINTS ",
            b"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA binary_compressed\n",
            b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n",
            b"$MeshFormat\n2.2 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Elements\n",
            b"\x01\0\0\0\x02\0\0\0\x03\0\0\0\x14\0\0\0\x03\0\0\0",
        ] {
            read_as_anything(&[start, &bytes].concat());
        }
    }
}
