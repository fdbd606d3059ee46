//! `remesh sample`: its arguments, and what it does.

use crate::base::error::Result;
use crate::base::progress::{Monitor, Stopwatch, check};
use crate::cli::args::{MeshFile, NormalArgs, Stop, Voice, density, points, positive, voice};
use crate::cli::run::{load, name, peak_memory_bytes};
use crate::cli::terminal::{self, Terminal};
use crate::io::{Format, Loaded, file};
use crate::remesh::{Density, SampleOptions, Sampled, Signal, sample, sample_points};
use crate::report::samples::SamplesReport;
use crate::surface::attributes::{Attribute, Attributes, Scalar};
use crate::surface::points::Points;
use clap::ArgAction;
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Samples a surface: points with normals, without triangles, as the paper's gradient ascent leaves them (blue noise).
With --scan-only a subset of the input's points, each with its index in it (in PLY as the property index). A cloud of
points is sampled on its robust implicit surface; normals that it lacks are estimated.

Formats of the output, by the ending of the file: obj (v, vn), ply (x y z nx ny nz index), xyz.

Exit status: 0 sampled, 1 a file cannot be read or written, or cannot be sampled, 2 wrong usage, 130 interrupted.";

#[derive(Debug, clap::Args)]
pub(super) struct SampleArgs {
    /// The mesh or the cloud of points to read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The points to write; an existing file is replaced when the new one is complete
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Number of samples
    #[arg(long, value_name = "N", group = "density", allow_negative_numbers = true, value_parser = points)]
    points: Option<Density>,
    /// Mean distance between neighbouring samples, in the units of the input
    #[arg(long, value_name = "L", group = "density", allow_negative_numbers = true, value_parser = positive)]
    edge_length: Option<f64>,
    /// Kernel width σp of the sampler, in the units of the input
    #[arg(long, value_name = "S", group = "density", allow_negative_numbers = true, value_parser = positive)]
    sigma_p: Option<f64>,
    /// Kernel width σn along unit normals: with 0.5 to 1 samples gather where the surface bends; inf is even
    #[arg(long, value_name = "S", default_value_t = f64::INFINITY, allow_negative_numbers = true)]
    sigma_n: f64,
    /// Kernel width along a property of the input's vertices (PLY, or glTF like _HEAT), in its units: samples gather
    /// where it changes; up to four times
    #[arg(long = "sigma", value_name = "NAME=VALUE", value_parser = property_width)]
    properties: Vec<PropertyWidth>,
    /// How far the points of a cloud reach, in mean distances of neighbouring ones: the larger, the smoother [default: 2.3]
    #[arg(long, value_name = "W", allow_negative_numbers = true, conflicts_with = "scan_only")]
    smooth: Option<f64>,
    #[command(flatten)]
    normals: NormalArgs,
    /// Take a subset of the input's points by the linear scan alone
    #[arg(long)]
    scan_only: bool,
    /// Seed of the random numbers: same seed, same input, same output
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Sweeps of gradient ascent
    #[arg(long, value_name = "N", default_value_t = 10, conflicts_with = "scan_only")]
    sweeps: usize,
    /// Threads to use; the output does not depend on it [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Format of the input [default: by its ending, else by its content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    /// Write the report to a file, as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Name each stage on standard error as it begins
    #[arg(short, long, action = ArgAction::SetTrue)]
    verbose: bool,
}

/// A property of the input's vertices and the width of the kernel along it.
#[derive(Debug, Clone, PartialEq)]
pub struct PropertyWidth {
    /// The name of the property.
    pub name: String,
    /// The width, in its units.
    pub sigma: f64,
}

/// Sample a file into another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// What to read.
    pub input: MeshFile,
    /// What to write.
    pub output: PathBuf,
    /// How to sample; signals that it has a place for are still to be read.
    pub options: SampleOptions,
    /// Where the signals are.
    pub properties: Vec<PropertyWidth>,
    /// Where the report goes as JSON, if it is wanted.
    pub report: Option<PathBuf>,
    /// As many as there are cores without.
    pub threads: Option<usize>,
    /// How much to say meanwhile.
    pub voice: Voice,
}

impl SampleArgs {
    pub(super) fn resolve(self) -> std::result::Result<Sampling, Stop> {
        let SampleArgs {
            input,
            output,
            points,
            edge_length,
            sigma_p,
            sigma_n,
            properties,
            smooth,
            normals,
            scan_only,
            seed,
            sweeps,
            threads,
            format,
            report,
            quiet,
            verbose,
        } = self;
        let density = density(points, edge_length, sigma_p, None)?;
        Ok(Sampling {
            input: MeshFile { path: input, format },
            output,
            options: SampleOptions {
                density,
                sigma_n,
                signals: Vec::new(),
                scan_only,
                seed,
                sweeps,
                cloud: normals.resolve(smooth, 0.0),
            },
            properties,
            report,
            threads: threads.map(usize::from),
            voice: voice(quiet, verbose),
        })
    }
}

/// `NAME=VALUE`, a name that may have a = in it.
pub(super) fn property_width(word: &str) -> std::result::Result<PropertyWidth, String> {
    let parts = word.rsplit_once('=').filter(|(name, _)| !name.is_empty());
    let (name, sigma) = parts.ok_or("it must be the name of a property, = and a width, as in quality=0.5")?;
    Ok(PropertyWidth { name: name.into(), sigma: positive(sigma)? })
}

/// The signals that properties of an input are.
pub(super) fn signals(properties: &[PropertyWidth], input: &Loaded) -> Result<Vec<Signal>> {
    let signal = |p: &PropertyWidth| Ok(Signal { values: input.attributes.numbers(&p.name)?, sigma: p.sigma });
    properties.iter().map(signal).collect()
}

/// Reads, samples, writes, reports.
pub(super) fn sample_file(job: &Sampling) -> Result<()> {
    job.options.validate()?;
    file::points_format(&job.output, None)?;
    file::check_target(&job.output)?;
    job.report.iter().try_for_each(|path| file::check_target(path))?;
    let report = {
        let terminal = Terminal::new(job.voice);
        let monitor = Stopwatch::new(&terminal);
        let input = load(&job.input, &monitor)?;
        let mut sampled = sample_loaded(&input, job, &monitor).map_err(|e| e.in_file(&name(&job.input)))?;
        sampled.notes.splice(0..0, input.notes.iter().cloned());
        check(&monitor)?;
        monitor.stage("write");
        file::write_points_file(&job.output, &sampled.points, &numbers(&sampled), None)?;
        let report = SamplesReport::new(&sampled, &job.options, name(&job.input), job.output.display().to_string());
        report.with_run(&monitor.laps(), peak_memory_bytes(), rayon::current_num_threads())
    };
    if let Some(path) = &job.report {
        file::replace_file(path, &mut |out| out.write_all(report.to_json().as_bytes()))?;
    }
    if job.voice == Voice::Quiet { Ok(()) } else { terminal::print(&report.to_text()) }
}

fn sample_loaded(input: &Loaded, job: &Sampling, monitor: &Stopwatch) -> Result<Sampled> {
    let options = SampleOptions { signals: signals(&job.properties, input)?, ..job.options.clone() };
    if input.mesh.triangles.is_empty() {
        let points = Points { positions: input.mesh.positions.clone(), normals: input.attributes.normals() };
        return sample_points(&points, &options, monitor);
    }
    sample(&input.mesh, &options, monitor)
}

/// The numbers of samples in the input, if they are points of it, as the property `index`.
fn numbers(sampled: &Sampled) -> Attributes {
    let attribute = |indices: &Vec<u32>| Attribute {
        name: "index".into(),
        components: 1,
        values: indices.iter().map(|&i| f64::from(i)).collect(),
        scalar: Scalar::U32,
    };
    Attributes { vertex: sampled.indices.iter().map(attribute).collect(), ..Attributes::default() }
}
