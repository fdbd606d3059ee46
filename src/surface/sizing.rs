//! The edge lengths that are wanted at the vertices of a domain: from its shape, or from a field of lengths.
//!
//! *From the shape.* The radius ρ at a vertex is the smaller of two: that of its curvature, and half the thickness along
//! the normal there.
//! Edges of length h leave an error of about h² / (8 ρ), so h ∝ √ρ makes it the same everywhere; A between 0 and 1 asks
//! for h ∝ ρ^(A/2). Radii are cut off at `RANGE` times and a `RANGE`-th of their geometric mean over the area.
//!
//! *Curvature* is the mean of the curvature tensor over about a spacing, so that the noise of a scan cancels: each edge
//! of length l, direction e and dihedral angle β adds β l e eᵗ to both its ends. The radius is 1 / √((κ₁² + κ₂²) / 2).
//! Sharp edges have no curvature: the surface is cut there. Radii are averaged over a spacing once more, as logarithms.
//!
//! *Gradient.* Lengths of neighbouring edges should differ little: h(v) ≤ h(u) + g |uv| for all edges, by one pass of
//! Dijkstra's algorithm. Sizes are lengths relative to the mean spacing, such that the mean of 1 / size² over the area
//! is 1 and 2 / (√3 h²) integrates to the wanted number of vertices; each of both changes the other, so they take turns.
//!
//! Based on: D. Cohen-Steiner, J.-M. Morvan, Restricted Delaunay triangulations and normal cycle, 2003,
//! DOI 10.1145/777792.777839 (tensor); J. J. Koenderink, A. J. van Doorn, Surface shape and curvature scales, 1992,
//! DOI 10.1016/0262-8856(92)90076-F (curvedness); P.-O. Persson, Mesh size functions for implicit
//! geometries and PDE-based gradient limiting, 2006, DOI 10.1007/s00366-006-0014-1. Departures: the mean of the tensor
//! is one of random walks; one ray tells the thickness; the limit is along edges, which are longer than the shortest
//! way.
//!
//! Cost: a ray for each vertex, and a sum over its neighbours for each step of the walks.
//!
//! Limits: where curves of the boundary or along sharp edges bend is not looked at.

use crate::base::heap::Ranked;
use crate::base::math;
use crate::geom::triangle::barycentric;
use crate::mesh::half_edge::next;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::surface::domain::Domain;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BinaryHeap;

/// Radii that are told apart, as a ratio to their geometric mean: with A = 1 edge lengths differ by a factor of 8.
const RANGE: f64 = 8.0;

/// Smallest radius that is told from zero, in spacings.
const SMALLEST_RADIUS: f64 = 0.1;

/// Largest gradient of the length: how much longer edges may be for each length of an edge gone. With 0.15 three animals
/// at A = 1 are no nearer to the input than with 0.1, and have worse triangles. Whoever gives a field knows better.
const ADAPTED_GRADIENT: f64 = 0.1;
pub(super) const FIELD_GRADIENT: f64 = 0.2;

/// Steps of the random walks that a mean is taken over: inputs whose edges are a tenth of the spacing need a hundred.
const MOST_STEPS: f64 = 100.0;

/// Least cosine between the way into the inside and the normal of a face that ends it: 60 degrees. Next to a sharp edge
/// that way runs along a face.
const OPPOSITE: f64 = 0.5;

/// Turns of limiting and normalising, and the error of the mean length at which they end.
const MOST_TURNS: usize = 40;
const MEAN_TOLERANCE: f64 = 1e-3;

/// The sizes for adaptivity `adapt`, from 0 for none to 1 for the same error everywhere, relative to `spacing`.
pub fn adapted_sizes(domain: &Domain, adapt: f64, spacing: f64) -> Vec<f64> {
    let lengths = radii(domain, spacing).into_iter().map(|radius| math::pow(radius, 0.5 * adapt)).collect();
    normalised(domain, lengths, spacing, ADAPTED_GRADIENT)
}

/// The sizes for a field of `lengths`, scaled by one factor to as many vertices as `spacing` means and relative to it.
pub fn field_sizes(domain: &Domain, lengths: Vec<f64>, spacing: f64) -> Vec<f64> {
    normalised(domain, lengths, spacing, FIELD_GRADIENT)
}

/// The lengths of a field, made shorter where their gradient is too large.
pub fn field_lengths(domain: &Domain, lengths: Vec<f64>) -> Vec<f64> {
    limited(domain, &Graph::whole(domain), lengths, FIELD_GRADIENT)
}

/// Lengths that are known but for a factor, relative to `spacing` and of as many vertices as that means.
fn normalised(domain: &Domain, mut lengths: Vec<f64>, spacing: f64, gradient: f64) -> Vec<f64> {
    let graph = Graph::whole(domain);
    let excess = mean_density(&domain.mesh, &lengths).sqrt();
    scale(&mut lengths, excess);
    let mut turns = 0;
    loop {
        let mut sizes = limited(domain, &graph, lengths.clone(), gradient / spacing);
        let excess = mean_density(&domain.mesh, &sizes).sqrt();
        turns += 1;
        if (excess - 1.0).abs() <= MEAN_TOLERANCE || turns == MOST_TURNS {
            scale(&mut sizes, excess);
            return sizes;
        }
        scale(&mut lengths, excess);
    }
}

/// The mean of 1 / h² over the area of `mesh`, for lengths h at its vertices; of each triangle at the middles of its
/// sides.
pub fn mean_density(mesh: &Mesh, lengths: &[f64]) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let own = mesh.area_vector(t).length();
        let [a, b, c] = corners.map(|v| lengths[v as usize]);
        let density: f64 = [a + b, b + c, c + a].iter().map(|twice| 4.0 / (twice * twice)).sum();
        sum += own * density / 3.0;
        area += own;
    }
    sum / area
}

/// The lengths that a field over the vertices of `from` has at `points`: that of the closest point of its triangles,
/// interpolated.
pub fn transferred(lengths: &[f64], from: &Mesh, points: &[DVec3]) -> Vec<f64> {
    let bvh = Bvh::new(from);
    let at = |&p: &DVec3| {
        let Some(hit) = bvh.closest(from, p) else { return f64::NAN };
        let weights = barycentric(hit.point, from.corners(hit.triangle as usize)).map(|w| w.clamp(0.0, 1.0));
        let corners = from.triangles[hit.triangle as usize];
        let sum: f64 = (0..3).map(|k| weights[k] * lengths[corners[k] as usize]).sum();
        sum / weights.iter().sum::<f64>()
    };
    points.par_iter().map(at).collect()
}

fn scale(lengths: &mut [f64], factor: f64) {
    lengths.iter_mut().for_each(|length| *length *= factor);
}

/// The neighbours of vertices.
pub(super) struct Graph {
    /// Where each vertex's neighbours begin; one more entry than vertices.
    start: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// Those of the vertices of a domain within its smooth patches.
    fn of_patches(domain: &Domain) -> Graph {
        Graph::new(domain, |v| v, |side| domain.twin[side] == NONE)
    }

    /// Those of the vertices of a domain as they were before sharp edges were cut; further copies of them have none.
    pub(super) fn whole(domain: &Domain) -> Graph {
        let on_boundary = |side: usize| domain.twin[side] == NONE && domain.across[side] == NONE;
        Graph::new(domain, |v| domain.original[v as usize], on_boundary)
    }

    /// Each side makes its end a neighbour of its start, and also the other way where no side across does.
    fn new(domain: &Domain, name: impl Fn(u32) -> u32, on_boundary: impl Fn(usize) -> bool) -> Graph {
        let corner = |side: u32| name(domain.mesh.triangles[side as usize / 3][side as usize % 3]);
        let sides = 0..domain.twin.len() as u32;
        let mut pairs: Vec<(u32, u32)> = sides.clone().map(|s| (corner(s), corner(next(s)))).collect();
        pairs.extend(sides.filter(|&s| on_boundary(s as usize)).map(|s| (corner(next(s)), corner(s))));
        pairs.par_sort_unstable();
        let vertices = 0..=domain.mesh.positions.len() as u32;
        let start = vertices.map(|v| pairs.partition_point(|p| p.0 < v) as u32).collect();
        Graph { start, neighbours: pairs.into_iter().map(|p| p.1).collect() }
    }

    fn of(&self, v: u32) -> &[u32] {
        &self.neighbours[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }

    /// What is where after `steps` steps of random walks, each to a neighbour or nowhere.
    fn spread<const K: usize>(&self, mut amounts: Vec<[f64; K]>, steps: usize) -> Vec<[f64; K]> {
        let share = |v: u32| 1.0 / (1 + self.of(v).len()) as f64;
        for _ in 0..steps {
            let arriving = |v: u32| {
                let mut sum = [0.0; K];
                for &w in self.of(v).iter().chain([&v]) {
                    (0..K).for_each(|k| sum[k] += share(w) * amounts[w as usize][k]);
                }
                sum
            };
            amounts = (0..amounts.len() as u32).into_par_iter().map(arriving).collect();
        }
        amounts
    }
}

/// `lengths` such that none exceeds that of a neighbour by more than `slope` times their distance. `graph` is that of
/// the whole domain: copies of a vertex get the same length.
pub(super) fn limited(domain: &Domain, graph: &Graph, mut lengths: Vec<f64>, slope: f64) -> Vec<f64> {
    for (v, &first) in domain.original.iter().enumerate() {
        lengths[first as usize] = lengths[first as usize].min(lengths[v]);
    }
    let position = |v: u32| domain.mesh.positions[v as usize];
    let vertices = (0..lengths.len() as u32).filter(|&v| domain.original[v as usize] == v);
    let mut heap: BinaryHeap<Ranked> = vertices.map(|v| Ranked::new(-lengths[v as usize], v)).collect();
    while let Some(Ranked { rank, index: vertex, .. }) = heap.pop() {
        let length = -rank;
        if length > lengths[vertex as usize] {
            continue;
        }
        for &w in graph.of(vertex) {
            let most = length + slope * position(vertex).distance(position(w));
            if most < lengths[w as usize] {
                lengths[w as usize] = most;
                heap.push(Ranked::new(-most, w));
            }
        }
    }
    domain.original.iter().map(|&first| lengths[first as usize]).collect()
}

/// The radius ρ of each vertex, averaged over about a `spacing`.
fn radii(domain: &Domain, spacing: f64) -> Vec<f64> {
    let graph = Graph::of_patches(domain);
    let steps = steps_within(domain, spacing);
    let areas = vertex_areas(&domain.mesh);
    let widest = domain.mesh.diagonal();
    let smallest = SMALLEST_RADIUS * spacing;
    let curvatures = curvatures(domain, &graph, &areas, steps);
    let logarithm = |v: usize| {
        let of_curvature = (1.0 / curvatures[v]).clamp(smallest, widest);
        math::ln(half_thickness(domain, v, of_curvature).max(smallest))
    };
    let logarithms: Vec<f64> = (0..areas.len()).into_par_iter().map(logarithm).collect();
    let mean = areas.iter().zip(&logarithms).map(|(a, l)| a * l).sum::<f64>() / areas.iter().sum::<f64>();
    let cut_off = |l: f64| l.clamp(mean - math::ln(RANGE), mean + math::ln(RANGE));
    let amounts = areas.iter().zip(logarithms).map(|(&area, l)| [area, area * cut_off(l)]).collect();
    let amounts = graph.spread(amounts, steps);
    amounts.into_iter().map(|[area, sum]| if area > 0.0 { math::exp(sum / area) } else { math::exp(mean) }).collect()
}

/// The steps of a random walk along edges of the mean length that lead about as far as `distance`.
fn steps_within(domain: &Domain, distance: f64) -> usize {
    let mesh = &domain.mesh;
    let length = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        a.distance(b) + b.distance(c) + c.distance(a)
    };
    let mean = (0..mesh.triangles.len()).map(length).sum::<f64>() / domain.twin.len() as f64;
    math::square(distance / mean).clamp(1.0, MOST_STEPS).round() as usize
}

/// A third of the area of the triangles at each vertex.
fn vertex_areas(mesh: &Mesh) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let third = mesh.area_vector(t).length() / 6.0;
        corners.iter().for_each(|&v| areas[v as usize] += third);
    }
    areas
}

/// √((κ₁² + κ₂²) / 2) of the curvature tensor at each vertex, averaged over `steps` steps.
fn curvatures(domain: &Domain, graph: &Graph, areas: &[f64], steps: usize) -> Vec<f64> {
    let mesh = &domain.mesh;
    // The tensor by its six different entries, those off the diagonal times √2, and the area.
    let mut amounts: Vec<[f64; 7]> = areas.iter().map(|&area| [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, area]).collect();
    for side in 0..domain.twin.len() as u32 {
        let twin = domain.twin[side as usize];
        if twin == NONE || twin < side {
            continue;
        }
        let ends = [side, next(side)].map(|s| mesh.triangles[s as usize / 3][s as usize % 3] as usize);
        let along = mesh.positions[ends[1]] - mesh.positions[ends[0]];
        let e = along.normalize_or_zero();
        let [n, m] = [side, twin].map(|s| mesh.area_vector(s as usize / 3));
        let half = 0.5 * along.length() * math::atan2(e.dot(n.cross(m)), n.dot(m));
        let off = std::f64::consts::SQRT_2 * half;
        let entries =
            [half * e.x * e.x, half * e.y * e.y, half * e.z * e.z, off * e.x * e.y, off * e.y * e.z, off * e.z * e.x];
        for end in ends {
            (0..6).for_each(|k| amounts[end][k] += entries[k]);
        }
    }
    let curvature = |[t @ .., area]: [f64; 7]| {
        let squares: f64 = t.iter().map(|entry| entry * entry).sum();
        if area > 0.0 { (0.5 * squares).sqrt() / area } else { 0.0 }
    };
    graph.spread(amounts, steps).into_iter().map(curvature).collect()
}

/// Half the way through the inside at vertex `v`, along its normal; at most `widest`.
fn half_thickness(domain: &Domain, v: usize, widest: f64) -> f64 {
    let (mesh, inwards) = (&domain.mesh, -domain.vertex_normals[v]);
    let faces_away = |t: u32| {
        let own = mesh.area_vector(t as usize);
        own.dot(inwards) > OPPOSITE * own.length()
    };
    let thickness = domain.bvh.along_ray(mesh, mesh.positions[v], inwards, 2.0 * widest, faces_away);
    thickness.map_or(widest, |thickness| 0.5 * thickness)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::surface::features::Features;
    use glam::dvec3;

    /// The closed surface of revolution of a profile, given by radius and height between the poles, which are the first
    /// two heights asked for.
    fn revolved(poles: [f64; 2], profile: &[(f64, f64)], around: u32) -> Mesh {
        let mut positions: Vec<DVec3> = poles.iter().map(|&z| dvec3(0.0, 0.0, z)).collect();
        for &(radius, z) in profile {
            positions.extend((0..around).map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(around)).sin_cos();
                dvec3(radius * cos, radius * sin, z)
            }));
        }
        let at = |ring: u32, i: u32| 2 + ring * around + i % around;
        let last = profile.len() as u32 - 1;
        let mut triangles = Vec::new();
        for i in 0..around {
            triangles.extend([[0, at(0, i + 1), at(0, i)], [1, at(last, i), at(last, i + 1)]]);
            for ring in 0..last {
                let [a, b, c, d] = [at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Mesh { positions, triangles }
    }

    fn sphere() -> Mesh {
        let angle = |i: i32| std::f64::consts::PI * f64::from(i) / 40.0;
        let profile: Vec<(f64, f64)> = (1..40).map(|i| (angle(i).sin(), -angle(i).cos())).collect();
        revolved([-1.0, 1.0], &profile, 60)
    }

    /// A cube of `n` by `n` squares a face, its edges sharp.
    fn cube() -> Domain {
        let corners = (0..8).map(|v| dvec3(f64::from(v & 1), f64::from(v >> 1 & 1), f64::from(v >> 2)));
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mut mesh = Mesh { positions: corners.collect(), triangles };
        crate::mesh::refine::refine(&mut mesh, 0.15, usize::MAX);
        Domain::with_features(mesh, Features::Degrees(30.0), 0.1)
    }

    fn random_lengths(domain: &Domain) -> Vec<f64> {
        let mut rng = stream(3, Stage::Scan);
        domain.mesh.positions.iter().map(|_| 0.01 + unit(&mut rng).powi(4)).collect()
    }

    #[test]
    fn no_length_exceeds_that_of_a_neighbour_by_too_much_also_across_sharp_edges() {
        let domain = cube();
        let lengths = random_lengths(&domain);
        let limited = field_lengths(&domain, lengths.clone());
        assert!(domain.original.iter().enumerate().any(|(v, &first)| first as usize != v));
        for (v, &first) in domain.original.iter().enumerate() {
            assert!(limited[v] == limited[first as usize] && limited[v] <= lengths[v]);
        }
        for t in &domain.mesh.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let distance = domain.mesh.positions[a as usize].distance(domain.mesh.positions[b as usize]);
                let difference = (limited[a as usize] - limited[b as usize]).abs();
                assert!(difference <= FIELD_GRADIENT * distance + 1e-12);
            }
        }
        let least = |lengths: &[f64]| lengths.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(least(&limited), least(&lengths));
    }

    #[test]
    fn sizes_mean_the_wanted_number_of_vertices() {
        let domain = cube();
        for spacing in [0.01, 0.1, 0.5] {
            let sizes = field_sizes(&domain, random_lengths(&domain), spacing);
            assert!((mean_density(&domain.mesh, &sizes) - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_sphere_is_even() {
        let domain = Domain::new(sphere());
        for adapt in [0.5, 1.0] {
            let sizes = adapted_sizes(&domain, adapt, 0.1);
            assert!(
                sizes.iter().all(|size| (size - 1.0).abs() < 0.05),
                "{:?}",
                sizes.iter().map(|s| s - 1.0).fold(0.0, f64::max)
            );
        }
    }

    #[test]
    fn curvature_and_thickness_are_those_of_a_sphere_and_a_tube() {
        let tube = revolved([-3.0, 3.0], &(0..=60).map(|i| (0.5, -3.0 + 0.1 * f64::from(i))).collect::<Vec<_>>(), 60);
        for (mesh, curvature, thickness) in [(sphere(), 1.0, 1.0), (tube, 0.5f64.sqrt() / 0.5, 0.5)] {
            let domain = Domain::new(mesh);
            let areas = vertex_areas(&domain.mesh);
            let curvatures = curvatures(&domain, &Graph::of_patches(&domain), &areas, 3);
            for (v, p) in domain.mesh.positions.iter().enumerate().filter(|(_, p)| p.z.abs() < 0.5) {
                assert!((curvatures[v] / curvature - 1.0).abs() < 0.02, "{p} {}", curvatures[v]);
                assert!((half_thickness(&domain, v, 9.0) / thickness - 1.0).abs() < 0.02, "{p}");
            }
        }
    }

    #[test]
    fn edges_are_short_where_a_bottle_is_thin() {
        let radius = |z: f64| if z < 0.0 { 1.0 } else { 0.25 + 0.75 * (1.0 - z).max(0.0) };
        let profile: Vec<(f64, f64)> = (-20..=60).map(|i| 0.05 * f64::from(i)).map(|z| (radius(z), z)).collect();
        let domain = Domain::new(revolved([-1.0, 3.0], &profile, 60));
        let sizes = adapted_sizes(&domain, 1.0, 0.1);
        let mean = |which: &dyn Fn(f64) -> bool| {
            let there =
                domain.mesh.positions.iter().zip(&sizes).filter(|(p, _)| which(p.z) && p.truncate().length() > 0.2);
            let (sum, count) = there.fold((0.0, 0.0), |(sum, count), (_, size)| (sum + size, count + 1.0));
            sum / count
        };
        let ratio = mean(&|z| (2.0..2.6).contains(&z)) / mean(&|z| (-0.7..-0.3).contains(&z));
        assert!((0.4..0.65).contains(&ratio), "{ratio}: the root of a quarter is a half");
        let even = adapted_sizes(&domain, 0.0, 0.1);
        assert!(even.iter().all(|size| (size - 1.0).abs() < 1e-9));
    }

    #[test]
    fn a_field_is_found_again_by_place() {
        let mesh = sphere();
        let field = |p: DVec3| 2.0 + p.x + 0.5 * p.z;
        let lengths: Vec<f64> = mesh.positions.iter().map(|&p| field(p)).collect();
        let points: Vec<DVec3> =
            (0..mesh.triangles.len()).map(|t| mesh.corners(t).into_iter().sum::<DVec3>() / 3.0).collect();
        for (found, &p) in transferred(&lengths, &mesh, &points).into_iter().zip(&points) {
            assert!((found - field(p)).abs() < 1e-9, "{p}");
        }
        assert_eq!(transferred(&lengths, &mesh, &mesh.positions[5..6])[0], lengths[5]);
    }
}
