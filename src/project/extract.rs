//! All of the implicit surface of a point cloud as triangles.
//!
//! The zero set is contoured on a lattice ([`crate::project::lattice`]), from the points projected on it. Of it stays what
//! is the surface: at a distance of up to about a spacing from a point and facing as that one does. Beyond, the function
//! is zero at places that mean nothing, at the rim of what points reach and between the two sides of a thin wall. Pieces
//! that are hardly larger than the distance of two points go, too.
//!
//! Cost: that of the lattice, where a value takes some ten microseconds.
//!
//! Limits: where the cloud has a border, the surface goes on for up to a spacing. Where points are denser than the cells,
//! they reach as far as if they were as dense as these, so that no cell is without a value.

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::project::lattice::{Lattice, contour};
use crate::project::rimls::Rimls;
use crate::surface::mesh::Mesh;
use crate::surface::neighbors::Neighbor;
use crate::surface::topology::components;
use glam::DVec3;
use rayon::prelude::*;

/// How far from the nearest point the surface may be, in spacings there: points of a random sampling have gaps.
const FARTHEST: f64 = 1.2;

/// Least cosine between the normal of the surface and that of the nearest point: at a sharp edge it may be any above zero
/// and a little less, the sheets that mean nothing face the other way.
const LEAST_AGREEMENT: f64 = -0.5;

/// Pieces in a box with a diagonal below so many mean spacings are none.
const TINY: f64 = 3.0;

/// The part of `surface` that is near its points, as an oriented mesh. It is a manifold, but for vertices in which two
/// parts of the boundary meet. `lattice` has room for all of it.
///
/// # Errors
/// Those of [`contour`].
pub fn extract(surface: &Rimls, lattice: &Lattice, most: usize, monitor: &dyn Monitor) -> Result<Mesh> {
    let (seeds, _) = surface.smoothed();
    check(monitor)?;
    let value = |x: DVec3, found: &mut Vec<Neighbor>| {
        let value = surface.value(x, found)?;
        let nearest = found.first()?;
        let farthest = FARTHEST * surface.spacing(nearest.point) + lattice.edge();
        (nearest.distance_squared <= farthest * farthest).then_some(value.f)
    };
    let mut mesh = contour(lattice, &seeds, value, most, monitor)?;
    let belongs = belonging(&mesh, surface);
    mesh.triangles.retain(|t| t.iter().all(|&v| belongs[v as usize]));
    mesh.drop_unused();
    drop_tiny_pieces(&mut mesh, TINY * surface.mean_spacing());
    Ok(mesh)
}

/// For each vertex whether it is of the surface that the points mean.
fn belonging(mesh: &Mesh, surface: &Rimls) -> Vec<bool> {
    let normals = mesh.vertex_area_vectors();
    let belongs = |found: &mut Vec<Neighbor>, (&x, normal): (&DVec3, &DVec3)| {
        surface.nearest(x, found).is_some_and(|(nearest, theirs)| {
            let farthest = FARTHEST * surface.spacing(nearest.point);
            nearest.distance_squared <= farthest * farthest && normal.normalize_or_zero().dot(theirs) >= LEAST_AGREEMENT
        })
    };
    mesh.positions.par_iter().zip(&normals).map_init(Vec::new, belongs).collect()
}

/// Drops the pieces whose bounding box has a diagonal below `smallest`.
fn drop_tiny_pieces(mesh: &mut Mesh, smallest: f64) {
    let piece = components(mesh.positions.len(), &mesh.triangles);
    let mut boxes: Vec<(DVec3, DVec3)> = Vec::new();
    for (&piece, &p) in piece.iter().zip(&mesh.positions) {
        if piece as usize == boxes.len() {
            boxes.push((p, p));
        }
        let (lo, hi) = &mut boxes[piece as usize];
        (*lo, *hi) = (lo.min(p), hi.max(p));
    }
    let is_tiny: Vec<bool> = boxes.iter().map(|(lo, hi)| lo.distance(*hi) < smallest).collect();
    mesh.triangles.retain(|t| !is_tiny[piece[t[0] as usize] as usize]);
    mesh.drop_unused();
}
