//! Finds inconsistent stars, and replaces them by consistent ones.
//!
//! Where a surface is thinner or more strongly curved than the samples resolve, stars contradict each other. The domain
//! around such a place gets a mutual tessellation, which is a manifold whatever the samples are, and samples well inside
//! take their stars from it. Among themselves, these stars are consistent; towards the rest they are Delaunay like all
//! others, and agree just as well. If that region was too small, the process is repeated with a larger one, and finally with
//! the whole connected patch, which thereby becomes a manifold with the topology of the domain.

use crate::base::csr::Csr;
use crate::base::parallel;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::used_vertices;
use crate::surface::domain::{Domain, Sample};
use crate::triangulate::mutual_tessellation::{Insertion, Tessellation, mutual_tessellation};
use crate::triangulate::star::INTERIOR;
use crate::triangulate::triangulation::Boundary;
use crate::triangulate::unfold::SamplesByTriangle;
use std::collections::VecDeque;

/// Number of edges between the border of a part cut out of the domain and the nearest samples that take their stars from it.
const RIM: u32 = 3;

/// Samples and their stars.
pub struct Starred {
    /// The samples.
    pub samples: Vec<Sample>,
    /// The next sample on the boundary, or [`INTERIOR`].
    pub successor: Vec<u32>,
    /// All triangles of all stars, each beginning with the centre of its star.
    pub stars: Vec<[u32; 3]>,
}

impl Starred {
    /// Returns the samples whose `triangles` are neither one closed fan nor, on the boundary, one fan from their successor
    /// to their predecessor.
    pub fn at_open_fans(&self, triangles: &[[u32; 3]]) -> Vec<Sample> {
        let sides = || triangles.iter().flat_map(|&[a, b, c]| [(a, [b, c]), (b, [c, a]), (c, [a, b])]);
        let fans = Csr::new(self.samples.len(), sides);
        self.those(|s| !is_consistent(fans.row(s as u32), s as u32, &self.successor))
    }

    /// Returns the samples without a triangle.
    pub fn not_used(&self, triangles: &[[u32; 3]]) -> Vec<Sample> {
        let used = used_vertices(triangles, self.samples.len());
        self.those(|s| !used[s])
    }

    /// Returns the corners of triangles that face away from the surface at one of their corners. Other limits of the cosine
    /// between -0.5 and 0.3 gave the same meshes at more or less cost.
    pub fn turned_away(&self, triangles: &[[u32; 3]]) -> Vec<Sample> {
        let mut away = vec![false; self.samples.len()];
        for t in triangles.iter().filter(|t| self.facing(**t) < 0.0) {
            t.iter().for_each(|&s| away[s as usize] = true);
        }
        self.those(|s| away[s])
    }

    fn those(&self, which: impl Fn(usize) -> bool) -> Vec<Sample> {
        (0..self.samples.len()).filter(|&s| which(s)).map(|s| self.samples[s]).collect()
    }

    /// Smallest cosine between a triangle and the surface at its corners.
    fn facing(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|s| self.samples[s as usize]);
        let normal = (b.position - a.position).cross(c.position - a.position).normalize_or_zero();
        [a, b, c].iter().map(|s| s.normal.dot(normal)).fold(1.0, f64::min)
    }
}

/// Returns whether the fan of vertex `v`, given as the sides opposite it, is closed or, on the boundary, runs from its
/// successor to its predecessor. A vertex without triangles counts as consistent.
fn is_consistent(fan: &[[u32; 2]], v: u32, successor: &[u32]) -> bool {
    let Some(first) = fan.first() else { return true };
    let next = successor[v as usize];
    let begin = if next == INTERIOR { first[0] } else { next };
    let mut at = begin;
    for step in 0..fan.len() {
        let Some(side) = fan.iter().find(|s| s[0] == at) else { return false };
        at = side[1];
        if at == begin {
            return next == INTERIOR && step + 1 == fan.len();
        }
    }
    next != INTERIOR && successor[at as usize] == v
}

/// Gives the samples around `centres` the stars of a mutual tessellation of the domain. It covers the domain within `radius`
/// times their size of them, or all of their patches if `radius` is infinite.
pub fn tessellate_around(
    domain: &Domain,
    starred: &mut Starred,
    boundary: Boundary<'_>,
    centres: &[Sample],
    radius: f64,
) {
    let by_triangle = SamplesByTriangle::new(domain.mesh.triangles.len(), &starred.samples);
    let samples = &starred.samples;
    let tessellate = |part: Vec<u32>| {
        let own: Vec<u32> = part.iter().flat_map(|&t| by_triangle.on(t)).copied().collect();
        let insertion = |&s: &u32| {
            let (s, on_boundary) = (s as usize, boundary.sites.len());
            let is_spike = (on_boundary..on_boundary + boundary.spikes).contains(&s);
            Insertion { sample: samples[s], on_side: boundary.sites.get(s).copied(), is_spike }
        };
        let insertions: Vec<Insertion> = own.iter().map(insertion).collect();
        let mut made = mutual_tessellation(domain, &part, &insertions);
        made.insertion.iter_mut().filter(|i| **i != NONE).for_each(|i| *i = own[*i as usize]);
        (made, own)
    };
    let made: Vec<(Tessellation, Vec<u32>)> = parallel::each(parts(domain, centres, radius), tessellate);
    let mut replaced = vec![false; samples.len()];
    let mut left_out = vec![false; samples.len()];
    let mut stars = Vec::new();
    for (tessellation, own) in made {
        own.iter().for_each(|&s| left_out[s as usize] = true);
        tessellation.insertion.iter().filter(|s| **s != NONE).for_each(|&s| left_out[s as usize] = false);
        starred.transplant(&tessellation, &mut replaced, &mut stars);
    }
    // Samples that were left out agree only among themselves.
    let is_gone = |s: u32| replaced[s as usize] || left_out[s as usize];
    starred.stars.retain(|t| !replaced[t[0] as usize] && !t.iter().all(|&s| is_gone(s)));
    starred.stars.extend(stars);
}

impl Starred {
    /// Takes over the stars well inside a tessellation. Vertices of the domain that remained there become samples.
    fn transplant(&mut self, from: &Tessellation, replaced: &mut [bool], stars: &mut Vec<[u32; 3]>) {
        let c = &from.mesh.connectivity;
        let inside: Vec<bool> = rings_from_border(from).into_iter().map(|ring| ring >= RIM).collect();
        let mut number = from.insertion.clone();
        for (v, number) in number.iter_mut().enumerate().filter(|(v, n)| **n == NONE && inside[*v]) {
            *number = self.samples.len() as u32;
            self.samples.push(from.mesh.samples()[v]);
            self.successor.push(INTERIOR);
        }
        let known = |v: u32| number[v as usize] != NONE;
        for v in (0..c.vertex_bound()).filter(|&v| inside[v as usize] && c.ring(v).all(known)) {
            let sample = number[v as usize] as usize;
            if let Some(replaced) = replaced.get_mut(sample) {
                *replaced = true;
            }
            stars.extend(c.outgoing(v).map(|h| c.triangle(h).map(|v| number[v as usize])));
            let first = c.outgoing(v).next().filter(|_| c.is_boundary(v));
            self.successor[sample] = first.map_or(INTERIOR, |h| number[c.target(h) as usize]);
        }
    }
}

/// Number of edges from each vertex to the nearest one on the border, at most [`RIM`].
fn rings_from_border(from: &Tessellation) -> Vec<u32> {
    let c = &from.mesh.connectivity;
    let mut rings: Vec<u32> = (0..c.vertex_bound()).map(|v| if from.border.contains(v) { 0 } else { RIM }).collect();
    for ring in 1..RIM {
        for v in 0..c.vertex_bound() {
            if rings[v as usize] == RIM && c.ring(v).any(|w| rings[w as usize] == ring - 1) {
                rings[v as usize] = ring;
            }
        }
    }
    rings
}

/// Returns the connected parts of the domain that are reached from the samples `centres` without leaving the balls of
/// `radius` times their size around them, each as its sorted triangles.
fn parts(domain: &Domain, centres: &[Sample], radius: f64) -> Vec<Vec<u32>> {
    let mut reached = vec![false; domain.mesh.triangles.len()];
    let mut queue = VecDeque::new();
    for centre in centres {
        reached[centre.triangle as usize] = true;
        queue.push_back((centre.triangle, centre.position, radius * centre.size));
    }
    let across = |t: u32| (0..3).map(move |k| domain.twin[3 * t as usize + k]).filter(|&s| s != NONE).map(|s| s / 3);
    while let Some((t, centre, radius)) = queue.pop_front() {
        for u in across(t) {
            let near = domain.mesh.corners(u as usize).iter().any(|p| p.distance(centre) <= radius);
            if near && !std::mem::replace(&mut reached[u as usize], true) {
                queue.push_back((u, centre, radius));
            }
        }
    }
    let mut parts = Vec::new();
    for t in 0..reached.len() as u32 {
        if !reached[t as usize] {
            continue;
        }
        reached[t as usize] = false;
        let mut part = vec![t];
        let mut next = 0;
        while next < part.len() {
            let t = part[next];
            next += 1;
            part.extend(across(t).filter(|&u| std::mem::replace(&mut reached[u as usize], false)));
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::mesh::topology::topology;
    use crate::testing::grid;
    use crate::triangulate::agreement::agreed;
    use glam::{DVec3, dvec3};

    const NO_BOUNDARY: Boundary = Boundary { sites: &[], successor: &[], spikes: 0 };

    /// A slightly vaulted square of `n` by `n` unit cells.
    fn sheet(n: u32) -> Domain {
        let place = |u: f64, v: f64| f64::from(n) * dvec3(u, v, 0.0);
        let vaulted = |p: DVec3| dvec3(p.x, p.y, 0.01 * (p.x * p.y).sin());
        Domain::new(grid(n, n, |u, v| vaulted(place(u, v))).try_into().unwrap())
    }

    /// A sample in the centre of every second triangle, without stars.
    fn without_stars(domain: &Domain) -> Starred {
        let count = domain.mesh.triangles.len() as u32;
        let samples: Vec<Sample> = (0..count).step_by(2).map(|t| domain.sample(t, [1.0 / 3.0; 3])).collect();
        Starred { successor: vec![INTERIOR; samples.len()], samples, stars: Vec::new() }
    }

    #[test]
    fn fans_are_consistent_if_they_close_or_end_at_the_boundary() {
        let samples = without_stars(&sheet(3)).samples[..5].to_vec();
        let star =
            |successor: [u32; 5]| Starred { samples: samples.clone(), successor: successor.into(), stars: vec![] };
        let loose = star([INTERIOR; 5]);
        let rim = star([INTERIOR, 2, 3, 4, 1]);
        let wheel = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
        assert_eq!(loose.at_open_fans(&wheel).len(), 4);
        assert_eq!(rim.at_open_fans(&wheel), []);
        assert_eq!(rim.at_open_fans(&wheel[..3]), [0, 1, 4].map(|s| samples[s]));
        assert_eq!(rim.not_used(&wheel[..1]), samples[3..]);
        assert_eq!(rim.turned_away(&[[0, 1, 2], [2, 1, 0]]).len(), 3);
    }

    #[test]
    fn a_whole_piece_becomes_a_manifold_of_its_topology() {
        let domain = sheet(12);
        let sites: Vec<(u32, f64)> = domain.boundary_loops()[0].iter().map(|&side| (side, 0.5)).collect();
        let middle = |side: u32| {
            let mut weights = [0.5; 3];
            weights[(side as usize + 2) % 3] = 0.0;
            domain.sample(side / 3, weights)
        };
        let rim = sites.iter().map(|s| middle(s.0));
        let samples: Vec<Sample> = rim.chain(without_stars(&domain).samples).collect();
        let on_rim: Vec<u32> = (1..sites.len() as u32).chain([0]).collect();
        let mut successor = on_rim.clone();
        successor.resize(samples.len(), INTERIOR);
        let mut starred = Starred { successor, stars: Vec::new(), samples };
        let boundary = Boundary { sites: &sites, successor: &on_rim, spikes: 0 };
        let centre = [starred.samples[0]];
        tessellate_around(&domain, &mut starred, boundary, &centre, f64::INFINITY);
        let triangles = agreed(&starred.stars);
        let t = topology(starred.samples.len(), &triangles);
        assert!(t.is_manifold() && t.is_oriented(), "{t:?}");
        assert_eq!((t.euler, t.components, t.boundary_loops), (1, 1, 1));
        assert!(starred.at_open_fans(&triangles).is_empty() && starred.not_used(&triangles).is_empty());
    }

    #[test]
    fn stars_well_inside_a_part_agree_and_others_stay_as_they_are() {
        let domain = sheet(20);
        let mut starred = without_stars(&domain);
        let far = starred.samples.len() as u32 - 1;
        starred.stars.push([far, 0, 1]);
        let middle = starred.samples[starred.samples.len() / 2 + 10];
        tessellate_around(&domain, &mut starred, NO_BOUNDARY, &[middle], 7.0);
        assert_eq!(starred.stars[0], [far, 0, 1]);
        let triangles = agreed(&starred.stars[1..]);
        let open = starred.at_open_fans(&triangles);
        let consistent = |s: &&Sample| !open.contains(s) && !starred.not_used(&triangles).contains(s);
        let inside: Vec<&Sample> = starred.samples.iter().filter(consistent).collect();
        assert!(inside.len() > 20, "{}", inside.len());
        assert!(inside.iter().all(|s| s.position.distance(middle.position) < 7.0));
    }

    #[test]
    fn parts_that_are_not_joined_by_the_surface_are_apart() {
        let domain = sheet(20);
        let ends =
            [domain.sample(0, [1.0, 0.0, 0.0]), domain.sample(domain.mesh.triangles.len() as u32 - 1, [1.0, 0.0, 0.0])];
        assert_eq!(parts(&domain, &ends, 4.0).len(), 2);
        assert_eq!(parts(&domain, &ends, f64::INFINITY), [(0..800).collect::<Vec<u32>>()]);
    }
}
