//! Origins of the vertices and triangles of a result on the input.
//!
//! Each vertex knows a nearby triangle of the sampled surface, from which a short walk finds the closest point; the
//! provenance of the surface maps that point to the input.
//!
//! Cost: about a microsecond per vertex and per triangle, in parallel.

use crate::base::parallel;
use crate::manifold::Manifold;
use crate::mesh::half_edge::OnCurve;
use crate::mesh::provenance::{Origins, PointOnTriangle};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::coarse::origins_through;
use crate::pipeline::prepared::PreparedInput;
use crate::pipeline::sized::SizedSurface;
use crate::pipeline::sized::within::{Sewn, Within};
use crate::surface::domain::Sample;

/// Returns the origins of `of_part`, the mesh of `made` in the pipeline's unit, and of what was joined to it.
pub(in crate::pipeline) fn origins(
    prepared: &PreparedInput,
    surface: &SizedSurface,
    made: &Manifold,
    of_part: &Mesh,
    sewn: Option<&Sewn>,
) -> Origins {
    if let Some(fine) = &prepared.fine {
        return origins_through(&fine.mesh, of_part, prepared.input);
    }
    let (domain, input) = (&surface.domain, &prepared.input.triangles);
    let (_, old) = made.connectivity.compact();
    let reach = |size: f64| surface.scale.spacing * size;
    let vertex = |&v: &u32| {
        let sample = made.sample(v);
        domain.origin(sample, reach(sample.size), input)
    };
    let triangle = |t: usize| {
        let centre = of_part.centroid(t);
        let normal = of_part.area_vector(t);
        // A corner that is not on a curve identifies the smooth patch.
        let mut corners = of_part.triangles[t].iter().map(|&v| old[v as usize]);
        match corners.find(|&v| made.connectivity.curve_at(v) == OnCurve::No) {
            Some(v) => {
                let near = made.sample(v);
                domain.origin(&Sample { position: centre, normal, ..*near }, reach(near.size), input)
            }
            None => domain.origin(&domain.project_facing(centre, normal), 0.0, input),
        }
    };
    let vertices: Vec<PointOnTriangle> = parallel::map(&old[..], vertex);
    let triangles: Vec<PointOnTriangle> = parallel::map(0..of_part.triangles.len(), triangle);
    let of_part = Origins { vertices, triangles };
    match surface.within.as_ref().zip(sewn) {
        Some((within, sewn)) => joined(within, sewn, of_part, prepared.input),
        None => of_part,
    }
}

/// Returns the origins of the whole, whose kept vertices and triangles come first.
fn joined(within: &Within, sewn: &Sewn, of_part: Origins, input: &Mesh) -> Origins {
    let kept = sewn.mesh.positions.len() - sewn.new.len();
    let mut vertices = vec![PointOnTriangle { triangle: NONE, weights: [0.0; 3] }; kept];
    for (corners, &t) in sewn.mesh.triangles.iter().zip(&sewn.kept_triangles) {
        for (k, &v) in corners.iter().enumerate() {
            let corner = std::array::from_fn(|i| f64::from(i == k));
            vertices[v as usize] = within.origin(t, corner, input);
        }
    }
    vertices.extend(sewn.new.iter().map(|&v| of_part.vertices[v as usize]));
    let mut triangles: Vec<PointOnTriangle> =
        sewn.kept_triangles.iter().map(|&t| within.origin(t, [1.0 / 3.0; 3], input)).collect();
    triangles.extend(of_part.triangles);
    Origins { vertices, triangles }
}
