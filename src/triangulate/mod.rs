//! From samples on a surface to an oriented 2-manifold with the surface's topology.

pub mod agreement;
pub mod glue;
pub mod holes;
pub mod mutual;
pub mod star;
pub mod unfold;

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::surface::domain::{Domain, Sample};
use crate::surface::manifold::Manifold;
use crate::surface::topology::{Topology, topology};
use agreement::agreed;
use glam::DVec3;
use holes::fill_holes;
use mutual::{Insertion, mutual_tessellation};
use rayon::prelude::*;
use star::{INTERIOR, StarMaker};
use std::collections::HashMap;
use unfold::{SamplesByTriangle, Unfolding};

/// Samples that one task makes the stars of: enough to outweigh the memory that a walk needs.
const CHUNK: usize = 512;

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
    pub mesh: Manifold,
    /// Pieces whose stars did not settle and that were tessellated from the input.
    pub tessellated_pieces: usize,
}

/// The oriented 2-manifold over `samples`, of the topology of the domain. `spacing` is the mean distance of neighbours.
pub fn triangulate(
    domain: &Domain,
    samples: &[Sample],
    boundary: Boundary<'_>,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<Triangulated> {
    let mut successor = boundary.successor.to_vec();
    successor.resize(samples.len(), INTERIOR);
    let mut triangles = agreed(stars(domain, samples, &successor, spacing, monitor)?);
    let positions: Vec<DVec3> = samples.iter().map(|s| s.position).collect();
    let normals: Vec<DVec3> = samples.iter().map(|s| s.normal).collect();
    fill_holes(&positions, &normals, &successor, &mut triangles);
    check(monitor)?;
    let pieces = Pieces::new(domain, samples, triangles);
    let parts: Vec<(Manifold, bool)> = (0..pieces.count)
        .into_par_iter()
        .map(|p| match pieces.settled(domain, samples, p) {
            Some(mesh) => (mesh, false),
            None => (pieces.tessellate(domain, samples, boundary, p), true),
        })
        .collect();
    check(monitor)?;
    let tessellated_pieces = parts.iter().filter(|p| p.1).count();
    let mesh = join(parts.into_iter().map(|p| p.0));
    // TEMPORARY
    let key = |s: &Sample| (s.position.to_array().map(f64::to_bits), s.triangle);
    let at: HashMap<_, u32> = mesh.samples.iter().zip(0u32..).map(|(s, i)| (key(s), i)).collect();
    let mut order: Vec<u32> = Vec::new();
    for s in &samples[..boundary.successor.len()] {
        order.extend(at.get(&key(s)));
    }
    let mut used = vec![false; mesh.samples.len()];
    order.iter().for_each(|&v| used[v as usize] = true);
    if order.len() == boundary.successor.len() {
        order.extend((0..mesh.samples.len() as u32).filter(|&v| !used[v as usize]));
    } else {
        eprintln!("LOST");
        order = (0..mesh.samples.len() as u32).collect();
    }
    let mut number = vec![0; order.len()];
    for (n, &v) in order.iter().enumerate() {
        number[v as usize] = n as u32;
    }
    let (triangles, _) = mesh.connectivity.compact();
    let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    let mesh = Manifold::new(order.iter().map(|&v| mesh.samples[v as usize]).collect(), &triangles);
    Ok(Triangulated { mesh, tessellated_pieces })
}

/// Everything by the connected piece of the domain that it belongs to.
struct Pieces {
    count: usize,
    /// Triangles of the domain, of each piece.
    domain: Vec<Vec<u32>>,
    /// Samples of each piece, in increasing order.
    samples: Vec<Vec<u32>>,
    /// Triangles over the samples, of each piece.
    triangles: Vec<Vec<[u32; 3]>>,
}

impl Pieces {
    fn new(domain: &Domain, samples: &[Sample], triangles: Vec<[u32; 3]>) -> Self {
        let count = domain.piece.iter().max().map_or(0, |&p| p as usize + 1);
        let of = |s: u32| domain.piece_of(samples[s as usize].triangle) as usize;
        let mut pieces =
            Pieces { count, domain: vec![vec![]; count], samples: vec![vec![]; count], triangles: vec![vec![]; count] };
        for t in 0..domain.mesh.triangles.len() as u32 {
            pieces.domain[domain.piece_of(t) as usize].push(t);
        }
        for s in 0..samples.len() as u32 {
            pieces.samples[of(s)].push(s);
        }
        for t in triangles {
            pieces.triangles[of(t[0])].push(t);
        }
        pieces
    }

    /// The manifold that the stars of piece `p` made, if it is one, uses most of the samples, faces the way of the
    /// surface and has the topology of the domain there.
    fn settled(&self, domain: &Domain, samples: &[Sample], p: usize) -> Option<Manifold> {
        let (old, triangles) = renumber(&self.triangles[p]);
        let domain_triangles: Vec<[u32; 3]> =
            self.domain[p].iter().map(|&t| domain.mesh.triangles[t as usize]).collect();
        let (vertices, domain_triangles) = renumber(&domain_triangles);
        let wanted = topology(vertices.len(), &domain_triangles);
        let made = topology(old.len(), &triangles);
        let kind = |t: &Topology| (t.euler, t.components, t.boundary_loops);
        let right = made.is_manifold() && made.is_oriented() && kind(&made) == kind(&wanted);
        let lost = self.samples[p].len() - old.len();
        (right && LEAST_USED * lost <= old.len())
            .then(|| Manifold::new(old.iter().map(|&s| samples[s as usize]).collect(), &triangles))
    }

    fn tessellate(&self, domain: &Domain, samples: &[Sample], boundary: Boundary<'_>, p: usize) -> Manifold {
        let insertion =
            |&s: &u32| Insertion { sample: samples[s as usize], on_side: boundary.sites.get(s as usize).copied() };
        let insertions: Vec<Insertion> = self.samples[p].iter().map(insertion).collect();
        mutual_tessellation(domain, &self.domain[p], &insertions)
    }
}

/// A piece may lose one sample in this many to holes that were filled across it.
const LEAST_USED: usize = 50;

/// The vertices that triangles use, in increasing order, and the triangles over their ranks.
fn renumber(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.par_sort_unstable();
    used.dedup();
    let rank = |v: u32| used.partition_point(|&u| u < v) as u32;
    let triangles = triangles.iter().map(|t| t.map(rank)).collect();
    (used, triangles)
}

/// One manifold of several.
fn join(parts: impl Iterator<Item = Manifold>) -> Manifold {
    let (mut samples, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let base = samples.len() as u32;
        let (own, _) = part.connectivity.compact();
        triangles.extend(own.iter().map(|t| t.map(|v| v + base)));
        samples.extend(part.samples);
    }
    Manifold::new(samples, &triangles)
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
    let maker = || StarMaker::new(Unfolding::new(domain, samples, &by_triangle), spacing, successor);
    let chunks: Vec<Vec<[u32; 3]>> = (0..samples.len().div_ceil(CHUNK))
        .into_par_iter()
        .map_init(maker, |maker, chunk| {
            let mut triangles = Vec::with_capacity(6 * CHUNK);
            for centre in CHUNK * chunk..(CHUNK * (chunk + 1)).min(samples.len()) {
                maker.star(centre as u32, &mut triangles);
            }
            triangles
        })
        .collect();
    Ok(chunks.concat())
}
