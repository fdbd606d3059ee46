//! Computes the spacing of the samples of a scan over the whole domain: the edge lengths that keep their density.
//!
//! Candidates are evenly distributed, so the share of candidates nearest to a sample is its share of the area. At hexagonal
//! packing, a sample of area a has its neighbours at distance √(2a / √3). A vertex of the domain gets the geometric mean
//! over the samples around it, which averages out the randomness of their places.
//!
//! Limits: next to a boundary, samples have less area than others, and distances come out up to a quarter too short.
//!
//! Cost: one search among the samples for each candidate and each vertex.

use crate::base::math;
use crate::base::parallel;
use crate::geom::packing::spacing_of;
use crate::spatial::kdtree::Neighbors;
use crate::spectral::candidates::Candidate;
use crate::surface::domain::{Domain, Sample};

/// Maximum distance, in units of σ, of a candidate from the nearest sample: the scan would have kept a farther one.
const FARTHEST: f64 = 1.5;

/// Number of samples averaged at a vertex.
const AVERAGED: usize = 7;

/// Returns the spacing of the samples at each vertex of `domain`, in its units. `samples` were chosen from `candidates` with
/// a kernel of width `sigma`.
pub fn spacings(domain: &Domain, candidates: &[Candidate], samples: &[Sample], sigma: f64) -> Vec<f64> {
    let positions: Vec<_> = samples.iter().map(|s| s.position).collect();
    let set = Neighbors::new(&positions);
    let facing = |at: &Sample| {
        let found = set.within(at.position, FARTHEST * sigma).into_iter().map(|n| n.point as usize);
        let normal = at.normal;
        found.filter(move |&i| samples[i].normal.dot(normal) >= 0.0)
    };
    let nearest: Vec<Option<usize>> = parallel::map(candidates, |c| facing(&c.sample(domain)).next());
    let mut counts = vec![0.0; samples.len()];
    nearest.into_iter().flatten().for_each(|i| counts[i] += 1.0);
    let mean_area = domain.mesh.area() / candidates.len() as f64;
    let logarithms: Vec<f64> =
        counts.iter().map(|&n| math::ln(spacing_of(1.0, mean_area * f64::max(n, 1.0)))).collect();
    let otherwise = math::ln(spacing_of(1.0, domain.mesh.area() / samples.len().max(1) as f64));
    let at_vertex = |v: u32| {
        let position = domain.mesh.positions[v as usize];
        let sample = Sample { position, normal: domain.vertex_normal(v), triangle: 0, size: 1.0 };
        let around: Vec<f64> = facing(&sample).take(AVERAGED).map(|i| logarithms[i]).collect();
        let mean = if around.is_empty() { otherwise } else { around.iter().sum::<f64>() / around.len() as f64 };
        math::exp(mean)
    };
    parallel::map(0..domain.mesh.positions.len() as u32, at_vertex)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::refine::refine;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::spectral::candidates::candidates;
    use crate::spectral::scan::linear_scan;
    use glam::dvec3;

    /// A unit square of small triangles.
    fn square() -> Domain {
        let positions = (0..4).map(|v| dvec3(f64::from(v & 1), f64::from(v >> 1), 0.0)).collect();
        let mesh = Mesh { positions, triangles: vec![[0, 1, 3], [0, 3, 2]] };
        let mut mesh = mesh.try_into().unwrap();
        refine(&mut mesh, 0.05, usize::MAX);
        Domain::new(mesh)
    }

    #[test]
    fn even_samples_have_the_spacing_of_their_number() {
        let domain = square();
        let all = candidates(&domain, 40_000, 9);
        let sigma = 0.03;
        let samples = linear_scan(&domain, &all, &[], sigma, 9, &()).unwrap();
        let expected = (2.0 / (3f64.sqrt() * samples.len() as f64)).sqrt();
        let found = spacings(&domain, &all, &samples, sigma);
        assert_eq!(found.len(), domain.mesh.positions.len());
        for (p, h) in domain.mesh.positions.iter().zip(&found) {
            let inside = p.truncate().min_element().min(1.0 - p.truncate().max_element()) > 0.1;
            assert!((h / expected - 1.0).abs() < if inside { 0.25 } else { 0.3 }, "{p} {h} {expected}");
        }
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        assert!((mean / expected - 1.0).abs() < 0.05, "{mean} {expected}");
    }

    #[test]
    fn dense_samples_are_near_each_other() {
        let domain = square();
        let all = candidates(&domain, 40_000, 1);
        let samples = linear_scan(&domain, &all, &[], 0.03, 1, &()).unwrap();
        // Keep a quarter of the samples on the right.
        let thinned: Vec<Sample> = (samples.iter().enumerate())
            .filter(|(i, s)| s.position.x < 0.5 || i % 4 == 0)
            .map(|(_, &sample)| sample)
            .collect();
        let found = spacings(&domain, &all, &thinned, 0.1);
        let mean = |is_inside: &dyn Fn(f64) -> bool| {
            let inside = domain.mesh.positions.iter().zip(&found).filter(|(p, _)| is_inside(p.x));
            let lengths: Vec<f64> = inside.map(|(_, &length)| length).collect();
            lengths.iter().sum::<f64>() / lengths.len() as f64
        };
        let ratio = mean(&|x| x > 0.6) / mean(&|x| x < 0.4);
        assert!((1.8..2.2).contains(&ratio), "{ratio}");
    }
}
