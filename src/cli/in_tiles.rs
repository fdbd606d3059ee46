//! Clouds that are sampled tile by tile, and whose meshes are made piece by piece, in temporary files.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::cli::args::{MeshFile, OutOfCore, Remeshing, Sampling, Voice};
use crate::cli::out_of_core::{Place, announce, is_large};
use crate::cli::outputs::Outputs;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::{Density, Grading, SampleDensity, SampleOptions, Sampled};
use crate::surface::features::Features;
use crate::tiles::{PlanOptions, TileFolder, can_plan, make_plan, merge, merge_mesh, mesh_pieces, sample_tiles};
use std::fs;
use std::path::Path;

/// Bytes that remeshing a cloud in memory takes for each vertex of the result.
const BYTES_PER_VERTEX: u64 = 3000;

/// Whether a job is done tile by tile: if that is wanted, or if its file is larger than the memory for it and can be.
pub(super) fn is_sampled_in_tiles(job: &Sampling) -> bool {
    job.out_of_core.wanted
        || is_large(&job.input, &job.out_of_core) && can_plan(&job.input.path, job.input.format, &job.options)
}

/// Samples the file of a job tile by tile.
pub(super) fn sample_in_tiles(job: &Sampling, monitor: &dyn Monitor) -> Result<Sampled> {
    let work = Work { input: &job.input, output: &job.output, wanted: &job.out_of_core, voice: job.run.voice };
    let merged = |folder: &TileFolder| {
        monitor.stage("merge");
        merge(folder)
    };
    work.done(&job.options, merged, monitor)
}

/// The mesh of a job whose file is a cloud, made piece by piece, if it is too large for the memory and can be made so; else
/// `None`.
pub(super) fn mesh_in_pieces(job: &Remeshing, outputs: &Outputs, monitor: &dyn Monitor) -> Result<Option<Mesh>> {
    let can_be = |options: &SampleOptions| !outputs.are_tiles && can_plan(&job.input.path, job.input.format, options);
    let Some(options) = in_pieces(job).filter(can_be) else { return Ok(None) };
    let work = Work { input: &job.input, output: &job.output.path, wanted: &job.out_of_core, voice: job.run.voice };
    let mesh = |folder: &TileFolder| {
        mesh_pieces(folder, &[], monitor)?;
        monitor.stage("merge");
        merge_mesh(folder)
    };
    work.done(&options, mesh, monitor).map(Some)
}

/// How the samples of a mesh are drawn that is too large for the memory, if pieces can be what the job asks for.
fn in_pieces(job: &Remeshing) -> Option<SampleOptions> {
    let (surface, cloud) = (&job.options.surface, &job.options.cloud);
    let Density::Points(wanted) = surface.density else { return None };
    let is_plain = surface.grading == Grading::Even
        && matches!(surface.features, Features::Automatic | Features::Smooth)
        && surface.part.is_none()
        && surface.max_error.is_none()
        && surface.optimize
        && cloud.fill_holes == 0.0
        && job.levels.is_empty()
        && job.sizing.is_none();
    let is_too_large = BYTES_PER_VERTEX * wanted as u64 > job.out_of_core.memory();
    (is_plain && is_too_large).then(|| SampleOptions {
        density: SampleDensity::Points(wanted),
        seed: surface.seed,
        cloud: cloud.clone(),
        ..SampleOptions::default()
    })
}

/// A job that is done in a folder of tiles.
struct Work<'a> {
    input: &'a MeshFile,
    output: &'a Path,
    wanted: &'a OutOfCore,
    voice: Voice,
}

impl Work<'_> {
    /// What `last` makes of the folder once all tiles are sampled.
    fn done<T>(
        &self,
        sample: &SampleOptions,
        last: impl FnOnce(&TileFolder) -> Result<T>,
        monitor: &dyn Monitor,
    ) -> Result<T> {
        let options = PlanOptions { sample: sample.clone(), memory: self.wanted.memory(), tiles: 1 };
        let place = Place::of(self.output, self.wanted)?;
        let folder = place.folder()?;
        let is_begun = self.wanted.resume && folder.is_of(&self.input.path, &options);
        if !is_begun {
            let size = fs::metadata(&self.input.path).map_or(0, |found| found.len());
            announce(self.input, &place, size + size / 4, self.voice);
            make_plan(&self.input.path, self.input.format, &folder, &options, monitor)?;
            folder.note(&self.input.path, &options)?;
        }
        sample_tiles(&folder, &[], monitor)?;
        let made = last(&folder)?;
        place.clear();
        Ok(made)
    }
}
