//! The Rust of `docs/library.md`, compiled and run.

use spectral_remesh::io::file::{read_file, write_file};
use spectral_remesh::transfer::vertex::carry;
use spectral_remesh::{Density, Options, remesh};
use std::path::Path;

pub fn clean(from: &Path, to: &Path) -> spectral_remesh::Result<bool> {
    let input = read_file(from, None)?;
    let options = Options { density: Density::Points(2000), ..Options::default() };
    let result = remesh(&input.mesh, &options, &())?;
    let carried = carry(&input.mesh, &input.attributes, &result.mesh);
    write_file(to, &result.mesh, &carried.attributes, None)?;
    Ok(result.verified())
}

use spectral_remesh::{CloudOptions, Points, Remeshed, mesh_of_points};

pub fn connect(points: &Points) -> spectral_remesh::Result<Remeshed> {
    let made = mesh_of_points(points, &CloudOptions::default(), &())?;
    let options = Options { density: Density::Points(2000), of_points: true, ..Options::default() };
    remesh(&made.mesh, &options, &())
}

#[test]
fn the_page_has_this_code() {
    let page = include_str!("../../docs/library.md");
    let blocks: Vec<&str> = page.split("```rust\n").skip(1).filter_map(|rest| rest.split("\n```").next()).collect();
    assert_eq!(blocks.len(), 2);
    blocks.iter().for_each(|block| assert!(include_str!("library.rs").contains(block), "{block}"));
}

#[test]
fn a_file_is_cleaned() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("blob.ply");
    let input = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/blob.obj");
    assert_eq!(clean(&input, &output), Ok(true));
    assert_eq!(read_file(&output, None).unwrap().mesh.positions.len(), 2000);
}

#[test]
fn points_are_connected() {
    let positions = crate::common::sphere(4, glam::DVec3::ZERO, 1.0).positions;
    let made = connect(&Points { positions, normals: vec![] }).unwrap();
    assert!(made.verified());
    assert_eq!(crate::common::audit(&made.mesh).vertices, 2000);
}
