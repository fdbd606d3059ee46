//! From samples on a surface to an oriented 2-manifold with the surface's topology.

pub mod agreement;
pub mod boundary_loops;
pub mod cell;
pub mod hole_filling;
pub mod inconsistent_stars;
pub mod mutual_tessellation;
pub mod points;
pub mod star;
pub mod stitch;
pub mod unfold;

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::manifold::Manifold;
use crate::mesh::topology::{NONE, components};
use crate::spatial::kdtree::Neighbors;
use crate::surface::domain::{Domain, Sample};
use agreement::agreed;
use glam::DVec3;
use hole_filling::fill_holes;
use inconsistent_stars::{Starred, tessellate_around};
use rayon::prelude::*;
use star::{Cloud, INTERIOR, StarMaker};
use unfold::SamplesByTriangle;

/// Samples that one task makes the stars of: enough to outweigh the memory that a walk needs.
const CHUNK: usize = 512;

/// How far around samples that do not settle the domain is tessellated, in mean spacings, in one attempt after the
/// other. The first also goes to where triangles are possible but not good, the last is of the whole patch.
const REACHES: [f64; 3] = [6.0, 12.0, f64::INFINITY];

/// Gaps between samples are too small for triangles in them to be held to a direction.
const ANY_FACING: f64 = f64::NEG_INFINITY;

/// Gaps of more sides than this are no ambiguity but a failure.
const MOST_SIDES: usize = 48;

/// Samples on the boundary of a domain, the first ones of all samples.
#[derive(Debug, Clone, Copy)]
pub struct Boundary<'a> {
    /// The side `3 t + k` of the domain that each lies on, and how far along in 0..1.
    pub sites: &'a [(u32, f64)],
    /// The next one on its loop; the surface is on the left of the way there.
    pub successor: &'a [u32],
}

/// A triangulation of samples.
#[derive(Debug, Clone)]
pub struct Triangulated {
    /// The mesh.
    pub mesh: Manifold,
    /// For each of its vertices the sample that it is; vertices of the domain come after all samples.
    pub source: Vec<u32>,
    /// Pieces whose stars did not settle and that were tessellated from the input as a whole.
    pub tessellated_patches: usize,
}

/// The oriented 2-manifold over `samples`, of the topology of the domain. `spacing` is the mean distance of neighbours.
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
            return Ok(Triangulated::new(&starred, &triangles, tessellated_patches));
        }
        let whole = reach == f64::INFINITY;
        tessellated_patches = if whole { patches_of(domain, &centres).len() } else { 0 };
        tessellate_around(domain, &mut starred, boundary, &centres, reach * spacing);
    }
    let triangles = joined(&starred);
    Ok(Triangulated::new(&starred, &triangles, tessellated_patches))
}

/// The triangles that stars agree on and those that fill the gaps between them.
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

/// Counts of a connected patch, or of its mesh, that tell its topology.
#[derive(Debug, Clone, Copy, Default)]
struct Kind {
    vertices: usize,
    faces: usize,
    boundary_edges: usize,
    boundary_loops: usize,
    components: usize,
}

impl Kind {
    /// Those of each of `patches` patches. `component` is the connected component of
    /// each vertex, `next` the vertex after it on the boundary, or [`INTERIOR`].
    fn of_patches(
        patches: usize,
        patch: impl Fn(u32) -> u32,
        triangles: &[[u32; 3]],
        component: &[u32],
        next: &[u32],
    ) -> Vec<Kind> {
        let mut kinds = vec![Kind::default(); patches];
        let mut used = vec![false; next.len()];
        for t in triangles {
            t.iter().for_each(|&v| used[v as usize] = true);
            kinds[patch(t[0]) as usize].faces += 1;
        }
        let mut counted = vec![false; next.len()];
        let mut walked = vec![false; next.len()];
        for v in (0..next.len() as u32).filter(|&v| used[v as usize]) {
            let kind = &mut kinds[patch(v) as usize];
            kind.vertices += 1;
            kind.boundary_edges += usize::from(next[v as usize] != INTERIOR);
            kind.components += usize::from(!std::mem::replace(&mut counted[component[v as usize] as usize], true));
            let mut at = v;
            kind.boundary_loops += usize::from(next[at as usize] != INTERIOR && !walked[at as usize]);
            while next[at as usize] != INTERIOR && !std::mem::replace(&mut walked[at as usize], true) {
                at = next[at as usize];
            }
        }
        kinds
    }

    /// Euler characteristic, components and boundary loops.
    fn topology(&self) -> (i64, usize, usize) {
        let edges = (3 * self.faces + self.boundary_edges) / 2;
        let euler = self.vertices as i64 - edges as i64 + self.faces as i64;
        (euler, self.components, self.boundary_loops)
    }
}

/// The patches of the domain.
fn kinds_of_domain(domain: &Domain) -> Vec<Kind> {
    let mut next = vec![INTERIOR; domain.mesh.positions.len()];
    for (t, corners) in domain.mesh.triangles.iter().enumerate() {
        for k in (0..3).filter(|k| domain.twin[3 * t + k] == NONE) {
            next[corners[k] as usize] = corners[(k + 1) % 3];
        }
    }
    let patches = domain.patch.iter().max().map_or(0, |&p| p as usize + 1);
    Kind::of_patches(patches, |v| domain.patch[v as usize], &domain.mesh.triangles, &domain.patch, &next)
}

/// Adds to `unsettled` a point of each further patch whose triangles, although they fit together everywhere, are not of
/// the topology wanted or do not use most of its samples.
fn add_patches_of_wrong_kind(
    domain: &Domain,
    starred: &Starred,
    triangles: &[[u32; 3]],
    wanted: &[Kind],
    unsettled: &mut Vec<Sample>,
) {
    let patch = |s: u32| domain.patch_of(starred.samples[s as usize].triangle);
    let component = components(starred.samples.len(), triangles);
    let kinds = Kind::of_patches(wanted.len(), patch, triangles, &component, &starred.successor);
    let known = patches_of(domain, unsettled);
    let mut samples_of = vec![0; wanted.len()];
    (0..starred.samples.len() as u32).for_each(|s| samples_of[patch(s) as usize] += 1);
    let mut triangle_of = vec![NONE; wanted.len()];
    (0..domain.mesh.triangles.len() as u32).for_each(|t| triangle_of[domain.patch_of(t) as usize] = t);
    let wrong = |p: usize| {
        let lost = samples_of[p] - kinds[p].vertices;
        kinds[p].topology() != wanted[p].topology() || LEAST_USED * lost > kinds[p].vertices
    };
    let further = (0..wanted.len()).filter(|&p| wrong(p) && known.binary_search(&(p as u32)).is_err());
    unsettled.extend(further.map(|p| domain.sample(triangle_of[p], [1.0, 0.0, 0.0])));
}

/// The patches that `samples` are of, in increasing order.
fn patches_of(domain: &Domain, samples: &[Sample]) -> Vec<u32> {
    let mut patches: Vec<u32> = samples.iter().map(|s| domain.patch_of(s.triangle)).collect();
    patches.sort_unstable();
    patches.dedup();
    patches
}

/// A patch may lose one sample in this many to holes that were filled across it.
const LEAST_USED: usize = 50;

impl Triangulated {
    /// The manifold of `triangles` over the samples that they use.
    fn new(starred: &Starred, triangles: &[[u32; 3]], tessellated_patches: usize) -> Self {
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
}

/// The stars of all samples, as triangles that begin with the centre of the star.
pub fn stars(
    domain: &Domain,
    samples: &[Sample],
    successor: &[u32],
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<[u32; 3]>> {
    check(monitor)?;
    let by_triangle = SamplesByTriangle::new(domain.mesh.triangles.len(), samples);
    let positions: Vec<DVec3> = samples.iter().map(|s| s.position).collect();
    let near = Neighbors::new(&positions);
    let cloud = Cloud { domain, samples, successor, spacing, by_triangle: &by_triangle, near: &near };
    let chunks: Vec<Vec<[u32; 3]>> = (0..samples.len().div_ceil(CHUNK))
        .into_par_iter()
        .map_init(
            || StarMaker::new(cloud),
            |maker, chunk| {
                let mut triangles = Vec::with_capacity(6 * CHUNK);
                for centre in CHUNK * chunk..(CHUNK * (chunk + 1)).min(samples.len()) {
                    maker.star(centre as u32, &mut triangles);
                }
                triangles
            },
        )
        .collect();
    Ok(chunks.concat())
}
