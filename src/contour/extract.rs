//! Triangulates the entire implicit surface of a point cloud.
//!
//! The zero set is contoured on a lattice ([`crate::contour::lattice`]), starting from the points projected onto it. Not all
//! of it is meaningful: the function is also zero past a border, at the limit of the points' support, and between the two
//! sides of a thin wall. A part of the surface is doubtful if it is farther from the nearest point than that point's
//! neighbours are, or faces away from that point's normal. Doubtful parts are kept only if they fill a gap: if they are
//! small and surrounded by parts that are not doubtful. Pieces hardly larger than the distance of two points are dropped as
//! well.
//!
//! Cost: that of the lattice, where a value takes about three microseconds.
//!
//! Limits: at a border of the cloud, the surface continues for up to a spacing.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::contour::lattice::{Field, Lattice, contour};
use crate::geom::aabb::Aabb;
use crate::mesh::topology::{NONE, components, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::implicit::{Found, Local, Rimls};
use glam::DVec3;

/// Distance from the nearest point beyond which the surface is doubtful, in local spacings: what lies beyond is past a
/// border.
const FARTHEST: f64 = 1.0;

/// Maximum extent of the surface from the nearest point, in spacings: random sampling leaves gaps of that size.
const WIDEST: f64 = 2.2;

/// Minimum cosine between the normal of the surface and that of the nearest point without doubt: at a sharp edge it may be
/// as low as slightly below zero, while meaningless sheets face the other way.
const LEAST_AGREEMENT: f64 = -0.5;

/// Maximum diagonal of a gap's bounding box, in mean spacings.
const GAP: f64 = 6.0;

/// Minimum diagonal of a piece's bounding box, in mean spacings.
const TINY: f64 = 3.0;

/// Returns the part of `surface` near its points, as an oriented mesh. It is a manifold, except at vertices where two parts
/// of the boundary meet. `lattice` has room for all of it.
///
/// # Errors
/// Those of [`contour`].
pub fn extract(surface: &Rimls, lattice: &Lattice, most: usize, monitor: &dyn Monitor) -> Result<Mesh> {
    let seeds = surface.seeds();
    check(monitor)?;
    let mut mesh = contour(lattice, &seeds, &NearPoints { surface, edge: lattice.edge() }, most, monitor)?;
    drop_doubtful_parts(&mut mesh, surface);
    drop_tiny_pieces(&mut mesh, TINY * surface.mean_spacing());
    Ok(mesh)
}

/// The function, limited to where cells may be useful.
struct NearPoints<'a> {
    surface: &'a Rimls<'a>,
    edge: f64,
}

impl Field for NearPoints<'_> {
    type Local = Local;

    fn local(&self, centre: DVec3, radius: f64) -> Local {
        self.surface.local(centre, radius)
    }

    fn value(&self, local: &mut Local, x: DVec3) -> Option<f64> {
        let (value, nearest) = self.surface.value_in(local, x)?;
        let farthest = WIDEST * self.surface.spacing(nearest.point) + self.edge;
        (nearest.distance_squared <= farthest * farthest).then_some(value.f)
    }
}

/// Drops doubtful parts, except those that fill a gap: small ones surrounded by other parts.
fn drop_doubtful_parts(mesh: &mut Mesh, surface: &Rimls) {
    let is_doubtful = doubtful(mesh, surface);
    let sides = || mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let inner: Vec<[u32; 3]> =
        sides().filter(|side| side.iter().all(|&v| is_doubtful[v as usize])).map(|[a, b]| [a, b, b]).collect();
    let part = components(mesh.positions.len(), &inner);
    drop(inner);
    let extent = extents(&part, &mesh.positions);
    let widest = GAP * surface.mean_spacing();
    let mut fills_gap: Vec<bool> = extent.into_iter().map(|extent| extent <= widest).collect();
    for (side, _) in (0..).zip(twins(&mesh.triangles)).filter(|&(_, twin)| twin == NONE) {
        fills_gap[part[mesh.origin(side) as usize] as usize] = false;
    }
    let stays = |&v: &u32| !is_doubtful[v as usize] || fills_gap[part[v as usize] as usize];
    mesh.triangles.retain(|t| t.iter().all(stays));
    mesh.drop_unused();
}

/// Returns whether each vertex is doubtful: not clearly on the surface that the points represent.
fn doubtful(mesh: &Mesh, surface: &Rimls) -> Vec<bool> {
    let normals = mesh.vertex_area_vectors();
    let is_doubtful = |found: &mut Found, x: DVec3, normal: DVec3| {
        surface.nearest(x, found).is_none_or(|(nearest, theirs)| {
            let farthest = FARTHEST * surface.spacing(nearest.point);
            nearest.distance_squared > farthest * farthest || normal.normalize_or_zero().dot(theirs) < LEAST_AGREEMENT
        })
    };
    parallel::map_with(0..normals.len(), Found::default, |found, v| is_doubtful(found, mesh.positions[v], normals[v]))
}

/// Diagonals of the bounding boxes of parts, which are numbered in the order of their first vertex.
fn extents(part: &[u32], positions: &[DVec3]) -> Vec<f64> {
    let mut boxes: Vec<Aabb> = Vec::new();
    for (&part, &p) in part.iter().zip(positions) {
        match boxes.get_mut(part as usize) {
            Some(own) => *own = own.join(&Aabb::at(p)),
            None => boxes.push(Aabb::at(p)),
        }
    }
    boxes.iter().map(Aabb::diagonal).collect()
}

/// Drops the pieces that are smaller than `smallest`.
fn drop_tiny_pieces(mesh: &mut Mesh, smallest: f64) {
    let piece = components(mesh.positions.len(), &mesh.triangles);
    let extent = extents(&piece, &mesh.positions);
    mesh.triangles.retain(|t| extent[piece[t[0] as usize] as usize] >= smallest);
    mesh.drop_unused();
}
