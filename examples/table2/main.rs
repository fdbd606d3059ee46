//! The paper's Table 2 with other ways to take a part of the points: what is lost of a surface that is reconstructed from
//! the points that the scan keeps, from as many random ones, and from one a voxel.
//!
//! ```text
//! cargo run --release --example table2 -- MODEL...
//! ```

mod measure;

use measure::{Lost, rows};
use spectral_remesh::io::file::read_file;
use spectral_remesh::points_of_mesh;
use std::path::Path;

fn main() -> spectral_remesh::Result<()> {
    println!("| model | σp | points | of | | scan | random | voxels |");
    println!("|---|---|---|---|---|---|---|---|");
    for name in std::env::args().skip(1) {
        let loaded = read_file(Path::new(&name), None)?;
        let is_cloud = loaded.mesh.triangles.is_empty();
        let points = if is_cloud { loaded.into_points() } else { points_of_mesh(&loaded.mesh) };
        for row in rows(&points, &[0.5, 0.75, 1.0], None)? {
            let line = |what: &str, f: fn(&Lost) -> f64| {
                let [ours, random, voxels] = [row.ours, row.random, row.voxels].map(|lost| f(&lost));
                let (sigma_p, kept, all) = (row.sigma_p, row.points, points.positions.len());
                println!("| {name} | {sigma_p} | {kept} | {all} | {what} | {ours:.4} | {random:.4} | {voxels:.4} |");
            };
            line("RMS", |lost| lost.rms);
            line("Hausdorff", |lost| lost.hausdorff);
        }
    }
    Ok(())
}
