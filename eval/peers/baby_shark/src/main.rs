//! The remesher of the crate baby_shark as a program: baby_shark SOURCE.ply TARGET.ply VERTICES
//!
//! The edge length is that with which so many vertices at hexagonal packing fill the area. Prints the seconds of
//! remeshing alone as JSON.

use baby_shark::io::{read_from_file, write_to_file};
use baby_shark::mesh::corner_table::CornerTableD;
use baby_shark::mesh::traits::Triangles;
use baby_shark::remeshing::incremental::IncrementalRemesher;
use std::path::Path;
use std::time::Instant;

const VERSION: &str = "0.3.12";

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words == ["--version"] {
        println!("{VERSION}");
        return;
    }
    let [source, target, wanted] = words.as_slice() else { panic!("expected SOURCE TARGET VERTICES") };
    let wanted: f64 = wanted.parse().expect("a number of vertices");
    let mut mesh: CornerTableD = read_from_file(Path::new(source)).expect("a mesh");
    let area: f64 = mesh.triangles().map(|t| t.get_area()).sum();
    let length = (2.0 * area / (3f64.sqrt() * wanted)).sqrt();
    let start = Instant::now();
    IncrementalRemesher::new().with_iterations_count(10).remesh(&mut mesh, length);
    let seconds = start.elapsed().as_secs_f64();
    write_to_file(&mesh, Path::new(target)).expect("the target can be written");
    println!("{{\"seconds\": {seconds}}}");
}
