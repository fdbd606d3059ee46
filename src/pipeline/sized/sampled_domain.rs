//! Domain that is sampled for a number of vertices: refined, with the feature curves that so many vertices can follow.

use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::refine::{refine, refine_edges};
use crate::mesh::sides::lower_first;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::density::Density;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::scale::{LONGEST_EDGE, LONGEST_ON_CURVES, Scale};
use crate::pipeline::sized::expected::with_curves;
use crate::pipeline::sized::resizing::Resizing;
use crate::pipeline::sized::sharp_edges::left_out as edges_left_out;
use crate::pipeline::sized::within::Within;
use crate::prepare::bend::Split;
use crate::surface::domain::Domain;
use crate::surface::features::sharp_sides;
use crate::surface::narrow_patches::{LeftOut, Room, leave_out_narrow, samples_on};
use crate::surface::sizing::has_room_between_curves;
use crate::surface::wedges::end_wedges;
use glam::DVec3;
use std::collections::HashSet;

/// Steps up to this width, in mean distances of neighbouring points, come from sampling and not from the surface: in a
/// lattice, the diagonal of a cell is one and a half times its side.
const STEP: f64 = 1.5;

/// Maximum share of the vertices on sharp edges.
const MOST_ON_EDGES: f64 = 0.6;

/// Share of the vertices above which a boundary is long: it may take so many that edges become much longer.
const LONG_BOUNDARY: f64 = 0.2;

/// Factor by which edges may become longer for that reason before the curves are found again, and the maximum number of
/// times that they are.
const LONGER: f64 = 1.2;
const TRIES: usize = 3;

/// Domain, and information on sharp edges that were left out.
pub(in crate::pipeline) struct SampledDomain {
    pub domain: Domain,
    /// Whether it had more sharp edges than can be kept.
    pub blunted: bool,
    pub left_out: LeftOut,
    /// Ends of the edges that were left out.
    pub left_out_edges: Vec<[DVec3; 2]>,
}

/// Calls [`domain_over`] for `clean` at the spacing that its boundary leaves for the number of vertices: of corners closer
/// together than vertices will be, only one counts. Sharp edges are left out by `domain_over` itself.
pub(in crate::pipeline) fn domain_at(
    clean: OrientedManifold,
    within: Option<&Within>,
    prepared: &PreparedInput,
    scale: &Scale,
    density: Density,
    resizing: &Resizing,
) -> SampledDomain {
    let has_boundary = within.is_none() && prepared.of_repaired.boundary_loops > 0;
    let is_long = || samples_on_boundary(&clean, scale.spacing) > LONG_BOUNDARY * scale.wanted as f64;
    let again = (has_boundary && is_long()).then(|| clean.clone());
    let mut found = domain_over(clean, within, prepared, scale, resizing);
    let Some(clean) = again else { return found };
    let mut at = *scale;
    for _ in 0..TRIES {
        let spacing = with_curves(&found.domain, *scale, density).spacing;
        if found.domain.is_sharp() || spacing <= LONGER * at.spacing {
            break;
        }
        at.spacing = spacing;
        found = domain_over(clean.clone(), within, prepared, &at, resizing);
    }
    found
}

/// Returns the number of samples `spacing` apart on the boundary of `mesh`.
fn samples_on_boundary(mesh: &Mesh, spacing: f64) -> f64 {
    let twin = twins(&mesh.triangles);
    let open = (0..twin.len() as u32).filter(|&side| twin[side as usize] == NONE);
    open.map(|side| mesh.segment(side)).map(|[p, q]| p.distance(q)).sum::<f64>() / spacing
}

/// Makes the domain over `clean`, refined for the given scale.
fn domain_over(
    mut clean: OrientedManifold,
    within: Option<&Within>,
    prepared: &PreparedInput,
    scale: &Scale,
    resizing: &Resizing,
) -> SampledDomain {
    let Scale { spacing, wanted } = *scale;
    let went_wrong = |mesh: &Mesh, t: u32| mesh.corners(t as usize).into_iter().any(|p| resizing.is_near(p, spacing));
    let (twin, found) = refined(&mut clean, prepared, scale, went_wrong);
    let interface = within.map_or_else(Vec::new, |within| within.part.interface.clone());
    let mut tried = None;
    let room = |sharp: &[bool], narrowest: f64| {
        tried = None;
        if samples_on(&clean, &twin, sharp, spacing) > MOST_ON_EDGES * wanted as f64 {
            return Room::TooLittle;
        }
        let domain = Domain::with_sharp(clean.clone(), twin.clone(), sharp, spacing, interface.clone());
        if has_room_between_curves(tried.insert(domain), narrowest, spacing) { Room::Enough } else { Room::OnCurves }
    };
    let is_needed = |t: u32| went_wrong(&clean, t);
    let (mut sharp, left_out) = leave_out_narrow(&clean, &twin, &found, spacing, is_needed, room);
    let blunted = samples_on(&clean, &twin, &sharp, spacing) > wanted as f64;
    if blunted {
        (tried, sharp) = (None, vec![false; sharp.len()]);
    }
    let mut left_out_edges = edges_left_out(&clean, &twin, &found, &sharp);
    let ended = end_wedges(&mut clean, twin, sharp, !interface.is_empty(), spacing, went_wrong);
    if !ended.edges.is_empty() {
        tried = None;
    }
    left_out_edges.extend(&ended.edges);
    let domain = tried.unwrap_or_else(|| Domain::with_sharp(clean, ended.twin, &ended.sharp, spacing, interface));
    SampledDomain { domain, blunted, left_out: left_out.and(ended.left_out), left_out_edges }
}

/// Splits the edges on curves that are longer than `longest`, so that differing lengths along them can be resolved. Returns
/// the new twin of each side, and whether it is sharp.
fn refined_curves(
    clean: &mut OrientedManifold,
    twin: &[u32],
    sharp: &[bool],
    longest: f64,
    most: usize,
) -> (Vec<u32>, Vec<bool>) {
    let ends = |mesh: &OrientedManifold, side: usize| lower_first(mesh.ends(side as u32));
    // Only looked up, never iterated.
    let edges_of = |which: &dyn Fn(usize) -> bool| -> HashSet<[u32; 2]> {
        (0..twin.len()).filter(|&s| which(s)).map(|s| ends(clean, s)).collect()
    };
    let mut creases = edges_of(&|s| sharp[s]);
    let mut boundary = edges_of(&|s| twin[s] == NONE);
    refine_edges(clean, &mut creases, longest, most);
    refine_edges(clean, &mut boundary, longest, most);
    let sharp = (0..3 * clean.triangles.len()).map(|s| creases.contains(&ends(clean, s))).collect();
    (twins(&clean.triangles), sharp)
}

/// Returns the mean edge length of `mesh`.
fn mean_edge_length(mesh: &OrientedManifold) -> f64 {
    let of_triangle = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        a.distance(b) + b.distance(c) + c.distance(a)
    };
    let count = mesh.triangles.len();
    (0..count).map(of_triangle).sum::<f64>() / (3 * count) as f64
}

/// Splits the long edges of `clean`, and bends it if its vertices are points of a smooth surface. Returns the new twin of
/// each side, and whether it is sharp. Sharp edges beside triangles that `went_wrong` are kept.
fn refined(
    clean: &mut OrientedManifold,
    prepared: &PreparedInput,
    scale: &Scale,
    went_wrong: impl Fn(&Mesh, u32) -> bool,
) -> (Vec<u32>, Vec<bool>) {
    let features = prepared.features();
    // Detail between the points is not known.
    let finest = if prepared.options.of_points { STEP * mean_edge_length(clean) } else { 0.0 };
    let longest = LONGEST_EDGE * scale.spacing;
    let most = 4 * clean.triangles.len() + 16 * scale.wanted;
    let creases = |mesh: &OrientedManifold| {
        let twin = twins(&mesh.triangles);
        let sharp = sharp_sides(mesh, &twin, features, scale.spacing, finest, |t| went_wrong(mesh, t));
        (twin, sharp)
    };
    let Some(support) = prepared.options.support() else {
        refine(clean, longest, most);
        let (twin, sharp) = creases(clean);
        if !sharp.contains(&true) {
            return (twin, sharp);
        }
        return refined_curves(clean, &twin, &sharp, LONGEST_ON_CURVES * scale.spacing, most);
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
        split.bend(clean, &twin, &sharp, support);
    }
    (twin, sharp)
}
