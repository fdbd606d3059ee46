//! Decides how coarse the sampled surface may be: an input far finer than the target triangles can be decimated.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::{Origins, PointOnTriangle};
use crate::mesh::topology::twins;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::density::Density;
use crate::pipeline::options::{Grading, Options};
use crate::pipeline::prepared::{Fine, PreparedInput};
use crate::pipeline::scale::Scale;
use crate::prepare::coarsen::{Coarsened, Coarseness, coarsened, in_spatial_order, share_of_edges_below};
use crate::spatial::bvh::Bvh;
use crate::spatial::foot::Foot;
use crate::surface::features::{Features, sharp_sides};
use glam::DVec3;

/// Shortest edges of the sampled surface, in mean spacings. Triangles with such edges add an error of at most a tenth of
/// that of the result.
const SHORTEST: f64 = 0.2;

/// Maximum distance of removed vertices from the remaining surface, in mean spacings.
const TOLERANCE: f64 = 0.01;

/// Coarsening pays if at least this share of all edges (`MANY`) is shorter than this share of the shortest one
/// (`FAR_SHORTER`).
const FAR_SHORTER: f64 = 0.5;
const MANY: f64 = 0.5;

/// Minimum number of vertices per wanted vertex for which coarsening pays. In a part with fewer, the short edges belong to
/// fillets and text beside wide faces.
const MANY_TIMES: usize = 8;

/// Returns how coarse a surface may be that is sampled with this mean spacing.
pub fn coarseness_for(spacing: f64) -> Coarseness {
    Coarseness { shortest: SHORTEST * spacing, tolerance: TOLERANCE * spacing }
}

/// Returns the spacing of the result if `repaired` is much finer; `None` if it is not or must not become coarser: if lengths
/// are graded, the error is bounded, or only a part is remeshed.
pub(super) fn far_wider_spacing(
    prepared: &PreparedInput,
    repaired: &OrientedManifold,
    density: Density,
) -> Result<Option<f64>> {
    if !may_be_coarser(prepared.options) {
        return Ok(None);
    }
    let Scale { wanted, spacing } = Scale::new(density, None, repaired, &prepared.unit)?;
    let is_finer = repaired.positions.len() >= MANY_TIMES * wanted
        && share_of_edges_below(repaired, FAR_SHORTER * SHORTEST * spacing) >= MANY;
    Ok(is_finer.then_some(spacing))
}

/// Puts `repaired` in spatial order, coarsens it as far as results of this spacing permit, and returns it with its sharp
/// edges.
pub(super) fn coarse(
    prepared: &PreparedInput,
    repaired: OrientedManifold,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<(OrientedManifold, Fine)> {
    monitor.stage("coarsen");
    let fine = in_spatial_order(repaired);
    let sharp = sharp_sides(&fine, &twins(&fine.triangles), &prepared.options.features, spacing, 0.0, |_| false);
    check(monitor)?;
    let Coarsened { mesh, sharp } = coarsened(&fine, &sharp, coarseness_for(spacing));
    check(monitor)?;
    Ok((mesh, Fine { mesh: fine, features: Features::Edges(sharp) }))
}

fn may_be_coarser(options: &Options) -> bool {
    matches!(options.grading, Grading::Even)
        && options.part.is_none()
        && options.max_error.is_none()
        && !options.of_points
}

/// Returns the origins of `mesh`, in the pipeline's unit, on `input`: through the closest points of `repaired` that face the
/// same way.
pub(super) fn origins_through(repaired: &OrientedManifold, mesh: &Mesh, input: &Mesh) -> Origins {
    // `coarse` left the triangles in spatial order, and there are few queries.
    let bvh = Bvh::in_order_of(repaired);
    let origin = |p: DVec3, normal: DVec3| {
        let faces = |t: u32| repaired.area_vector(t as usize).dot(normal) > 0.0;
        let hit = bvh.closest_where(repaired, p, f64::INFINITY, faces).or_else(|| bvh.closest(repaired, p));
        let foot = Foot::of_hit(repaired, hit.expect("the repaired input has triangles"));
        let corners = repaired.triangles[foot.triangle as usize];
        repaired.provenance().origin(foot.triangle, corners, foot.weights, &input.triangles)
    };
    let normals = mesh.vertex_area_vectors();
    let vertices: Vec<PointOnTriangle> =
        parallel::map(0..mesh.positions.len(), |v| origin(mesh.positions[v], normals[v]));
    let triangles: Vec<PointOnTriangle> =
        parallel::map(0..mesh.triangles.len(), |t| origin(mesh.centroid(t), mesh.area_vector(t)));
    Origins { vertices, triangles }
}
