//! Sharp edges in the mesh of a cloud.

use crate::pipeline::cloud::MeshOfPoints;
use crate::pipeline::density::Density;
use crate::pipeline::scale::{Scale, spacing_on};
use crate::prepare::sharpen::{SharpEdges, Sharpened, sharpened};
use crate::surface::features::{BETWEEN_PLANES, Features, SHORTEST};

/// Minimum spacing of the result, in those of the points, for restoring sharp edges. If the points are sparser, details of a
/// few of them matter, and planes through their neighbours miss these.
const SPARSEST: f64 = 2.8;

/// Radius of the points of a plane in spacings of the result, and its limits in rings of neighbours.
const RADIUS: f64 = 0.5;
const FEWEST_RINGS: f64 = 1.0;
const MOST_RINGS: f64 = 3.0;

/// Spacing of the result, in those of the points, if the density does not determine it.
const FINEST: f64 = 4.0;

impl MeshOfPoints {
    /// Restores the sharp edges between the points for a result of the given density, and returns the edges to keep sharp
    /// then: those, if there are any.
    pub fn sharpen(&mut self, features: Features, density: Density) -> Features {
        let angle = match features {
            Features::Automatic => BETWEEN_PLANES,
            Features::Degrees(angle) => angle,
            Features::Edges(_) | Features::Smooth => return features,
        };
        let area = self.mesh.area();
        let of_points = Scale::of_points(self.mesh.positions.len(), area).spacing;
        let spacing = spacing_on(area, density).unwrap_or(FINEST * of_points);
        let ratio = spacing / of_points;
        // A sheet is a regular grid, not the points themselves.
        if ratio < SPARSEST || self.summary.plan_cell > 0.0 {
            return features;
        }
        let rings = (RADIUS * ratio).round().clamp(FEWEST_RINGS, MOST_RINGS) as usize;
        let wanted = SharpEdges { angle, shortest: SHORTEST * spacing, rings };
        let Some(Sharpened { mesh, beside, edges }) = sharpened(&self.mesh, &wanted) else { return features };
        self.mesh = mesh;
        self.source.extend(beside.iter().map(|&v| self.source[v as usize]).collect::<Vec<_>>());
        self.summary.on_sharp_edges = beside.len();
        Features::Edges(edges)
    }
}
