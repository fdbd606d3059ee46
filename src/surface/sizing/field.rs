//! Target edge lengths at the vertices of a domain, derived from its shape or from a field of lengths.
//!
//! Edges of length h on a surface of radius ρ leave an error of about h² / (8 ρ), so h ∝ √ρ makes the error uniform. An
//! adaptivity A between 0 and 1 means h ∝ ρ^(A/2).
//!
//! Sizes are lengths relative to the mean spacing, scaled so that the mean of 1 / size² over the area is 1 and 2 / (√3 h²)
//! integrates to the wanted number of vertices. Scaling to that mean and limiting the gradient affect each other, so they
//! alternate.
//!
//! Cost: one pass of Dijkstra's algorithm for each alternation.

use crate::base::math;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::domain::Domain;
use crate::surface::sizing::gradation::limited;
use crate::surface::sizing::graph::Graph;
use crate::surface::sizing::radii::radii;

/// Largest gradient of the edge length, as its growth per unit of distance. For three animals at A = 1, 0.15 is no closer to
/// the input than 0.1 and gives worse triangles. A given field may be steeper.
const ADAPTED_GRADIENT: f64 = 0.1;
pub(super) const FIELD_GRADIENT: f64 = 0.2;

/// Maximum number of alternations between limiting and scaling, and the error of the mean length at which they stop.
const MOST_TURNS: usize = 40;
const MEAN_TOLERANCE: f64 = 1e-3;

/// Sizes for adaptivity `adapt`, from 0 (uniform) to 1 (the same error everywhere), relative to `spacing`.
pub fn adapted_sizes(domain: &Domain, adapt: f64, spacing: f64) -> Vec<f64> {
    let lengths = radii(domain, spacing).into_iter().map(|radius| math::pow(radius, 0.5 * adapt)).collect();
    normalised(domain, lengths, spacing, ADAPTED_GRADIENT)
}

/// Sizes for a field of `lengths`, scaled by one factor to the number of vertices that `spacing` implies, and relative to
/// it.
pub fn field_sizes(domain: &Domain, lengths: Vec<f64>, spacing: f64) -> Vec<f64> {
    normalised(domain, lengths, spacing, FIELD_GRADIENT)
}

/// Lengths of a field, reduced where their gradient is too large.
pub fn field_lengths(domain: &Domain, lengths: Vec<f64>) -> Vec<f64> {
    limited(domain, &Graph::whole(domain), lengths, FIELD_GRADIENT)
}

/// Normalises lengths known up to a factor: relative to `spacing`, and scaled to the number of vertices that it implies.
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

/// Mean of 1 / h² over the area of `mesh`, for lengths h at its vertices, evaluated at the midpoints of each triangle's
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

fn scale(lengths: &mut [f64], factor: f64) {
    lengths.iter_mut().for_each(|length| *length *= factor);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::mesh::refine::refine;
    use crate::surface::features::Features;
    use crate::testing::{self, revolved, sphere};

    /// A cube of small triangles with sharp edges.
    fn cube() -> Domain {
        let mut mesh = testing::cube().try_into().unwrap();
        refine(&mut mesh, 0.15, usize::MAX);
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
        let domain = Domain::new(sphere().try_into().unwrap());
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
    fn edges_are_short_where_a_bottle_is_thin() {
        let radius = |z: f64| if z < 0.0 { 1.0 } else { 0.25 + 0.75 * (1.0 - z).max(0.0) };
        let profile: Vec<(f64, f64)> = (-20..=60).map(|i| 0.05 * f64::from(i)).map(|z| (radius(z), z)).collect();
        let domain = Domain::new(revolved([-1.0, 3.0], &profile, 60).try_into().unwrap());
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
}
