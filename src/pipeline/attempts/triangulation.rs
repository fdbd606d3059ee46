//! Triangulation of samples of a surface, and the places where there are too few samples.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::manifold::Manifold;
use crate::mesh::topology::topology;
use crate::optimize::crossings::crossing_faces;
use crate::pipeline::attempts::Attempt;
use crate::pipeline::attempts::rods;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::result::has_kind;
use crate::pipeline::scale::CANDIDATES_PER_POINT;
use crate::pipeline::sized::SizedSurface;
use crate::spectral::candidates::candidates;
use crate::spectral::curve_samples::sample_curves;
use crate::spectral::scan::linear_scan;
use crate::surface::domain::Sample;
use crate::triangulate::chords::part_chords;
use crate::triangulate::rims::straighten_rims;
use crate::triangulate::stitch::{Gluing, Torn, glue};
use crate::triangulate::{Boundary, triangulate};
use glam::DVec3;
use std::ops::RangeInclusive;

/// Shares of intersecting triangles for which samples are too few: fewer can be separated one by one, and with more there is
/// no room for finer edges.
const CROSSED: RangeInclusive<f64> = 0.01..=0.1;

/// Maximum length of edges away from curves where samples follow the surface, in target lengths: those of smooth models stay
/// below two. Along a rod thinner than the target length with fewer than three samples around, they are longer.
const LONGEST: f64 = 2.5;

/// Thickness of a rod, in target lengths, below which even edges of half the length are too few to go around it.
const VERY_THIN: f64 = 0.6;

/// Triangulated samples of a surface.
pub(in crate::pipeline) struct Triangulation {
    pub mesh: Manifold,
    /// Number of smooth patches that were tessellated from the input as a whole.
    pub tessellated_patches: usize,
    /// Places where patches do not fit together.
    pub torn: Torn,
    /// Samples that did not become vertices.
    lost: Vec<Sample>,
}

impl Triangulation {
    /// Triangulates the samples of an attempt on `surface`.
    pub(in crate::pipeline) fn new(
        surface: &SizedSurface,
        attempt: Attempt,
        monitor: &dyn Monitor,
    ) -> Result<Triangulation> {
        let SizedSurface { domain, scale, .. } = surface;
        let curves = sample_curves(domain, scale.curve_spacing(domain) / attempt.curve_density);
        let at_spikes: Vec<Sample> = domain.at_spikes().collect();
        let fixed = [curves.samples.as_slice(), &at_spikes].concat();
        let candidates = candidates(domain, CANDIDATES_PER_POINT * scale.wanted, attempt.seed);
        let samples = linear_scan(domain, &candidates, &fixed, scale.sigma(), attempt.seed, monitor)?;
        monitor.stage("triangulate");
        let spikes = at_spikes.len();
        let boundary = Boundary { sites: &curves.sites, successor: &curves.successor, spikes };
        let mut patches = triangulate(domain, &samples, boundary, scale.spacing, monitor)?;
        let tessellated_patches = patches.tessellated_patches;
        let lost = without(&samples, &patches.source);
        let seams = Gluing { point: &curves.point, edges: &curves.edges, corners: &curves.corners, spikes };
        straighten_rims(domain, &mut patches, boundary);
        part_chords(domain, &mut patches, seams);
        let glued = glue(&patches, seams);
        let (mesh, torn) = glued.map(|mesh| (mesh, Torn::default())).unwrap_or_else(|torn| {
            let mut mesh = patches.mesh;
            mesh.lock_boundary();
            (mesh, torn)
        });
        Ok(Triangulation { mesh, tessellated_patches, torn, lost })
    }

    /// Returns the places with too few samples, and those of them where half the edge length is still too long: the ends of
    /// edges stretched along a thin rod and the samples lost there, and the corners of intersecting triangles, unless these
    /// are so few that they can be separated one by one, or so many that there is no room for finer edges. A surface laid
    /// through points is not known well enough for rods.
    pub(in crate::pipeline) fn sparse_places(
        &self,
        prepared: &PreparedInput,
        surface: &SizedSurface,
    ) -> [Vec<DVec3>; 2] {
        let mut crossing = crossing_faces(&surface.domain, &self.mesh);
        if !are_too_many(crossing.len(), self.mesh.triangles().count()) {
            crossing.clear();
        }
        let rods = if prepared.options.of_points { Vec::new() } else { self.along_rods(surface) };
        let crossing = crossing.into_iter().flat_map(|t| self.mesh.corners(t));
        let very_thin = rods.iter().filter(|(_, width)| *width < VERY_THIN).map(|(p, _)| *p).collect();
        [crossing.chain(rods.iter().map(|(p, _)| *p)).collect(), very_thin]
    }

    /// Returns the ends of edges that are stretched along rods and the samples that were lost between them, with the widths
    /// of the rods there in target lengths.
    fn along_rods(&self, surface: &SizedSurface) -> Vec<(DVec3, f64)> {
        let (c, samples) = (&self.mesh.connectivity, self.mesh.samples());
        let (domain, spacing) = (&surface.domain, surface.scale.spacing);
        let stretched = self.stretched(LONGEST * spacing).flat_map(|h| {
            let [a, b] = [c.origin(h), c.target(h)].map(|v| &samples[v as usize]);
            let axis = (b.position - a.position).normalize_or_zero();
            let width = move |&Sample { position, normal, size, .. }: &Sample| {
                rods::width_along(domain, position, normal, axis, size * spacing)
            };
            [a, b].into_iter().filter_map(move |end| Some((end.position, width(end)?)))
        });
        let mut found: Vec<(DVec3, f64)> = stretched.collect();
        // Samples are also lost at the tip of a spike, where nothing is missing.
        if !found.is_empty() {
            found.extend(self.lost.iter().filter_map(|&Sample { position, normal, size, .. }| {
                Some((position, rods::width_at(domain, position, normal, size * spacing)?))
            }));
        }
        found
    }

    /// Returns the edges away from curves that are longer than `longest`, relative to the target sizes at their ends: the
    /// lengths of those between narrow strips are determined by the curves.
    fn stretched(&self, longest: f64) -> impl Iterator<Item = u32> {
        let c = &self.mesh.connectivity;
        let is_free = |h: u32| !c.is_on_curve(c.origin(h)) && !c.is_on_curve(c.target(h));
        self.mesh.edges().filter(move |&h| is_free(h) && self.mesh.relative_length_squared(h) > longest * longest)
    }

    /// Returns whether the mesh is torn, or has another topology than `surface`.
    pub(in crate::pipeline) fn has_other_topology(&self, surface: &SizedSurface) -> bool {
        let made = self.mesh.to_mesh();
        let kind = topology(made.positions.len(), &made.triangles);
        !self.torn.places.is_empty() || !has_kind(&kind, &surface.topology)
    }
}

/// Returns whether to draw samples again if `crossing` of `triangles` intersect others.
fn are_too_many(crossing: usize, triangles: usize) -> bool {
    CROSSED.contains(&(crossing as f64 / triangles as f64))
}

/// Returns the `samples` whose numbers are not among `used`.
fn without(samples: &[Sample], used: &[u32]) -> Vec<Sample> {
    let mut is_used = vec![false; samples.len()];
    used.iter().filter(|&&s| (s as usize) < samples.len()).for_each(|&s| is_used[s as usize] = true);
    samples.iter().zip(is_used).filter(|(_, is_used)| !is_used).map(|(sample, _)| *sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::pipeline::attempts::Attempts;
    use crate::pipeline::density::Density;
    use crate::pipeline::options::Options;
    use crate::pipeline::sized::resizing::Resizing;
    use crate::testing::{joined, moved, revolved, sphere};
    use glam::dvec3;

    /// Returns a unit sphere and a rod of the given radius beside it.
    fn sphere_and_rod(radius: f64) -> Mesh {
        let profile: Vec<(f64, f64)> = (0..=60).map(|i| (radius, -1.5 + 0.05 * f64::from(i))).collect();
        joined([sphere(), moved(revolved([-1.5, 1.5], &profile, 24), 2.0 * DVec3::X)])
    }

    /// Returns the sparse places of the samples for 1000 vertices, in the input's unit.
    fn sparse_places(input: &Mesh, of_points: bool) -> [Vec<DVec3>; 2] {
        let options = Options { of_points, ..Options::default() };
        let (prepared, repaired) = PreparedInput::new(input, &options, &()).unwrap();
        let density = Density::Points(1000);
        let surface = SizedSurface::new(&prepared, repaired, density, &Resizing::default(), &()).unwrap();
        let attempt = Attempts::new(1, surface.domain.is_sharp()).current();
        let places = Triangulation::new(&surface, attempt, &()).unwrap().sparse_places(&prepared, &surface);
        places.map(|places| places.into_iter().map(|p| prepared.unit.outwards_point(p)).collect())
    }

    #[test]
    fn triangles_that_cross_are_too_many_if_neither_few_nor_most_of_them() {
        assert_eq!([9, 10, 100, 101].map(|crossing| are_too_many(crossing, 1000)), [false, true, true, false]);
    }

    #[test]
    fn samples_are_too_few_along_a_thin_rod_only() {
        let rod = sphere_and_rod(0.02);
        let [sparse, sparsest] = sparse_places(&rod, false);
        let is_on_rod = |p: &DVec3| (*p - dvec3(2.0, 0.0, p.z)).length() < 0.03;
        assert!(!sparsest.is_empty() && sparse.iter().chain(&sparsest).all(is_on_rod), "{sparse:?}");
        for (input, of_points) in [(&rod, true), (&sphere_and_rod(0.2), false), (&sphere(), false)] {
            assert_eq!(sparse_places(input, of_points), [const { Vec::new() }; 2]);
        }
    }
}
