//! Writes the models of `data/`, with the same bytes every time: `cargo run --example make_data [FOLDER]`.

#![allow(clippy::disallowed_methods)]

mod shapes;

use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("data"), PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    for model in shapes::all() {
        model.audit();
        let bytes = model.bytes()?;
        std::fs::write(folder.join(model.file), &bytes)?;
        let (vertices, faces) = (model.mesh.positions.len(), model.mesh.triangles.len());
        println!("{:12} {vertices:6} vertices {faces:6} faces {:7} bytes", model.file, bytes.len());
    }
    Ok(())
}
