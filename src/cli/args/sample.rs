//! The arguments of `remesh sample`.

use crate::cli::args::shared::{MemoryArgs, MeshFile, NormalArgs, Run, RunArgs, support_help};
use crate::cli::args::stop::{Stop, refused};
use crate::cli::args::words::{PropertyWidth, no_density, property_width, samples, within};
use crate::io::Format;
use crate::job::large::OutOfCore;
use crate::job::settings::{NormalSettings, SampleSettings};
use crate::job::words::positive;
use crate::pipeline::{SampleDensity, SampleOptions, Signal};
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Samples a surface: points with normals, without triangles, as the paper's gradient ascent leaves them (blue noise).
They take the colours and other attributes of the mesh at their place, or of the nearest point of a cloud. With --scan-only
they are a subset of the input's points, each with its own attributes and its index in the input (in PLY, the property
index). A point cloud is sampled on its robust implicit surface; missing normals are estimated.

Formats of the output, by file extension: obj (v, vn), ply (x y z nx ny nz index), off, gltf, glb, vtp, pcd, xyz.

Exit status: 0 sampled, 1 a file cannot be read or written, or cannot be sampled, 2 wrong usage, 130 interrupted.";

#[derive(Debug, clap::Args)]
pub(super) struct SampleArgs {
    /// The mesh or point cloud to read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The points to write; an existing file is replaced when the new one is complete
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    even: EvenArgs,
    /// Kernel width σn along unit normals: 0.5 to 1 concentrates samples where the surface bends; inf spreads them evenly
    #[arg(long, value_name = "S", default_value_t = SampleOptions::default().sigma_n, allow_negative_numbers = true)]
    sigma_n: f64,
    /// Kernel width along a property of the input's vertices (in PLY, or in glTF such as _HEAT), in its units: concentrates
    /// samples where the property changes; can be given up to four times
    #[arg(long = "sigma", value_name = "NAME=VALUE", value_parser = property_width)]
    properties: Vec<PropertyWidth>,
    #[command(flatten)]
    normals: NormalArgs,
    /// Write the points in progressive order, so that any initial part of them is also evenly spread: K levels, each with a
    /// quarter of the points of the next one. The report says where each level ends
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    levels: Option<usize>,
    /// Format of the input [default: by its extension, else by its content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    #[command(flatten)]
    out_of_core: OutOfCoreArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// How to sample evenly, in memory or tile by tile.
#[derive(Debug, clap::Args)]
pub(super) struct EvenArgs {
    /// Number of samples
    #[arg(long, value_name = "N", group = "density", allow_negative_numbers = true, value_parser = samples)]
    points: Option<SampleDensity>,
    /// Mean distance between neighbouring samples, in the units of the input
    #[arg(long, value_name = "L", group = "density", allow_negative_numbers = true, value_parser = positive)]
    edge_length: Option<f64>,
    /// Kernel width σp of the sampler, in the units of the input
    #[arg(long, value_name = "S", group = "density", allow_negative_numbers = true, value_parser = positive)]
    sigma_p: Option<f64>,
    #[arg(long, value_name = "W", allow_negative_numbers = true, conflicts_with = "scan_only", help = support_help())]
    smooth: Option<f64>,
    /// Use only the points of a cloud inside this box, in the units of the input
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true, value_parser = within)]
    within: Option<[[f64; 3]; 2]>,
    /// Take a subset of the input's points, using only the linear scan
    #[arg(long)]
    scan_only: bool,
    /// Seed of the random numbers: same seed, same input, same output
    #[arg(long, value_name = "SEED", default_value_t = SampleOptions::default().seed)]
    seed: u64,
    /// Sweeps of gradient ascent
    #[arg(long, value_name = "N", default_value_t = SampleOptions::default().sweeps, conflicts_with = "scan_only")]
    sweeps: usize,
}

impl EvenArgs {
    /// Returns these settings, and defaults for all others.
    pub(super) fn settings(self) -> Result<SampleSettings, Stop> {
        let EvenArgs { points, edge_length, sigma_p, smooth, within, scan_only, seed, sweeps } = self;
        if points.is_none() && edge_length.is_none() && sigma_p.is_none() {
            return Err(no_density());
        }
        Ok(SampleSettings {
            points,
            edge_length,
            sigma_p,
            sigma_n: SampleOptions::default().sigma_n,
            signals: Vec::new(),
            within,
            smooth,
            normals: NormalSettings::default(),
            scan_only,
            levels: None,
            seed,
            sweeps,
        })
    }
}

/// How what is larger than memory is sampled.
#[derive(Debug, clap::Args)]
struct OutOfCoreArgs {
    /// Sample tile by tile, with all points in temporary files; automatic for files larger than --memory. Works for points in
    /// binary PLY, LAS, LAZ, E57 and text
    #[arg(long)]
    out_of_core: bool,
    #[command(flatten)]
    memory: MemoryArgs,
}

/// A job that samples one file and writes the samples to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// The file to read.
    pub input: MeshFile,
    /// The file to write.
    pub output: PathBuf,
    /// How to sample.
    pub options: SampleOptions,
    /// How an input larger than memory is sampled.
    pub out_of_core: OutOfCore,
    /// Settings of the run.
    pub run: Run,
}

impl SampleArgs {
    pub(super) fn resolve(self) -> Result<Sampling, Stop> {
        let SampleArgs { input, output, even, sigma_n, properties, normals, levels, format, out_of_core, run } = self;
        let OutOfCoreArgs { out_of_core: always, memory } = out_of_core;
        let out_of_core = memory.resolve(always);
        let signals = properties.into_iter().map(Signal::from).collect();
        let settings = SampleSettings { sigma_n, signals, normals: normals.into(), levels, ..even.settings()? };
        let options = settings.resolve().map_err(|e| refused(&e))?;
        Ok(Sampling {
            input: MeshFile { path: input, format },
            output,
            options,
            out_of_core: OutOfCore { always: out_of_core.always || out_of_core.resume, ..out_of_core },
            run: Run::from(run).without_page("samples")?,
        })
    }
}
