//! Estimates the number of vertices of a triangulation with the target lengths.
//!
//! Samples on curves are as dense as the target length requires, even where the space between the curves is too narrow for
//! triangles of that size, and samples on the boundary have triangles on one side only. With V inner vertices and R on its
//! rim, a disk has F = 2 V + R - 2 triangles, each of area √3/4 h². So the number of inner vertices of a patch is what its
//! area implies, minus half the number on its rim.
//!
//! Cost: one sampling of the curves for each spacing that is tried, and some sums over the triangles.

use crate::base::math;
use crate::pipeline::density::Density;
use crate::pipeline::scale::Scale;
use crate::spectral::curve_samples::sample_curves;
use crate::surface::domain::Domain;

/// Maximum factor, up and down, of the search for the spacing, and its number of steps.
const LARGEST_FACTOR: f64 = 4.0;
const STEPS: usize = 16;

/// Returns `scale` with the spacing that gives its number of vertices or, if lengths are given, with the number of vertices
/// that they imply.
pub(in crate::pipeline) fn with_curves(domain: &Domain, scale: Scale, density: Density) -> Scale {
    if domain.curves.list.is_empty() {
        return scale;
    }
    let patches = Patches::new(domain);
    if !density.fixes_count() {
        return Scale { wanted: patches.vertices(scale).round() as usize, ..scale };
    }
    let (mut least, mut most) = (scale.spacing / LARGEST_FACTOR, scale.spacing * LARGEST_FACTOR);
    for _ in 0..STEPS {
        let spacing = (least * most).sqrt();
        let expected = patches.vertices(Scale { spacing, ..scale });
        if expected > scale.wanted as f64 { least = spacing } else { most = spacing }
    }
    Scale { spacing: most, ..scale }
}

/// Smooth patches of a domain.
struct Patches<'a> {
    domain: &'a Domain,
    /// For each patch, the integral of 1 / h² over its area, with lengths h relative to the spacing.
    relative_area: Vec<f64>,
}

impl Patches<'_> {
    fn new(domain: &Domain) -> Patches<'_> {
        let mut relative_area = vec![0.0; domain.mesh.positions.len()];
        for (t, corners) in (0u32..).zip(&domain.mesh.triangles) {
            let size = corners.iter().map(|&v| domain.size_at(v)).sum::<f64>() / 3.0;
            relative_area[domain.patch_of(t) as usize] += domain.mesh.triangle_area(t as usize) / math::square(size);
        }
        Patches { domain, relative_area }
    }

    /// Returns the approximate number of vertices on the curves and inside the patches.
    fn vertices(&self, scale: Scale) -> f64 {
        let curves = sample_curves(self.domain, scale.curve_spacing(self.domain));
        let mut inside: Vec<f64> =
            self.relative_area.iter().map(|area| 2.0 * area / (3f64.sqrt() * math::square(scale.spacing))).collect();
        for sample in &curves.samples {
            inside[self.domain.patch_of(sample.triangle) as usize] -= 0.5;
        }
        let on_curves = curves.point.iter().max().map_or(0, |&last| last + 1);
        f64::from(on_curves) + inside.iter().map(|n| n.max(0.0)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::features::Features;
    use crate::testing::{cube, grid, sphere};
    use glam::dvec3;

    fn spacing(domain: &Domain, wanted: usize) -> f64 {
        let scale = Scale::of_points(wanted, domain.mesh.area());
        with_curves(domain, scale, Density::Points(wanted)).spacing / scale.spacing
    }

    #[test]
    fn triangles_on_one_side_of_the_boundary_are_larger() {
        // The band is 1 wide and 100 long: with three rows, 300 by 4 vertices have 1800 triangles, not 2400.
        let band = Domain::new(grid(200, 2, |u, v| dvec3(100.0 * u, v, 0.0)).try_into().unwrap());
        let ratio = spacing(&band, 1200);
        assert!((ratio - (4.0f64 / 3.0).sqrt()).abs() < 0.02, "{ratio}");
    }

    #[test]
    fn sharp_edges_between_wide_patches_and_none_at_all_change_nothing() {
        let ratio = spacing(&Domain::with_features(cube().try_into().unwrap(), Features::Automatic, 0.05), 5000);
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
        assert_eq!(spacing(&Domain::new(sphere().try_into().unwrap()), 500), 1.0);
    }

    #[test]
    fn given_lengths_mean_a_number_of_vertices() {
        let band = Domain::new(grid(200, 2, |u, v| dvec3(100.0 * u, v, 0.0)).try_into().unwrap());
        let of_area = Scale::of_points(1200, band.mesh.area());
        let wanted = with_curves(&band, of_area, Density::EdgeLength(of_area.spacing)).wanted;
        assert!((1500..1650).contains(&wanted), "{wanted}");
    }
}
