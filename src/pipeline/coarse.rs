//! How coarse the surface may be that is sampled: of what is far finer than the wanted triangles much can go.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::{Origins, PointOnTriangle};
use crate::mesh::topology::twins;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::density::Density;
use crate::pipeline::options::{Grading, Options};
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::scale::Scale;
use crate::prepare::coarsen::{Coarsened, Coarseness, coarsened, share_of_edges_below};
use crate::spatial::bvh::Bvh;
use crate::spatial::foot::Foot;
use crate::surface::features::{Features, sharp_sides};
use glam::DVec3;
use rayon::prelude::*;

/// The shortest edges of what is sampled, in mean spacings: the error that triangles of such edges make is a tenth of that of the
/// result, or less.
const SHORTEST: f64 = 0.2;

/// How far what goes may be from what is left, in mean spacings.
const TOLERANCE: f64 = 0.01;

/// Edges shorter than this share of the shortest one, and the share of all edges from which on it pays to coarsen.
const FAR_SHORTER: f64 = 0.5;
const MANY: f64 = 0.5;

/// `repaired` as coarse as suffices for that density, and its sharp edges; `None` if it is not much finer, or is to be held to
/// as it is: where lengths follow something, a bound on the error is asked for, or only a part is remeshed.
pub(super) fn coarse(
    prepared: &PreparedInput,
    repaired: &OrientedManifold,
    density: Density,
    monitor: &dyn Monitor,
) -> Result<Option<(OrientedManifold, Features)>> {
    if !may_be_coarser(prepared.options) {
        return Ok(None);
    }
    let scale = Scale::new(density, None, repaired, &prepared.unit)?;
    let coarseness = Coarseness { shortest: SHORTEST * scale.spacing, tolerance: TOLERANCE * scale.spacing };
    if share_of_edges_below(repaired, FAR_SHORTER * coarseness.shortest) < MANY {
        return Ok(None);
    }
    monitor.stage("coarsen");
    let sharp = sharp_sides(repaired, &twins(&repaired.triangles), &prepared.options.features, scale.spacing, 0.0);
    check(monitor)?;
    let Coarsened { mesh, sharp } = coarsened(repaired, &sharp, coarseness);
    check(monitor)?;
    Ok(Some((mesh, Features::Edges(sharp))))
}

fn may_be_coarser(options: &Options) -> bool {
    matches!(options.grading, Grading::Even)
        && options.part.is_none()
        && options.max_error.is_none()
        && !options.of_points
}

/// The origins of `mesh`, in the pipeline's unit, on `input`: through the closest points of `repaired` that face its way.
pub(super) fn origins_through(repaired: &OrientedManifold, mesh: &Mesh, input: &Mesh) -> Origins {
    let bvh = Bvh::new(repaired);
    let origin = |p: DVec3, normal: DVec3| {
        let faces = |t: u32| repaired.area_vector(t as usize).dot(normal) > 0.0;
        let hit = bvh.closest_where(repaired, p, f64::INFINITY, faces).or_else(|| bvh.closest(repaired, p));
        let foot = Foot::of_hit(repaired, hit.expect("the repaired input has triangles"));
        let corners = repaired.triangles[foot.triangle as usize];
        repaired.provenance().origin(foot.triangle, corners, foot.weights, &input.triangles)
    };
    let normals = mesh.vertex_area_vectors();
    let vertices: Vec<PointOnTriangle> =
        mesh.positions.par_iter().zip(normals).map(|(&p, normal)| origin(p, normal)).collect();
    let centre = |t: usize| mesh.corners(t).into_iter().sum::<DVec3>() / 3.0;
    let triangles: Vec<PointOnTriangle> =
        (0..mesh.triangles.len()).into_par_iter().map(|t| origin(centre(t), mesh.area_vector(t))).collect();
    Origins { vertices, triangles }
}
