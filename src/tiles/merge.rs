//! Joins the samples of all tiles, and the pieces of a mesh.

use crate::base::count::counted;
use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::mesh::attributes::Attributes;
use crate::mesh::points::Points;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Sampled, TilePoint, count_notes};
use crate::spectral::subset::thin_or_fill;
use crate::surface::domain::Sample;
use crate::surface::lift::{BarePoints, Lift, Lifted};
use crate::tiles::folder::TileFolder;
use crate::tiles::joined::Joined;
use crate::tiles::nearest::attributes_near;
use crate::tiles::pieces::{Piece, pieces};

/// Joins the samples of all tiles, in the order of the input. There are usually a few more than wanted; the least important
/// are removed. Each has the attributes of the nearest point of the input, which in a subset is the sample itself.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if a tile is not sampled yet, or cannot be read;
/// [`Error::Cancelled`](crate::Error::Cancelled) if the monitor asks for it.
pub fn merge(folder: &TileFolder, monitor: &dyn Monitor) -> Result<Sampled> {
    let plan = folder.plan()?;
    let mut all: Vec<TilePoint> = Vec::new();
    for number in 0..plan.tiles.len() {
        all.extend(folder.read_samples(number)?);
    }
    all.sort_unstable_by_key(|sample| sample.number);
    if let Some(wanted) = plan.wanted.filter(|&wanted| wanted < all.len()) {
        all = most_important(&all, plan.sampling.sigma, wanted);
    }
    let mut notes = plan.notes.clone();
    notes.extend(count_notes(all.len(), plan.points, plan.wanted));
    notes.push(format!("sampled in {}", counted(plan.tiles.len(), "tile", "tiles")));
    let is_subset = plan.sampling.sweeps.is_none();
    let points = Points::from_pairs(all.iter().map(|sample| (sample.position, sample.normal)));
    let attributes = attributes_near(folder, &plan, points.positions(), monitor)?;
    let sampled = Sampled {
        points,
        indices: is_subset.then(|| all.iter().map(|sample| sample.number).collect()),
        candidates: plan.points,
        sigma_p: plan.sampling.sigma,
        wanted: plan.wanted,
        levels: Vec::new(),
        cloud: None,
        notes,
        origins: Vec::new(),
        carried: Attributes::default(),
    };
    Ok(sampled.carrying(attributes))
}

/// Joins all pieces of the mesh.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if a piece is not made yet, or cannot be read.
pub fn merge_mesh(folder: &TileFolder) -> Result<Mesh> {
    let all = pieces(&folder.plan()?).into_iter().enumerate();
    let triangles = all.filter(|(_, piece)| matches!(piece, Piece::Triangles(_)));
    let made: Vec<_> = triangles.map(|(number, _)| Ok((number, folder.read_piece(number)?))).collect::<Result<_>>()?;
    Ok(Joined::new(&made).mesh)
}

/// Returns `wanted` of the samples, without those that change the spectrum least.
fn most_important(all: &[TilePoint], sigma: f64, wanted: usize) -> Vec<TilePoint> {
    let sample = |p: &TilePoint| Sample { position: p.position, normal: p.normal, triangle: 0, size: 1.0 };
    let samples: Vec<Sample> = all.iter().map(sample).collect();
    let chosen: Vec<u32> = (0..all.len() as u32).collect();
    let surface = Lifted { surface: &BarePoints, lift: Lift::NONE };
    let kept = thin_or_fill::<_, 3>(&surface, &samples, &chosen, sigma, wanted);
    kept.into_iter().map(|i| all[i as usize]).collect()
}
