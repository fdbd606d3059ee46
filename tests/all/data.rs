//! Checks that the models in `data/` are what `cargo run --example make_data` writes, byte for byte.

#[path = "../../examples/make_data/shapes/mod.rs"]
mod shapes;

use spectral_remesh::stages::pipeline::remesh;
use spectral_remesh::{Density, Options};
use std::path::Path;

#[test]
fn the_models_are_what_the_program_writes() {
    for model in shapes::all() {
        model.audit();
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(model.file);
        let file = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let same = file == model.bytes().expect("a model that can be written");
        assert!(same, "{} differs; run `cargo run --example make_data`", path.display());
        assert!(file.len() < 500_000, "{} has {} bytes", path.display(), file.len());
    }
}

/// The wall of the shell is a sixth of the spacing thick: with some samples its faces intersect, and others are tried.
#[test]
#[ignore = "slow"]
fn the_models_are_remeshed() {
    for model in shapes::all() {
        let options = Options { density: Density::Points(3000), ..Options::default() };
        let made = remesh(&model.mesh, &options, &()).expect("a mesh that can be remeshed");
        assert!(made.verified(), "{}: {:?}", model.file, made.notes);
        assert_eq!(made.mesh.positions.len(), 3000, "{}", model.file);
    }
}
