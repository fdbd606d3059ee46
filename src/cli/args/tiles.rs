//! The arguments of `remesh tiles`.

use crate::cli::args::sample::EvenArgs;
use crate::cli::args::shared::{MeshFile, Run, RunArgs};
use crate::cli::args::stop::{Stop, refused};
use crate::cli::args::words::bytes;
use crate::io::Format;
use crate::pipeline::SampleOptions;
use clap::Subcommand;
use std::path::PathBuf;

pub(super) const HELP: &str = "\
Samples and meshes a point cloud of any size on any number of machines that share a folder. Files are the interface:
'plan' reads the cloud and sorts it into the folder; then any process on any machine can sample any tile, in any order
and any number of times; 'merge' joins the results. The result has the same bytes for any number of tiles, machines and
threads, and the same as that of 'remesh sample --out-of-core'.

  remesh tiles plan scan.ply work --points 300000 --tiles 16
  remesh tiles sample work 0        (and so on, one for each tile, anywhere)
  remesh tiles merge work points.ply

The mesh is made in pieces, in five rounds: the pieces of a round can also be made anywhere, once the rounds before it are
done. 'plan' prints the numbers of the first and the last piece of each round.

  remesh tiles mesh work            (all missing pieces; or give the numbers of some)
  remesh tiles merge work mesh.ply --mesh

Exit status: 0 done, 1 a file cannot be read or written, or cannot be sampled, 2 wrong usage, 3 the mesh is written, but
not sound, 130 interrupted.";

#[derive(Debug, Subcommand)]
pub(super) enum TilesArgs {
    /// Read a cloud, sort its points by position, and cut it into tiles; the first word printed is the number of tiles
    Plan(PlanArgs),
    /// Sample tiles
    Sample {
        /// The folder of the plan
        folder: PathBuf,
        /// Numbers of the tiles, from 0 [default: all that are not sampled yet]
        #[arg(value_name = "I")]
        numbers: Option<Vec<usize>>,
        #[command(flatten)]
        run: RunArgs,
    },
    /// Make pieces of the mesh from the samples
    Mesh {
        /// The folder of the plan
        folder: PathBuf,
        /// Numbers of the pieces, from 0 [default: all that are not made yet]
        #[arg(value_name = "I")]
        numbers: Option<Vec<usize>>,
        #[command(flatten)]
        run: RunArgs,
    },
    /// Join the samples of all tiles, or all pieces of the mesh
    Merge {
        /// The folder of the plan
        folder: PathBuf,
        /// The points or the mesh to write; an existing file is replaced when the new one is complete
        #[arg(value_name = "OUT")]
        output: PathBuf,
        /// Join the pieces of the mesh
        #[arg(long)]
        mesh: bool,
        #[command(flatten)]
        run: RunArgs,
    },
}

#[derive(Debug, clap::Args)]
pub(super) struct PlanArgs {
    /// The point cloud to read: binary PLY, LAS, LAZ, E57 or text
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The folder for the plan and everything made from it; created if it does not exist
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    #[command(flatten)]
    even: EvenArgs,
    /// Minimum number of tiles, if that many are possible
    #[arg(long, value_name = "N", default_value_t = 1)]
    tiles: usize,
    /// Memory that sampling a tile may take, such as 400M or 2G [default: half of the free memory here]
    #[arg(long, value_name = "M", value_parser = bytes)]
    memory: Option<u64>,
    /// Format of the input [default: by its extension, else by its content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    #[command(flatten)]
    run: RunArgs,
}

/// A job on tiles.
#[derive(Debug, Clone, PartialEq)]
pub enum Tiling {
    /// Make a plan.
    Plan(Box<Planning>),
    /// Sample the tiles with these numbers, or all that have not been sampled yet.
    Sample {
        /// The folder of the plan.
        folder: PathBuf,
        /// The numbers of the tiles.
        numbers: Option<Vec<usize>>,
        /// Settings of the run.
        run: Run,
    },
    /// Make the pieces of the mesh with these numbers, or all that have not been made yet.
    Mesh {
        /// The folder of the plan.
        folder: PathBuf,
        /// The numbers of the pieces.
        numbers: Option<Vec<usize>>,
        /// Settings of the run.
        run: Run,
    },
    /// Join the samples, or the pieces of the mesh.
    Merge {
        /// The folder of the plan.
        folder: PathBuf,
        /// The file to write.
        output: PathBuf,
        /// Whether to join the mesh rather than the samples.
        mesh: bool,
        /// Settings of the run.
        run: Run,
    },
}

/// A job that makes a plan for a cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct Planning {
    /// The file to read.
    pub input: MeshFile,
    /// The folder of the plan.
    pub folder: PathBuf,
    /// How to sample.
    pub options: SampleOptions,
    /// Minimum number of tiles.
    pub tiles: usize,
    /// Memory limit for a tile in bytes; by default, half of the free memory.
    pub memory: Option<u64>,
    /// Settings of the run.
    pub run: Run,
}

impl Tiling {
    /// Returns the settings of the run.
    pub fn run(&self) -> &Run {
        match self {
            Tiling::Plan(plan) => &plan.run,
            Tiling::Sample { run, .. } | Tiling::Mesh { run, .. } | Tiling::Merge { run, .. } => run,
        }
    }
}

impl TilesArgs {
    pub(super) fn resolve(self) -> Result<Tiling, Stop> {
        Ok(match self {
            TilesArgs::Plan(args) => Tiling::Plan(Box::new(args.resolve()?)),
            TilesArgs::Sample { folder, numbers, run } => {
                Tiling::Sample { folder, numbers, run: Run::from(run).without_page("tiles")? }
            }
            TilesArgs::Mesh { folder, numbers, run } => {
                Tiling::Mesh { folder, numbers, run: Run::from(run).without_page("pieces")? }
            }
            TilesArgs::Merge { folder, output, mesh, run } => {
                Tiling::Merge { folder, output, mesh, run: Run::from(run).without_page("tiles")? }
            }
        })
    }
}

impl PlanArgs {
    fn resolve(self) -> Result<Planning, Stop> {
        let PlanArgs { input, folder, even, tiles, memory, format, run } = self;
        let options = even.settings()?.resolve().map_err(|e| refused(&e))?;
        let run = Run::from(run).without_page("plans")?;
        Ok(Planning { input: MeshFile { path: input, format }, folder, options, tiles, memory, run })
    }
}
