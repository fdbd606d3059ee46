//! What was typed, as clap reads it, and what it resolves to.
//!
//! `Args` has the words of the command line, [`Job`] what there is to do. Between them every field is named, so a
//! flag or an option that is added to one and forgotten in the other does not compile.

use crate::cli::reconstruct::{HELP as RECONSTRUCT_HELP, ReconstructArgs, Reconstructing};
use crate::cli::sample::{HELP, PropertyWidth, SampleArgs, Sampling, property_width};
use crate::io::Format;
use crate::remesh::{CloudOptions, Density, MaxError, NormalFit, Options, Reach, Selection};
use crate::surface::features::Features;
use clap::builder::PossibleValue;
use clap::{ArgAction, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use std::ffi::OsString;
use std::path::PathBuf;

/// Examples and exit statuses, below the help.
pub const AFTER_HELP: &str = "\
Examples:
  remesh scan.ply clean.ply --points 20000
      as many vertices as asked for, evenly spread
  remesh part.stl part.obj --edge-length 0.5 --report part.json
      triangles of about that size, and a report as JSON
  remesh scan.ply clean.ply --points auto --max-error 0.2%
      as few vertices as stay within 0.2 % of the diagonal of the input
  remesh sample scan.ply points.ply --points 20000
      blue noise without triangles: points with normals
  remesh reconstruct scan.ply dense.ply --resolution 0.2
      the smooth surface of a cloud, all of it as dense triangles
  remesh quality clean.ply --against scan.ply
      measure any mesh, and how far it is from another one

Formats, by the ending of the file: obj, ply, stl, off, gltf, glb. Points without triangles are
read from all of them but stl, from las and laz, and from columns of numbers: xyz, xyzn, pts, asc,
txt.

Exit status:
  0   the result is written and verified: an oriented manifold of the input's topology whose faces
      do not cross each other, unless the input's do, and within --max-error if that is given
  1   a file cannot be read or written, or holds no mesh that can be remeshed
  2   wrong usage, or an option out of its range
  3   the result is written, but could not be verified; the report says why
  130 interrupted; no file was changed";

const QUALITY_HELP: &str = "\
Measures the triangles of a mesh as they are: angles, quality Q = 6S/(√3 p h), edge lengths, valences and topology;
and with --against the distance to another mesh, in percent of the diagonal of that one's bounding box.

Exit status: 0 measured, 1 a file cannot be read, 2 wrong usage, 130 interrupted.";

/// Remesh a surface by spectral sampling: exactly the vertices asked for, well-shaped triangles, the input's topology.
#[derive(Debug, Parser)]
#[command(name = "remesh", version, after_help = AFTER_HELP, max_term_width = 100)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(override_usage = "remesh <IN> <OUT> <--points N|auto | --edge-length L | --sigma-p S> [OPTIONS]\n       \
                            remesh sample <IN> <OUT> <--points N | --edge-length L | --sigma-p S> [OPTIONS]\n       \
                            remesh reconstruct <IN> <OUT> [--resolution R] [--smooth W] [OPTIONS]\n       \
                            remesh quality <MESH> [--against <INPUT>] [--json]\n       \
                            remesh completions <SHELL>")]
struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    remesh: Option<RemeshArgs>,
    // Not within the others, which clap would not see then.
    #[command(flatten)]
    normals: NormalArgs,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Sample a surface: points with normals, without triangles, or a subset of the input's points
    #[command(long_about = HELP)]
    Sample(SampleArgs),
    /// Extract all of the smooth surface of a cloud of points, or of a mesh's vertices, as dense triangles
    #[command(long_about = RECONSTRUCT_HELP)]
    Reconstruct(ReconstructArgs),
    /// Measure a mesh, also one that this tool did not write
    #[command(long_about = QUALITY_HELP)]
    Quality(QualityArgs),
    /// Print the completions of a shell, to be sourced by it
    Completions { shell: Shell },
}

#[derive(Debug, clap::Args)]
struct RemeshArgs {
    /// The mesh to read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The mesh to write; an existing file is replaced when the new one is complete
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Number of vertices of the output; auto, with --max-error, takes as many as that needs
    #[arg(long, value_name = "N|auto", group = "density", allow_negative_numbers = true, value_parser = points)]
    points: Option<Density>,
    /// Mean edge length of the output, in the units of the input
    #[arg(long, value_name = "L", group = "density", allow_negative_numbers = true, value_parser = positive)]
    edge_length: Option<f64>,
    /// Kernel width σp of the sampler, in the units of the input
    #[arg(long, value_name = "S", group = "density", allow_negative_numbers = true, value_parser = positive)]
    sigma_p: Option<f64>,
    /// Seed of the random numbers: same seed, same input, same output
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Weld boundary vertices within this distance, in the units of the input, to close seams left open by rounding
    #[arg(long, value_name = "DISTANCE", allow_negative_numbers = true, value_parser = positive)]
    weld: Option<f64>,
    /// Sharp edges to keep: those across which the input turns by so many degrees, or none [default: decided from the
    /// input]
    #[arg(long, value_name = "DEGREES|none", allow_negative_numbers = true, value_parser = features)]
    features: Option<Features>,
    /// How much edge lengths follow the shape: from 0, even, to 1, short where it bends or is thin
    #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true, conflicts_with = "sizing")]
    adapt: f64,
    /// Kernel width σn along unit normals: with 0.5 to 1 samples gather where the surface bends; inf is even
    #[arg(long, value_name = "S", default_value_t = f64::INFINITY, allow_negative_numbers = true)]
    sigma_n: f64,
    /// Kernel width along a property of the input's vertices (as of a vertex in PLY, or an attribute like _HEAT in glTF),
    /// in its units: samples gather where it changes; up to four times
    #[arg(long = "sigma", value_name = "NAME=VALUE", value_parser = property_width)]
    properties: Vec<PropertyWidth>,
    /// Edge lengths wanted at the vertices of the input: a property of theirs, as of a vertex in PLY or an attribute like
    /// _SIZE in glTF, or a .json file with a list; also says how dense, if nothing else does
    #[arg(long, value_name = "PROPERTY|F.json")]
    sizing: Option<String>,
    /// Smooth noise away first, of clouds and of meshes: points reach as far as W mean distances of neighbouring ones
    #[arg(long, value_name = "W", num_args = 0..=1, default_missing_value = "2.7", allow_negative_numbers = true)]
    smooth: Option<f64>,
    /// Close holes of a cloud that fit in a box with this diagonal, in the units of the input
    #[arg(long, value_name = "SIZE", default_value_t = 0.0, allow_negative_numbers = true)]
    fill_holes: f64,
    /// Remesh only what is inside this box, in the units of the input; the rest stays as it is to the last bit. --points
    /// then counts the vertices strictly inside of the part, and not those on its seam with the rest
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true, value_parser = within)]
    within: Option<Selection>,
    /// Remesh only the triangles at whose corners this property of the input's vertices is not zero, or has a value;
    /// otherwise as --within
    #[arg(long, value_name = "PROPERTY[=VALUE]", conflicts_with = "within", value_parser = mark)]
    select: Option<Mark>,
    /// How far any point of the output may be from the input, and back: a length, or a share of the diagonal of the
    /// input's bounding box, as in 0.1%
    #[arg(long, value_name = "E|E%", allow_negative_numbers = true, value_parser = max_error)]
    max_error: Option<MaxError>,
    /// Leave out colours, texture coordinates, normals and other attributes of the input
    #[arg(long)]
    no_attributes: bool,
    /// 1 optimises the triangles after sampling, 0 leaves the samples where the paper's gradient ascent does
    #[arg(long, value_name = "0|1", default_value_t = 1, value_parser = clap::value_parser!(u8).range(0..=1))]
    optimize: u8,
    /// Threads to use; the output does not depend on it [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Format of the input [default: by its ending, else by its content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    /// Format of the output [default: by its ending]
    #[arg(long, value_name = "FORMAT")]
    output_format: Option<Format>,
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

/// How normals of a cloud are estimated.
#[derive(Debug, clap::Args)]
pub(super) struct NormalArgs {
    /// What normals of a cloud without them are fitted to [default: plane, or sphere with --smooth]
    #[arg(long, value_name = "FIT")]
    normal_fit: Option<NormalFit>,
    /// How many neighbours they are fitted to [default: 8, or 16 with --smooth]
    #[arg(long, value_name = "K", conflicts_with = "normal_radius")]
    normal_neighbors: Option<usize>,
    /// How far away, in the units of the input, these neighbours may be instead
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = positive)]
    normal_radius: Option<f64>,
}

impl NormalArgs {
    /// What to make of a cloud, with as much smoothing and as large holes closed as are given.
    pub(super) fn resolve(self, smooth: Option<f64>, fill_holes: f64) -> CloudOptions {
        let NormalArgs { normal_fit, normal_neighbors, normal_radius } = self;
        let neighborhood = normal_neighbors.map(Reach::Count).or(normal_radius.map(Reach::Radius));
        CloudOptions { fit: normal_fit, neighborhood, smooth, fill_holes }
    }
}

#[derive(Debug, clap::Args)]
struct QualityArgs {
    /// The mesh to measure
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Measure the distance to this mesh, too
    #[arg(long, value_name = "INPUT")]
    against: Option<PathBuf>,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
    /// Format of the mesh [default: by its ending, else by its content]
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,
    /// Threads to use; the figures do not depend on it [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// What there is to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Job {
    /// Remesh this.
    Remesh(Box<Remeshing>),
    /// Sample this.
    Sample(Sampling),
    /// Reconstruct this.
    Reconstruct(Reconstructing),
    /// Measure this.
    Measure(Measuring),
    /// Print these completions.
    Complete(String),
}

/// Remesh a file into another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Remeshing {
    /// What to read.
    pub input: MeshFile,
    /// What to write.
    pub output: MeshFile,
    /// What to make of it; lengths and signals that it has a place for are still to be read.
    pub options: Options,
    /// What to make of the input if it has no triangles.
    pub cloud: CloudOptions,
    /// Where the lengths for [`Options::sizing`] are, if there are any.
    pub sizing: Option<Sizing>,
    /// Whether the attributes of the input are carried to the output.
    pub attributes: bool,
    /// Where the selection for [`Options::part`] is, if there is one.
    pub select: Option<Mark>,
    /// Where the values for [`Options::signals`] are.
    pub properties: Vec<PropertyWidth>,
    /// Where the report goes as JSON, if it is wanted.
    pub report: Option<PathBuf>,
    /// As many as there are cores without.
    pub threads: Option<usize>,
    /// How much to say meanwhile.
    pub voice: Voice,
}

/// Measure a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Measuring {
    /// What to measure.
    pub mesh: MeshFile,
    /// What to measure the distance to, if to anything.
    pub against: Option<MeshFile>,
    /// Whether to print JSON and not a table.
    pub json: bool,
    /// As many as there are cores without.
    pub threads: Option<usize>,
}

/// A file and the format that it is said to have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshFile {
    /// Its path, as it was given.
    pub path: PathBuf,
    /// The format, where its ending or content are not to decide.
    pub format: Option<Format>,
}

/// Where the wanted edge lengths are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sizing {
    /// In the input, as the property of this name.
    Property(String),
    /// In a JSON file.
    File(PathBuf),
}

/// What marks the vertices of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// A property of the input's vertices.
    pub property: String,
    /// The value that it has to have; any but zero without.
    pub value: Option<f64>,
}

/// How much is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Voice {
    /// Errors only.
    Quiet,
    /// The report, and a progress bar on a terminal.
    Normal,
    /// The report, and a line for each stage.
    Verbose,
}

/// Why there is nothing to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// Help or version was asked for: this is it.
    Shown(String),
    /// The arguments make no sense: one line that says why.
    Wrong(String),
}

/// What the words of a command line, the program's name first, ask for.
pub fn parse(words: impl IntoIterator<Item = OsString>) -> Result<Job, Stop> {
    let Args { command, remesh, normals } = Args::try_parse_from(words).map_err(|e| stop(&e))?;
    match (command, remesh) {
        (Some(Command::Sample(args)), _) => args.resolve().map(Job::Sample),
        (Some(Command::Reconstruct(args)), _) => Ok(Job::Reconstruct(args.resolve())),
        (Some(Command::Quality(args)), _) => Ok(Job::Measure(args.resolve())),
        (Some(Command::Completions { shell }), _) => Ok(Job::Complete(completions(shell))),
        (None, Some(args)) => args.resolve(normals).map(|job| Job::Remesh(Box::new(job))),
        (None, None) => Err(wrong("the input and the output file are missing")),
    }
}

impl RemeshArgs {
    fn resolve(self, normals: NormalArgs) -> Result<Remeshing, Stop> {
        let RemeshArgs {
            input,
            output,
            points,
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
            max_error,
            no_attributes,
            optimize,
            threads,
            format,
            output_format,
            report,
            quiet,
            verbose,
        } = self;
        // Options without a flag keep their default; each is named, so that a new one is thought of here.
        let Options {
            density: _,
            seed: _,
            weld: _,
            features: _,
            adapt: _,
            sigma_n: _,
            signals: _,
            sizing: _,
            smooth: _,
            part: _,
            max_error: _,
            optimize: _,
            sweeps,
        } = Options::default();
        let sizing = sizing.map(Sizing::from);
        let density = density(points, edge_length, sigma_p, sizing.as_ref())?;
        let features = features.unwrap_or_default();
        Ok(Remeshing {
            input: MeshFile { path: input, format },
            output: MeshFile { path: output, format: output_format },
            options: Options {
                density,
                seed,
                weld,
                features,
                adapt,
                sigma_n,
                signals: Vec::new(),
                sizing: sizing.as_ref().map(|_| Vec::new()),
                smooth,
                part: within,
                max_error,
                optimize: optimize != 0,
                sweeps,
            },
            cloud: normals.resolve(smooth, fill_holes),
            sizing,
            attributes: !no_attributes,
            select,
            properties,
            report,
            threads: threads.map(usize::from),
            voice: voice(quiet, verbose),
        })
    }
}

impl QualityArgs {
    fn resolve(self) -> Measuring {
        let QualityArgs { mesh, against, json, format, threads } = self;
        Measuring {
            mesh: MeshFile { path: mesh, format },
            against: against.map(|path| MeshFile { path, format: None }),
            json,
            threads: threads.map(usize::from),
        }
    }
}

impl ValueEnum for Format {
    fn value_variants<'a>() -> &'a [Format] {
        &Format::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.extension()))
    }
}

impl ValueEnum for NormalFit {
    fn value_variants<'a>() -> &'a [NormalFit] {
        &[NormalFit::Plane, NormalFit::Sphere]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(match self {
            NormalFit::Plane => "plane",
            NormalFit::Sphere => "sphere",
        }))
    }
}

impl From<String> for Sizing {
    fn from(word: String) -> Sizing {
        let path = PathBuf::from(&word);
        let is_json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        if is_json { Sizing::File(path) } else { Sizing::Property(word) }
    }
}

/// How much is said, of two flags that exclude each other.
pub(super) fn voice(quiet: bool, verbose: bool) -> Voice {
    match (quiet, verbose) {
        (true, _) => Voice::Quiet,
        (_, true) => Voice::Verbose,
        _ => Voice::Normal,
    }
}

/// The one that is given of the ways to say how dense the output shall be.
pub(super) fn density(
    points: Option<Density>,
    edge_length: Option<f64>,
    sigma_p: Option<f64>,
    sizing: Option<&Sizing>,
) -> Result<Density, Stop> {
    let others = edge_length.map(Density::EdgeLength).or(sigma_p.map(Density::SigmaP));
    let of_sizing = sizing.map(|_| Density::OfSizing);
    points
        .or(others)
        .or(of_sizing)
        .ok_or_else(|| wrong("how dense? give one of --points N, --edge-length L and --sigma-p S"))
}

/// A number of vertices; what is too few or too many for a surface is for the library to say.
pub(super) fn points(word: &str) -> Result<Density, String> {
    let count = || word.parse().ok().filter(|&n| n > 0).map(Density::Points);
    let density = if word == "auto" { Some(Density::Auto) } else { count() };
    density.ok_or_else(|| "it must be a whole number of at least 1, or auto".into())
}

/// A length, or a share of the diagonal in per cent.
fn max_error(word: &str) -> Result<MaxError, String> {
    let share = |number: &str| positive(number).map(|percent| MaxError::OfDiagonal(percent / 100.0));
    let error = word.strip_suffix('%').map_or_else(|| positive(word).map(MaxError::Length), share);
    error.map_err(|_| "it must be a positive length, or a positive number with a %".into())
}

/// Which edges are sharp; what angles make sense is for the library to say.
fn features(word: &str) -> Result<Features, String> {
    match word {
        "auto" => Ok(Features::Automatic),
        "none" => Ok(Features::Smooth),
        _ => positive(word).map(Features::Degrees).map_err(|_| "it must be an angle in degrees, auto or none".into()),
    }
}

/// A box by its lowest and its highest corner; what boxes make sense is for the library to say.
fn within(word: &str) -> Result<Selection, String> {
    let numbers: Option<Vec<f64>> = word.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, z0, x1, y1, z1]) => Ok(Selection::Box([x0, y0, z0], [x1, y1, z1])),
        _ => Err("it must be six numbers: the lowest x, y and z of a box, then the highest".into()),
    }
}

/// The name of a property, or one and a value; the name may have an = of its own.
fn mark(word: &str) -> Result<Mark, String> {
    let parts = word.rsplit_once('=').and_then(|(property, value)| Some((property, value.parse().ok()?)));
    let (property, value) = parts.map_or((word, None), |(property, value)| (property, Some(value)));
    if property.is_empty() {
        Err("it must be the name of a property".into())
    } else {
        Ok(Mark { property: property.into(), value })
    }
}

/// A length that makes sense.
pub(super) fn positive(word: &str) -> Result<f64, String> {
    let positive = word.parse().ok().filter(|&x: &f64| x > 0.0 && x.is_finite());
    positive.ok_or_else(|| "it must be a positive number".into())
}

fn completions(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Args::command(), "remesh", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

fn wrong(cause: &str) -> Stop {
    Stop::Wrong(format!("{cause}; see remesh --help"))
}

/// Clap's answer: what it shows as it is, what is wrong as one line without the usage.
fn stop(error: &clap::Error) -> Stop {
    let text = error.to_string();
    if !error.use_stderr() {
        return Stop::Shown(text);
    }
    let paragraphs = text.split("\n\n").take_while(|p| !p.starts_with("Usage:") && !p.starts_with("For more"));
    let lines: Vec<String> = paragraphs.map(|p| p.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    wrong(lines.join("; ").trim_start_matches("error: "))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let Remeshing { input, output, options, cloud, sizing, select, properties, attributes, report, threads, voice } =
            job;
        assert_eq!(options, Options::default());
        assert_eq!(cloud, CloudOptions::default());
        assert_eq!((input, output), (file("a.obj"), file("b.ply")));
        assert_eq!((sizing, properties, attributes), (None, vec![], true));
        assert_eq!(select, None);
        assert_eq!((report, threads, voice), (None, None, Voice::Normal));
    }

    #[test]
    fn every_flag_arrives() {
        let line = "remesh a b --sigma-p 0.5 --seed 7 --threads 3 --format ply --output-format glb --report r.json \
                    --features 30 -v";
        let job = remeshing(line);
        let options =
            Options { density: Density::SigmaP(0.5), seed: 7, features: Features::Degrees(30.0), ..Options::default() };
        assert_eq!(job.options, options);
        assert_eq!((job.input.format, job.output.format), (Some(Format::Ply), Some(Format::Glb)));
        assert_eq!((job.report, job.threads, job.voice), (Some("r.json".into()), Some(3), Voice::Verbose));
        assert_eq!(remeshing("remesh a b --points 5 --features none").options.features, Features::Smooth);
        assert_eq!(remeshing("remesh a b --points 5 --adapt 0.5").options.adapt, 0.5);
        assert_eq!(remeshing("remesh a b --sizing h").options.density, Density::OfSizing);
        assert_eq!(remeshing("remesh a b --points 5 --sizing h").sizing, Some(Sizing::Property("h".into())));
        assert_eq!(remeshing("remesh a b --points 5 --sizing h.JSON").sizing, Some(Sizing::File("h.JSON".into())));
        assert!(!remeshing("remesh a b --points 5 --no-attributes").attributes);
        assert_eq!(remeshing("remesh a b --edge-length 2 -q").options.density, Density::EdgeLength(2.0));
        assert_eq!(remeshing("remesh a b --points 5 -q").voice, Voice::Quiet);
        let part = Some(Selection::Box([-1.0, 0.0, 0.5], [1.0, 2.0, 3e1]));
        assert_eq!(remeshing("remesh a b --points 5 --within -1,0,.5,1,2,3e1").options.part, part);
        let mark = |property: &str, value| Some(Mark { property: property.into(), value });
        assert_eq!(remeshing("remesh a b --points 5 --select red").select, mark("red", None));
        assert_eq!(remeshing("remesh a b --points 5 --select red=-1").select, mark("red", Some(-1.0)));
        assert_eq!(remeshing("remesh a b --points 5 --select a=b=2").select, mark("a=b", Some(2.0)));
        let options = remeshing("remesh a b --points auto --max-error 0.5%").options;
        assert_eq!((options.density, options.max_error), (Density::Auto, Some(MaxError::OfDiagonal(0.005))));
        let options = remeshing("remesh a b --points 9 --max-error 0.5").options;
        assert_eq!(options.max_error, Some(MaxError::Length(0.5)));
    }

    #[test]
    fn exactly_one_density() {
        assert!(complaint("remesh a b").contains("one of --points N, --edge-length L and --sigma-p S"));
        assert!(complaint("remesh a b --points 9 --sigma-p 1").contains("cannot be used with"));
        assert!(complaint("remesh a b --sizing h --adapt 1").contains("cannot be used with"));
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
            "remesh quality a b",
            "remesh completions klingon",
        ] {
            let said = complaint(line);
            assert!(!said.contains('\n') && said.ends_with("; see remesh --help"), "{line}: {said}");
        }
        assert!(complaint("remesh a b --point 4").contains("'--points'"));
    }

    #[test]
    fn subcommands() {
        let file = |path: &str| MeshFile { path: path.into(), format: None };
        let job = Measuring { mesh: file("m.stl"), against: Some(file("i.obj")), json: true, threads: None };
        assert_eq!(parsed("remesh quality m.stl --against i.obj --json"), Ok(Job::Measure(job)));
        assert!(
            matches!(parsed("remesh completions bash"), Ok(Job::Complete(script)) if script.contains("edge-length"))
        );
        assert!(
            matches!(parsed("remesh --version"), Err(Stop::Shown(text)) if text.contains(env!("CARGO_PKG_VERSION")))
        );
        assert!(matches!(parsed("remesh quality --help"), Err(Stop::Shown(text)) if text.contains("--against")));
    }
}
