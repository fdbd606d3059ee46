//! The idea of the paper's Table 2: the loss of a surface reconstructed from the points kept by the scan grows with σp, and
//! is less than with equally many points chosen at random or one per voxel.

use crate::common::{Ends, grid};
use glam::{DVec3, dvec3};
use spectral_remesh::stages::base::rng::{Rng, Stage, stream};
use spectral_remesh::stages::pipeline::{points_of_mesh, reconstruct, sample_points};
use spectral_remesh::stages::quality::distance::distance;
use spectral_remesh::{Mesh, Points, ReconstructOptions, Result, SampleDensity, SampleOptions};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// The values of σp in the table's rows, and its σn.
const WIDTHS: [f64; 3] = [0.5, 0.75, 1.0];
const SIGMA_N: f64 = 0.75;

/// Edge length of the cells with which surfaces are extracted.
const RESOLUTION: f64 = 0.65;

/// Number of points on each surface at which their distance is measured.
const SAMPLES: usize = 20_000;

#[test]
#[ignore = "slow"]
fn less_is_lost_with_the_points_that_the_scan_keeps() {
    // A bumpy ring whose points are half as far apart as those kept with the narrowest kernel.
    let bumpy = grid(520, 66, Ends::Joined, Ends::Joined, |u, v| {
        let (a, b) = (TAU * u, TAU * v);
        let small = 4.0 + 0.5 * (24.0 * a).sin() * (3.0 * b).cos();
        let r = 31.0 + small * b.cos();
        dvec3(r * a.cos(), r * a.sin(), small * b.sin())
    });
    let rows = rows(&points_of_mesh(&bumpy)).unwrap();
    let figures: [fn(&Lost) -> f64; 2] = [|lost| lost.rms, |lost| lost.hausdorff];
    for figure in figures {
        assert!(rows.is_sorted_by(|a, b| figure(&a.ours) < figure(&b.ours)), "{rows:#?}");
        let is_best = |row: &Row| figure(&row.ours) < figure(&row.random).min(figure(&row.voxels));
        assert!(rows.iter().all(is_best), "{rows:#?}");
    }
    assert!(rows.is_sorted_by(|a, b| a.sigma_p < b.sigma_p && a.points > b.points));
}

/// RMS and Hausdorff distance, in percent of the diagonal of the bounding box.
#[derive(Debug, Clone, Copy)]
struct Lost {
    rms: f64,
    hausdorff: f64,
}

/// The loss with as many points as the scan keeps for one σp.
#[derive(Debug)]
struct Row {
    sigma_p: f64,
    points: usize,
    ours: Lost,
    random: Lost,
    voxels: Lost,
}

/// Returns the rows of the table for a model, scaled to a bounding box with a diagonal of 100.
fn rows(model: &Points) -> Result<Vec<Row>> {
    let points = scaled(model);
    let options = ReconstructOptions { resolution: Some(RESOLUTION), ..Default::default() };
    let whole = reconstruct(&points, &options, &())?;
    let lost = |part: &[u32]| {
        let made = reconstruct(&part_of(&points, part), &options, &())?.mesh;
        Ok(lost(&made, &whole.mesh))
    };
    let row = |&sigma_p: &f64| {
        let density = SampleDensity::SigmaP(sigma_p);
        let options = SampleOptions { density, sigma_n: SIGMA_N, scan_only: true, ..SampleOptions::default() };
        let kept = sample_points(&points, &options, &())?.indices.expect("a subset has numbers");
        let random = lost(&random(points.positions().len(), kept.len()))?;
        let voxels = lost(&voxels(points.positions(), kept.len()))?;
        Ok(Row { sigma_p, points: kept.len(), ours: lost(&kept)?, random, voxels })
    };
    WIDTHS.iter().map(row).collect()
}

fn lost(made: &Mesh, whole: &Mesh) -> Lost {
    let d = distance(made, whole, SAMPLES, 0).expect("both have triangles");
    // Percent of a diagonal of about 100.
    Lost { rms: d.rms, hausdorff: d.hausdorff }
}

fn scaled(points: &Points) -> Points {
    let lowest = points.positions().iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let highest = points.positions().iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let size = 100.0 / lowest.distance(highest);
    let positions = points.positions().iter().map(|p| size * (*p - lowest)).collect();
    Points::new(positions, points.normals().to_vec()).unwrap()
}

fn part_of(points: &Points, part: &[u32]) -> Points {
    let of = |list: &[DVec3]| part.iter().map(|&i| list[i as usize]).collect();
    Points::new(of(points.positions()), of(points.normals())).unwrap()
}

/// Returns `wanted` random numbers below `count`, without repetition.
fn random(count: usize, wanted: usize) -> Vec<u32> {
    let mut rng = stream(1, Stage::Scan);
    let mut drawn: Vec<(u64, u32)> = (0..count as u32).map(|i| (rng.next_u64(), i)).collect();
    drawn.sort_unstable();
    drawn.truncate(wanted);
    drawn.into_iter().map(|d| d.1).collect()
}

/// Returns the point nearest to the centre of each occupied voxel; the voxel size is chosen to give about `wanted` points.
fn voxels(positions: &[DVec3], wanted: usize) -> Vec<u32> {
    let (mut narrow, mut wide) = (1e-3, 100.0);
    for _ in 0..30 {
        let size = f64::sqrt(narrow * wide);
        if one_a_voxel(positions, size).len() > wanted {
            narrow = size;
        } else {
            wide = size;
        }
    }
    one_a_voxel(positions, narrow)
}

fn one_a_voxel(positions: &[DVec3], size: f64) -> Vec<u32> {
    let mut best: BTreeMap<[i64; 3], (f64, u32)> = BTreeMap::new();
    for (i, p) in positions.iter().enumerate() {
        let voxel = (*p / size).floor();
        let here = (p.distance_squared((voxel + 0.5) * size), i as u32);
        let entry = best.entry(voxel.to_array().map(|x| x as i64)).or_insert(here);
        if here.0 < entry.0 {
            *entry = here;
        }
    }
    best.into_values().map(|b| b.1).collect()
}
