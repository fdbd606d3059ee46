//! The pipeline from mesh to mesh: the only place that knows the order of the stages.

use crate::base::error::{Error, Result};
use crate::base::progress::{Monitor, check};
use crate::base::rng::{Stage, stream};
use crate::optimize::angles::improve_angles;
use crate::optimize::counts::meet_count;
use crate::optimize::fit::fit;
use crate::optimize::levels::{balance, coarsen, fix_all_but_bent, fix_all_but_narrow, fix_tips, narrow, split_to};
use crate::optimize::relax::{Flips, relax};
use crate::optimize::untangle::untangle;
use crate::optimize::valence::{remove_defects, remove_near_defects};
use crate::quality::bound::{Bounds, hausdorff_bounds};
use crate::spectral::ascent::{Climb, LONG_STEP, PAPER_STEP, SIGMA_OF_SPACING as ASCENT_SIGMA, ascend};
use crate::spectral::candidates::candidates;
use crate::spectral::curves::sample_curves;
use crate::spectral::scan::linear_scan;
use crate::surface::crossings::crossing_faces;
use crate::surface::domain::Domain;
use crate::surface::features::Features;
use crate::surface::manifold::Manifold;
use crate::surface::mesh::Mesh;
use crate::surface::refine::refine;
use crate::surface::repair::{Repairs, repair};
use crate::surface::seams::{close_seams, open_seams};
use crate::surface::sizing::{adapted_sizes, field_lengths, field_sizes, mean_density, transferred};
use crate::surface::topology::{Topology, topology};
use crate::triangulate::glue::{Seams, glue};
use crate::triangulate::{Boundary, triangulate};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// How dense the result shall be. Each says it all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// The number of vertices of the result.
    Points(usize),
    /// The mean edge length, in the units of the input.
    EdgeLength(f64),
    /// The kernel width σp of the sampler, in the units of the input.
    SigmaP(f64),
    /// As many vertices as the lengths of [`Options::sizing`] ask for.
    OfSizing,
    /// As many vertices as [`Options::max_error`] needs, and hardly more: see [`remesh`].
    Auto,
}

/// How far the result may be from the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaxError {
    /// A length, in the units of the input.
    Length(f64),
    /// A share of the diagonal of the input's bounding box: 0.001 is a tenth of a per cent.
    OfDiagonal(f64),
}

impl MaxError {
    fn length(self, diagonal: f64) -> f64 {
        match self {
            MaxError::Length(length) => length,
            MaxError::OfDiagonal(share) => share * diagonal,
        }
    }
}

/// What to make of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// How dense the result shall be. Default: 10,000 points.
    pub density: Density,
    /// Seed of all random numbers: same seed, same input, same result. Default: 0.
    pub seed: u64,
    /// Boundary vertices as near as this to each other, in the units of the input, become one: closes seams that rounding
    /// left open. Default: `None`, only vertices at exactly the same place.
    pub weld: Option<f64>,
    /// Which edges of the input are kept sharp. Default: decided from the input.
    pub features: Features,
    /// How much the edge lengths follow the shape, from 0 (they are even) to 1 (short where the surface bends or is thin,
    /// in proportion to the root of the radius). Default: 0.
    pub adapt: f64,
    /// The edge length wanted at each vertex of the input, in its units; with a density other than [`Density::OfSizing`]
    /// all are scaled by one factor to meet that. Default: `None`, lengths are even or as `adapt` says.
    pub sizing: Option<Vec<f64>>,
    /// How far any point of the result may be from the repaired input, and any point of that from the result. Default:
    /// `None`, as near as the vertices allow on average.
    pub max_error: Option<MaxError>,
    /// Whether the triangles are optimised after sampling. Default: true. Without, the vertices are where the paper's
    /// gradient ascent leaves them: blue noise.
    pub optimize: bool,
    /// Sweeps of gradient ascent over all samples if nothing is optimised. Default: 10, as in the paper (section 6.3);
    /// more make the triangles a little better.
    pub sweeps: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            density: Density::Points(10_000),
            seed: 0,
            weld: None,
            features: Features::Automatic,
            adapt: 0.0,
            sizing: None,
            max_error: None,
            optimize: true,
            sweeps: 10,
        }
    }
}

/// Fewest vertices that can be asked for: those of a triangle.
pub const FEWEST_POINTS: usize = 3;

/// Most vertices that can be asked for: the candidates for so many take some four gigabytes.
pub const MOST_POINTS: usize = 5_000_000;

impl Options {
    /// Refuses what no input can be remeshed with.
    ///
    /// # Errors
    /// [`Error::Option`] for a number of points out of range or a length that is not positive and finite.
    pub fn validate(&self) -> Result<()> {
        let length = |option, value: f64| {
            let remedy = "give a length above zero in the units of the input".into();
            (value > 0.0 && value.is_finite()).then_some(()).ok_or(Error::Option {
                option,
                cause: format!("{value} is not a length"),
                remedy,
            })
        };
        self.weld.map_or(Ok(()), |tolerance| length("weld", tolerance))?;
        if let Features::Degrees(degrees) = self.features
            && !(degrees > 0.0 && degrees < 180.0)
        {
            let cause = format!("{degrees} is not an angle between faces");
            return Err(Error::Option { option: "features", cause, remedy: "give degrees between 0 and 180".into() });
        }
        if !(0.0..=1.0).contains(&self.adapt) {
            let cause = format!("{} is not a degree of adaptivity", self.adapt);
            return Err(Error::Option { option: "adapt", cause, remedy: "give a number from 0 to 1".into() });
        }
        if self.adapt > 0.0 && self.sizing.is_some() {
            let cause = "edge lengths cannot follow the shape and a field at the same time".into();
            return Err(Error::Option { option: "adapt", cause, remedy: "leave out adapt or sizing".into() });
        }
        self.sizing.as_deref().map_or(Ok(()), check_lengths)?;
        match self.max_error {
            Some(MaxError::Length(l)) => length("max-error", l)?,
            Some(MaxError::OfDiagonal(share)) => length("max-error", share)?,
            None => {}
        }
        match self.density {
            Density::OfSizing if self.sizing.is_none() => Err(Error::Option {
                option: "sizing",
                cause: "there are no lengths that say how dense the result shall be".into(),
                remedy: "give lengths or another density".into(),
            }),
            Density::OfSizing => Ok(()),
            Density::Points(n) => check_count("points", n, format!("{n} vertices are asked for")),
            Density::EdgeLength(l) => length("edge-length", l),
            Density::SigmaP(s) => length("sigma-p", s),
            Density::Auto if self.max_error.is_none() => Err(Error::Option {
                option: "points",
                cause: "nothing says how many are needed".into(),
                remedy: "give a max-error, or a number of points".into(),
            }),
            Density::Auto => Ok(()),
        }
    }
}

fn check_lengths(lengths: &[f64]) -> Result<()> {
    let is_length = |length: &f64| *length > 0.0 && length.is_finite();
    lengths.iter().position(|length| !is_length(length)).map_or(Ok(()), |v| {
        Err(Error::Option {
            option: "sizing",
            cause: format!("vertex {v} has {}, which is not a length", lengths[v]),
            remedy: "give each vertex a length above zero in the units of the input".into(),
        })
    })
}

/// Refuses a field of another number of lengths than the input has vertices.
fn check_field(input: &Mesh, lengths: &[f64]) -> Result<()> {
    let (vertices, given) = (input.positions.len(), lengths.len());
    if given == vertices {
        return Ok(());
    }
    let cause = format!("{given} lengths for the {vertices} vertices of the input");
    Err(Error::Option { option: "sizing", cause, remedy: "give one length for each vertex".into() })
}

fn check_count(option: &'static str, n: usize, cause: String) -> Result<()> {
    if (FEWEST_POINTS..=MOST_POINTS).contains(&n) {
        return Ok(());
    }
    Err(Error::Option { option, cause, remedy: format!("from {FEWEST_POINTS} to {MOST_POINTS} are possible") })
}

/// A remeshed surface and what there is to say about it.
#[derive(Debug, Clone)]
pub struct Remeshed {
    /// The result, in the coordinates of the input.
    pub mesh: Mesh,
    /// The input as it came, before repairs.
    pub input: Topology,
    /// The input after repairs: what the result's topology is held against.
    pub repaired: Topology,
    /// The result.
    pub output: Topology,
    /// What was mended in the input.
    pub repairs: Repairs,
    /// Kernel width used, in the units of the input.
    pub sigma_p: f64,
    /// The distance that the wanted vertices have at hexagonal packing on the input's area, in the units of the input.
    pub spacing: f64,
    /// The smallest and the largest of the distances wanted, both the spacing where nothing is graded.
    pub spacing_range: [f64; 2],
    /// Vertices wanted, as the density says.
    pub wanted: usize,
    /// Sharp edges that were kept, as curves between corners.
    pub sharp_curves: usize,
    /// Smooth patches whose samples did not settle even with parts of them tessellated from the input, and that were
    /// tessellated as a whole.
    pub tessellated_pieces: usize,
    /// Faces of the result that cross or touch another one where they are not joined, in increasing order.
    pub crossing_faces: Vec<u32>,
    /// How many faces of the repaired input do; `None` where the result has none, since then nobody needs to know.
    pub crossing_faces_of_input: Option<usize>,
    /// How far the result is from the repaired input; `None` if no bound was asked for.
    pub deviation: Option<Deviation>,
    /// Things a user should know, a sentence each.
    pub notes: Vec<String>,
}

/// How far a result is from what it was made of, and may be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// How far it may be, in the units of the input.
    pub allowed: f64,
    /// No point of the result is farther from the repaired input, and none of that from the result, but for rounding: an
    /// upper bound, mostly within a tenth of the Hausdorff distance or a quarter of `allowed`, in the units of the
    /// input.
    pub reached: f64,
    /// A point that is about as far: x, y and z.
    pub place: [f64; 3],
}

impl Deviation {
    /// Whether the result is as near as it has to be.
    pub fn is_allowed(&self) -> bool {
        self.reached <= self.allowed
    }
}

impl Remeshed {
    /// Whether the result is what it should be: of the topology of the repaired input, without faces that cross each
    /// other, unless the input has some, too, and as near to the input as was asked for.
    pub fn verified(&self) -> bool {
        self.is_sound() && self.deviation.is_none_or(|d| d.is_allowed())
    }

    /// Whether the result is of the topology of the repaired input, without faces that cross each other, unless the input
    /// has some, too.
    pub fn is_sound(&self) -> bool {
        self.has_topology() && (self.crossing_faces.is_empty() || self.crossing_faces_of_input != Some(0))
    }

    /// Whether the result is an oriented manifold of the repaired input's Euler characteristic, components and
    /// boundary loops.
    pub fn has_topology(&self) -> bool {
        let kind = |t: &Topology| (t.euler, t.components, t.boundary_loops);
        self.output.is_manifold() && self.output.is_oriented() && kind(&self.output) == kind(&self.repaired)
    }
}

/// σp in units of the mean spacing d at which the scan with ε = 0.5 keeps a density of 2 / (√3 d²): measured on eleven
/// closed models at 5,000 to 20,000 points, where it met the count within 1 %.
const SIGMA_OF_SPACING: f64 = 0.866;

/// Candidates for each wanted point: with fewer the scan leaves gaps, with more it only takes longer.
const CANDIDATES_PER_POINT: usize = 20;

/// Samples of the boundary for each wanted point: a narrow band has two, a heap of needles might have thousands.
const MOST_ON_CURVES: f64 = 4.0;

/// Share of the error that is allowed below which it does not matter how small it is.
const OF_INTEREST: f64 = 0.25;

/// Longest edge of the domain in mean spacings, for the sake of the walks over it.
const LONGEST_EDGE: f64 = 2.0;

/// Remeshes `input`: as many vertices as wanted, evenly spread over its surface, and triangles of its topology.
///
/// An input that is not an oriented manifold is made one first; [`Remeshed::repairs`] says what that took.
///
/// With [`Density::Auto`] the input is remeshed several times. The error falls about as one over the number of vertices,
/// so the next number follows from the last error, between the largest one that did not do and the smallest one that
/// did. The result is the latter, once both are within a tenth of each other.
///
/// # Errors
/// [`Error::Mesh`] for an input without triangles or without area, or with bad numbers; [`Error::Option`] for options
/// out of range; [`Error::Cancelled`] if the monitor asks for it.
pub fn remesh(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    options.validate()?;
    match options.density {
        Density::Auto => with_fewest_points(input, options, monitor),
        _ => remesh_soundly(input, options, monitor),
    }
}

/// The vertices that the search for as few as needed begins with, the tries that it takes at most, and the factor
/// between two numbers at which it ends.
const FIRST_POINTS: usize = 2_000;
const MOST_TRIES: usize = 8;
const NEAR_ENOUGH: f64 = 1.1;

/// Most that the number of vertices changes by from one try to the next: a single far place says little about others.
const LARGEST_CHANGE: f64 = 8.0;

/// The result of the fewest vertices that keep to the error asked for, of those that were tried; if none did, the last.
fn with_fewest_points(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    let (mut too_few, mut enough) = (FEWEST_POINTS as f64, MOST_POINTS as f64);
    let (mut best, mut last) = (None, None);
    let mut n = FIRST_POINTS as f64;
    for _ in 0..MOST_TRIES {
        let density = Density::Points(n.round() as usize);
        let made = remesh_soundly(input, &Options { density, ..options.clone() }, monitor)?;
        let ratio = made.deviation.map_or(1.0, |d| d.reached / d.allowed);
        if ratio <= 1.0 {
            enough = n;
            best = Some(made);
        } else {
            too_few = n;
            last = Some(made);
        }
        if enough <= NEAR_ENOUGH * too_few || n == enough && n <= NEAR_ENOUGH * FEWEST_POINTS as f64 {
            break;
        }
        let wanted = n * ratio.clamp(1.0 / LARGEST_CHANGE, LARGEST_CHANGE);
        // Well inside of what is left, so that each try narrows it down.
        let step = (enough / too_few).powf(0.2).min(NEAR_ENOUGH);
        n = wanted.clamp(step * too_few, enough / step);
    }
    Ok(best.or(last).expect("at least one try was made"))
}

/// Attempts at a sound result, each with other random numbers: where a wall is far thinner than the spacing, whether all
/// its faces can be parted is a matter of where the samples happen to lie.
const MOST_ATTEMPTS: u64 = 3;

/// The first result that is sound, or, if none is, the one with the fewest faces that cross.
fn remesh_soundly(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    let mut best: Option<Remeshed> = None;
    for attempt in 0..MOST_ATTEMPTS {
        // Far from the seeds that people give.
        let seed = options.seed.wrapping_add(attempt << 48);
        let mut made = remesh_once(input, &Options { seed, ..options.clone() }, monitor)?;
        let sound = made.is_sound();
        if sound && attempt > 0 {
            made.notes.push(format!("attempt {} of {MOST_ATTEMPTS}: before it, some faces crossed", attempt + 1));
        }
        let rank = |r: &Remeshed| (!r.has_topology(), r.crossing_faces.len());
        if best.as_ref().is_none_or(|best| rank(&made) < rank(best)) {
            best = Some(made);
        }
        if sound {
            break;
        }
    }
    Ok(best.expect("at least one attempt was made"))
}

fn remesh_once(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    monitor.stage("repair");
    refuse_bad_numbers(input)?;
    options.sizing.as_deref().map_or(Ok(()), |lengths| check_field(input, lengths))?;
    let unit = Unit::of(input);
    let mut clean = unit.inwards(input);
    if let Some(tolerance) = options.weld {
        clean = close_seams(&clean, tolerance / unit.size);
    }
    let (mut clean, repairs) = repair(&clean);
    let open_seams = if options.weld.is_none() { open_seams(&clean) } else { 0 };
    let input_topology = topology(input.positions.len(), &input.triangles);
    let untouched = options.weld.is_none() && repairs == Repairs::default();
    let repaired = if untouched { input_topology } else { topology(clean.positions.len(), &clean.triangles) };
    let field = options.sizing.as_deref().map(|lengths| Field::new(lengths, input, &unit));
    let mut scale = Scale::new(options.density, field.as_ref(), &clean, &unit)?;
    let allowed = options.max_error.map(|e| e.length(unit.size * clean.diagonal()));
    check(monitor)?;

    monitor.stage("sample");
    let most = 4 * clean.triangles.len() + 16 * scale.wanted;
    refine(&mut clean, LONGEST_EDGE * scale.spacing, most);
    let mut domain = Domain::with_features(clean, options.features, scale.spacing);
    if let Some(field) = &field {
        scale = field.grade(&mut domain, options.density, scale)?;
    } else if options.adapt > 0.0 {
        domain.grade(adapted_sizes(&domain, options.adapt, scale.spacing));
    }
    let (domain, mut made) = sample_and_triangulate(domain, &scale, &repaired, options, monitor)?;
    if options.optimize {
        optimize(&domain, &mut made.mesh, &scale, allowed.map(|a| a / unit.size), monitor)?;
    } else {
        meet_count(&domain, &mut made.mesh, scale.wanted);
        monitor.stage("ascend");
        let climb = Climb { sigma: ASCENT_SIGMA * scale.spacing, step: PAPER_STEP, sweeps: options.sweeps };
        ascend(&domain, &mut made.mesh, climb, monitor)?;
    }

    monitor.stage("untangle");
    untangle(&domain, &mut made.mesh, monitor)?;
    let mesh = made.mesh.to_mesh();
    let deviation = allowed.and_then(|allowed| {
        monitor.stage("bound");
        let Bounds { upper, place, .. } = hausdorff_bounds(&mesh, &domain.mesh, OF_INTEREST * allowed / unit.size)?;
        Some(Deviation { allowed, reached: unit.size * upper, place: unit.outwards_point(place).to_array() })
    });
    let mesh = unit.outwards(mesh);
    let crossing = crossing_faces(&mesh);
    let mut result = Remeshed {
        input: input_topology,
        repaired,
        output: topology(mesh.positions.len(), &mesh.triangles),
        mesh,
        repairs,
        sigma_p: unit.size * scale.sigma(),
        spacing: unit.size * scale.spacing,
        spacing_range: domain.size_range().map(|size| unit.size * scale.spacing * size),
        wanted: scale.wanted,
        sharp_curves: domain.sharp_curves(),
        tessellated_pieces: made.tessellated_pieces,
        crossing_faces_of_input: (!crossing.is_empty()).then(|| domain.crossing_faces().len()),
        crossing_faces: crossing,
        deviation,
        notes: Vec::new(),
    };
    result.notes = notes(&result, open_seams);
    Ok(result)
}

/// The mesh of the samples of `domain`, which comes back without its sharp edges if they could not be kept.
fn sample_and_triangulate(
    domain: Domain,
    scale: &Scale,
    wanted: &Topology,
    options: &Options,
    monitor: &dyn Monitor,
) -> Result<(Domain, Meshed)> {
    for density in CURVE_DENSITIES {
        let meshed = mesh_of_samples(&domain, scale, density, options, monitor)?;
        if meshed.glued && has_kind(&meshed.mesh, wanted) || domain.sharp_curves() == 0 {
            return Ok((domain, meshed));
        }
        monitor.stage("sample");
    }
    let domain = domain.smooth();
    let meshed = mesh_of_samples(&domain, scale, 1.0, options, monitor)?;
    Ok((domain, meshed))
}

/// Points on curves for each spacing of their length, in one attempt after the other: patches narrower than the spacing
/// need more of them.
const CURVE_DENSITIES: [f64; 3] = [1.0, 2.0, 4.0];

/// Samples, triangulated.
struct Meshed {
    mesh: Manifold,
    /// Whether the patches between the curves fit together.
    glued: bool,
    tessellated_pieces: usize,
}

/// Samples `domain` and triangulates the samples.
fn mesh_of_samples(
    domain: &Domain,
    scale: &Scale,
    curve_density: f64,
    options: &Options,
    monitor: &dyn Monitor,
) -> Result<Meshed> {
    let curves = sample_curves(domain, scale.curve_spacing(domain) / curve_density);
    let candidates =
        candidates(domain, CANDIDATES_PER_POINT * scale.wanted, &mut stream(options.seed, Stage::Candidates));
    let samples = linear_scan(domain, &candidates, &curves.samples, scale.sigma(), options.seed, monitor)?;
    drop(candidates);
    monitor.stage("triangulate");
    let boundary = Boundary { sites: &curves.sites, successor: &curves.successor };
    let patches = triangulate(domain, &samples, boundary, scale.spacing, monitor)?;
    let seams = Seams { point: &curves.point, edges: &curves.edges, corners: &curves.corners };
    let glued = glue(&patches, seams);
    let tessellated_pieces = patches.tessellated_pieces;
    Ok(match glued {
        Some(mesh) => Meshed { mesh, glued: true, tessellated_pieces },
        None => {
            let mut mesh = patches.mesh;
            mesh.hold_boundary();
            Meshed { mesh, glued: false, tessellated_pieces }
        }
    })
}

fn has_kind(mesh: &Manifold, wanted: &Topology) -> bool {
    let (triangles, old) = mesh.connectivity.compact();
    let made = topology(old.len(), &triangles);
    (made.euler, made.components, made.boundary_loops) == (wanted.euler, wanted.components, wanted.boundary_loops)
}

/// The mesh of the samples, coarse to fine, with good angles, at the wanted count, and fitted to the surface: to within
/// `limit`, in the pipeline's unit, if that can be.
fn optimize(
    domain: &Domain,
    mesh: &mut Manifold,
    scale: &Scale,
    limit: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<()> {
    let Scale { wanted, spacing } = *scale;
    monitor.stage("ascend");
    if fix_all_but_narrow(domain, mesh, spacing) {
        let narrow = Climb { sigma: COARSE_SIGMA * spacing, step: LONG_STEP, sweeps: COARSE_SWEEPS };
        ascend(domain, mesh, narrow, monitor)?;
    }
    fix_all_but_bent(mesh);
    let fine = Climb { sigma: ASCENT_SIGMA * spacing, step: LONG_STEP, sweeps: FINE_SWEEPS };
    ascend(domain, mesh, fine, monitor)?;
    coarsen(domain, mesh, spacing);
    let coarse = Climb { sigma: COARSE_SIGMA * 2.0 * spacing, step: LONG_STEP, sweeps: COARSE_SWEEPS / 2 };
    for _ in 0..2 {
        ascend(domain, mesh, coarse, monitor)?;
        balance(domain, mesh, wanted, spacing);
    }
    monitor.stage("relax");
    remove_near_defects(mesh, 2.0 * spacing);
    relax(domain, mesh, 2.0 * spacing, Flips::KeepValence, SETTLING_ROUNDS, monitor)?;
    relax(domain, mesh, 2.0 * spacing, Flips::Delaunay, ROUNDS, monitor)?;
    *mesh = split_to(domain, mesh, wanted);
    fix_tips(mesh);
    remove_near_defects(mesh, spacing);
    relax(domain, mesh, spacing, Flips::Delaunay, ROUNDS, monitor)?;
    meet_count(domain, mesh, wanted);
    for _ in 0..2 {
        let wide: Vec<bool> = narrow(domain, mesh, spacing).into_iter().map(|narrow| !narrow).collect();
        remove_defects(mesh, &wide);
        relax(domain, mesh, spacing, Flips::KeepValence, SETTLING_ROUNDS, monitor)?;
    }
    relax(domain, mesh, spacing, Flips::KeepValence, 2 * ROUNDS, monitor)?;
    monitor.stage("improve angles");
    mesh.fixed.fill(false);
    improve_angles(domain, mesh, spacing, monitor)?;
    monitor.stage("fit");
    fit(domain, mesh, spacing, limit, monitor)?;
    // A vertex that was taken back to the surface may have spoilt its triangles.
    improve_angles(domain, mesh, spacing, monitor)
}

/// Sweeps of ascent in the places that no coarser mesh can follow, and those over the coarse mesh: irregular vertices
/// get fewer up to about seventy.
const FINE_SWEEPS: usize = 11;
const COARSE_SWEEPS: usize = 40;

/// Kernel width of the ascent over the coarse mesh, in its spacings: a wide one orders more.
const COARSE_SIGMA: f64 = 1.1;

/// Rounds of relaxation at each level: after three, vertices move by a hundredth of an edge. Those after defects have gone
/// only give the rows room.
const ROUNDS: usize = 3;
const SETTLING_ROUNDS: usize = 2;

/// A field of wanted edge lengths, in the pipeline's unit.
struct Field {
    mesh: Mesh,
    lengths: Vec<f64>,
}

impl Field {
    /// `lengths` at the vertices of `input`.
    fn new(lengths: &[f64], input: &Mesh, unit: &Unit) -> Field {
        Field { mesh: unit.inwards(input), lengths: lengths.iter().map(|length| length / unit.size).collect() }
    }

    /// The spacing of as many vertices as the lengths ask for.
    fn spacing(&self) -> f64 {
        mean_density(&self.mesh, &self.lengths).sqrt().recip()
    }

    /// Gives `domain` the sizes of the field, and the scale that they have with that density. Repairs number the
    /// vertices anew, so the lengths are looked up by place.
    fn grade(&self, domain: &mut Domain, density: Density, scale: Scale) -> Result<Scale> {
        let lengths = transferred(&self.lengths, &self.mesh, &domain.mesh.positions);
        if density != Density::OfSizing {
            domain.grade(field_sizes(domain, lengths, scale.spacing));
            return Ok(scale);
        }
        let lengths = field_lengths(domain, lengths);
        let spacing = mean_density(&domain.mesh, &lengths).sqrt().recip();
        domain.grade(lengths.into_iter().map(|length| length / spacing).collect());
        let wanted = count(domain.mesh.area(), spacing);
        check_count("sizing", wanted, format!("the lengths mean {wanted} vertices"))?;
        Ok(Scale { wanted, spacing })
    }
}

/// How many vertices at distance `spacing` cover `area` at hexagonal packing: √3 / 2 d² each.
fn count(area: f64, spacing: f64) -> usize {
    (2.0 * area / (3f64.sqrt() * spacing * spacing)).round() as usize
}

/// The lengths that a density means on a surface, in the pipeline's unit.
struct Scale {
    wanted: usize,
    spacing: f64,
}

/// Smallest spacing that can be worked with, in the pipeline's unit: cells of the sampler are numbered in 32 bits.
const SMALLEST_SPACING: f64 = 1e-8;

impl Scale {
    fn new(density: Density, field: Option<&Field>, clean: &Mesh, unit: &Unit) -> Result<Scale> {
        let area = clean.area();
        if area <= unit.area_of_rounding(clean) {
            return Err(Error::Mesh {
                cause: "the triangles have no area".into(),
                remedy: "a surface is needed; check that the coordinates are not all on one line".into(),
            });
        }
        let checked = |wanted: usize, spacing: f64| {
            if spacing >= SMALLEST_SPACING {
                return Ok(Scale { wanted, spacing });
            }
            let cause = format!("{wanted} vertices would be {:e} apart", spacing * unit.size);
            Err(Error::Mesh { cause, remedy: "so narrow a surface needs fewer vertices".into() })
        };
        let from_length = |option, length: f64, spacing: f64| {
            let wanted = count(area, spacing);
            check_count(option, wanted, format!("a length of {length} means {wanted} vertices"))?;
            checked(wanted, spacing)
        };
        let points = |n: usize| checked(n, (2.0 * area / (3f64.sqrt() * n as f64)).sqrt());
        match density {
            Density::Points(n) => points(n),
            Density::EdgeLength(l) => from_length("edge-length", l, l / unit.size),
            Density::OfSizing => {
                let spacing = field.map_or(f64::NAN, Field::spacing);
                from_length("sizing", spacing * unit.size, spacing)
            }
            Density::SigmaP(s) => from_length("sigma-p", s, s / unit.size / SIGMA_OF_SPACING),
            Density::Auto => points(FIRST_POINTS),
        }
    }

    /// The spacing along curves: wider where they are so long, for the area, that they would take many times the wanted
    /// vertices.
    fn curve_spacing(&self, domain: &Domain) -> f64 {
        self.spacing.max(domain.curves.length() / (MOST_ON_CURVES * self.wanted as f64))
    }

    fn sigma(&self) -> f64 {
        SIGMA_OF_SPACING * self.spacing
    }
}

/// The pipeline's own coordinates: around the origin and about one in size, so that neither the scale of the input nor
/// its distance from the origin matters.
struct Unit {
    centre: DVec3,
    /// A power of two, so that scaling is exact.
    size: f64,
}

impl Unit {
    fn of(mesh: &Mesh) -> Unit {
        let (lo, hi) = mesh.bounds().unwrap_or_default();
        let longest = (hi - lo).max_element();
        let size = if longest > 0.0 { longest.log2().ceil().exp2() } else { 1.0 };
        Unit { centre: lo + (hi - lo) / 2.0, size }
    }

    /// The area that `mesh`, in this unit, could have if all its corners were on one line but for the rounding of their
    /// coordinates.
    fn area_of_rounding(&self, mesh: &Mesh) -> f64 {
        let longest = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        let rounding = f64::EPSILON * (1.0 + self.centre.abs().max_element() / self.size);
        (0..mesh.triangles.len()).map(|t| rounding * longest(t)).sum()
    }

    fn inwards(&self, mesh: &Mesh) -> Mesh {
        let positions = mesh.positions.iter().map(|&p| (p - self.centre) / self.size).collect();
        Mesh { positions, triangles: mesh.triangles.clone() }
    }

    fn outwards(&self, mut mesh: Mesh) -> Mesh {
        mesh.positions.iter_mut().for_each(|p| *p = self.outwards_point(*p));
        mesh
    }

    fn outwards_point(&self, p: DVec3) -> DVec3 {
        p * self.size + self.centre
    }
}

/// Largest coordinate that can be worked with: squares of differences must stay finite.
const LARGEST_COORDINATE: f64 = 1e150;

fn refuse_bad_numbers(mesh: &Mesh) -> Result<()> {
    let mesh_error = |cause: String, remedy: &str| Err(Error::Mesh { cause, remedy: remedy.into() });
    if mesh.triangles.is_empty() {
        let n = mesh.positions.len();
        let remedy = "a surface with faces is needed; reconstruct one from the points first";
        return mesh_error(format!("{n} points and no faces"), remedy);
    }
    if let Some(v) = mesh.positions.iter().position(|p| !p.abs().cmplt(DVec3::splat(LARGEST_COORDINATE)).all()) {
        return mesh_error(format!("vertex {v} is at {}", mesh.positions[v]), "remove it or mend its coordinates");
    }
    let bound = mesh.positions.len();
    if let Some(t) = mesh.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= bound)) {
        return mesh_error(
            format!("triangle {t} has a corner that is not there: {:?} of {bound}", mesh.triangles[t]),
            "mend the indices",
        );
    }
    Ok(())
}

/// What a user should know about a result.
fn notes(result: &Remeshed, open_seams: usize) -> Vec<String> {
    let mut notes = Vec::new();
    let r = &result.repairs;
    let mut note = |n: usize, text: &str| {
        if n > 0 {
            notes.push(format!("{n} {text}"));
        }
    };
    note(r.cut_edges, "edges with more than two faces were taken apart into sheets");
    note(r.split_vertices, "vertices were doubled where sheets met only at a point or an edge");
    note(r.unorientable_edges, "edges were cut open because the surface has no two sides (like a Möbius strip)");
    note(r.flipped_triangles, "faces were turned over to agree with their neighbours");
    note(r.degenerate_triangles + r.duplicate_triangles, "degenerate or repeated faces were dropped");
    note(
        open_seams,
        "boundary vertices all but touch another one: seams that rounding left open? Welding within a tolerance closes them",
    );
    if result.output.vertices != result.wanted {
        notes.push(format!(
            "{} vertices instead of {}: the topology of the input needs as many",
            result.output.vertices, result.wanted
        ));
    }
    notes.extend(note_on_crossings(result));
    notes.extend(result.deviation.as_ref().filter(|d| !d.is_allowed()).map(note_on_deviation));
    if !result.has_topology() {
        notes.push("the result does not have the topology of the input".into());
    }
    notes
}

/// How many faces cross, where the first one is, and whether the input is to blame.
fn note_on_crossings(result: &Remeshed) -> Option<String> {
    let (first, count) = (*result.crossing_faces.first()?, result.crossing_faces.len());
    let place = near(result.mesh.corners(first as usize).into_iter().sum::<DVec3>() / 3.0);
    let input = match result.crossing_faces_of_input {
        Some(0) | None => "none of the input do; more points there would part them".into(),
        Some(n) => format!("so do {n} of the input"),
    };
    Some(format!("{count} faces cross or touch each other, the first {place}: {input}"))
}

/// By how much the error that was asked for is exceeded, and where.
fn note_on_deviation(deviation: &Deviation) -> String {
    let Deviation { allowed, reached, place } = deviation;
    let place = near(DVec3::from_array(*place));
    format!("{reached:.4e} from the input {place}, and not within {allowed:.4e}: more points come nearer")
}

fn near(place: DVec3) -> String {
    let [x, y, z] = place.to_array().map(|x| format!("{x:.6}"));
    format!("near ({x}, {y}, {z})")
}
