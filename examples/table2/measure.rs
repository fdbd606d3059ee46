//! How much of a surface is lost if it is reconstructed from a part of its points: those that the scan keeps, random ones,
//! and one for each voxel of a grid.

use glam::DVec3;
use spectral_remesh::base::rng::{Rng, Stage, stream};
use spectral_remesh::quality::distance::distance;
use spectral_remesh::{Density, Mesh, Points, ReconstructOptions, Result, SampleOptions, reconstruct, sample_points};
use std::collections::BTreeMap;

/// σn of the table.
const SIGMA_N: f64 = 0.75;

/// Points on each surface that their distance is measured at.
const SAMPLES: usize = 20_000;

/// RMS and Hausdorff distance, in units of which the diagonal of the bounding box has 100.
#[derive(Debug, Clone, Copy)]
pub struct Lost {
    pub rms: f64,
    pub hausdorff: f64,
}

/// What is lost with as many points as the scan keeps for one σp.
#[derive(Debug)]
pub struct Row {
    pub sigma_p: f64,
    pub points: usize,
    pub ours: Lost,
    pub random: Lost,
    pub voxels: Lost,
}

/// The rows of the table for a model, scaled to a bounding box with a diagonal of 100, and widths of the kernel.
pub fn rows(model: &Points, widths: &[f64], resolution: Option<f64>) -> Result<Vec<Row>> {
    let points = scaled(model);
    let whole = reconstruct(&points, &ReconstructOptions { resolution, ..Default::default() }, &())?;
    let same = ReconstructOptions { resolution: Some(whole.resolution), ..Default::default() };
    let lost = |part: &[u32]| {
        let made = reconstruct(&part_of(&points, part), &same, &())?.mesh;
        Ok(lost(&made, &whole.mesh))
    };
    let row = |&sigma_p: &f64| {
        let density = Density::SigmaP(sigma_p);
        let options = SampleOptions { density, sigma_n: SIGMA_N, scan_only: true, ..SampleOptions::default() };
        let kept = sample_points(&points, &options, &())?.indices.expect("a subset has numbers");
        let random = lost(&random(points.positions.len(), kept.len()))?;
        let voxels = lost(&voxels(&points.positions, kept.len()))?;
        Ok(Row { sigma_p, points: kept.len(), ours: lost(&kept)?, random, voxels })
    };
    widths.iter().map(row).collect()
}

fn lost(made: &Mesh, whole: &Mesh) -> Lost {
    let d = distance(made, whole, SAMPLES, 0).expect("both have triangles");
    // Percents of a diagonal that is about 100.
    Lost { rms: d.rms, hausdorff: d.hausdorff }
}

fn scaled(points: &Points) -> Points {
    let lowest = points.positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let highest = points.positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let size = 100.0 / lowest.distance(highest);
    Points {
        positions: points.positions.iter().map(|p| size * (*p - lowest)).collect(),
        normals: points.normals.clone(),
    }
}

fn part_of(points: &Points, part: &[u32]) -> Points {
    let of = |list: &[DVec3]| part.iter().map(|&i| list[i as usize]).collect();
    Points { positions: of(&points.positions), normals: of(&points.normals) }
}

/// `wanted` of `count` numbers at random.
fn random(count: usize, wanted: usize) -> Vec<u32> {
    let mut rng = stream(1, Stage::Scan);
    let mut drawn: Vec<(u64, u32)> = (0..count as u32).map(|i| (rng.next_u64(), i)).collect();
    drawn.sort_unstable();
    drawn.truncate(wanted);
    drawn.into_iter().map(|d| d.1).collect()
}

/// The point nearest to the middle of each voxel that has some, for the voxels with which these are about `wanted`.
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
