//! Dihedral angles across the edges of a mesh.
//!
//! The normal of a needle or cap that is too narrow for the samples cannot be trusted, since rounding turns it. It is
//! replaced by that of the triangle across the longest side. Strips this narrow become one edge.
//!
//! Cost: linear in the triangles.

use crate::base::math;
use crate::base::parallel;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;

/// Height of a triangle, relative to its longest side and to the spacing, below which its normal is not trusted.
const NARROW: f64 = 0.05;

/// Maximum length of a chain of narrow triangles to follow to one that is not narrow.
const LONGEST_CHAIN: usize = 16;

/// Returns a vector along the normal of triangle `first`. If the triangle is so narrow for samples with this `spacing` that
/// its normal cannot be trusted, that of the triangle across its longest side is taken, and so on. For two narrow triangles
/// with the same longest side, it is the sum of both.
pub(super) fn trusted_normal(mesh: &Mesh, twin: &[u32], spacing: f64, first: u32) -> DVec3 {
    let seen = |t: u32| Seen::new(mesh, t, spacing);
    let mut own = seen(first);
    for _ in 0..LONGEST_CHAIN {
        let across = twin[own.longest_side as usize];
        if across == NONE || !own.is_narrow {
            return own.normal;
        }
        let next = seen(across / 3);
        if next.longest_side == across && next.is_narrow {
            return own.normal + next.normal;
        }
        own = next;
    }
    mesh.area_vector(first as usize)
}

/// Properties of a triangle.
struct Seen {
    normal: DVec3,
    longest_side: u32,
    is_narrow: bool,
}

impl Seen {
    fn new(mesh: &Mesh, t: u32, spacing: f64) -> Seen {
        let normal = mesh.area_vector(t as usize);
        let [a, b, c] = mesh.corners(t as usize);
        let lengths = [a.distance(b), b.distance(c), c.distance(a)];
        // The first of several equally long sides.
        let k = (1..3).fold(0, |k, l| if lengths[l] > lengths[k] { l } else { k });
        let longest = lengths[k];
        let is_narrow = normal.length() < NARROW * longest * longest.min(spacing);
        Seen { normal, longest_side: 3 * t + k as u32, is_narrow }
    }
}

/// Returns the narrow triangles that are folded over, each with a vector along the normal that is trusted instead of its
/// own.
pub(super) fn folded_over(mesh: &Mesh, twin: &[u32], spacing: f64) -> Vec<(u32, DVec3)> {
    let folded = |t: u32| {
        let trusted = trusted_normal(mesh, twin, spacing, t);
        (trusted.dot(mesh.area_vector(t as usize)) < 0.0).then_some((t, trusted))
    };
    parallel::collect(0..mesh.triangles.len() as u32, |block| block.filter_map(folded))
}

/// Share of the smallest angle to report, below which angles are set to zero. The margin exceeds rounding errors.
const CLEARLY: f64 = 0.999;

/// Returns the dihedral angle across each side, in degrees, negative where the surface is concave; zero at the boundary and
/// next to triangles without area. Angles below `least` degrees may be reported as zero.
pub(super) fn dihedral_angles(mesh: &Mesh, twin: &[u32], spacing: f64, least: f64) -> Vec<f64> {
    let flat = math::square(math::sin_cos((CLEARLY * least).to_radians()).1);
    let trusted = |t: u32| trusted_normal(mesh, twin, spacing, t);
    let normals = parallel::map(0..mesh.triangles.len() as u32, trusted);
    let turn = |side: usize| {
        let across = twin[side];
        if across == NONE {
            return 0.0;
        }
        let [a, b] = [side, across as usize].map(|s| normals[s / 3]);
        let cosine = a.dot(b);
        if a == DVec3::ZERO || b == DVec3::ZERO {
            return 0.0;
        }
        if cosine > 0.0 && cosine * cosine > flat * a.length_squared() * b.length_squared() {
            return 0.0;
        }
        let [from, to] = mesh.segment(side as u32);
        let axis = a.cross(b);
        math::atan2(axis.length(), cosine).to_degrees().copysign(axis.dot(to - from))
    };
    parallel::map(0..twin.len(), turn)
}

pub(super) fn length(mesh: &Mesh, side: u32) -> f64 {
    let [a, b] = mesh.segment(side);
    a.distance(b)
}

/// Unit vector along a side; zero for a side without length.
pub(super) fn direction(mesh: &Mesh, side: u32) -> DVec3 {
    let [a, b] = mesh.segment(side);
    (b - a).normalize_or_zero()
}
