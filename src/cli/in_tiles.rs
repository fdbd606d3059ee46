//! Clouds that are sampled tile by tile, and meshed piece by piece, in temporary files.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::cli::args::{MeshFile, OutOfCore, Remeshing, Sampling, Voice};
use crate::cli::out_of_core::{Place, announce, is_large};
use crate::cli::outputs::Outputs;
use crate::io::dense::PointFile;
use crate::job::Carry;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Density, Grading, MOST_OF_BASE, SampleDensity, SampleOptions, Sampled};
use crate::surface::features::Features;
use crate::tiles::{
    PlanOptions, TileFolder, can_plan, make_plan, merge, merge_mesh, mesh_pieces, nearest_attributes, sample_tiles,
};
use crate::transfer::vertex::Carried;
use std::fs;
use std::path::Path;

/// Memory in bytes per vertex of the result for remeshing a cloud in memory.
const BYTES_PER_VERTEX: u64 = 3000;

/// Minimum number of points per vertex: with fewer, pieces of a mesh would stay open.
const POINTS_PER_VERTEX: u64 = 3;

/// Size of temporary files in bytes, in addition to the points: per sample, and per vertex of a mesh.
const BYTES_OF_SAMPLE: u64 = 52;
const BYTES_OF_VERTEX: u64 = 180;

/// Returns whether a job is done tile by tile: if requested, or if its file is larger than its memory limit and can be
/// tiled.
pub(super) fn is_sampled_in_tiles(job: &Sampling) -> bool {
    job.out_of_core.wanted
        || is_large(&job.input, &job.out_of_core) && can_plan(&job.input.path, job.input.format, &job.options)
}

/// Samples a job's file tile by tile.
pub(super) fn sample_in_tiles(job: &Sampling, monitor: &dyn Monitor) -> Result<Sampled> {
    let work = Work { input: &job.input, output: &job.output, wanted: &job.out_of_core, voice: job.run.voice };
    let (place, folder) = work.planned(&job.options, BYTES_OF_SAMPLE, monitor)?;
    sample_tiles(&folder, &[], monitor)?;
    monitor.stage("merge");
    let sampled = merge(&folder, monitor)?;
    place.clear();
    Ok(sampled)
}

/// Returns the mesh of a job whose file is a cloud, made piece by piece, if it is too large for the memory and can be made
/// this way; else `None`.
pub(super) fn mesh_in_pieces(
    job: &Remeshing,
    outputs: &Outputs,
    monitor: &dyn Monitor,
) -> Result<Option<(Mesh, Carried)>> {
    let can_be = |options: &SampleOptions| {
        !outputs.are_tiles && is_dense(&job.input, options) && can_plan(&job.input.path, job.input.format, options)
    };
    let Some(options) = in_pieces(job).filter(can_be) else { return Ok(None) };
    let work = Work { input: &job.input, output: &job.output.path, wanted: &job.out_of_core, voice: job.run.voice };
    let (place, folder) = work.planned(&options, BYTES_OF_SAMPLE + BYTES_OF_VERTEX, monitor)?;
    if folder.plan()?.is_thick {
        place.clear();
        return Ok(None);
    }
    sample_tiles(&folder, &[], monitor)?;
    mesh_pieces(&folder, &[], monitor)?;
    monitor.stage("merge");
    let mesh = merge_mesh(&folder)?;
    let mut carried = match job.options.carry {
        Carry::Nothing => Carried::default(),
        _ => nearest_attributes(&folder, &mesh, monitor)?,
    };
    carried.leave_out(outputs.format.cannot_hold(&carried.attributes));
    place.clear();
    Ok(Some((mesh, carried)))
}

/// Returns whether a cloud has as many points as pieces of a mesh need.
fn is_dense(input: &MeshFile, options: &SampleOptions) -> bool {
    let points = PointFile::open(&input.path, input.format).ok().flatten().map_or(0, |file| file.table.points);
    points as u64 >= POINTS_PER_VERTEX * wanted(options)
}

/// Returns how to draw the samples of a mesh that is too large for the memory, if what the job asks for can be made in
/// pieces.
fn in_pieces(job: &Remeshing) -> Option<SampleOptions> {
    let (surface, cloud) = (&job.options.surface, &job.options.cloud);
    let Density::Points(wanted) = surface.density else { return None };
    let is_plain = surface.grading == Grading::Even
        && matches!(surface.features, Features::Automatic | Features::Smooth)
        && surface.part.is_none()
        && surface.max_error.is_none()
        && surface.optimize
        && cloud.fill_holes == 0.0
        && cloud.terrain != Some(true)
        && job.levels.is_empty()
        && job.sizing.is_none();
    // A base mesh, which has at most this many vertices, is made in memory in any case.
    let is_too_large = wanted > MOST_OF_BASE && BYTES_PER_VERTEX * wanted as u64 > job.out_of_core.memory();
    (is_plain && is_too_large).then(|| SampleOptions {
        density: SampleDensity::Points(wanted),
        seed: surface.seed,
        cloud: cloud.clone(),
        ..SampleOptions::default()
    })
}

/// Returns the target number of samples; 0 if it is not known.
fn wanted(options: &SampleOptions) -> u64 {
    match options.density {
        SampleDensity::Points(wanted) => wanted as u64,
        _ => 0,
    }
}

/// A job that is done in a folder of tiles.
struct Work<'a> {
    input: &'a MeshFile,
    output: &'a Path,
    wanted: &'a OutOfCore,
    voice: Voice,
}

impl Work<'_> {
    /// Returns the folder with the planned tiles, and its location. Temporary files will take `bytes_per_sample` for each
    /// sample.
    fn planned(
        &self,
        sample: &SampleOptions,
        bytes_per_sample: u64,
        monitor: &dyn Monitor,
    ) -> Result<(Place, TileFolder)> {
        let options = PlanOptions { sample: sample.clone(), memory: self.wanted.memory(), tiles: 1 };
        let place = Place::of(self.output, self.wanted)?;
        let folder = place.folder()?;
        let is_begun = self.wanted.resume && folder.is_of(&self.input.path, &options);
        if !is_begun {
            let size = fs::metadata(&self.input.path).map_or(0, |found| found.len());
            announce(self.input, &place, size + size / 4 + bytes_per_sample * wanted(sample), self.voice);
            make_plan(&self.input.path, self.input.format, &folder, &options, monitor)?;
            folder.note(&self.input.path, &options)?;
        }
        Ok((place, folder))
    }
}
