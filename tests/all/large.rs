//! Meshes larger than memory, which are coarsened while they are read.

use crate::common::*;
use glam::DVec3;
use serde_json::Value;
use spectral_remesh::io::file::{read_file, write_file};
use spectral_remesh::stages::mesh::topology::topology;
use spectral_remesh::{Attribute, Attributes, Mesh, Scalar};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn remesh(folder: &Path, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_remesh")).current_dir(folder).args(words.split(' ')).output().unwrap()
}

/// Returns a temporary folder that contains a folder `temp`, and `mesh` in a file of this name.
fn folder_with(name: &str, mesh: &Mesh, attributes: &Attributes) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("temp")).unwrap();
    write_file(&folder.path().join(name), mesh, attributes, None).unwrap();
    folder
}

/// Returns a torus with the radii 1 and 0.4 and 100,000 vertices.
fn fine_torus() -> Mesh {
    torus(500, 200, 1.0, 0.4)
}

/// Remeshes the file of this name out of core to 1,000 vertices in `out.ply`, with these extra arguments, and returns the report.
fn report_of(folder: &Path, name: &str, words: &str) -> Value {
    let out = remesh(folder, &format!("{name} out.ply --points 1000 --temp temp --report r.json {words}"));
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(0), "{said}");
    // Triangles are sorted in a file only if memory is short.
    assert_eq!(said.contains("MB of temporary files"), words.contains("--memory"), "{said}");
    assert_eq!(fs::read_dir(folder.join("temp")).unwrap().count(), 0);
    serde_json::from_str(&fs::read_to_string(folder.join("r.json")).unwrap()).unwrap()
}

/// Returns the largest distance of a vertex from the torus.
fn farthest(mesh: &Mesh) -> f64 {
    let far = |p: &DVec3| ((p.truncate().length() - 1.0).hypot(p.z) - 0.4).abs();
    mesh.positions.iter().map(far).fold(0.0, f64::max)
}

#[test]
fn what_is_read_in_blocks_is_coarser_and_comes_out_like_what_is_read_as_a_whole() {
    for name in ["fine.ply", "fine.stl", "fine.obj"] {
        let folder = folder_with(name, &fine_torus(), &Attributes::default());
        let report = report_of(folder.path(), name, "--out-of-core");
        let mesh = read_file(&folder.path().join("out.ply"), None).unwrap().mesh;
        let t = topology(mesh.positions.len(), &mesh.triangles);
        assert_eq!((t.vertices, t.euler, t.components, t.is_manifold()), (1000, 0, 1, true));
        assert!(farthest(&mesh) < 0.01, "{}", farthest(&mesh));
        let read = report["input"]["topology"]["vertices"].as_u64().unwrap();
        assert!((5_000..40_000).contains(&read), "{read}");
        assert!(report["output"]["shape"]["theta_min"].as_f64().unwrap() > 38.0);
        let note = report["notes"][0].as_str().unwrap();
        assert!(note.starts_with("200000 triangles were coarsened to "), "{note}");
    }
}

#[test]
fn a_file_larger_than_the_memory_is_read_in_blocks_by_itself() {
    let folder = folder_with("fine.ply", &fine_torus(), &Attributes::default());
    let fine = report_of(folder.path(), "fine.ply", "--memory 4M");
    let coarse = report_of(folder.path(), "fine.ply", "--memory 2M");
    let vertices = |report: &Value| report["input"]["topology"]["vertices"].as_u64().unwrap();
    assert!(vertices(&coarse) < vertices(&fine), "{} {}", vertices(&coarse), vertices(&fine));
    let out = remesh(folder.path(), "fine.ply out.ply --points 100000 --memory 1M");
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("--memory: remeshing to 100000 vertices takes about"), "{said}");
}

#[test]
fn what_is_no_manifold_becomes_one() {
    // Each triangle has its own corners; the triangles are in random order, some are flipped, some occur twice; and an
    // edge has a fin.
    let mut mesh = shuffled(&soup(&fine_torus()), &mut random(3));
    for t in (0..mesh.triangles.len()).step_by(1000) {
        mesh.triangles[t].swap(0, 1);
        mesh.triangles.push(mesh.triangles[t + 1]);
    }
    let [a, b, _] = mesh.triangles[7];
    mesh.positions.push(1.01 * mesh.positions[a as usize]);
    mesh.triangles.push([a, b, mesh.positions.len() as u32 - 1]);
    let folder = folder_with("dirty.ply", &mesh, &Attributes::default());
    let report = report_of(folder.path(), "dirty.ply", "--out-of-core");
    let out = read_file(&folder.path().join("out.ply"), None).unwrap().mesh;
    let t = topology(out.positions.len(), &out.triangles);
    assert!(t.is_manifold() && t.is_oriented());
    assert!(report["input"]["topology"]["vertices"].as_u64().unwrap() < 50_000);
}

#[test]
fn attributes_of_vertices_arrive() {
    let mesh = fine_torus();
    let values = mesh.positions.iter().flat_map(|p| [if p.x > 0.0 { 255.0 } else { 0.0 }, 0.0, 0.0]).collect();
    let color = Attribute { name: "color".into(), components: 3, values, scalar: Scalar::U8 };
    let attributes = Attributes { vertex: vec![color], ..Attributes::default() };
    for name in ["fine.ply", "fine.obj"] {
        let folder = folder_with(name, &mesh, &attributes);
        report_of(folder.path(), name, "--out-of-core");
        let out = read_file(&folder.path().join("out.ply"), None).unwrap();
        let red = &out.attributes.vertex[0].values;
        let full = red.iter().copied().fold(0.0, f64::max);
        let is_wrong = |v: usize| {
            out.mesh.positions[v].x.abs() > 0.1 && (red[3 * v] > 0.5 * full) != (out.mesh.positions[v].x > 0.0)
        };
        assert_eq!((0..1000).filter(|&v| is_wrong(v)).count(), 0);
    }
}

#[test]
fn what_cannot_be_read_in_blocks_is_refused() {
    let folder = folder_with("fine.ply", &fine_torus(), &Attributes::default());
    let home = folder.path();
    fs::write(home.join("a.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap();
    fs::write(home.join("points.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    fs::write(home.join("wrong.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n4\n").unwrap();
    let bytes = fs::read(home.join("fine.ply")).unwrap();
    fs::write(home.join("short.ply"), &bytes[..bytes.len() - 100]).unwrap();
    // The last corner is out of range.
    let end = bytes.len() - 4;
    fs::write(home.join("wrong.ply"), [&bytes[..end], &[255, 255, 255, 0]].concat()).unwrap();
    // The first face claims four billion corners.
    let head = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement face 100\nproperty list uint int vertex_indices\nend_header\n";
    fs::write(home.join("long.ply"), [head.as_bytes(), &[0; 36], &[255; 4_000_000]].concat()).unwrap();
    let fails = |words: &str, status: i32, expected: &str| {
        let out = remesh(home, words);
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(status), "{said}");
        assert!(said.contains(expected), "{said}");
        assert_eq!(fs::read_dir(home.join("temp")).unwrap().count(), 0);
    };
    let line = "out.ply --points 1000 --out-of-core --temp";
    fails(&format!("a.off {line} temp"), 1, "a.off: it cannot be read in blocks: only faces in OBJ");
    fails(&format!("points.obj {line} temp"), 1, "points.obj: it cannot be read in blocks: only faces in OBJ");
    fails(&format!("wrong.obj {line} temp"), 1, "wrong.obj:5: a face uses vertex 4, but the file has only 3");
    fails(&format!("short.ply {line} temp"), 1, "short.ply, byte ");
    let cause = format!("long.ply, byte {}: a list has 4294967295 values", head.len() + 36);
    fails(&format!("long.ply {line} temp"), 1, &cause);
    fails(&format!("wrong.ply {line} temp"), 1, "there is no vertex 16777215");
    fails(&format!("fine.ply {line} nowhere"), 1, "nowhere: there is no such folder");
    fails(&format!("fine.ply {line} temp --max-error 0.1%"), 2, "--max-error: it needs the whole mesh");
    fails(&format!("fine.ply {line} temp --within 0,0,0,1,1,1"), 2, "--within: it needs the whole mesh");
}
