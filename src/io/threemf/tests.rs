use super::*;
use crate::io::bytes::samples::{fault, tetrahedron};
use crate::io::content::Content;
use glam::DVec3;
use std::io::Write;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn archive(files: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in files {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

const MESH: &str = "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' z='0'/>\
                    </vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>";

fn model(resources: &str, build: &str) -> String {
    format!("<?xml version='1.0'?><model unit='inch'><resources>{resources}</resources><build>{build}</build></model>")
}

fn simple(resources: &str, build: &str) -> Vec<u8> {
    archive(&[(MODEL, &model(resources, build))])
}

#[test]
fn objects_are_put_together_in_their_places() {
    let part = model(&format!("<object id='7'>{MESH}</object>"), "");
    let root = model(
        &format!(
            "<object id='1'>{MESH}</object><object id='2'><components><component objectid='1'/>\
             <component objectid='7' p:path='/3D/part.model' transform='-1 0 0 0 1 0 0 0 1 0 0 2'/></components></object>"
        ),
        "<item objectid='2' transform='1 0 0 0 1 0 0 0 1 5 0 0'/>",
    );
    let relations =
        "<Relationships><Relationship Target='/3D/a.model' Id='r' Type='http://x/3dmodel'/></Relationships>";
    let bytes = archive(&[(RELATIONS, relations), ("3D/a.model", &root), ("3D/part.model", &part)]);
    assert!(has_signature(&bytes));
    let read = parse(&bytes).unwrap();
    let place = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let first = [place(5.0, 0.0, 0.0), place(6.0, 0.0, 0.0), place(5.0, 1.0, 0.0)];
    let second = [place(5.0, 0.0, 2.0), place(4.0, 0.0, 2.0), place(5.0, 1.0, 2.0)];
    assert_eq!(read.mesh.positions, [first, second].concat());
    // A mirrored object keeps its outside.
    assert_eq!(read.mesh.triangles, [[0, 1, 2], [3, 5, 4]]);
}

#[test]
fn objects_are_read_if_nothing_is_built() {
    assert_eq!(parse(&simple(&format!("<object id='3'>{MESH}</object>"), "")).unwrap().mesh.triangles.len(), 1);
}

#[test]
fn colours_of_triangles_are_those_of_vertices() {
    let colored = MESH.replace("v3='2'", "v3='2' pid='4' p1='0' p2='1' p3='0'");
    let group = "<m:colorgroup id='4'><m:color color='#FF0000'/><m:color color='#00FF0080'/></m:colorgroup>";
    let objects = format!("{group}<object id='1'>{MESH}</object><object id='2'>{colored}</object>");
    let read = parse(&simple(&objects, "<item objectid='1'/><item objectid='2'/>")).unwrap();
    let color = read.attributes.color().unwrap();
    assert_eq!((color.components, color.of(0), color.of(3)), (4, &[255.0; 4][..], &[255.0, 0.0, 0.0, 255.0][..]));
    assert_eq!(color.of(4), [0.0, 255.0, 0.0, 128.0]);
    assert_eq!(read.notes, ["objects without colours are white"]);
    let by_object = format!("{group}<object id='1' pid='4' pindex='1'>{MESH}</object>");
    let read = parse(&simple(&by_object, "<item objectid='1'/>")).unwrap();
    assert_eq!(read.attributes.color().unwrap().of(2), [0.0, 255.0, 0.0, 128.0]);
}

#[test]
fn errors_name_the_part() {
    let object = |mesh: &str| simple(&format!("<object id='1'>{mesh}</object>"), "<item objectid='1'/>");
    for (bytes, words) in [
        (b"PK\x03\x04 and no more .model".to_vec(), "it is not a ZIP archive"),
        (archive(&[("a", "b")]), "3dmodel.model: it cannot be read"),
        (object(&MESH.replace("v3='2'", "v3='3'")), "triangle 0 of object 1"),
        (object(&MESH.replace("v3='2'", "")), "'triangle' has no v3"),
        (object(&MESH.replace("x='1'", "x='one'")), "x is 'one', not a number"),
        (object(&MESH.replace("x='1'", "x='inf'")), "not finite"),
        (object(&MESH.replace("</mesh>", "")), "not XML"),
        (simple("", "<item objectid='5'/>"), "object 5: does not exist"),
        (simple("", "<item objectid='5' transform='1 2'/>"), "twelve numbers"),
        (
            simple(
                "<object id='1'><components><component objectid='1'/></components></object>",
                "<item objectid='1'/>",
            ),
            "contains itself",
        ),
        (archive(&[(MODEL, "<model><resources>")]), "ends early"),
    ] {
        let error = parse(&bytes).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn what_would_fill_the_memory_is_refused() {
    let bytes = archive(&[(MODEL, &" ".repeat(4 << 20))]);
    assert!(fault(parse(&bytes)).1.contains("more than 256 times"));
    let mut objects = format!("<object id='1'>{MESH}</object>");
    for id in 2..31 {
        let component = format!("<component objectid='{}'/>", id - 1);
        objects += &format!("<object id='{id}'><components>{}</components></object>", component.repeat(8));
    }
    assert!(fault(parse(&simple(&objects, "<item objectid='30'/>"))).1.contains("repeats its objects too often"));
}

#[test]
fn the_same_mesh_gives_the_same_bytes() {
    let mesh = tetrahedron();
    let attributes = Attributes::default();
    let content = Content { positions: &mesh.positions, triangles: &mesh.triangles, attributes: &attributes };
    let [mut a, mut b] = [Vec::new(), Vec::new()];
    write(&content, &mut a).unwrap();
    write(&content, &mut b).unwrap();
    assert_eq!(a, b);
    assert_eq!(parse(&a).unwrap().mesh, mesh);
    for end in 0..a.len() {
        assert!(parse(&a[..end]).is_err());
    }
}
