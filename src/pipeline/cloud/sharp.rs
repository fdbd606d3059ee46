//! Sharp edges in the mesh of a cloud.

use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::cloud::MeshOfPoints;
use crate::pipeline::density::Density;
use crate::pipeline::scale::{Scale, spacing_on};
use crate::prepare::sharpen::{CutEdges, Sharpened, Sharpening};
use crate::surface::features::{BETWEEN_PLANES, Features, SHORTEST};

/// Minimum spacing of the result, in those of the points, for restoring sharp edges: that of three points per vertex. If there
/// are fewer, details of a few of them matter, and planes through neighbours miss these.
const SPARSEST: f64 = 1.7;

/// Radius of the points of a plane in spacings of the result, and its limits in rings of neighbours.
const RADIUS: f64 = 0.55;
const FEWEST_RINGS: f64 = 1.0;
const MOST_RINGS: f64 = 3.0;

/// Spacing of the result, in those of the points, if the density does not determine it.
const ASSUMED: f64 = 4.0;

impl MeshOfPoints {
    /// Restores the sharp edges between the points for a result of the given density, and returns the edges to keep sharp
    /// then: those, if there are any.
    pub fn sharpen(&mut self, features: Features, density: Density) -> Features {
        let Some(cut) = self.cut_edges(&features, density) else { return features };
        let Sharpened { mesh, beside, edges } = cut.restored();
        self.mesh = mesh;
        self.source.extend(beside.iter().map(|&v| self.source[v as usize]).collect::<Vec<_>>());
        self.summary.on_sharp_edges = beside.len();
        Features::Edges(edges)
    }

    /// Returns the sharp edges of the surface, between the points, for a result of the given density.
    pub fn cut_edges(&self, features: &Features, density: Density) -> Option<CutEdges<'_>> {
        let angle = match features {
            Features::Automatic => BETWEEN_PLANES,
            Features::Degrees(angle) => *angle,
            Features::Edges(_) | Features::Smooth => return None,
        };
        // A sheet is a regular grid, not the points themselves.
        if self.summary.plan_cell > 0.0 {
            return None;
        }
        let spacing = spacing_on(self.mesh.area(), density);
        let spacing = spacing.unwrap_or_else(|| ASSUMED * spacing_of_vertices(&self.mesh));
        cut_edges(&self.mesh, angle, spacing).filter(CutEdges::are_certain)
    }
}

/// Returns the sharp edges that a mesh through points seems to cut off, for a result with this `spacing`; `None` if there are
/// none, or the points are too few.
pub(in crate::pipeline) fn cut_edges(mesh: &Mesh, angle: f64, spacing: f64) -> Option<CutEdges<'_>> {
    let ratio = spacing / spacing_of_vertices(mesh);
    let rings = (RADIUS * ratio).round().clamp(FEWEST_RINGS, MOST_RINGS) as usize;
    let wanted = Sharpening { angle, shortest: SHORTEST * spacing, rings };
    if ratio >= SPARSEST { CutEdges::find(mesh, wanted) } else { None }
}

/// Mean distance of neighbouring vertices.
fn spacing_of_vertices(mesh: &Mesh) -> f64 {
    Scale::of_points(mesh.positions.len(), mesh.area()).spacing
}
