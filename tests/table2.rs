//! The idea of the paper's Table 2: what is lost of a surface that is reconstructed from the points that the scan keeps
//! grows with σp, and is less than with as many points chosen at random or one a voxel.

mod common;
#[path = "../examples/table2/measure.rs"]
mod measure;

use common::{Ends, grid};
use glam::dvec3;
use measure::{Lost, Row, rows};
use spectral_remesh::points_of_mesh;
use std::f64::consts::TAU;

#[test]
fn less_is_lost_with_the_points_that_the_scan_keeps() {
    // A ring with bumps, whose points are half as far apart as those that the narrowest kernel keeps.
    let bumpy = grid(520, 66, Ends::Joined, Ends::Joined, |u, v| {
        let (a, b) = (TAU * u, TAU * v);
        let small = 4.0 + 0.5 * (24.0 * a).sin() * (3.0 * b).cos();
        let r = 31.0 + small * b.cos();
        dvec3(r * a.cos(), r * a.sin(), small * b.sin())
    });
    let rows = rows(&points_of_mesh(&bumpy), &[0.5, 0.75, 1.0], Some(0.65)).unwrap();
    let figures: [fn(&Lost) -> f64; 2] = [|lost| lost.rms, |lost| lost.hausdorff];
    for figure in figures {
        assert!(rows.is_sorted_by(|a, b| figure(&a.ours) < figure(&b.ours)), "{rows:#?}");
        let is_best = |row: &Row| figure(&row.ours) < figure(&row.random).min(figure(&row.voxels));
        assert!(rows.iter().all(is_best), "{rows:#?}");
    }
    assert!(rows.is_sorted_by(|a, b| a.sigma_p < b.sigma_p && a.points > b.points));
}
