//! Surface that is sampled for a number of vertices, with its target edge lengths.

pub(in crate::pipeline) mod expected;
pub(in crate::pipeline) mod flakes;
pub(in crate::pipeline) mod follow;
pub(in crate::pipeline) mod pinholes;
pub(in crate::pipeline) mod resizing;
pub(in crate::pipeline) mod sampled_domain;
pub(in crate::pipeline) mod sharp_edges;
pub(in crate::pipeline) mod within;

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::topology::{Topology, topology};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::density::Density;
use crate::pipeline::kernel::KernelFeatures;
use crate::pipeline::options::Grading;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::scale::Scale;
use crate::pipeline::sized::expected::with_curves;
use crate::pipeline::sized::flakes::without_flakes;
use crate::pipeline::sized::follow::follow;
use crate::pipeline::sized::pinholes::{Pinholes, close_pinholes};
use crate::pipeline::sized::resizing::{Resizing, sizes_at};
use crate::pipeline::sized::sampled_domain::{SampledDomain, domain_at};
use crate::pipeline::sized::sharp_edges::sharp_edges;
use crate::pipeline::sized::within::{Within, sampled_part};
use crate::prepare::coarsen::in_spatial_order;
use crate::spatial::self_intersections::self_intersections;
use crate::surface::domain::Domain;
use crate::surface::narrow_patches::LeftOut;
use crate::surface::sizing::{adapted_sizes, sizes_between_curves, sizes_with_whole_rows};
use glam::DVec3;

/// Number of rounds in which lengths that fit whole rows and the spacing are adapted to each other.
const FITS_OF_ROWS: usize = 3;

/// Domain of sampling, its scale, and the kernel width.
pub(in crate::pipeline) struct SizedSurface {
    /// In the pipeline's unit.
    pub domain: Domain,
    pub scale: Scale,
    /// Width σp of the kernel, in the pipeline's unit.
    pub sigma: f64,
    /// Whether there were sharp edges that could not be kept.
    pub blunted: bool,
    /// Sharp edges beside narrow patches that were left out.
    pub left_out: LeftOut,
    /// Number of curves along sharp edges that were smoothed over because the patches beside them did not fit together.
    pub smoothed_curves: usize,
    /// Ends of each sharp edge that was left out, in the pipeline's unit.
    pub left_out_edges: Vec<[DVec3; 2]>,
    /// Holes that were closed, in the pipeline's unit.
    pub pinholes: Pinholes,
    /// The rest of the input, if only a part of it is sampled.
    pub within: Option<Within>,
    /// Topology of the sampled surface.
    pub topology: Topology,
    /// Expected topology of a whole result: that of the repaired input without the parts that are left out.
    pub of_whole: Topology,
}

impl SizedSurface {
    /// Makes the surface of `repaired`, the repaired input, for the given density. `resizing` holds the places where a
    /// previous result needs edges of other lengths.
    pub(in crate::pipeline) fn new(
        prepared: &PreparedInput,
        repaired: OrientedManifold,
        density: Density,
        resizing: &Resizing,
        monitor: &dyn Monitor,
    ) -> Result<SizedSurface> {
        let (mut clean, within) = sampled_part(prepared, repaired, density)?;
        // The interface of a part is identified by vertex numbers.
        if within.is_none() {
            clean = in_spatial_order(clean);
        }
        let scale = Scale::new(density, prepared.field.as_ref(), &clean, &prepared.unit)?;
        monitor.stage("sample");
        let topology_of = |mesh: &Mesh| topology(mesh.positions.len(), &mesh.triangles);
        let mut of_whole = prepared.of_repaired;
        let mut pinholes = Pinholes::default();
        if within.is_none() {
            let shortest = prepared.field.as_ref().map_or(scale.spacing, |field| field.shortest(scale.spacing));
            let left = (of_whole.components > 1).then(|| without_flakes(&clean, shortest)).flatten();
            let has_flakes = left.is_some();
            clean = left.unwrap_or(clean);
            if of_whole.boundary_loops > 0 {
                pinholes = close_pinholes(&mut clean, shortest);
            }
            if has_flakes || pinholes.count > 0 {
                of_whole = topology_of(&clean);
            }
        }
        let topology = if within.is_some() { topology_of(&clean) } else { of_whole };
        let SampledDomain { domain, blunted, left_out, left_out_edges } =
            domain_at(clean, within.as_ref(), prepared, &scale, density, resizing);
        let sigma = scale.sigma();
        let smoothed_curves = 0;
        let mut surface = SizedSurface {
            domain,
            scale,
            sigma,
            blunted,
            left_out,
            smoothed_curves,
            left_out_edges,
            pinholes,
            within,
            topology,
            of_whole,
        };
        surface.grade(prepared, density, resizing, monitor)?;
        surface.domain.find_contacts();
        if !prepared.options.of_points {
            surface.domain.find_spikes();
        }
        Ok(surface)
    }

    /// Gives the domain the lengths required by the options, the curves, faulty places, and the interface.
    fn grade(
        &mut self,
        prepared: &PreparedInput,
        density: Density,
        resizing: &Resizing,
        monitor: &dyn Monitor,
    ) -> Result<()> {
        let options = prepared.options;
        let domain = &mut self.domain;
        let follows_curves = matches!(options.grading, Grading::Even | Grading::Curvature(_));
        match &options.grading {
            Grading::Even => {}
            Grading::Curvature(adapt) if *adapt > 0.0 => {
                domain.grade(adapted_sizes(domain, *adapt, self.scale.spacing));
            }
            Grading::Curvature(_) => {}
            Grading::Field(_) => {
                if let Some(field) = &prepared.field {
                    self.scale = field.grade(domain, density, self.scale)?;
                }
            }
            Grading::Kernel { sigma_n, signals } => {
                let features = KernelFeatures::over(domain, *sigma_n, signals);
                let followed = follow(domain, &features, self.scale, density, options.seed, monitor)?;
                domain.grade(followed.sizes);
                (self.scale, self.sigma) = (followed.scale, followed.sigma);
            }
        }
        if follows_curves
            && domain.is_sharp()
            && let Some(sizes) = sizes_between_curves(domain, &domain.sizes(), self.scale.spacing)
        {
            domain.grade(sizes);
        }
        if let Some(sizes) = resizing.shorter(domain, self.scale.spacing) {
            domain.grade(sizes);
        }
        if let Some(within) = &self.within {
            self.scale = within.grade(&mut self.domain, density, &self.scale);
        } else if !matches!(options.grading, Grading::Kernel { .. }) {
            self.scale = with_curves(domain, self.scale, density);
            if follows_curves && domain.is_sharp() {
                self.fit_rows(density);
            }
        }
        if !matches!(options.grading, Grading::Kernel { .. }) {
            self.sigma = self.scale.sigma();
        }
        Ok(())
    }

    /// Adjusts the lengths between curves so that whole rows of triangles fit. This changes the spacing for the number of
    /// vertices, and vice versa.
    fn fit_rows(&mut self, density: Density) {
        let before = self.domain.sizes();
        for _ in 0..FITS_OF_ROWS {
            self.domain.grade(sizes_with_whole_rows(&self.domain, &before, self.scale.spacing));
            self.scale = with_curves(&self.domain, self.scale, density);
        }
    }

    /// Makes edges `factor` times as long around `places`. Returns whether there is room for that.
    pub(in crate::pipeline) fn resize_at(&mut self, places: &[DVec3], factor: f64) -> bool {
        let sizes = sizes_at(places, factor, &self.domain, self.scale.spacing);
        let has_room = sizes.is_some();
        sizes.into_iter().for_each(|sizes| self.domain.grade(sizes));
        has_room
    }

    /// Returns the same surface with all sharp edges smoothed over.
    pub(in crate::pipeline) fn smooth(self) -> SizedSurface {
        SizedSurface {
            blunted: true,
            left_out: LeftOut::default(),
            smoothed_curves: 0,
            ..self.without_curves(|_| true)
        }
    }

    /// Returns the same surface with the sharp edges on curves whose number `is_left_out` smoothed over.
    pub(in crate::pipeline) fn without_curves(mut self, is_left_out: impl Fn(u32) -> bool) -> SizedSurface {
        self.smoothed_curves += self.domain.sharp_curves().filter(|&curve| is_left_out(curve)).count();
        self.left_out_edges.extend(sharp_edges(&self.domain, &is_left_out));
        self.domain = self.domain.without_curves(is_left_out);
        self.domain.find_contacts();
        self
    }

    /// Number of triangles of the repaired input that intersect others.
    pub(in crate::pipeline) fn self_intersections_of_input(&self) -> usize {
        let of_whole = self.within.as_ref().map(|within| self_intersections(&within.whole).len());
        of_whole.unwrap_or_else(|| self.domain.self_intersections().len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::options::Options;
    use crate::testing::{cube, joined, moved};

    #[test]
    fn self_intersections_are_those_of_the_whole_refined_surface() {
        // Two that intersect, and a separate one.
        let places = [DVec3::ZERO, DVec3::new(0.3, 0.4, 0.6), DVec3::new(4.0, 0.1, 0.2)];
        let input = joined(places.map(|at| moved(cube(), at)));
        let options = Options::default();
        let (prepared, repaired) = PreparedInput::new(&input, &options, &()).unwrap();
        let (density, resizing) = (Density::Points(900), Resizing::default());
        let SizedSurface { domain, .. } = SizedSurface::new(&prepared, repaired, density, &resizing, &()).unwrap();
        assert!(domain.mesh.triangles.len() > 10 * input.triangles.len());
        let whole = self_intersections(&domain.mesh);
        assert!(whole.len() > 20 && whole.len() < domain.mesh.triangles.len() / 4);
        assert_eq!(domain.self_intersections(), whole);
    }

    #[test]
    fn what_is_smoothed_over_is_counted_and_its_edges_are_told() {
        let (input, options) = (cube(), Options::default());
        let (prepared, repaired) = PreparedInput::new(&input, &options, &()).unwrap();
        let surface = SizedSurface::new(&prepared, repaired, Density::Points(200), &Resizing::default(), &()).unwrap();
        let curves: Vec<u32> = surface.domain.sharp_curves().collect();
        assert_eq!((curves.len(), surface.left_out_edges.len()), (12, 0));
        let length = |edges: &[[DVec3; 2]]| edges.iter().map(|[a, b]| a.distance(*b)).sum::<f64>();
        let all = length(&sharp_edges(&surface.domain, |_| true).collect::<Vec<_>>());
        let surface = surface.without_curves(|curve| curves[..2].contains(&curve));
        assert_eq!((surface.smoothed_curves, surface.domain.sharp_curves().count()), (2, 10));
        assert!((length(&surface.left_out_edges) - all / 6.0).abs() < 1e-9 && !surface.blunted);
        let surface = surface.smooth();
        assert!(surface.blunted && surface.smoothed_curves == 0 && !surface.domain.is_sharp());
        assert!((length(&surface.left_out_edges) - all).abs() < 1e-9);
    }

    #[test]
    fn a_narrow_chamfer_stays_where_an_attempt_went_wrong() {
        // A block with one edge cut off by a twelfth of the spacing.
        let outline = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.05, 10.0], [0.0, 9.95]];
        let positions = outline.iter().flat_map(|&[x, y]| [DVec3::new(x, y, 0.0), DVec3::new(x, y, 10.0)]).collect();
        let sides = (0..5).map(|i| (2 * i, 2 * ((i + 1) % 5))).flat_map(|(a, b)| [[a, b, b + 1], [a, b + 1, a + 1]]);
        let ends = (1..4).flat_map(|i| [[0, 2 * i + 2, 2 * i], [1, 2 * i + 1, 2 * i + 3]]);
        let block = Mesh { positions, triangles: sides.chain(ends).collect() };
        let options = Options::default();
        let (prepared, repaired) = PreparedInput::new(&block, &options, &()).unwrap();
        let left_out = |resizing: &Resizing| {
            let sized = SizedSurface::new(&prepared, repaired.clone(), Density::Points(1500), resizing, &());
            sized.unwrap().left_out.patches
        };
        assert_eq!(left_out(&Resizing::default()), 1);
        let mut resizing = Resizing::default();
        resizing.shorten_at(&[prepared.unit.inwards_point(DVec3::new(0.05, 10.0, 0.0))]);
        assert_eq!(left_out(&resizing), 0);
    }
}
