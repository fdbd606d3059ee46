//! Triangulates samples: takes the triangles on which their Delaunay stars agree, and fills the gaps between them. Where
//! stars are inconsistent or give another topology than the domain's, a mutual tessellation takes their place.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::manifold::Manifold;
use crate::mesh::topology::{NONE, components};
use crate::surface::domain::{Domain, Sample};
use crate::triangulate::agreement::agreed;
use crate::triangulate::hole_filling::fill_holes;
use crate::triangulate::inconsistent_stars::{Starred, tessellate_around};
use crate::triangulate::patch_topology::{Kind, kinds_of_domain};
use crate::triangulate::star::{INTERIOR, stars};
use crate::triangulate::triangulation::{Boundary, Triangulated};
use glam::DVec3;

/// Radius around inconsistent samples within which the domain is tessellated, in mean spacings, for one attempt after the
/// other. The first one also covers places where triangles are possible but not good, the last one covers whole patches.
const REACHES: [f64; 3] = [6.0, 12.0, f64::INFINITY];

/// Gaps between samples are too small to require a direction of their triangles.
const ANY_FACING: f64 = f64::NEG_INFINITY;

/// Gaps with more sides than this are failures, not ambiguities.
const MOST_SIDES: usize = 48;

/// Returns the oriented 2-manifold over `samples` with the topology of the domain. `spacing` is the mean distance of
/// neighbours.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn triangulate(
    domain: &Domain,
    samples: &[Sample],
    boundary: Boundary<'_>,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<Triangulated> {
    let mut successor = boundary.successor.to_vec();
    successor.resize(samples.len(), INTERIOR);
    let stars = stars(domain, samples, &successor, spacing, monitor)?;
    let mut starred = Starred { samples: samples.to_vec(), successor, stars };
    let wanted = kinds_of_domain(domain);
    let mut tessellated_patches = 0;
    for reach in REACHES {
        check(monitor)?;
        let triangles = joined(&starred);
        let mut centres = starred.at_open_fans(&triangles);
        if reach == REACHES[0] {
            centres.extend(starred.not_used(&triangles));
            centres.extend(starred.turned_away(&triangles));
        }
        add_patches_of_wrong_kind(domain, &starred, &triangles, &wanted, &mut centres);
        if centres.is_empty() {
            return Ok(triangulated(&starred, &triangles, tessellated_patches));
        }
        let whole = reach == f64::INFINITY;
        tessellated_patches = if whole { patches_of(domain, &centres).len() } else { 0 };
        tessellate_around(domain, &mut starred, boundary, &centres, reach * spacing);
    }
    let triangles = joined(&starred);
    Ok(triangulated(&starred, &triangles, tessellated_patches))
}

/// Returns the triangles on which stars agree, and those that fill the gaps between them.
fn joined(starred: &Starred) -> Vec<[u32; 3]> {
    let mut triangles = agreed(&starred.stars);
    let positions: Vec<DVec3> = starred.samples.iter().map(|s| s.position).collect();
    let normals: Vec<DVec3> = starred.samples.iter().map(|s| s.normal).collect();
    fill_holes(
        &positions,
        &normals,
        &starred.successor,
        |polygon| polygon.len() <= MOST_SIDES,
        ANY_FACING,
        &mut triangles,
    );
    triangles
}

/// Adds to `inconsistent` a point of each further patch whose triangles fit together everywhere, but have another topology than
/// wanted or leave out too many of its samples.
fn add_patches_of_wrong_kind(
    domain: &Domain,
    starred: &Starred,
    triangles: &[[u32; 3]],
    wanted: &[Kind],
    inconsistent: &mut Vec<Sample>,
) {
    let patch = |s: u32| domain.patch_of(starred.samples[s as usize].triangle);
    let component = components(starred.samples.len(), triangles);
    let kinds = Kind::of_patches(wanted.len(), patch, triangles, &component, &starred.successor);
    let known = patches_of(domain, inconsistent);
    let mut samples_of = vec![0; wanted.len()];
    (0..starred.samples.len() as u32).for_each(|s| samples_of[patch(s) as usize] += 1);
    let mut triangle_of = vec![NONE; wanted.len()];
    (0..domain.mesh.triangles.len() as u32).for_each(|t| triangle_of[domain.patch_of(t) as usize] = t);
    let wrong = |p: usize| {
        let lost = samples_of[p] - kinds[p].vertices;
        kinds[p].topology() != wanted[p].topology() || LEAST_USED * lost > kinds[p].vertices
    };
    let further = (0..wanted.len()).filter(|&p| wrong(p) && known.binary_search(&(p as u32)).is_err());
    inconsistent.extend(further.map(|p| domain.sample(triangle_of[p], [1.0, 0.0, 0.0])));
}

/// Returns the patches of `samples`, sorted.
fn patches_of(domain: &Domain, samples: &[Sample]) -> Vec<u32> {
    let mut patches: Vec<u32> = samples.iter().map(|s| domain.patch_of(s.triangle)).collect();
    patches.sort_unstable();
    patches.dedup();
    patches
}

/// A patch may lose one sample in this many to holes that were filled across it.
const LEAST_USED: usize = 50;

/// Returns the manifold of `triangles` over the samples that they use.
fn triangulated(starred: &Starred, triangles: &[[u32; 3]], tessellated_patches: usize) -> Triangulated {
    let mut number = vec![NONE; starred.samples.len()];
    triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
    let mut source = Vec::new();
    for (s, number) in number.iter_mut().enumerate().filter(|(_, n)| **n != NONE) {
        *number = source.len() as u32;
        source.push(s as u32);
    }
    let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    let mesh = Manifold::new(source.iter().map(|&s| starred.samples[s as usize]).collect(), &triangles);
    Triangulated { mesh, source, tessellated_patches }
}
