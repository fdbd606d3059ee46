//! Decides which side of a surface is outside where nothing else tells: a surface encloses a positive volume; of a sheet,
//! which encloses none, the upper side is outside.

use crate::base::math;
use crate::mesh::topology::components;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// A surface is a sheet, like ground, if at least this share of its area faces the same way.
const SHEET: f64 = 0.6;

/// A piece of one of several surfaces: the number of the surface, a point on the piece and its area vector.
type Piece = (u32, DVec3, DVec3);

/// Sums over the pieces of a surface.
struct Sums {
    origin: DVec3,
    /// Three times the volume between the origin and the surface.
    volume: f64,
    area: f64,
    area_vector: DVec3,
}

impl Sums {
    fn looks_inwards(&self) -> bool {
        let sum = self.area_vector;
        let upwards = [sum.z, sum.y, sum.x].into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        if sum.length() > SHEET * self.area { upwards < Some(0.0) } else { self.volume < 0.0 }
    }
}

/// Turns over the components of `mesh` that face inwards.
pub fn face_outwards(mesh: &mut Mesh) {
    let component = components(mesh.positions.len(), &mesh.triangles);
    let surface = |t: &[u32; 3]| component[t[0] as usize];
    let pieces =
        (0..mesh.triangles.len()).map(|t| (surface(&mesh.triangles[t]), mesh.corners(t)[0], mesh.area_vector(t)));
    let sums = sums(pieces);
    for t in mesh.triangles.iter_mut().filter(|t| sums[&surface(t)].looks_inwards()) {
        t.swap(1, 2);
    }
}

/// Turns over the `normals` of each part of the points that faces inwards. `part` is the number of each point's part,
/// `spacings` the local point spacing.
pub fn turn_outwards(points: &[DVec3], normals: &mut [DVec3], part: &[u32], spacings: &[f64]) {
    let pieces = (0..points.len()).map(|p| (part[p], points[p], math::square(spacings[p]) * normals[p]));
    let sums = sums(pieces);
    normals.iter_mut().zip(part).filter(|(_, part)| sums[part].looks_inwards()).for_each(|(n, _)| *n = -*n);
}

fn sums(pieces: impl Iterator<Item = Piece>) -> FxHashMap<u32, Sums> {
    let mut sums = FxHashMap::default();
    for (surface, place, area) in pieces {
        let new = || Sums { origin: place, volume: 0.0, area: 0.0, area_vector: DVec3::ZERO };
        let sums = sums.entry(surface).or_insert_with(new);
        sums.volume += (place - sums.origin).dot(area);
        sums.area += area.length();
        sums.area_vector += area;
    }
    sums
}
