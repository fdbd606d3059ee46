//! Draws candidates for the linear scan: points on a mesh with the same density everywhere, relative to the wanted edge
//! length.
//!
//! The vertices of a mesh are poor candidates (a CAD part has none on its flat sides), so the surface is covered evenly: a
//! triangle whose share is n candidates gets ⌊n + u⌋, with u random, uniformly distributed in it. Where edges of relative
//! length h are wanted, area counts 1 / h² times: candidates are drawn as densely as the smallest h of their triangle
//! requires, and kept with probability (smallest h / h)².
//!
//! Random numbers are drawn by address: the candidates of a triangle depend only on the triangle, its number, the density
//! and the seed, and a higher density only adds to them.
//!
//! Cost: linear in candidates and triangles, on all threads.

use crate::base::math;
use crate::base::parallel;
use crate::base::rng::{Address, Stage, units_at};
use crate::surface::domain::{Domain, Sample};

/// A candidate, small enough that there can be hundreds of millions of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The triangle of the domain that it lies on.
    pub triangle: u32,
    /// Barycentric coordinates of the first two corners.
    weights: [f32; 2],
}

impl Candidate {
    /// Returns the candidate as a point of the surface.
    #[inline]
    pub fn sample(&self, domain: &Domain) -> Sample {
        let [a, b] = self.weights.map(f64::from);
        // Rounded to f32 the two may sum to more than 1, which would be off the triangle.
        let b = b.min(1.0 - a);
        domain.sample(self.triangle, [a, b, 1.0 - a - b])
    }

    /// Returns the address for which its random numbers are drawn: the input triangle, and its place in the part of that
    /// triangle.
    #[inline]
    pub(super) fn address(&self, domain: &Domain) -> Address {
        let [a, b] = self.weights.map(|w| u64::from(w.to_bits()));
        (domain.source_triangle(self.triangle), a << 32 | b)
    }
}

/// Returns about `count` points on the surface, in the order of its triangles.
pub fn candidates(domain: &Domain, count: usize, seed: u64) -> Vec<Candidate> {
    let density = count as f64 / domain.mesh.area();
    let parts = part_numbers(domain);
    parallel::collect(0..domain.mesh.triangles.len() as u32, |block| {
        block.flat_map(|t| in_triangle(domain, t, parts[t as usize], density, seed))
    })
}

/// Returns, for each triangle, which part of its input triangle it is, counted from 0.
fn part_numbers(domain: &Domain) -> Vec<u32> {
    let sources = || (0..domain.mesh.triangles.len() as u32).map(|t| domain.source_triangle(t) as usize);
    let mut parts = vec![0; sources().max().map_or(0, |last| last + 1)];
    let next = |source: usize| {
        parts[source] += 1;
        parts[source] - 1
    };
    sources().map(next).collect()
}

/// Returns the candidates of triangle `t`, which is part number `part` of an input triangle. `density` is their number per
/// unit area where the wanted size is 1.
fn in_triangle(domain: &Domain, t: u32, part: u32, density: f64, seed: u64) -> impl Iterator<Item = Candidate> {
    let source = domain.source_triangle(t);
    let units = move |stage: Stage, k: u64| units_at(seed, stage, (source, u64::from(part) << 32 | k));
    let sizes = domain.mesh.triangles[t as usize].map(|v| domain.size_at(v));
    let smallest = sizes.into_iter().fold(f64::INFINITY, f64::min);
    let is_even = sizes == [smallest; 3];
    let area = domain.mesh.triangle_area(t as usize) / math::square(smallest);
    let count = (density * area + units(Stage::Counts, 0)[0]) as u64;
    let stays = move |candidate: &Candidate, k: u64| {
        let share = math::square(smallest / candidate.sample(domain).size);
        is_even || units(Stage::Thinning, k)[0] < share
    };
    (0..count).filter_map(move |k| {
        let [u, v] = units(Stage::Candidates, k);
        // The square root maps equal shares of the unit interval to equal areas.
        let root = u.sqrt();
        let candidate = Candidate { triangle: t, weights: [1.0 - root, root * (1.0 - v)].map(|w| w as f32) };
        stays(&candidate, k).then_some(candidate)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::oriented_manifold::OrientedManifold;
    use crate::mesh::refine::refine;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::testing;
    use glam::{DVec3, dvec3};

    /// A cube refined into triangles of different areas.
    fn cube() -> Domain {
        fine(testing::cube().try_into().unwrap())
    }

    fn fine(mut mesh: OrientedManifold) -> Domain {
        mesh.positions_mut().iter_mut().for_each(|p| *p *= dvec3(1.0, 2.0, 0.5));
        refine(&mut mesh, 0.1, usize::MAX);
        Domain::new(mesh)
    }

    #[test]
    fn a_part_of_a_surface_draws_what_the_whole_does() {
        let second = testing::cube();
        let mut both = testing::cube();
        both.positions.extend(second.positions.iter().map(|p| p + 3.0));
        both.triangles.extend(second.triangles.iter().map(|t| t.map(|v| v + 8)));
        let whole = OrientedManifold::try_from(both).unwrap();
        let numbers = |from: u32, to: u32| (from..to).collect::<Vec<u32>>();
        let mesh = Mesh { positions: whole.positions[8..].to_vec(), ..second };
        let part =
            OrientedManifold::trusted(mesh, whole.provenance().clone().select(&numbers(8, 16), &numbers(12, 24)));
        let places = |domain: &Domain, count: usize| {
            let all = candidates(domain, count, 4).into_iter().map(|c| c.sample(domain).position);
            all.filter(|p| p.x > 2.0).collect::<Vec<DVec3>>()
        };
        let (whole, part) = (fine(whole), fine(part));
        let mut of_whole = places(&whole, 8000);
        let mut of_part = places(&part, 4000);
        let order = |a: &DVec3, b: &DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
        of_whole.sort_by(order);
        of_part.sort_by(order);
        assert!(of_part.len() > 3000 && of_part == of_whole);
    }

    #[test]
    fn as_many_as_are_wanted_in_proportion_to_the_area() {
        let domain = cube();
        for count in [300, 100_000] {
            let all = candidates(&domain, count, 1);
            let deviation = (domain.mesh.triangles.len() as f64).sqrt().min((count as f64).sqrt());
            assert!((all.len() as f64 - count as f64).abs() < 3.0 * deviation, "{}", all.len());
            let mean = all.iter().map(|c| c.sample(&domain).position).sum::<DVec3>() / all.len() as f64;
            let centre = domain.mesh.bounds().map(|bounds| 0.5 * (bounds.lo + bounds.hi)).unwrap();
            assert!(mean.distance(centre) < 3.0 / (count as f64).sqrt(), "{mean}");
        }
    }

    #[test]
    fn a_triangle_gets_its_number_of_points_all_over() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let domain = Domain::new(Mesh { positions, triangles: vec![[0, 1, 2]] }.try_into().unwrap());
        let all = candidates(&domain, 10_000, 3);
        assert_eq!(all.len(), 10_000);
        for (i, j) in (0..10).flat_map(|i| (0..10 - i).map(move |j| (i, j))) {
            let (x, y) = (0.1 * f64::from(i), 0.1 * f64::from(j));
            let is_in = |p: &DVec3| (x..x + 0.1).contains(&p.x) && (y..y + 0.1).contains(&p.y);
            let found = all.iter().map(|c| c.sample(&domain).position).filter(is_in).count() as f64;
            let expected = if i + j == 9 { 100.0 } else { 200.0 };
            assert!((found - expected).abs() < 4.0 * expected.sqrt(), "{i} {j} {found}");
        }
    }

    #[test]
    fn a_triangle_draws_the_same_by_itself_and_on_any_number_of_threads() {
        let domain = cube();
        let drawn = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| candidates(&domain, 5000, 7))
        };
        let all = drawn(1);
        assert!(all == drawn(3) && all != candidates(&domain, 5000, 8));
        let triangle = all[all.len() / 2].triangle;
        let part = part_numbers(&domain)[triangle as usize];
        let own: Vec<Candidate> = all.iter().copied().filter(|c| c.triangle == triangle).collect();
        let alone: Vec<Candidate> = in_triangle(&domain, triangle, part, 5000.0 / domain.mesh.area(), 7).collect();
        assert_eq!(own, alone);
        let denser: Vec<Candidate> = in_triangle(&domain, triangle, part, 60_000.0 / domain.mesh.area(), 7).collect();
        assert!(denser.len() > own.len() && denser[..own.len()] == own);
    }
}
