use super::*;
use crate::io::bytes::samples;
use proptest::prelude::*;

fn mesh(text: &str) -> Mesh {
    parse(text.as_bytes()).unwrap().mesh
}

fn notes(text: &str) -> Vec<String> {
    parse(text.as_bytes()).unwrap().notes
}

fn triangles(text: &str) -> Vec<[u32; 3]> {
    mesh(text).triangles
}

#[track_caller]
fn fails_at(text: &str, line: usize, words: &str) {
    samples::fails_at(parse(text.as_bytes()), line, words);
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn corners_in_all_forms() {
    for face in ["1 2 3", "1/1 2/2 3/3", "1//1 2//1 3//1", "1/1/1 2/2/1 3/3/1", "-4 -3 -2", "-4/1 -3// +3/-1/-1"] {
        assert_eq!(triangles(&format!("{SQUARE}f {face}\n")), [[0, 1, 2]], "{face}");
    }
}

#[test]
fn vertices_in_all_forms() {
    let m = mesh("v 1e-5 2 -3.5 # in words\nv 1 2 3 0.5\nv\t4 5 6 1 0 0\r\nv 7 8 9 nan nan nan nan");
    let expected = [[1e-5, 2.0, -3.5], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]];
    assert_eq!(m.positions, expected.map(DVec3::from));
    assert!(m.triangles.is_empty());
}

#[test]
fn groups_and_objects_are_one_mesh() {
    let text = format!(
        "# C:\\models\\\nmtllib gone.mtl\n{SQUARE}o one\ng a b\ns off\nusemtl red\nf 1 2 3\no two\nv 0 0 1\nf -1 1 2\n"
    );
    assert_eq!(triangles(&text), [[0, 1, 2], [4, 0, 1]]);
    assert!(notes(&text).is_empty());
}

#[test]
fn polygons_and_lines_that_go_on() {
    assert_eq!(triangles(&format!("{SQUARE}f 1 2 \\\n 3\\\r\n4\nf 1 2 3")), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    let dart = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n";
    assert_eq!(triangles(dart), [[0, 1, 3], [1, 2, 3]]);
}

#[test]
fn faces_may_come_first() {
    assert_eq!(triangles(&format!("f 1 2 3 4\n{SQUARE}")).len(), 2);
}

#[test]
fn lines_by_themselves_are_no_cloud() {
    let read = |text: &str| parse(text.as_bytes()).map(|read| read.mesh.positions.len());
    let error = read("v 0 0 0\nv 1 0 0\nl 1 2\n").unwrap_err();
    assert!(error.to_string().contains("it has lines but no faces; export"), "{error}");
    assert_eq!(read("v 0 0 0\nv 1 0 0\nl 1 2\np 1 2\n"), Ok(2));
}

#[test]
fn vertices_of_free_form_geometry_are_no_cloud() {
    let curve = "v 0 0 0\nv 1 0 0\nv 1 1 0\ncstype bspline\ndeg 1\ncurv 0 2 1 2 3\nparm u 0 1 2\nend\n";
    let read = |text: &str| parse(text.as_bytes()).map(|read| read.mesh.positions.len());
    let error = read(curve).unwrap_err();
    assert!(error.to_string().contains("free-form curves or surfaces, but no faces; mesh"), "{error}");
    assert_eq!(read(&format!("{curve}f 1 2 3\n")), Ok(3));
}

#[test]
fn what_is_left_out_is_said() {
    let text = format!("{SQUARE}p 1\nl 1 2\nf 1 2\nf\nvp 1 2\ncstype bezier\nsurf 0 1\nend\nfoo\nbar\n");
    assert_eq!(
        notes(&text),
        [
            "2 faces with fewer than three corners are left out",
            "1 point or line element is left out",
            "free-form curves and surfaces are left out",
            "statements that are not part of OBJ are left out: 2, the first is 'foo' on line 13",
        ]
    );
}

#[test]
fn names_need_not_be_utf8() {
    let mut text = b"# caf\xE9\r\ng \xFF\xFE\r\n".to_vec();
    text.extend(SQUARE.bytes());
    text.extend(b"f 1 2 3\r\n");
    assert_eq!(parse(&text).unwrap().mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn errors_name_the_line() {
    fails_at("v 0 0 0\n\nv 1 nan 0\n", 3, "'nan' is not finite");
    fails_at("v 0 0 -inf", 1, "not finite");
    fails_at("v 0 0 1e999", 1, "not finite");
    fails_at("v 0 0\nv 0 0 0", 1, "missing");
    fails_at("v 0 0 x7\n", 1, "'x7' is not a number");
    fails_at(&format!("{SQUARE}f 1 2 5\n"), 5, "vertex 5, but the file has only 4");
    fails_at(&format!("{SQUARE}f 1 2 99999999999\nf 1 2 3"), 5, "vertex 99999999999");
    fails_at(&format!("{SQUARE}f 1 2 0\n"), 5, "counts from 1");
    fails_at(&format!("{SQUARE}f 1 2 -5\n"), 5, "only 4 precede");
    fails_at(&format!("{SQUARE}f 1 2 a\n"), 5, "not a vertex number");
    fails_at(&format!("{SQUARE}f 1 2 /3\n"), 5, "not a vertex number");
    fails_at(&format!("{SQUARE}f 1 2 --3\n"), 5, "not a vertex number");
    fails_at("# one \\\nv 0 0 \\\n  0\nf 1 1 2", 4, "vertex 2");
}

#[test]
fn the_written_is_short() {
    let m = Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(-0.5, 1e-7, 0.1)], triangles: vec![[0, 1, 2]] };
    let mut text = Vec::new();
    crate::io::write(&m, crate::io::Format::Obj, &mut text).unwrap();
    assert_eq!(String::from_utf8(text).unwrap(), "v 0 0 0\nv 1 0 0\nv -0.5 1e-7 0.1\nf 1 2 3\n");
}

fn attributes(text: &str) -> Attributes {
    parse(text.as_bytes()).unwrap().attributes
}

#[test]
fn numbers_behind_all_coordinates_are_colours() {
    let fractions = attributes("v 0 0 0 1 0 0.5\nv 1 0 0 0 0 0 # black\n");
    assert_eq!(fractions.color().unwrap().values, [1.0, 0.0, 0.5, 0.0, 0.0, 0.0]);
    let bytes = attributes("v 0 0 0 255 0 7 255\nv 1 0 0 0 0 0 0\n");
    assert_eq!((bytes.color().unwrap().components, bytes.color().unwrap().color(0)), (4, [1.0, 0.0, 7.0 / 255.0]));
    for none in ["v 0 0 0 1 0 0\nv 1 0 0\n", "v 0 0 0\nv 1 0 0 1 0 0\n", "v 0 0 0 -1 0 0\n", "v 0 0 0 nan 0 0\n"] {
        assert!(attributes(none).is_empty());
        assert!(notes(none)[0].starts_with("the numbers after the vertex coordinates"), "{none}");
    }
    // A fourth number alone is a weight.
    assert!(attributes("v 0 0 0 1\nv 1 0 0 1\n").is_empty() && notes("v 0 0 0 1\nv 1 0 0 1\n").is_empty());
}

#[test]
fn corners_keep_their_texture_coordinates() {
    let text =
        format!("{SQUARE}f 1 2 3\nvt 0 0\nvt 1 0 0\nf 1/1 2/2\nvt 1 1\nvt 0 1\nf 1/-4 2/2 3/3 4/-1\nf 1/9 2/0 3/x\n");
    let texture = attributes(&text).texture;
    let numbers: Vec<_> = texture.iter().map(|t| t.map(|at| at.to_array())).collect();
    assert_eq!(numbers[1..3], [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]]);
    assert_eq!(numbers.len(), 4);
    assert!([&texture[0], &texture[3]].into_iter().flatten().all(|at| at.is_nan()));
    assert_eq!(
        notes(&format!("{SQUARE}vt 0 0\nf 1 2 3\n")),
        ["1 pair of texture coordinates that no face uses is left out"]
    );
}

#[test]
fn normals_of_corners_are_added_up() {
    let text = format!("{SQUARE}vn 1 0 0\nvn 0 2 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//-1\n");
    let normals = attributes(&text).normals();
    let both = DVec3::new(1.0, 1.0, 0.0).normalize();
    assert!(normals.iter().zip([both, DVec3::X, both, DVec3::Y]).all(|(n, m)| n.distance(m) < 1e-12), "{normals:?}");
    assert_eq!(attributes(&format!("{SQUARE}f 1//1 2//2 3//3\n")).normals(), []);
}

#[test]
fn triangles_have_the_material_of_their_face() {
    let text =
        format!("{SQUARE}f 1 2 3\nusemtl a b\nf 1 2\nf 1 2 3 4\nusemtl c\nusemtl d\nf 1 2 3\nusemtl a b\nf 1 2 3\n");
    let materials = attributes(&text).materials.unwrap();
    assert_eq!(materials.list, ["a b", "c", "d"].map(Material::named));
    assert_eq!(materials.of_triangle, [NONE, 0, 0, 2, 0]);
}

#[test]
fn objects_and_groups_keep_their_names() {
    let text = format!(
        "{SQUARE}f 1 2 3\no one\nf 1 2 3 4\ng  a b\nusemtl red\nf 2 3 4\no two\nf 1 2 4\no one\ng\nusemtl\nf 1 3 4\n"
    );
    let first = parse(text.as_bytes()).unwrap();
    let parts = first.attributes.parts.clone().unwrap();
    let part = |object: &str, group: &str| Part { object: object.into(), group: group.into() };
    assert_eq!(parts.list, [part("one", ""), part("one", "a b"), part("two", "")]);
    assert_eq!(parts.of_triangle, [NONE, 0, 0, 1, 2, 0]);
    assert_eq!(first.attributes.materials.as_ref().unwrap().of_triangle, [NONE, NONE, NONE, 0, 0, NONE]);
    let mut written = Vec::new();
    crate::io::write_with_attributes(&first.mesh, &first.attributes, crate::io::Format::Obj, &mut written).unwrap();
    let written = String::from_utf8(written).unwrap();
    assert!(
        written.ends_with("f 1 2 3\no one\nf 1 2 3\nf 1 3 4\nf 1 3 4\ng a b\nusemtl red\nf 2 3 4\no two\nf 1 2 4\n"),
        "{written}"
    );
    assert_eq!(attributes(&written).parts.unwrap().of_triangle, [NONE, 0, 0, 0, 1, 2]);
    // A single part without a name is not kept.
    assert_eq!(attributes(&format!("{SQUARE}o\nf 1 2 3\n")).parts, None);
}

/// The corner positions of all faces, as tobj reads them.
fn by_tobj(text: &str) -> Vec<Vec<[f32; 3]>> {
    let options = tobj::LoadOptions::default();
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials).unwrap();
    let mut faces = Vec::new();
    for m in models.iter().map(|m| &m.mesh) {
        let place = |&v: &u32| [0, 1, 2].map(|k| m.positions[3 * v as usize + k]);
        let sizes = if m.face_arities.is_empty() { vec![3; m.indices.len() / 3] } else { m.face_arities.clone() };
        let mut rest = &m.indices[..];
        for size in sizes {
            let (face, others) = rest.split_at(size as usize);
            faces.push(face.iter().map(place).collect());
            rest = others;
        }
    }
    faces
}

proptest! {
    #[test]
    fn tobj_reads_the_same(
        points in prop::collection::vec(prop::array::uniform3(-1e3f32..1e3), 3..20),
        faces in prop::collection::vec((prop::collection::vec(0usize..1000, 3..4), 0u8..5), 1..30),
    ) {
        let mut text: String = points.iter().map(|[x, y, z]| format!("v {x} {y} {z}\nvt 0 0\nvn 0 0 1\n")).collect();
        for (i, (corners, form)) in faces.iter().enumerate() {
            if i % 7 == 3 {
                text.push_str(&format!("o part{i}\n"));
            }
            text.push('f');
            for c in corners {
                let v = c % points.len() + 1;
                text.push_str(&match form {
                    0 => format!(" {v}"),
                    1 => format!(" {v}/1"),
                    2 => format!(" {v}//1"),
                    3 => format!(" {v}/1/1"),
                    _ => format!(" -{}", points.len() + 1 - v),
                });
            }
            text.push('\n');
        }
        let ours = mesh(&text);
        let places: Vec<Vec<[f32; 3]>> = ours.triangles.iter()
            .map(|t| t.iter().map(|&v| ours.positions[v as usize].as_vec3().to_array()).collect())
            .collect();
        prop_assert_eq!(places, by_tobj(&text));
    }
}

#[test]
fn tetrahedra_as_polygons_are_read_as_their_outside() {
    // An octahedron, split into one tetrahedron per face at its centre.
    let corners = "v 0 0 0\nv 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n";
    let sides = [[2, 4, 6], [4, 3, 6], [3, 5, 6], [5, 2, 6], [4, 2, 7], [3, 4, 7], [5, 3, 7], [2, 5, 7]];
    // A second shell around it, so that most triangles lie between two tetrahedra.
    let outer = "v 3 0 0\nv -3 0 0\nv 0 3 0\nv 0 -3 0\nv 0 0 3\nv 0 0 -3\n";
    let mut text = [corners, outer].concat();
    for [a, b, c] in sides {
        let [d, e, f] = [a, b, c].map(|v| v + 6);
        for [p, q, r, s] in [[1, a, b, c], [a, b, c, d], [b, c, d, e], [c, d, e, f]] {
            text += &format!("f {p} {q} {r} {s}\n");
        }
    }
    let read = parse(text.as_bytes()).unwrap();
    assert!(read.mesh.triangles.iter().flatten().all(|&v| v > 0), "no triangle has the middle");
    assert_eq!(read.notes, ["32 polygons are the tetrahedra of a volume: only its outer surface is used"]);
}
