//! The pipeline from mesh to mesh.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::rng::{Stage, stream};
use crate::manifold::Manifold;
use crate::mesh::refine::refine;
use crate::mesh::topology::{Topology, topology, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::optimize::counts::meet_count;
use crate::optimize::self_intersections::resolve_self_intersections;
use crate::pipeline::follow::{ascend_as_asked, follow};
use crate::pipeline::optimization::optimize;
use crate::pipeline::options::{Density, FEWEST_POINTS, FIRST_POINTS, MOST_POINTS, Options};
use crate::pipeline::result::{Deviation, Remeshed, notes};
use crate::pipeline::scale::{CANDIDATES_PER_POINT, LONGEST_EDGE, Scale};
use crate::pipeline::source::Source;
use crate::prepare::bend::{Split, smoothed};
use crate::quality::bound::{Bounds, hausdorff_bounds};
use crate::spatial::self_intersections::self_intersections;
use crate::spectral::candidates::candidates;
use crate::spectral::curve_samples::sample_curves;
use crate::spectral::scan::linear_scan;
use crate::surface::domain::Domain;
use crate::surface::features::{sharp_length, sharp_sides};
use crate::surface::sizing::adapted_sizes;
use crate::triangulate::stitch::{Gluing, glue};
use crate::triangulate::{Boundary, triangulate};

/// Share of the error that is allowed below which it does not matter how small it is.
const OF_INTEREST: f64 = 0.25;

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
///
/// [`Error::Mesh`]: crate::base::error::Error::Mesh
/// [`Error::Option`]: crate::base::error::Error::Option
/// [`Error::Cancelled`]: crate::base::error::Error::Cancelled
pub fn remesh(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    options.validate()?;
    match options.density {
        Density::Auto => with_fewest_points(input, options, monitor),
        _ => remesh_soundly(input, options, monitor),
    }
}

/// The tries that the search for as few vertices as needed takes at most, and the factor between two numbers at which it
/// ends.
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

/// More faces than this do not cross by chance: the samples are too few for how near to each other the walls are.
const MOST_BY_CHANCE: usize = 60;

/// The first result that is sound, or, if none is, the one with the fewest faces that cross.
fn remesh_soundly(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    let mut best: Option<Remeshed> = None;
    for attempt in 0..MOST_ATTEMPTS {
        // Far from the seeds that people give.
        let seed = options.seed.wrapping_add(attempt << 48);
        let mut made = remesh_once(input, &Options { seed, ..options.clone() }, monitor)?;
        let sound = made.is_sound();
        if sound && attempt > 0 {
            made.notes.push(format!(
                "attempt {} of {MOST_ATTEMPTS}: before it, samples that could not be made a sound mesh",
                attempt + 1
            ));
        }
        let rank = |r: &Remeshed| (!r.has_topology(), r.self_intersections.len());
        if best.as_ref().is_none_or(|best| rank(&made) < rank(best)) {
            best = Some(made);
        }
        if sound || best.as_ref().is_some_and(|best| best.self_intersections.len() > MOST_BY_CHANCE) {
            break;
        }
    }
    Ok(best.expect("at least one attempt was made"))
}

fn remesh_once(input: &Mesh, options: &Options, monitor: &dyn Monitor) -> Result<Remeshed> {
    monitor.stage("repair");
    let (source, mut clean) = Source::new(input, options)?;
    let scale = Scale::new(options.density, source.field.as_ref(), &clean, &source.unit)?;
    check(monitor)?;
    if let Some(reach) = options.smooth {
        monitor.stage("smooth");
        clean = smoothed(&clean, reach);
        check(monitor)?;
    }

    monitor.stage("sample");
    let graded = graded(&source, clean, scale, monitor)?;
    let (graded, mut made) = sample_and_triangulate(graded, &source.of_sampled, options, monitor)?;
    arrange(&source, &graded, &mut made.mesh, monitor)?;
    monitor.stage("resolve self-intersections");
    resolve_self_intersections(&graded.domain, &mut made.mesh, monitor)?;
    let mesh = made.mesh.to_mesh();
    let deviation = deviation(&source, &graded.domain, &mesh, monitor);
    Ok(remeshed(&source, &graded, &made, mesh, deviation))
}

/// A domain that knows the lengths wanted on it, the scale that these have, and the width σp of the kernel, both in the
/// pipeline's unit.
struct Graded {
    domain: Domain,
    scale: Scale,
    sigma: f64,
    /// Whether there were sharp edges that could not be kept.
    blunted: bool,
}

/// The domain of `clean` with the lengths that a field, the shape or a kernel want, and an interface.
fn graded(source: &Source, clean: Mesh, mut scale: Scale, monitor: &dyn Monitor) -> Result<Graded> {
    let options = source.options;
    let (mut domain, blunted) = domain_over(clean, source, &scale);
    if let Some(field) = &source.field {
        scale = field.grade(&mut domain, options.density, scale)?;
    } else if options.adapt > 0.0 {
        domain.grade(adapted_sizes(&domain, options.adapt, scale.spacing));
    }
    let mut sigma = scale.sigma();
    if options.has_kernel() {
        let followed = follow(&domain, &source.beside(&domain), scale, options, monitor)?;
        domain.grade(followed.sizes);
        (scale, sigma) = (followed.scale, followed.sigma);
    }
    if let Some(within) = &source.within {
        scale = within.grade(&mut domain, options.density, &scale);
        sigma = if options.has_kernel() { sigma } else { scale.sigma() };
    }
    Ok(Graded { domain, scale, sigma, blunted })
}

/// The domain over `clean`, refined for that scale; and whether it had more sharp edges than can be kept.
fn domain_over(mut clean: Mesh, source: &Source, scale: &Scale) -> (Domain, bool) {
    let (twin, mut sharp) = refined(&mut clean, source.options, scale);
    let blunted = !scale.has_room_on(sharp_length(&clean, &sharp));
    if blunted {
        sharp.fill(false);
    }
    let interface = source.within.as_ref().map_or_else(Vec::new, |within| within.part.interface.clone());
    (Domain::with_sharp(clean, twin, &sharp, scale.spacing, interface), blunted)
}

/// Splits the long edges of `clean`, and bends it where its vertices are points of a smooth surface. The side across each of
/// its sides then, and whether it is sharp.
fn refined(clean: &mut Mesh, options: &Options, scale: &Scale) -> (Vec<u32>, Vec<bool>) {
    let longest = LONGEST_EDGE * scale.spacing;
    let most = 4 * clean.triangles.len() + 16 * scale.wanted;
    let creases = |mesh: &Mesh| {
        let twin = twins(&mesh.triangles);
        let sharp = sharp_sides(mesh, &twin, options.features, scale.spacing);
        (twin, sharp)
    };
    let Some(reach) = options.reach() else {
        refine(clean, longest, most);
        return creases(clean);
    };
    let (mut twin, mut sharp) = creases(clean);
    let split = Split::new(clean, &sharp, longest, scale.spacing, most);
    if !split.is_empty() {
        // Neither splitting nor bending makes an edge sharp.
        (twin, sharp) = if sharp.contains(&true) {
            creases(clean)
        } else {
            (twins(&clean.triangles), vec![false; 3 * clean.triangles.len()])
        };
        split.bend(clean, &twin, &sharp, reach);
    }
    (twin, sharp)
}

/// Optimises the mesh, or, if that is not wanted, gives it the wanted count and leaves it where the paper's ascent does.
fn arrange(source: &Source, graded: &Graded, mesh: &mut Manifold, monitor: &dyn Monitor) -> Result<()> {
    let Graded { domain, scale, sigma, .. } = graded;
    if source.options.optimize {
        return optimize(domain, mesh, scale, source.allowed.map(|a| a / source.unit.size), monitor);
    }
    meet_count(domain, mesh, scale.wanted);
    monitor.stage("ascend");
    ascend_as_asked(domain, mesh, &source.beside(domain), *sigma, source.options.sweeps, monitor)
}

/// How far `mesh` is from the domain, if that is asked for.
fn deviation(source: &Source, domain: &Domain, mesh: &Mesh, monitor: &dyn Monitor) -> Option<Deviation> {
    let Source { allowed, unit, .. } = source;
    let allowed = (*allowed)?;
    monitor.stage("bound");
    let Bounds { upper, place, .. } = hausdorff_bounds(mesh, &domain.mesh, OF_INTEREST * allowed / unit.size)?;
    Some(Deviation { allowed, reached: unit.size * upper, place: unit.outwards_point(place).to_array() })
}

/// `mesh`, that of `made`, in the units of the input and joined to what was to stay of it, and what there is to say.
fn remeshed(source: &Source, graded: &Graded, made: &Meshed, mesh: Mesh, deviation: Option<Deviation>) -> Remeshed {
    let Graded { domain, scale, sigma, blunted } = graded;
    let (unit, within) = (&source.unit, source.within.as_ref());
    let mesh = unit.outwards(mesh);
    let (mesh, kept) = match within {
        Some(within) => within.sew(&mesh, &made.mesh, domain, source.input),
        None => (mesh, None),
    };
    let crossing = self_intersections(&mesh);
    let crossing_of_input =
        || within.map_or_else(|| domain.self_intersections(), |within| self_intersections(&within.whole));
    let mut result = Remeshed {
        input: source.of_input,
        repaired: source.of_repaired,
        output: topology(mesh.positions.len(), &mesh.triangles),
        mesh,
        repairs: source.repairs,
        sigma_p: unit.size * sigma,
        spacing: unit.size * scale.spacing,
        spacing_range: domain.size_range().map(|size| unit.size * scale.spacing * size),
        wanted: within.map_or(scale.wanted, |within| within.wanted(scale.wanted)),
        sharp_curves: domain.sharp_curves(),
        tessellated_patches: made.tessellated_patches,
        self_intersections_of_input: (!crossing.is_empty()).then(|| crossing_of_input().len()),
        self_intersections: crossing,
        deviation,
        kept,
        notes: Vec::new(),
    };
    result.notes = notes(&result, source.open_cracks, *blunted);
    if let (Some(within), Some(kept)) = (within, &result.kept) {
        result.notes.extend(within.notes(&result.mesh, kept));
    }
    result
}

/// The mesh of the samples of a domain, which comes back without its sharp edges if they could not be kept.
fn sample_and_triangulate(
    graded: Graded,
    wanted: &Topology,
    options: &Options,
    monitor: &dyn Monitor,
) -> Result<(Graded, Meshed)> {
    for density in CURVE_DENSITIES {
        let meshed = least_crossing(&graded, density, options, monitor)?;
        if meshed.glued && has_kind(&meshed.mesh, wanted) || graded.domain.sharp_curves() == 0 {
            return Ok((graded, meshed));
        }
        monitor.stage("sample");
    }
    let graded = Graded { domain: graded.domain.smooth(), blunted: true, ..graded };
    let meshed = least_crossing(&graded, 1.0, options, monitor)?;
    Ok((graded, meshed))
}

/// The mesh of the samples; where its patches fit together, but its faces cross more than those of the surface, that of
/// other samples if they cross less. At a thin wall the samples of its two sides may come together such that nothing later
/// parts them.
fn least_crossing(graded: &Graded, curve_density: f64, options: &Options, monitor: &dyn Monitor) -> Result<Meshed> {
    let Graded { domain, scale, .. } = graded;
    let mut best = mesh_of_samples(domain, scale, curve_density, options.seed, monitor)?;
    let mut least = self_intersections(&best.mesh.to_mesh()).len();
    let of_surface = if least == 0 { 0 } else { domain.self_intersections().len() };
    for attempt in 1..MOST_SAMPLINGS {
        if least <= of_surface || !best.glued {
            break;
        }
        monitor.stage("sample");
        let seed = options.seed.wrapping_add(attempt << 40);
        let other = mesh_of_samples(domain, scale, curve_density, seed, monitor)?;
        let crossing = self_intersections(&other.mesh.to_mesh()).len();
        if crossing < least {
            (best, least) = (other, crossing);
        }
    }
    Ok(best)
}

/// Times that the surface is sampled, the first included, for a mesh that does not cross itself.
const MOST_SAMPLINGS: u64 = 4;

/// Points on curves for each spacing of their length, in one attempt after the other: patches narrower than the spacing
/// need more of them.
const CURVE_DENSITIES: [f64; 3] = [1.0, 2.0, 4.0];

/// Samples, triangulated.
struct Meshed {
    mesh: Manifold,
    /// Whether the patches between the curves fit together.
    glued: bool,
    tessellated_patches: usize,
}

/// Samples `domain` and triangulates the samples.
fn mesh_of_samples(
    domain: &Domain,
    scale: &Scale,
    curve_density: f64,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Meshed> {
    let curves = sample_curves(domain, scale.curve_spacing(domain) / curve_density);
    let candidates = candidates(domain, CANDIDATES_PER_POINT * scale.wanted, &mut stream(seed, Stage::Candidates));
    let samples = linear_scan(domain, &candidates, &curves.samples, scale.sigma(), seed, monitor)?;
    drop(candidates);
    monitor.stage("triangulate");
    let boundary = Boundary { sites: &curves.sites, successor: &curves.successor };
    let patches = triangulate(domain, &samples, boundary, scale.spacing, monitor)?;
    let interfaces = Gluing { point: &curves.point, edges: &curves.edges, corners: &curves.corners };
    let glued = glue(&patches, interfaces);
    let tessellated_patches = patches.tessellated_patches;
    Ok(match glued {
        Some(mesh) => Meshed { mesh, glued: true, tessellated_patches },
        None => {
            let mut mesh = patches.mesh;
            mesh.lock_boundary();
            Meshed { mesh, glued: false, tessellated_patches }
        }
    })
}

fn has_kind(mesh: &Manifold, wanted: &Topology) -> bool {
    let (triangles, old) = mesh.connectivity.compact();
    let made = topology(old.len(), &triangles);
    (made.euler, made.components, made.boundary_loops) == (wanted.euler, wanted.components, wanted.boundary_loops)
}
