use super::*;
use crate::base::error::Result;
use crate::io::bytes::samples::{fault, tetrahedron};
use crate::mesh::attributes::Scalar;
use glam::DVec3;
use std::io::{self, Write};

/// The mesh and the notes.
fn parse(bytes: &[u8]) -> Result<(Mesh, Vec<String>)> {
    super::parse(bytes).map(|read| (read.mesh, read.notes))
}

fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    crate::io::write(mesh, crate::io::Format::Ply, out)
}

const TEXT: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 4\nproperty list uchar int vertex_indices\nend_header\n\
                    0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

fn place(bytes: &[u8]) -> Place {
    fault(parse(bytes)).0
}

fn mesh(text: &str) -> Mesh {
    parse(text.as_bytes()).unwrap().0
}

fn written() -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&tetrahedron(), &mut bytes).unwrap();
    bytes
}

/// A header followed by values, each already in bytes.
fn binary(header: &str, values: &[&[u8]]) -> Vec<u8> {
    [header.as_bytes(), &values.concat()].concat()
}

/// A text header of three vertices and `elements`, followed by the vertices and `body`.
fn three_vertices(elements: &str, body: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{elements}\
         end_header\n0 0 0\n1 0 0\n0 1 0\n{body}"
    )
}

#[test]
fn text() {
    let (mesh, notes) = parse(TEXT.as_bytes()).unwrap();
    assert_eq!((mesh, notes.len()), (tetrahedron(), 0));
}

#[test]
fn text_with_other_line_ends() {
    assert_eq!(mesh(&TEXT.replace('\n', "\r\n")), tetrahedron());
    assert_eq!(mesh(&TEXT.replace('\n', "\r")), tetrahedron());
}

#[test]
fn writing_and_reading_gives_the_same() {
    let mut mesh = tetrahedron();
    mesh.positions[1] = DVec3::new(0.1, -1e-300, 1e300);
    let mut bytes = Vec::new();
    write(&mesh, &mut bytes).unwrap();
    assert_eq!(parse(&bytes).unwrap(), (mesh, Vec::new()));
}

#[test]
fn big_endian_with_other_properties_in_any_order() {
    let header = "ply\nformat binary_big_endian 1.0\r\nelement vertex 3\nproperty list uchar ushort extra\n\
                  property double z\nproperty uchar red\nproperty short y\nproperty float x\nelement camera 1\n\
                  property int32 view\nelement face 1\nproperty uint8 flags\n\
                  property list int16 uint16 vertex_index\nproperty list uint8 float32 texcoord\nend_header\n";
    let vertex = |x: f32, y: i16, z: f64| {
        let extra: &[u8] = if y > 0 { &[2, 9, 9, 9, 9] } else { &[0] };
        [extra, &z.to_be_bytes(), &[255], &y.to_be_bytes(), &x.to_be_bytes()].concat()
    };
    let face = [&[7][..], &[0, 3, 0, 2, 0, 1, 0, 0], &[1, 0, 0, 0, 0]].concat();
    let vertices = [vertex(0.5, -300, 0.1), vertex(1.0, 2, -1e9), vertex(0.0, 1, 0.0)].concat();
    let (mesh, notes) = parse(&binary(header, &[&vertices, &[1, 2, 3, 4], &face])).unwrap();
    assert_eq!(mesh.positions[..2], [DVec3::new(0.5, -300.0, 0.1), DVec3::new(1.0, 2.0, -1e9)]);
    assert_eq!(mesh.triangles, [[2, 1, 0]]);
    assert_eq!(
        notes,
        [
            "the list property 'extra' of vertices is left out",
            "1 elements 'camera' are left out",
            "properties of faces are left out: 'flags'",
        ]
    );
}

#[test]
fn all_types_in_both_orders() {
    let cases: [(&str, &[u8]); 8] = [
        ("char", &(-5i8).to_le_bytes()),
        ("uchar", &[250]),
        ("short", &(-500i16).to_le_bytes()),
        ("ushort", &60_000u16.to_le_bytes()),
        ("int", &(-70_000i32).to_le_bytes()),
        ("uint", &4_000_000_000u32.to_le_bytes()),
        ("float", &1.5f32.to_le_bytes()),
        ("double", &1e200f64.to_le_bytes()),
    ];
    let values = [-5.0, 250.0, -500.0, 60_000.0, -70_000.0, 4e9, 1.5, 1e200];
    for ((name, bytes), value) in cases.into_iter().zip(values) {
        for order in ["little", "big"] {
            let mut bytes = bytes.to_vec();
            if order == "big" {
                bytes.reverse();
            }
            let header = format!(
                "ply\nformat binary_{order}_endian 1.0\nelement vertex 1\nproperty {name} x\nproperty {name} y\n\
                 property {name} z\nend_header\n"
            );
            let (mesh, _) = parse(&binary(&header, &[&bytes, &bytes, &bytes])).unwrap();
            assert_eq!(mesh.positions, [DVec3::splat(value)], "{name} {order}");
        }
    }
}

#[test]
fn polygons_become_triangles() {
    let text = TEXT.replace("face 4", "face 2");
    let body = text.find("3 0 2 1").unwrap();
    let square = text[..body].replace("0 0 1\n", "1 1 0\n") + "4 0 1 3 2\n2 0 1\n";
    let (mesh, notes) = parse(square.as_bytes()).unwrap();
    assert_eq!(mesh.triangles.len(), 2);
    assert_eq!(mesh.area(), 1.0);
    assert!((0..2).all(|t| mesh.area_vector(t).z > 0.0));
    assert_eq!(notes, ["1 face with fewer than three corners is left out"]);
}

#[test]
fn faces_may_come_first() {
    let text = "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\nelement vertex 4\n\
                property float x\nproperty float y\nproperty float z\nend_header\n3 0 1 2\n4 0 1 3 2\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    let mesh = mesh(text);
    assert_eq!((mesh.triangles.len(), mesh.area()), (3, 1.5));
    assert_eq!(place(text.replace("3 0 1 2", "3 0 1 4").as_bytes()), Place::Line(10));
}

#[test]
fn strips_wind_to_and_fro() {
    let strips = |kind: &str, list: &str| {
        let vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
        format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
             element tristrips 1\nproperty list int {kind} vertex_indices\nend_header\n{vertices}{list}\n"
        )
    };
    let one = mesh(&strips("int", "5 0 1 2 3 4"));
    assert_eq!(one.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert!((0..3).all(|t| one.area_vector(t).z > 0.0));
    // A new strip starts with the normal orientation.
    let two = mesh(&strips("int", "11 0 1 2 3 -1 2 3 4 -1 -1 0"));
    assert_eq!(two.triangles, one.triangles);
    let unsigned = mesh(&strips("uint", "8 0 1 2 3 4294967295 2 3 4"));
    assert_eq!(unsigned.triangles, one.triangles);
    // A repeated vertex joins strips.
    assert_eq!(mesh(&strips("int", "7 0 1 2 2 2 3 4")).triangles, [[0, 1, 2], [2, 3, 4]]);
    assert_eq!(place(strips("int", "3 0 1 5").as_bytes()), Place::Line(15));
    assert_eq!(place(strips("int", "3 0 1 -2").as_bytes()), Place::Line(15));
}

#[test]
fn vertices_alone_are_a_cloud() {
    let (mesh, notes) = parse(three_vertices("", "").as_bytes()).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len(), notes.len()), (3, 0, 0));
}

#[test]
fn what_follows_is_noted() {
    let (_, notes) = parse(format!("{TEXT} \n 1").as_bytes()).unwrap();
    assert_eq!(notes, ["everything after the last element is left out"]);
    let mut bytes = written();
    bytes.push(b'\n');
    assert_eq!(parse(&bytes).unwrap().1.len(), 0);
    bytes.push(1);
    assert_eq!(parse(&bytes).unwrap().1.len(), 1);
}

#[test]
fn malformed_text_has_a_line() {
    assert_eq!(place(TEXT.replace("0 1 0\n", "0 nan 0\n").as_bytes()), Place::Line(12));
    assert_eq!(place(TEXT.replace("0 1 0\n", "0 1e999 0\n").as_bytes()), Place::Line(12));
    assert_eq!(place(TEXT.replace("0 1 0\n", "0 one 0\n").as_bytes()), Place::Line(12));
    assert_eq!(place(TEXT.replace("3 1 2 3", "3 1 2 4").as_bytes()), Place::Line(16));
    assert_eq!(place(TEXT.replace("3 1 2 3", "3 1 2 -1").as_bytes()), Place::Line(16));
    assert_eq!(place(TEXT.replace("3 1 2 3", "3 1 2 0.5").as_bytes()), Place::Line(16));
    assert_eq!(place(TEXT.replace("3 1 2 3", "99 1 2 3").as_bytes()), Place::Line(16));
    assert_eq!(place(TEXT.replace("3 1 2 3", "-3 1 2 3").as_bytes()), Place::Line(16));
    assert_eq!(place(TEXT.replace("float y", "float why").as_bytes()), Place::Line(3));
    assert_eq!(place(TEXT.replace("vertex_indices", "corners").as_bytes()), Place::Line(7));
    assert_eq!(place(TEXT.replace("element vertex", "element point").as_bytes()), Place::Line(9));
}

#[test]
fn malformed_bytes_have_an_offset() {
    let good = written();
    let body = good.len() - 4 * 13 - 4 * 24;
    let mut bytes = good.clone();
    bytes[body + 32..body + 40].copy_from_slice(&f64::INFINITY.to_le_bytes());
    assert_eq!(place(&bytes), Place::Byte(body + 32));
    let mut bytes = good.clone();
    bytes[good.len() - 4..].copy_from_slice(&4u32.to_le_bytes());
    assert_eq!(place(&bytes), Place::Byte(good.len() - 4));
    let mut bytes = good.clone();
    bytes[good.len() - 13] = 200;
    assert_eq!(place(&bytes), Place::Byte(good.len() - 13));
}

#[test]
fn counts_are_not_believed() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for count in ["4000000000", "18446744073709551615"] {
            let vertices = TEXT.replace("ascii", encoding).replace("vertex 4", &format!("vertex {count}"));
            assert!(parse(vertices.as_bytes()).is_err());
            let faces = TEXT.replace("face 4", &format!("face {count}"));
            assert_eq!(place(faces.as_bytes()), Place::Line(17));
            let others = three_vertices(&format!("element other {count}\nproperty int i\n"), "");
            assert!(parse(others.as_bytes()).is_err());
            let nothing = three_vertices(&format!("element other {count}\n"), "");
            assert!(parse(nothing.as_bytes()).is_ok());
        }
    }
    let list = "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
                property float z\nelement tristrips 1\nproperty list uint int vertex_indices\nend_header\n";
    assert_eq!(place(&binary(list, &[&[255; 4]])), Place::Byte(list.len()));
}

#[test]
fn cut_anywhere() {
    for end in 0..TEXT.len() - 1 {
        assert!(parse(&TEXT.as_bytes()[..end]).is_err(), "{end}");
    }
    let bytes = written();
    for end in 0..bytes.len() {
        assert!(parse(&bytes[..end]).is_err(), "{end}");
    }
}

#[test]
fn properties_of_vertices() {
    let text = "ply\nformat ascii 1.0\nelement before 1\nproperty int i\nelement vertex 3\nproperty float h\n\
                property list uchar int l\nproperty float x\nproperty float y\nproperty float z\nproperty uchar n\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                9\n0.5 0 0 0 0 1\n0.25 1 7 1 0 0 2\n2 2 8 9 0 1 0 3\n3 0 1 2\n";
    let attributes = super::parse(text.as_bytes()).unwrap().attributes;
    let read = |name| attributes.numbers(name);
    assert_eq!((read("h"), read("n")), (Ok(vec![0.5, 0.25, 2.0]), Ok(vec![1.0, 2.0, 3.0])));
    assert_eq!(attributes.vertex.iter().map(|a| a.scalar).collect::<Vec<_>>(), [Scalar::F32, Scalar::U8]);
    assert!(read("size").unwrap_err().to_string().ends_with("no property 'size'; use one of h, n"));
    assert!(read("l").is_err() && super::parse(b"ply\nformat ascii 1.0\nend_header\n").is_err());
}

#[test]
fn normals_and_colours_are_known_by_their_names() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float u\nproperty float v\nproperty uchar blue\n\
                property uchar red\nproperty uchar green\nproperty uchar alpha\nproperty double x\nproperty double y\n\
                property double z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n\
                0.5 0.25 3 1 2 4 7 8 9 0 0 1\n";
    let attributes = super::parse(text.as_bytes()).unwrap().attributes;
    assert_eq!(attributes.normals(), [DVec3::Z]);
    assert_eq!(attributes.color().unwrap().values, [1.0, 2.0, 3.0, 4.0]);
    // Without faces there are no texture coordinates.
    assert_eq!((attributes.names().join(" "), attributes.texture.len()), ("normal color u v".into(), 0));
}

#[test]
fn texture_coordinates_of_corners_and_of_vertices() {
    let corners = three_vertices(
        "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n",
        "3 0 1 2 0\n3 2 1 0 6 1 2 3 4 5 6\n",
    );
    let [none, some] = super::parse(corners.as_bytes()).unwrap().attributes.texture[..] else { panic!() };
    assert!(none.iter().all(|at| at.is_nan()));
    assert_eq!(some.map(|at| at.to_array()), [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]);
    let vertices = TEXT
        .replace("end_header", "property uchar k\nend_header")
        .replace("float z", "float z\nproperty float s\nproperty float t");
    let vertices = vertices.replace("0 0 0\n1 0 0\n0 1 0\n0 0 1\n", "0 0 0 1 2\n1 0 0 3 4\n0 1 0 5 6\n0 0 1 7 8\n");
    let vertices =
        vertices.replace("3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n", "3 0 2 1 0\n3 0 1 3 0\n3 1 2 3 0\n3 2 0 3 0\n");
    let texture = super::parse(vertices.as_bytes()).unwrap().attributes.texture;
    assert_eq!((texture.len(), texture[0].map(|at| at.x)), (4, [1.0, 5.0, 3.0]));
}
