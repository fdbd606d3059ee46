//! Transfers texture coordinates from one mesh to another.
//!
//! Texture coordinates jump at UV seams, so each output triangle has to lie on one side of a seam as a whole: the side of
//! the input triangle below its centre. From there a walk covers the input as far as the output triangle extends, without
//! crossing seams. A corner above a visited triangle gets the coordinates there, the same as in all its other triangles on
//! this side. A corner beyond a seam gets the coordinates of the closest visited point, extrapolated by the affine map that
//! best fits the coordinates of the visited triangles (least squares, weighted by area).
//!
//! Cost: for each output triangle, the input triangles below it.
//!
//! Limits: next to a seam shorter than an output edge, or in a chart narrower than one, coordinates are distorted. A
//! triangle at a seam counts as distorted if all its corners are beyond the seam, or if one of its sides in the texture
//! differs from that under the affine map by more than half of the longest.

use crate::base::parallel;
use crate::geom::triangle::{area, barycentric, closest_point, longest_side};
use crate::mesh::attributes::Wedges;
use crate::mesh::provenance::{Origins, PointOnTriangle};
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::weld::weld;
use glam::{DMat2, DVec2, DVec3};
use std::collections::HashSet;

/// Maximum deviation of the sides in the texture from those of the affine map, in longest sides there.
const DISTORTED: f64 = 0.5;

/// Distance beyond seams, in longest sides: a triangle with all corners farther beyond counts as distorted.
const BEYOND: f64 = 0.1;

/// Mesh with texture coordinates.
pub(super) struct Atlas<'a> {
    mesh: &'a Mesh,
    texture: &'a [[DVec2; 3]],
    /// Twin of each side; [`NONE`] at seams and at the boundary.
    twin: Vec<u32>,
}

/// Triangles around a place that can be reached without crossing a seam.
struct Patch {
    triangles: Vec<u32>,
    /// Whether any of their sides is a seam or on the boundary.
    at_seam: bool,
}

impl<'a> Atlas<'a> {
    pub fn new(mesh: &'a Mesh, texture: &'a [[DVec2; 3]]) -> Atlas<'a> {
        let wedges = Wedges::new(&weld(mesh).triangles, texture);
        Atlas { mesh, texture, twin: twins(&wedges.corners) }
    }

    /// Transfers the coordinates to all corners of `output`, which has these `origins` on this mesh; NaN where this mesh has
    /// none. Also returns the number of distorted triangles.
    pub fn carry(&self, output: &Mesh, origins: &Origins) -> (Vec<[DVec2; 3]>, usize) {
        let of_triangle = |t: usize| {
            let feet = output.triangles[t].map(|v| origins.vertices[v as usize]);
            self.triangle(output.corners(t), feet, origins.triangles[t])
        };
        let all: Vec<([DVec2; 3], bool)> = parallel::map(0..output.triangles.len(), of_triangle);
        let distorted = all.iter().filter(|(_, distorted)| *distorted).count();
        (all.into_iter().map(|(coordinates, _)| coordinates).collect(), distorted)
    }

    fn position(&self, PointOnTriangle { triangle, weights }: PointOnTriangle) -> DVec3 {
        let [a, b, c] = self.mesh.corners(triangle as usize);
        a * weights[0] + b * weights[1] + c * weights[2]
    }

    /// Returns the coordinates at three corners, given their feet and that of their centre on the mesh, and whether they are
    /// distorted.
    fn triangle(&self, corners: [DVec3; 3], feet: [PointOnTriangle; 3], centre: PointOnTriangle) -> ([DVec2; 3], bool) {
        if !self.texture[centre.triangle as usize].iter().all(|at| at.is_finite()) {
            return ([DVec2::NAN; 3], false);
        }
        let middle = self.position(centre);
        let reach = |k: usize| middle.distance(corners[k]).max(middle.distance(self.position(feet[k])));
        let patch = self.patch(centre, reach(0).max(reach(1)).max(reach(2)), feet.map(|foot| foot.triangle));
        let met = feet.map(|foot| patch.triangles.contains(&foot.triangle));
        if met == [true; 3] && !patch.at_seam {
            return (feet.map(|foot| self.at(foot)), false);
        }
        let frame = Frame::of(corners);
        let map = self.affine_map(&patch, &frame);
        let at = |k: usize| {
            if met[k] { (self.at(feet[k]), 0.0) } else { self.beyond(corners[k], &patch, &frame, map) }
        };
        let found = [0, 1, 2].map(at);
        let coordinates = found.map(|(at, _)| at);
        let is_beyond = found.iter().all(|(_, distance)| *distance > BEYOND * longest_side(corners));
        (coordinates, is_beyond || is_distorted(coordinates, corners.map(|p| map * frame.flat(p))))
    }

    /// Returns the triangles that a walk from that of `centre` visits within `radius`; ends early once it has visited all
    /// `wanted` ones.
    fn patch(&self, centre: PointOnTriangle, radius: f64, wanted: [u32; 3]) -> Patch {
        let middle = self.position(centre);
        let mut patch = Patch { triangles: vec![centre.triangle], at_seam: false };
        let mut met = HashSet::from([centre.triangle]);
        let mut next = 0;
        while next < patch.triangles.len() && !wanted.iter().all(|t| met.contains(t)) {
            let t = patch.triangles[next];
            next += 1;
            for side in 3 * t..3 * t + 3 {
                let other = self.twin[side as usize];
                if other == NONE {
                    patch.at_seam = true;
                } else if self.is_within(other / 3, middle, radius) && met.insert(other / 3) {
                    patch.triangles.push(other / 3);
                }
            }
        }
        patch
    }

    fn is_within(&self, t: u32, centre: DVec3, radius: f64) -> bool {
        centre.distance_squared(closest_point(centre, self.mesh.corners(t as usize))) <= radius * radius
    }

    /// Returns the coordinates at a point.
    fn at(&self, PointOnTriangle { triangle, weights }: PointOnTriangle) -> DVec2 {
        let [a, b, c] = self.texture[triangle as usize];
        a * weights[0] + b * weights[1] + c * weights[2]
    }

    /// Returns the coordinates at `p`, which lies beyond a seam of the patch, and its distance from the patch.
    fn beyond(&self, p: DVec3, patch: &Patch, frame: &Frame, map: DMat2) -> (DVec2, f64) {
        let foot = |&t: &u32| {
            let point = closest_point(p, self.mesh.corners(t as usize));
            (p.distance(point), t, point)
        };
        let (distance, t, point) =
            patch.triangles.iter().map(foot).min_by(|a, b| a.0.total_cmp(&b.0)).expect("a patch is not empty");
        let weights = barycentric(point, self.mesh.corners(t as usize));
        let at = self.at(PointOnTriangle { triangle: t, weights });
        (at + map * (frame.flat(p) - frame.flat(point)), distance)
    }

    /// Returns the linear part of the affine map from the frame to the texture that best fits the patch; zero if the patch
    /// is too thin to determine it.
    fn affine_map(&self, patch: &Patch, frame: &Frame) -> DMat2 {
        let corners = |t: u32| {
            let places = self.mesh.corners(t as usize);
            let weight = area(places);
            (0..3).map(move |k| (weight, frame.flat(places[k]), self.texture[t as usize][k]))
        };
        let all = || patch.triangles.iter().flat_map(|&t| corners(t));
        let total: f64 = all().map(|(weight, ..)| weight).sum();
        let (mut x_mean, mut u_mean) = (DVec2::ZERO, DVec2::ZERO);
        for (weight, x, u) in all() {
            x_mean += weight / total * x;
            u_mean += weight / total * u;
        }
        let (mut xx, mut ux) = (DMat2::ZERO, DMat2::ZERO);
        for (weight, x, u) in all() {
            let (x, u) = (x - x_mean, u - u_mean);
            xx += weight * DMat2::from_cols(x * x.x, x * x.y);
            ux += weight * DMat2::from_cols(u * x.x, u * x.y);
        }
        let map = ux * xx.inverse();
        if map.is_finite() { map } else { DMat2::ZERO }
    }
}

/// Returns whether the sides of a triangle in the texture are far from those `expected`.
fn is_distorted(found: [DVec2; 3], expected: [DVec2; 3]) -> bool {
    let side = |p: [DVec2; 3], k: usize| p[(k + 1) % 3] - p[k];
    let longest = (0..3).map(|k| side(expected, k).length()).fold(0.0, f64::max);
    (0..3).any(|k| side(found, k).distance(side(expected, k)) > DISTORTED * longest)
}

/// Coordinate frame in the plane of a triangle.
struct Frame {
    origin: DVec3,
    axes: [DVec3; 2],
}

impl Frame {
    fn of([a, b, c]: [DVec3; 3]) -> Frame {
        let (x, y) = (b - a).cross(c - a).normalize_or(DVec3::Z).any_orthonormal_pair();
        Frame { origin: a, axes: [x, y] }
    }

    fn flat(&self, p: DVec3) -> DVec2 {
        DVec2::new((p - self.origin).dot(self.axes[0]), (p - self.origin).dot(self.axes[1]))
    }
}
