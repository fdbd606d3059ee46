//! The arguments of the main command.

use crate::cli::args::shared::{FormatArgs, MemoryArgs, MeshFile, NormalArgs, Run, RunArgs, smoothing_help};
use crate::cli::args::stop::{Stop, refused};
use crate::cli::args::words::{PropertyWidth, Sizing, no_density, positive_or_zero, property_width, within};
use crate::job::RemeshOptions;
use crate::job::large::OutOfCore;
use crate::job::settings::RemeshSettings;
use crate::job::words::{features, mark, max_error, points, positive};
use crate::pipeline::{CloudOptions, Density, MaxError, Options, SMOOTHING_SUPPORT, Selection, Signal, check_levels};
use crate::surface::features::Features;
use clap::builder::BoolishValueParser;
use std::path::PathBuf;

/// What tells the main command from the others, which lack it.
#[derive(Debug, clap::Args)]
pub(super) struct FileArgs {
    /// The mesh to read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The mesh to write; an existing file is replaced when the new one is complete
    #[arg(value_name = "OUT")]
    output: PathBuf,
}

/// What may stand beside the files. It has defaults throughout, so that clap finds it with the other commands, too.
#[derive(Debug, clap::Args)]
pub(super) struct RemeshArgs {
    /// Number of vertices of the output; auto takes as many as --max-error needs
    #[arg(long, value_name = "N|auto", group = "density", allow_negative_numbers = true, value_parser = points)]
    points: Option<Density>,
    /// Levels of detail: one mesh for each of these vertex counts, from fine to coarse, as OUT-1, OUT-2 and so on; all in one
    /// file for glTF and GLB, or cut into tiles if OUT ends in .json
    #[arg(long, value_name = "N,N,...", group = "density", allow_negative_numbers = true, value_delimiter = ',')]
    levels: Vec<usize>,
    /// Mean edge length of the output, in the units of the input
    #[arg(long, value_name = "L", group = "density", allow_negative_numbers = true, value_parser = positive)]
    edge_length: Option<f64>,
    /// Kernel width σp of the sampler, in the units of the input
    #[arg(long, value_name = "S", group = "density", allow_negative_numbers = true, value_parser = positive)]
    sigma_p: Option<f64>,
    /// Seed of the random numbers: same seed, same input, same output
    #[arg(long, value_name = "SEED", default_value_t = Options::default().seed)]
    seed: u64,
    /// Weld boundary vertices within this distance, in the units of the input, to close cracks; 0 welds only those at
    /// exactly the same position [default: only close seams opened by rounding]
    #[arg(long, value_name = "DISTANCE", allow_negative_numbers = true, value_parser = positive_or_zero)]
    weld: Option<f64>,
    /// Keep edges with at least this dihedral angle, in degrees, sharp; none keeps no edge sharp, auto decides from the input
    /// [default: auto]
    #[arg(long, value_name = "DEGREES|none|auto", allow_negative_numbers = true, value_parser = features)]
    features: Option<Features>,
    /// How strongly edge lengths adapt to the shape: from 0, uniform, to 1, short where it bends or is thin
    #[arg(long, value_name = "A", group = "grading", allow_negative_numbers = true)]
    adapt: Option<f64>,
    /// Kernel width σn along unit normals: 0.5 to 1 concentrates samples where the surface bends; inf spreads them evenly
    #[arg(long, value_name = "S", conflicts_with = "grading", allow_negative_numbers = true)]
    sigma_n: Option<f64>,
    /// Kernel width along a property of the input's vertices (a vertex property in PLY, an attribute such as _HEAT in glTF),
    /// in its units: concentrates samples where the property changes; can be given up to four times
    #[arg(long = "sigma", value_name = "NAME=VALUE", conflicts_with = "grading", value_parser = property_width)]
    properties: Vec<PropertyWidth>,
    /// Target edge lengths at the vertices of the input: a property (a vertex property in PLY, an attribute such as _SIZE in
    /// glTF) or a .json file with a list; also sets the density, if no other option does
    #[arg(long, value_name = "PROPERTY|F.json", group = "grading")]
    sizing: Option<String>,
    #[arg(long, value_name = "W", num_args = 0..=1, allow_negative_numbers = true, help = smoothing_help())]
    smooth: Option<Option<f64>>,
    /// Close holes of a cloud that fit in a box with this diagonal, in the units of the input
    #[arg(long, value_name = "SIZE", default_value_t = CloudOptions::default().fill_holes, allow_negative_numbers = true)]
    fill_holes: f64,
    /// Whether to treat a cloud as terrain: the view from above becomes a sheet with one height at each place; z is up
    /// [default: yes if it looks like terrain and many points would otherwise be left out]
    #[arg(long, value_name = "yes|no", num_args = 0..=1, default_missing_value = "yes", value_parser = BoolishValueParser::new())]
    terrain: Option<bool>,
    #[command(flatten)]
    normals: NormalArgs,
    /// Remesh only what is inside this box, in the units of the input. The rest of a mesh is kept bit for bit, and --points
    /// counts the vertices strictly inside the part, not those on its interface with the rest; the rest of a cloud is left out
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true, value_parser = within)]
    within: Option<[[f64; 3]; 2]>,
    /// Remesh only the triangles with this vertex property of the input non-zero, or equal to VALUE, at all corners; otherwise
    /// as --within
    #[arg(long, value_name = "PROPERTY[=VALUE]", conflicts_with = "within", value_parser = mark)]
    select: Option<Selection>,
    /// Maximum distance of any point of the output from the input, and vice versa: a length, or a percentage of the diagonal
    /// of the input's bounding box, as in 0.1%
    #[arg(long, value_name = "E|E%", allow_negative_numbers = true, value_parser = max_error)]
    max_error: Option<MaxError>,
    /// Leave out colours, texture coordinates, normals and other attributes of the input
    #[arg(long)]
    no_attributes: bool,
    /// 1 optimises the triangles after sampling, 0 leaves the samples where the paper's gradient ascent puts them
    #[arg(long, value_name = "0|1", default_value_t = u8::from(Options::default().optimize), value_parser = clap::value_parser!(u8).range(0..=1))]
    optimize: u8,
    /// Read a mesh in blocks and coarsen it meanwhile; automatic for files larger than --memory, and for meshes far finer
    /// than the result. Works for faces in OBJ, binary PLY and binary STL; points are always thinned while they are read,
    /// and the result is made piece by piece if it would not fit in --memory
    #[arg(long)]
    out_of_core: bool,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    formats: FormatArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// A job that remeshes one file and writes the result to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Remeshing {
    /// The file to read.
    pub input: MeshFile,
    /// The file to write.
    pub output: MeshFile,
    /// How to remesh; target lengths from a separate file have not been read yet.
    pub options: RemeshOptions,
    /// The numbers of vertices of the levels of detail, if several meshes are requested.
    pub levels: Vec<usize>,
    /// The source of the target edge lengths, if there are any.
    pub sizing: Option<Sizing>,
    /// How an input larger than memory is read.
    pub out_of_core: OutOfCore,
    /// Settings of the run.
    pub run: Run,
}

impl RemeshArgs {
    pub(super) fn resolve(self, files: FileArgs) -> Result<Remeshing, Stop> {
        let RemeshArgs {
            points,
            levels,
            edge_length,
            sigma_p,
            seed,
            weld,
            features,
            adapt,
            sigma_n,
            properties,
            sizing,
            smooth,
            within,
            select,
            fill_holes,
            terrain,
            normals,
            max_error,
            no_attributes,
            optimize,
            out_of_core,
            memory,
            formats,
            run,
        } = self;
        let (input, output) = formats.resolve(files.input, files.output);
        let sizing = sizing.map(Sizing::from);
        if !levels.is_empty() {
            check_levels(&levels).map_err(|e| refused(&e))?;
        }
        let points = points.or(levels.first().map(|&n| Density::Points(n)));
        if points.is_none() && edge_length.is_none() && sigma_p.is_none() && sizing.is_none() {
            return Err(no_density());
        }
        let smooth = smooth.map(|support| support.unwrap_or(SMOOTHING_SUPPORT));
        let settings = RemeshSettings {
            points,
            edge_length,
            sigma_p,
            seed,
            weld,
            features,
            adapt,
            sigma_n,
            signals: properties.into_iter().map(Signal::from).collect(),
            sizing: sizing.as_ref().map(Sizing::values),
            smooth,
            within,
            select,
            fill_holes,
            terrain,
            normals: normals.into(),
            max_error,
            attributes: !no_attributes,
            optimize: optimize != 0,
        };
        let options = settings.resolve().map_err(|e| refused(&e))?;
        let out_of_core = memory.resolve(out_of_core);
        Ok(Remeshing { input, output, options, levels, sizing, out_of_core, run: run.into() })
    }
}
