//! Samples clouds tile by tile and remeshes them piece by piece.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::io::Format;
use crate::io::dense::PointFile;
use crate::job::large::LargeFile;
use crate::job::large::workspace::Workspace;
use crate::job::{Carry, Outcome, RemeshOptions};
use crate::pipeline::{Grading, MOST_OF_BASE, SampleDensity, SampleOptions, Sampled, Selection};
use crate::surface::features::Features;
use crate::tiles::{
    PlanOptions, TileFolder, can_plan, make_plan, merge, merge_mesh, mesh_pieces, nearest_attributes, sample_tiles,
};
use crate::transfer::vertex::Carried;

/// Memory for remeshing a cloud in memory, in bytes per vertex of the result.
const BYTES_PER_VERTEX: u64 = 3000;

/// Minimum number of points per vertex. With fewer, pieces of a mesh have holes.
const POINTS_PER_VERTEX: u64 = 3;

/// Size of temporary files besides those of the points, in bytes per sample and per vertex of a mesh.
const BYTES_OF_SAMPLE: u64 = 52;
const BYTES_OF_VERTEX: u64 = 180;

/// Samples the points of a file tile by tile. Returns `None` for a file that is not larger than memory or of which tiles
/// cannot be made, unless all files are to be sampled in this way.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if the file or a temporary one cannot be read or written;
/// [`Error::Option`](crate::Error::Option) for options that tiles do not know;
/// [`Error::Cancelled`](crate::Error::Cancelled) if the monitor asks for it.
pub fn sample_in_tiles(file: &LargeFile, options: &SampleOptions, monitor: &dyn Monitor) -> Result<Option<Sampled>> {
    let is_done = file.out_of_core.always || file.is_large() && can_plan(file.path, file.format, options);
    if !is_done {
        return Ok(None);
    }
    let (workspace, folder) = planned(file, options, false, BYTES_OF_SAMPLE, monitor)?;
    sample_tiles(&folder, None, monitor)?;
    monitor.stage("merge");
    let sampled = merge(&folder, monitor)?;
    workspace.clear();
    Ok(Some(sampled))
}

/// Remeshes a cloud piece by piece. Returns `None` if the mesh fits into memory or pieces cannot be what the options ask for.
/// Attributes that `format` cannot hold are left out.
///
/// # Errors
/// Those of [`sample_in_tiles`].
pub fn remesh_in_pieces(
    file: &LargeFile,
    options: &RemeshOptions,
    format: Option<Format>,
    monitor: &dyn Monitor,
) -> Result<Option<Outcome>> {
    let Some(wanted) = options.surface.density.points() else { return Ok(None) };
    let fewest = POINTS_PER_VERTEX * wanted as u64;
    let can_be = |sample: &SampleOptions| points(file) >= fewest && can_plan(file.path, file.format, sample);
    let Some(sample) = in_pieces(options, wanted, file.out_of_core.memory()).filter(can_be) else { return Ok(None) };
    let sharp_edges = options.surface.features != Features::Smooth;
    let (workspace, folder) = planned(file, &sample, sharp_edges, BYTES_OF_SAMPLE + BYTES_OF_VERTEX, monitor)?;
    let plan = folder.plan()?;
    if plan.is_thick || (plan.points as u64) < fewest {
        workspace.clear();
        return Ok(None);
    }
    sample_tiles(&folder, None, monitor)?;
    mesh_pieces(&folder, None, monitor)?;
    let outcome = merge_pieces(&folder, &options.carry, format, monitor)?;
    workspace.clear();
    Ok(Some(outcome))
}

/// Joins the pieces of a mesh in a folder of tiles. Attributes that `format` cannot hold are left out.
///
/// # Errors
/// [`Error::File`](crate::Error::File) if a piece is missing or a file cannot be read;
/// [`Error::Cancelled`](crate::Error::Cancelled) if the monitor asks for it.
pub fn merge_pieces(
    folder: &TileFolder,
    carry: &Carry,
    format: Option<Format>,
    monitor: &dyn Monitor,
) -> Result<Outcome> {
    monitor.stage("merge");
    let mesh = merge_mesh(folder)?;
    let mut carried = match carry {
        Carry::Nothing => Carried::default(),
        Carry::All | Carry::AllBut(_) => nearest_attributes(folder, &mesh, monitor)?,
    };
    if let Carry::AllBut(lost) = carry {
        carried.leave_out(lost.clone());
    }
    if let Some(format) = format {
        carried.leave_out(format.cannot_hold(&carried.attributes));
    }
    monitor.stage("measure");
    let plan = folder.plan()?;
    Ok(Outcome::of_pieces(mesh, carried, plan.wanted, plan.notes))
}

/// Returns the number of points of a cloud, 0 for other files.
fn points(file: &LargeFile) -> u64 {
    PointFile::open(file.path, file.format).ok().flatten().map_or(0, |file| file.table.points as u64)
}

/// Returns how to sample for a mesh of `wanted` vertices that is too large for the memory; `None` if pieces cannot be what the
/// options ask for.
fn in_pieces(options: &RemeshOptions, wanted: usize, memory: u64) -> Option<SampleOptions> {
    let (surface, cloud) = (&options.surface, &options.cloud);
    let is_plain = surface.grading == Grading::Even
        && matches!(surface.features, Features::Automatic | Features::Smooth)
        && !matches!(surface.part, Some(Selection::Vertices(_) | Selection::Marked { .. }))
        && surface.max_error.is_none()
        && surface.optimize
        && cloud.fill_holes == 0.0
        && cloud.terrain != Some(true);
    let within = match surface.part {
        Some(Selection::Box(corners)) => Some(corners),
        _ => None,
    };
    // A base mesh is made in memory in any case.
    let is_too_large = wanted > MOST_OF_BASE && BYTES_PER_VERTEX * wanted as u64 > memory;
    (is_plain && is_too_large).then(|| SampleOptions {
        density: SampleDensity::Points(wanted),
        within,
        seed: surface.seed,
        cloud: cloud.clone(),
        ..SampleOptions::default()
    })
}

/// Plans the tiles of a job in a workspace. Its files take `bytes_per_sample` for each sample, as far as their number is known.
fn planned(
    file: &LargeFile,
    sample: &SampleOptions,
    sharp_edges: bool,
    bytes_per_sample: u64,
    monitor: &dyn Monitor,
) -> Result<(Workspace, TileFolder)> {
    let options = PlanOptions { sample: sample.clone(), memory: file.out_of_core.memory(), tiles: 1, sharp_edges };
    let workspace = Workspace::of(file)?;
    let folder = workspace.folder()?;
    let is_begun = file.out_of_core.resume && folder.is_of(file.path, &options);
    if !is_begun {
        let (bytes, samples) = (file.bytes(), sample.density.points().unwrap_or(0) as u64);
        workspace.announce(bytes + bytes / 4 + bytes_per_sample * samples, monitor);
        make_plan(file.path, file.format, &folder, &options, monitor)?;
        folder.note(file.path, &options)?;
    }
    Ok((workspace, folder))
}
