//! Makes a plan: decides once everything that is global, and sorts the points by place.

use crate::base::error::{Error, Result, Setting};
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::base::rng::{Stage, bits_at};
use crate::io::Format;
use crate::io::dense::PointFile;
use crate::io::opened::Opened;
use crate::io::spill::{Chunk, SpillWriter};
use crate::mesh::points::Points;
use crate::pipeline::{
    NormalNeighborhood, SMOOTHING_SUPPORT, SampleOptions, Survey, TileOptions, count_in_tile, has_sharp_edges, survey,
    volume,
};
use crate::prepare::flatten::{Flatness, flatness};
use crate::prepare::thin::{Thinned, Wanted};
use crate::spatial::kdtree::Neighbors;
use crate::spectral::lattice::{BlockBox, place_of};
use crate::spectral::measure::RADIUS;
use crate::tiles::folder::TileFolder;
use crate::tiles::plan::{Plan, PlanOptions};
use crate::tiles::points::{CELLS, blocks_of, bucket_of, points_of};
use crate::tiles::watch::OfTile;
use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;
use std::path::Path;

/// Number of points of the outline.
const OUTLINE: usize = 100_000;

/// Factor by which blocks are wider than the first guess of the kernel width requires, so that the kernel may grow.
const ROOM: f64 = 1.1;

/// Number of points per sample that suffice.
const OF_SAMPLE: usize = 3;

/// Before all points are scanned, about this many samples are counted, in at most this many rounds, until the count is this
/// close to the wanted one.
const COUNTED: f64 = 50_000.0;
const ROUNDS: usize = 3;
const NEAR_ENOUGH: f64 = 0.05;

/// Factor for slightly more samples than wanted: in the end some can be removed, but none added.
const MORE: f64 = 1.004;

/// Approximate number of points per sample once a cloud is thinned, and the bytes that each of these points takes in the
/// end.
const POINTS_PER_SAMPLE: f64 = 4.4;
const BYTES_PER_POINT: f64 = 290.0;

/// Minimum number of buckets along each axis to which a memory limit shrinks a tile: with fewer, nearly all work would be
/// for the blocks around it.
const SMALLEST: i32 = 2;

/// Reads the file at `input` and makes a plan for it in `folder`.
///
/// # Errors
/// [`Error::File`] if a file cannot be read or written, or cannot be read in pieces; [`Error::Format`] with the place of
/// what is wrong in it; [`Error::Mesh`] if no surface passes through its points; [`Error::Option`] for options that are not
/// possible tile by tile; [`Error::Cancelled`] if the monitor asks for it.
pub fn make_plan(
    input: &Path,
    format: Option<Format>,
    folder: &TileFolder,
    options: &PlanOptions,
    monitor: &dyn Monitor,
) -> Result<Plan> {
    let SampleOptions { density, scan_only, seed, sweeps, cloud, .. } = &options.sample;
    refuse_impossible(&options.sample)?;
    let file = PointFile::open(input, format)?.ok_or_else(|| not_in_pieces(input))?;
    folder.forget()?;
    monitor.stage("read");
    let wanted = wanted(&options.sample);
    let name = input.display().to_string();
    let Survey { outline, is_sided, is_thick, sigma } =
        survey(&some_points(&file, wanted)?, *density, cloud, *seed, &OfTile(monitor)).map_err(|e| e.in_file(&name))?;
    check(monitor)?;
    let sampling = TileOptions {
        sigma,
        cell: ROOM * sigma * RADIUS / 2.0,
        seed: *seed,
        sweeps: (!scan_only).then_some(*sweeps),
        smooth: cloud.smoothing(),
        is_sided,
        is_sharp: options.sharp_edges && has_sharp_edges(&outline, &OfTile(monitor))?,
    };
    monitor.stage("sort");
    let (chunks, sorted) = sorted(&file, wanted, folder, sampling.block(), monitor)?;
    let Opened { format, head, length, .. } = file.file;
    let mut plan = Plan {
        input: name,
        points: sorted.inside,
        notes: sorted.notes(),
        wanted: density.points(),
        is_thick,
        sampling,
        tiles: vec![],
        tile: 1,
        lowest: [0; 3],
        format,
        length,
        chunks,
    };
    folder.write_context(&head, &outline)?;
    monitor.stage("count");
    calibrate(&mut plan, folder, cloud.smooth.is_none(), monitor)?;
    cut(&mut plan, &outline, options);
    folder.write_plan(&plan)?;
    Ok(plan)
}

/// Returns whether [`make_plan`] can make a plan for the file at `input` with these options.
pub fn can_plan(input: &Path, format: Option<Format>, options: &SampleOptions) -> bool {
    refuse_impossible(options).is_ok() && matches!(PointFile::open(input, format), Ok(Some(_)))
}

fn not_in_pieces(input: &Path) -> Error {
    Error::File {
        file: input.display().to_string(),
        cause: "it cannot be read in pieces: only points in binary PLY, LAS, LAZ, E57 and text (XYZ) can".into(),
        remedy: "convert it, or read it as a whole".into(),
    }
}

fn refuse_impossible(options: &SampleOptions) -> Result<()> {
    if options.sigma_n.is_finite() {
        return Err(impossible(Setting::SigmaN, "tiles are sampled evenly"));
    }
    if !options.signals.is_empty() {
        return Err(impossible(Setting::Signals, "tiles are sampled evenly"));
    }
    let setting = match (options.cloud.fit, options.cloud.neighborhood) {
        (Some(_), _) => Some(Setting::NormalFit),
        (_, Some(NormalNeighborhood::Count(_))) => Some(Setting::NormalNeighbors),
        (_, Some(NormalNeighborhood::Radius(_))) => Some(Setting::NormalRadius),
        _ => None,
    };
    if let Some(setting) = setting {
        return Err(impossible(setting, "the normals of tiles are those of planes through a few neighbours"));
    }
    if options.levels.is_some() {
        return Err(impossible(Setting::Levels, "tiles are in no progressive order"));
    }
    Ok(())
}

/// Returns which points of a file are wanted: of one with levels of detail, the coarser ones suffice.
fn wanted(sample: &SampleOptions) -> Wanted {
    Wanted { points: sample.density.points().map(|samples| OF_SAMPLE * samples), within: sample.bounds() }
}

/// Returns some points of a file, spread over all that are wanted.
fn some_points(file: &PointFile, wanted: Wanted) -> Result<Points> {
    let wanted = Wanted { points: Some(OUTLINE), ..wanted };
    let (thinned, rows) = file.thinned(wanted)?;
    thinned.refuse_empty(&wanted)?;
    let table = &file.table;
    let seen = || rows.chunks_exact(table.row).map(|row| table.rows.look(row));
    let normals: Vec<DVec3> = seen().map(|s| s.normal).collect();
    let has_normals = normals.iter().any(|n| *n != DVec3::ZERO);
    Points::new(seen().map(|s| s.position).collect(), if has_normals { normals } else { Vec::new() })
}

/// Writes the wanted points of a file to the folder, sorted by bucket. Returns their chunks, and what was left out.
fn sorted(
    file: &PointFile,
    wanted: Wanted,
    folder: &TileFolder,
    block: f64,
    monitor: &dyn Monitor,
) -> Result<(Vec<Chunk>, Thinned)> {
    let mut spill = SpillWriter::create(&folder.points())?;
    let (mut points, mut inside) = (0, 0);
    let levels = file.read(&wanted, &mut |first, rows| {
        check(monitor)?;
        for (row, number) in rows.chunks_exact(file.table.row).zip(first as u32..) {
            let place = file.table.rows.look(row).position;
            if wanted.contains(place) {
                spill.push(bucket_of(place_of(place, block)).to_array(), &number.to_le_bytes(), row)?;
                inside += 1;
            }
        }
        points = first + rows.len() / file.table.row;
        monitor.progress(first as f64 / file.table.points as f64);
        Ok(())
    })?;
    let points = if levels.is_some() { file.table.points } else { points };
    Ok((spill.finish()?, Thinned { points, levels, inside, bounds: None, cell: 0.0, numbers: Vec::new() }))
}

/// Finds the kernel width by scanning some of the buckets, and whether there is noise.
fn calibrate(plan: &mut Plan, folder: &TileFolder, may_smooth: bool, monitor: &dyn Monitor) -> Result<()> {
    let outline = folder.outline()?;
    let counts = outline_counts(outline.positions(), plan.sampling.block());
    let chosen = chosen_buckets(plan, &counts);
    if may_smooth && let Some(most) = chosen.iter().max_by_key(|bucket| counts[&bucket.to_array()]) {
        look_for_noise(plan, folder, blocks_of(*most), monitor)?;
    }
    let Some(wanted) = plan.wanted else { return Ok(()) };
    let (all, some): (usize, usize) =
        (counts.values().sum(), chosen.iter().map(|bucket| counts[&bucket.to_array()]).sum());
    for _ in 0..ROUNDS {
        check(monitor)?;
        let count = |bucket: &IVec3| {
            let tile = blocks_of(*bucket);
            let points = points_of(folder, plan, tile.grown(IVec3::ONE), CELLS, monitor)?;
            count_in_tile(points, tile, &plan.sampling, &outline, &OfTile(monitor))
        };
        let found: Vec<usize> = parallel::each(&chosen, count).into_iter().collect::<Result<_>>()?;
        let share = found.iter().sum::<usize>() as f64 * (all as f64 / some.max(1) as f64) / (MORE * wanted as f64);
        // On a surface the number of samples is proportional to the inverse square of the width.
        plan.sampling.sigma = (plan.sampling.sigma * share.sqrt()).min(plan.sampling.cell * 2.0 / RADIUS);
        if (share - 1.0).abs() < NEAR_ENOUGH {
            break;
        }
    }
    Ok(())
}

/// Returns the number of outline points in each bucket.
fn outline_counts(outline: &[DVec3], block: f64) -> FxHashMap<[i32; 3], usize> {
    let mut counts = FxHashMap::default();
    for &p in outline {
        *counts.entry(bucket_of(place_of(p, block)).to_array()).or_insert(0) += 1;
    }
    counts
}

/// Draws random buckets that contain enough of the samples to estimate the total number.
fn chosen_buckets(plan: &Plan, counts: &FxHashMap<[i32; 3], usize>) -> Vec<IVec3> {
    let mut buckets: Vec<[i32; 3]> = counts.keys().copied().collect();
    let lot = |place: &[i32; 3]| {
        let [x, y, z] = place.map(|x| u64::from(x as u32));
        (bits_at(plan.sampling.seed, Stage::Counts, (z as u32, x << 32 | y)), *place)
    };
    buckets.sort_unstable_by_key(lot);
    let all: usize = counts.values().sum();
    let enough = all as f64 * COUNTED / plan.wanted.unwrap_or(0).max(1) as f64;
    let mut sum = 0;
    let is_missing = |bucket: &[i32; 3]| {
        let missing = (sum as f64) < enough;
        sum += counts[bucket];
        missing
    };
    buckets.into_iter().take_while(is_missing).map(IVec3::from).collect()
}

/// Determines how noisy some of the points are, and the support radius that this requires.
fn look_for_noise(plan: &mut Plan, folder: &TileFolder, blocks: BlockBox, monitor: &dyn Monitor) -> Result<()> {
    let positions: Vec<DVec3> = points_of(folder, plan, blocks, CELLS, monitor)?.iter().map(|p| p.position).collect();
    match flatness(&positions, &Neighbors::new(&positions)) {
        Flatness::AtOnce => return Ok(()),
        Flatness::NotQuite => {}
        Flatness::At(_) => plan.is_thick = true,
        Flatness::Never => return Err(volume(plan.points).in_file(&plan.input)),
    }
    plan.sampling.smooth = Some(SMOOTHING_SUPPORT);
    Ok(())
}

/// Cuts the plan into tiles that are as large as memory allows, and no fewer than wanted.
fn cut(plan: &mut Plan, outline: &Points, options: &PlanOptions) {
    let counts = outline_counts(outline.positions(), plan.sampling.block());
    let all: usize = counts.values().sum();
    let expected = plan.wanted.map_or(plan.points as f64, |wanted| POINTS_PER_SAMPLE * wanted as f64);
    let bytes = BYTES_PER_POINT * expected.min(plan.points as f64) / all.max(1) as f64;
    let buckets: Vec<IVec3> = plan.buckets().map(|chunks| chunks[0].place.into()).collect();
    let lowest = buckets.iter().copied().reduce(IVec3::min).unwrap_or_default();
    let extent = buckets.iter().map(|b| (b - lowest).max_element()).max().unwrap_or(0);
    plan.lowest = lowest.to_array();
    for parts in 1.. {
        plan.tile = extent / parts + 1;
        let tile = |b: &IVec3| ((b - lowest) / plan.tile).to_array();
        plan.tiles = buckets.iter().map(tile).collect();
        plan.tiles.sort_unstable();
        plan.tiles.dedup();
        let needed = |number: usize| {
            let blocks = plan.sampling.needed(plan.tile_box(number));
            let inside = |bucket: &[i32; 3]| blocks.touches(blocks_of((*bucket).into()));
            bytes * counts.iter().filter(|(bucket, _)| inside(bucket)).map(|(_, count)| *count as f64).sum::<f64>()
        };
        let fits = || (0..plan.tiles.len()).all(|number| needed(number) <= options.memory as f64);
        let is_enough = plan.tiles.len() >= options.tiles;
        if plan.tile == 1 || is_enough && (plan.tile <= SMALLEST || fits()) {
            return;
        }
    }
}

/// Returns the error for an option that is not possible tile by tile.
fn impossible(option: Setting, cause: &str) -> Error {
    Error::Option { option, cause: cause.into(), remedy: "leave it out, or sample in memory".into() }
}
