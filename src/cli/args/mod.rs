//! Parses the command line with clap and resolves it into jobs; each command has a file of its own.
//!
//! `Args` and the structs flattened into it hold the words of the command line; [`Job`] holds the work to do. The conversion
//! names every field, so a flag or option that is added to one and forgotten in the other does not compile.

mod manual;
mod quality;
mod reconstruct;
mod remesh;
mod sample;
mod shared;
mod stop;
mod tiles;
mod words;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use quality::QualityArgs;
use reconstruct::ReconstructArgs;
use remesh::{FileArgs, RemeshArgs};
use sample::SampleArgs;
use std::ffi::OsString;
use std::path::Path;
use stop::{stop, wrong};
use tiles::TilesArgs;

pub use quality::Measuring;
pub use reconstruct::Reconstructing;
pub use remesh::Remeshing;
pub use sample::Sampling;
pub use shared::{MeshFile, Run, Voice, is_page};
pub use stop::Stop;
pub use tiles::{Planning, Tiling};
pub use words::Sizing;

/// Examples and exit statuses that follow the help.
pub const AFTER_HELP: &str = "\
Examples:
  remesh scan.ply clean.ply --points 20000
      exactly as many vertices as requested, evenly spread
  remesh part.stl part.obj --edge-length 0.5 --report part.json
      triangles with edges of about that length, and a report as JSON
  remesh scan.ply clean.ply --points auto --max-error 0.2%
      the fewest vertices that stay within 0.2 % of the input's diagonal
  remesh scan.ply scan.glb --levels 50000,10000,2000
      levels of detail: one finished mesh for each vertex count
  remesh sample scan.ply points.ply --points 20000
      blue noise without triangles: points with normals
  remesh reconstruct scan.ply dense.ply --resolution 0.2
      the whole smooth surface of a point cloud, as dense triangles
  remesh scan.ply clean.ply --points 20000 --report clean.html
      and a page for a browser with interactive 3D views of the mesh before and after
  remesh quality clean.ply --against scan.ply
      measure any mesh, and its distance to another one

Formats, by file extension: obj, ply, stl, off, gltf, glb, 3mf, vtp; and, for reading only, vtk,
vtu, msh, mesh, meshb. Points without triangles are read from most of these, from pcd, las, laz and
e57, and from columns of numbers: xyz, xyzn, pts, asc, txt. Any of these may be followed by .gz.

Exit status:
  0   the result is written and verified: an oriented manifold with the input's topology, no
      self-intersections where the input has none, no slivers and no triangles where the input
      has no surface, and within --max-error if that is given
  1   a file cannot be read or written, or holds no mesh that can be remeshed
  2   wrong usage, or an option out of range
  3   the result is written, but could not be verified; the report says why
  130 interrupted; no file was changed";

/// Remesh a surface by spectral sampling: exactly the requested number of vertices, well-shaped
/// triangles, the input's topology.
#[derive(Debug, Parser)]
#[command(name = "remesh", version, after_help = AFTER_HELP, max_term_width = 100)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(
    override_usage = "remesh <IN> <OUT> <--points N|auto | --levels N,N,... | --edge-length L | --sigma-p S> [OPTIONS]\n       \
                            remesh sample <IN> <OUT> <--points N | --edge-length L | --sigma-p S> [OPTIONS]\n       \
                            remesh reconstruct <IN> <OUT> [--resolution R] [--smooth W] [OPTIONS]\n       \
                            remesh quality <MESH>... [--against <INPUT>] [--json] [--report F]\n       \
                            remesh tiles <plan | sample | mesh | merge> ...\n       \
                            remesh completions <SHELL>\n       \
                            remesh man [COMMAND]"
)]
struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    files: Option<FileArgs>,
    #[command(flatten)]
    remesh: RemeshArgs,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Sample a surface: points with normals, without triangles, or a subset of the input's points
    #[command(long_about = sample::HELP)]
    Sample(SampleArgs),
    /// Extract the whole smooth surface of a point cloud, or of a mesh's vertices, as dense triangles
    #[command(long_about = reconstruct::HELP)]
    Reconstruct(ReconstructArgs),
    /// Sample a point cloud of any size tile by tile, on any number of machines that share a folder
    #[command(subcommand, long_about = tiles::HELP)]
    Tiles(TilesArgs),
    /// Measure any mesh, including those written by other tools
    #[command(long_about = quality::HELP)]
    Quality(QualityArgs),
    /// Print a completion script for a shell to source
    Completions { shell: Shell },
    /// Print the manual page of the program, or of a command, in man format
    Man {
        #[arg(value_parser = manual::COMMANDS)]
        command: Option<String>,
    },
}

/// The work to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Job {
    /// Remesh a file.
    Remesh(Box<Remeshing>),
    /// Sample a file.
    Sample(Sampling),
    /// Plan, sample, mesh or merge tiles.
    Tiles(Tiling),
    /// Reconstruct a surface.
    Reconstruct(Reconstructing),
    /// Measure meshes.
    Measure(Measuring),
    /// Print a text.
    Print(String),
}

impl Job {
    /// Returns the file for the report, if one was requested.
    pub fn report(&self) -> Option<&Path> {
        let path = match self {
            Job::Remesh(job) => &job.run.report,
            Job::Sample(job) => &job.run.report,
            Job::Tiles(job) => &job.run().report,
            Job::Reconstruct(job) => &job.run.report,
            Job::Measure(job) => &job.report,
            Job::Print(_) => &None,
        };
        path.as_deref()
    }
}

/// Parses the words of a command line, which begins with the name of the program.
pub fn parse(words: impl IntoIterator<Item = OsString>) -> Result<Job, Stop> {
    let Args { command, files, remesh } = Args::try_parse_from(words).map_err(|e| stop(&e))?;
    match (command, files) {
        (Some(Command::Sample(args)), _) => args.resolve().map(Job::Sample),
        (Some(Command::Reconstruct(args)), _) => args.resolve().map(Job::Reconstruct),
        (Some(Command::Tiles(args)), _) => args.resolve().map(Job::Tiles),
        (Some(Command::Quality(args)), _) => Ok(Job::Measure(args.resolve())),
        (Some(Command::Completions { shell }), _) => Ok(Job::Print(completions(shell))),
        (Some(Command::Man { command }), _) => Ok(Job::Print(manual::page(Args::command(), command.as_deref()))),
        (None, Some(files)) => remesh.resolve(files).map(|job| Job::Remesh(Box::new(job))),
        (None, None) => Err(wrong("the input and the output file are missing")),
    }
}

fn completions(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Args::command(), "remesh", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::error::Setting;
    use crate::cli::flags::flag;
    use crate::io::Format;
    use crate::job::large::OutOfCore;
    use crate::job::{Carry, RemeshOptions};
    use crate::pipeline::{
        CloudOptions, Density, Grading, MaxError, NormalFit, NormalNeighborhood, Options, Selection, Signal, Values,
    };
    use crate::surface::features::Features;

    fn parsed(line: &str) -> Result<Job, Stop> {
        parse(line.split(' ').map(OsString::from))
    }

    fn remeshing(line: &str) -> Remeshing {
        match parsed(line) {
            Ok(Job::Remesh(job)) => *job,
            other => panic!("{other:?}"),
        }
    }

    fn complaint(line: &str) -> String {
        match parsed(line) {
            Err(Stop::Wrong(cause)) => cause,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn clap_finds_no_fault_in_the_definition() {
        Args::command().debug_assert();
    }

    #[test]
    fn no_flags_give_the_default() {
        let file = |path: &str| MeshFile { path: path.into(), format: None };
        let job = remeshing("remesh a.obj b.ply --points 10000");
        let Remeshing { input, output, options, levels, sizing, out_of_core, run } = job;
        assert_eq!((options, levels), (RemeshOptions::default(), vec![]));
        assert_eq!((input, output, sizing), (file("a.obj"), file("b.ply"), None));
        assert_eq!(out_of_core, OutOfCore { always: false, memory: None, temp: None, resume: false });
        assert_eq!(run, Run { threads: None, report: None, voice: Voice::Normal });
    }

    #[test]
    fn every_flag_arrives() {
        let line = "remesh a b --sigma-p 0.5 --seed 7 --threads 3 --format ply --output-format glb --report r.json \
                    --features 30 -v";
        let job = remeshing(line);
        let options =
            Options { density: Density::SigmaP(0.5), seed: 7, features: Features::Degrees(30.0), ..Options::default() };
        assert_eq!(job.options, options.into());
        assert_eq!((job.input.format, job.output.format), (Some(Format::Ply), Some(Format::Glb)));
        assert_eq!(job.run, Run { threads: Some(3), report: Some("r.json".into()), voice: Voice::Verbose });
        let out_of_core = remeshing("remesh a b --points 5 --out-of-core --memory 2G --temp t --resume").out_of_core;
        let given = OutOfCore { always: true, memory: Some(2_000_000_000), temp: Some("t".into()), resume: true };
        assert_eq!(out_of_core, given);
        assert_eq!(remeshing("remesh a b --points 5 --features none").options.surface.features, Features::Smooth);
        assert_eq!(remeshing("remesh a b --points 5 --adapt 0.5").options.surface.grading, Grading::Curvature(0.5));
        assert_eq!(remeshing("remesh a b --sizing h").options.surface.density, Density::OfField);
        let field = Grading::Field(Values::Attribute("h".into()));
        assert_eq!(remeshing("remesh a b --points 5 --sizing h").options.surface.grading, field);
        let signals = vec![Signal { values: Values::Attribute("t=0".into()), sigma: 0.5 }];
        let kernel = |sigma_n, signals| Grading::Kernel { sigma_n, signals };
        let grading = |line: &str| remeshing(line).options.surface.grading;
        assert_eq!(grading("remesh a b --points 5 --sigma t=0=0.5"), kernel(f64::INFINITY, signals));
        assert_eq!(grading("remesh a b --points 5 --sigma-n 0.7"), kernel(0.7, vec![]));
        assert_eq!(remeshing("remesh a b --points 5 --sizing h").sizing, Some(Sizing::Property("h".into())));
        assert_eq!(remeshing("remesh a b --points 5 --sizing h.JSON").sizing, Some(Sizing::File("h.JSON".into())));
        assert_eq!(remeshing("remesh a b --points 5 --no-attributes").options.carry, Carry::Nothing);
        assert_eq!(remeshing("remesh a b --edge-length 2 -q").options.surface.density, Density::EdgeLength(2.0));
        assert_eq!(remeshing("remesh a b --points 5 -q").run.voice, Voice::Quiet);
        assert_eq!(remeshing("remesh a b --levels 90,30,9").levels, [90, 30, 9]);
        let part = Some(Selection::Box([[-1.0, 0.0, 0.5], [1.0, 2.0, 3e1]]));
        assert_eq!(remeshing("remesh a b --points 5 --within -1,0,.5,1,2,3e1").options.surface.part, part);
        let mark = |attribute: &str, value| Some(Selection::Marked { attribute: attribute.into(), value });
        assert_eq!(remeshing("remesh a b --points 5 --select red").options.surface.part, mark("red", None));
        assert_eq!(remeshing("remesh a b --points 5 --select red=-1").options.surface.part, mark("red", Some(-1.0)));
        assert_eq!(remeshing("remesh a b --points 5 --select a=b=2").options.surface.part, mark("a=b", Some(2.0)));
        let line = "remesh a b --points 5 --normal-fit sphere --normal-neighbors 9 --fill-holes 2 --terrain --smooth";
        let cloud = remeshing(line).options.cloud;
        let (fit, neighborhood) = (Some(NormalFit::Sphere), Some(NormalNeighborhood::Count(9)));
        assert_eq!(cloud, CloudOptions { fit, neighborhood, smooth: Some(2.7), fill_holes: 2.0, terrain: Some(true) });
        let terrain = |line: &str| remeshing(line).options.cloud.terrain;
        assert_eq!(terrain("remesh a b --points 5 --terrain no"), Some(false));
        assert_eq!(terrain("remesh a b --points 5"), None);
        let options = remeshing("remesh a b --points auto --max-error 0.5%").options.surface;
        assert_eq!((options.density, options.max_error), (Density::Auto, Some(MaxError::OfDiagonal(0.005))));
        let options = remeshing("remesh a b --points 9 --max-error 0.5").options.surface;
        assert_eq!(options.max_error, Some(MaxError::Length(0.5)));
    }

    #[test]
    fn errors_name_flags_that_there_are() {
        let help = |line: &str| match parsed(line) {
            Err(Stop::Shown(text)) => text,
            other => panic!("{other:?}"),
        };
        let texts = [help("remesh --help"), help("remesh reconstruct --help")].concat();
        for flag in Setting::ALL.map(flag) {
            assert!(texts.contains(&format!("{flag} <")) || texts.contains(&format!("{flag} [")), "{flag}");
        }
    }

    #[test]
    fn there_are_pages_of_meshes_only() {
        assert!(
            complaint("remesh sample a b --points 9 --report r.html")
                .contains("r.html: there is no report page for samples")
        );
        assert!(complaint("remesh reconstruct a b --report r.HTML").contains("ends in .json"));
        assert_eq!(remeshing("remesh a b --points 9 --report r.html").run.report, Some("r.html".into()));
    }

    #[test]
    fn exactly_one_density() {
        assert!(complaint("remesh a b").contains("one of --points N, --edge-length L and --sigma-p S"));
        assert!(complaint("remesh a b --points 9 --sigma-p 1").contains("cannot be used with"));
    }

    #[test]
    fn lengths_follow_one_thing() {
        for line in ["--sizing h --adapt 1", "--adapt 1 --sigma-n 0.5", "--sizing h --sigma t=1"] {
            assert!(complaint(&format!("remesh a b --points 9 {line}")).contains("cannot be used with"), "{line}");
        }
    }

    #[test]
    fn what_makes_no_sense_is_one_line() {
        for line in [
            "remesh",
            "remesh a",
            "remesh a b c --points 5",
            "remesh a b --points 0",
            "remesh a b --points many",
            "remesh a b --points -4",
            "remesh a b --point 4",
            "remesh a b --points 4 --max-error 0",
            "remesh a b --points 9 --levels 9,4",
            "remesh a b --levels 9,many",
            "remesh a b --levels 9,9",
            "remesh a b --levels 9,2",
            "remesh a b --points 4 --max-error x%",
            "remesh a b --edge-length 0",
            "remesh a b --edge-length nan",
            "remesh a b --sigma-p inf",
            "remesh a b --points 9 --threads 0",
            "remesh a b --points 9 --features sharp",
            "remesh a b --points 9 --features -20",
            "remesh a b --points 9 --format doc",
            "remesh a b --points 9 -q -v",
            "remesh a b --points 9 --within 0,0,0,1,1",
            "remesh a b --points 9 --within 0,0,0,1,1,one",
            "remesh a b --points 9 --within 0,0,0,1,1,1 --select red",
            "remesh a b --points 9 --select =1",
            "remesh quality",
            "remesh completions klingon",
            "remesh man help",
        ] {
            let said = complaint(line);
            assert!(!said.contains('\n') && said.ends_with("; see remesh --help"), "{line}: {said}");
        }
        assert!(complaint("remesh a b --point 4").contains("'--points'"));
    }

    #[test]
    fn subcommands() {
        let file = |path: &str| MeshFile { path: path.into(), format: None };
        let against = Some(file("i.obj"));
        let job = Measuring { meshes: vec![file("m.stl")], against, json: true, report: None, threads: None };
        assert_eq!(parsed("remesh quality m.stl --against i.obj --json"), Ok(Job::Measure(job)));
        let meshes = vec![file("a"), file("b")];
        let job = Measuring { meshes, against: None, json: false, report: Some("r.html".into()), threads: None };
        assert_eq!(parsed("remesh quality a b --report r.html"), Ok(Job::Measure(job)));
        assert!(matches!(parsed("remesh completions bash"), Ok(Job::Print(script)) if script.contains("edge-length")));
        assert!(matches!(parsed("remesh man quality"), Ok(Job::Print(page)) if page.contains("against")));
        assert!(
            matches!(parsed("remesh --version"), Err(Stop::Shown(text)) if text.contains(env!("CARGO_PKG_VERSION")))
        );
        assert!(matches!(parsed("remesh quality --help"), Err(Stop::Shown(text)) if text.contains("--against")));
    }
}
