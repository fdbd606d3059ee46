//! The radius ρ at each vertex: the smaller of the radius of curvature and half the thickness along the normal.
//!
//! *Curvature* is the mean of the curvature tensor over about a spacing, which averages out the noise of a scan: each edge
//! of length l, direction e and dihedral angle β adds β l e eᵗ to both its ends. The radius is 1 / √((κ₁² + κ₂²) / 2). Sharp
//! edges have no curvature, since the surface is cut there. The logarithms of the radii are averaged over a spacing once
//! more. Before that, radii are limited to the range from a `RANGE`-th of their geometric mean over the area to `RANGE`
//! times it.
//!
//! Based on: D. Cohen-Steiner, J.-M. Morvan, Restricted Delaunay triangulations and normal cycle, 2003,
//! DOI 10.1145/777792.777839 (tensor); J. J. Koenderink, A. J. van Doorn, Surface shape and curvature scales, 1992,
//! DOI 10.1016/0262-8856(92)90076-F (curvedness). Departures: the mean of the tensor is taken by random walks; one ray
//! measures the thickness.
//!
//! Cost: a ray for each vertex, and a sum over its neighbours for each step of the walks.
//!
//! Limits: the curvature of feature curves does not count.

use crate::base::math;
use crate::base::parallel;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::domain::Domain;
use crate::surface::sizing::graph::Graph;

/// Range of the radii, as a ratio to their geometric mean: with A = 1, edge lengths differ by a factor of 8.
const RANGE: f64 = 8.0;

/// Smallest radius that is distinguished from zero, in spacings.
const SMALLEST_RADIUS: f64 = 0.1;

/// Maximum number of steps of the random walks that average: inputs with edges of a tenth of the spacing need a hundred.
const MOST_STEPS: f64 = 100.0;

/// Radius ρ at each vertex, averaged over about a `spacing`.
pub(super) fn radii(domain: &Domain, spacing: f64) -> Vec<f64> {
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
    let logarithms = parallel::map(0..areas.len(), logarithm);
    let mean = areas.iter().zip(&logarithms).map(|(a, l)| a * l).sum::<f64>() / areas.iter().sum::<f64>();
    let cut_off = |l: f64| l.clamp(mean - math::ln(RANGE), mean + math::ln(RANGE));
    let amounts = areas.iter().zip(logarithms).map(|(&area, l)| [area, area * cut_off(l)]).collect();
    let amounts = graph.spread(amounts, steps);
    amounts.into_iter().map(|[area, sum]| if area > 0.0 { math::exp(sum / area) } else { math::exp(mean) }).collect()
}

/// Number of steps for which a random walk along edges of the mean length leads about as far as `distance`.
fn steps_within(domain: &Domain, distance: f64) -> usize {
    let mesh = &domain.mesh;
    let length = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        a.distance(b) + b.distance(c) + c.distance(a)
    };
    let mean = (0..mesh.triangles.len()).map(length).sum::<f64>() / domain.twin.len() as f64;
    math::square(distance / mean).clamp(1.0, MOST_STEPS).round() as usize
}

/// A third of the total area of the triangles at each vertex.
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
    // The six distinct entries of the tensor, the off-diagonal ones times √2, and the area.
    let mut amounts: Vec<[f64; 7]> = areas.iter().map(|&area| [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, area]).collect();
    for side in 0..domain.twin.len() as u32 {
        let twin = domain.twin[side as usize];
        if twin == NONE || twin < side {
            continue;
        }
        let ends = mesh.ends(side).map(|v| v as usize);
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

/// Half the distance through the interior from vertex `v`, along its normal; at most `widest`.
fn half_thickness(domain: &Domain, v: usize, widest: f64) -> f64 {
    let thickness = domain.thickness_at(domain.mesh.positions[v], domain.vertex_normals[v], 2.0 * widest);
    thickness.map_or(widest, |thickness| 0.5 * thickness)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{revolved, sphere};

    #[test]
    fn curvature_and_thickness_are_those_of_a_sphere_and_a_tube() {
        let tube = revolved([-3.0, 3.0], &(0..=60).map(|i| (0.5, -3.0 + 0.1 * f64::from(i))).collect::<Vec<_>>(), 60);
        for (mesh, curvature, thickness) in [(sphere(), 1.0, 1.0), (tube, 0.5f64.sqrt() / 0.5, 0.5)] {
            let domain = Domain::new(mesh.try_into().unwrap());
            let areas = vertex_areas(&domain.mesh);
            let curvatures = curvatures(&domain, &Graph::of_patches(&domain), &areas, 3);
            for (v, p) in domain.mesh.positions.iter().enumerate().filter(|(_, p)| p.z.abs() < 0.5) {
                assert!((curvatures[v] / curvature - 1.0).abs() < 0.02, "{p} {}", curvatures[v]);
                assert!((half_thickness(&domain, v, 9.0) / thickness - 1.0).abs() < 0.02, "{p}");
            }
        }
    }
}
