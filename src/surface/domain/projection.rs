//! Projection onto a domain: the closest points within a patch, on a curve and anywhere, by walks and by searches.

use super::{Domain, Sample};
use crate::geom::aabb::Aabb;
use crate::geom::triangle::{barycentric, closest_point};
use crate::mesh::half_edge::prev;
use crate::mesh::topology::NONE;
use crate::spatial::bvh::Hit;
use crate::spatial::foot::Foot;
use glam::DVec3;

/// Maximum number of triangles on a walk, beyond which a search from the root is cheaper.
const LONGEST_WALK: usize = 64;

/// Largest distance of a walk's end from its target, relative to the step: a smoothly curved surface is closer, the end of a
/// walk that got stuck at a fold is not.
const WALKED_OF_STEP: f64 = 0.6;

/// Minimum cosine between the direction into the interior and the normal of a face that ends the path: 60 degrees. Next to a
/// sharp edge, that direction runs along a face.
const OPPOSITE: f64 = 0.5;

impl Domain {
    /// Returns the point closest to `p` among those where the surface faces the same way as `normal`, which excludes the
    /// other side of a thin wall. `near` is a triangle of the intended patch known to be close.
    pub fn project(&self, p: DVec3, normal: DVec3, near: u32) -> Sample {
        let patch = self.patch_of(near);
        let here = closest_point(p, self.mesh.corners(near as usize));
        let bound = p.distance_squared(here);
        let faces = |t: u32| self.mesh.area_vector(t as usize).dot(normal) > 0.0;
        let hit =
            self.patches.closest((&self.mesh, &self.bvh), (patch, |t| self.patch_of(t) == patch), p, bound, faces);
        let (t, point) = hit.map_or((near, here), |h| (h.triangle, h.point));
        self.sample(t, barycentric(point, self.mesh.corners(t as usize)))
    }

    /// Moves `from` by `way`, which is tangential or nearly so, and returns the point of the surface closest to the end,
    /// found by walking from triangle to triangle.
    ///
    /// Where the end of the walk is unreliable, as in a fold narrower than the step, [`Self::project`] searches instead.
    pub fn follow(&self, from: &Sample, way: DVec3) -> Sample {
        self.project_by_walk(&Sample { position: from.position + way, ..*from }, WALKED_OF_STEP * way.length())
    }

    /// Returns the point of the surface closest to `off`, which lies off the surface: found by walking from its triangle, or
    /// by [`Self::project`] if the walk ends farther away than `reach`.
    pub fn project_by_walk(&self, off: &Sample, reach: f64) -> Sample {
        let agrees = |foot: &Foot| {
            foot.distance_squared <= reach * reach
                && self.mesh.area_vector(foot.triangle as usize).dot(off.normal) > 0.0
        };
        match self.walk(off.position, off.triangle).filter(agrees) {
            Some(foot) => self.sample(foot.triangle, foot.weights),
            None => self.project(off.position, off.normal, off.triangle),
        }
    }

    /// Walks from triangle `t` to adjacent ones that are closer to `p`, until none is. `None` if the walk is too long, or
    /// leads to a sliver or a corner of the boundary.
    fn walk(&self, p: DVec3, t: u32) -> Option<Foot> {
        let mut at = Foot::on_triangle(&self.mesh, p, t)?;
        for _ in 0..LONGEST_WALK {
            let nearer = self.nearer(p, at)?;
            if nearer.triangle == at.triangle {
                return Some(at);
            }
            at = nearer;
        }
        None
    }

    /// Returns a foot closer to `p` on a triangle that shares the side or the corner that `at` is on; `at` if there is none.
    fn nearer(&self, p: DVec3, at: Foot) -> Option<Foot> {
        let first = 3 * at.triangle;
        let corner = match at.weights.map(|w| w > 0.0) {
            [true, true, true] => return Some(at),
            [true, true, false] => return self.nearer_across(p, at, first),
            [false, true, true] => return self.nearer_across(p, at, first + 1),
            [true, false, true] => return self.nearer_across(p, at, first + 2),
            [true, ..] => first,
            [_, true, _] => first + 1,
            _ => first + 2,
        };
        let mut side = self.twin[prev(corner) as usize];
        while side != corner {
            if side == NONE {
                return None;
            }
            let other = Foot::on_triangle(&self.mesh, p, side / 3)?;
            if other.distance_squared < at.distance_squared {
                return Some(other);
            }
            side = self.twin[prev(side) as usize];
        }
        Some(at)
    }

    /// Returns the foot of `p` on the triangle across `side` if it is closer than `at`; otherwise `at`.
    fn nearer_across(&self, p: DVec3, at: Foot, side: u32) -> Option<Foot> {
        match self.twin[side as usize] {
            NONE => Some(at),
            twin => Foot::on_triangle(&self.mesh, p, twin / 3)
                .map(|other| if other.distance_squared < at.distance_squared { other } else { at }),
        }
    }

    /// Returns the point of curve `curve` closest to `p`. Its normal is zero on a sharp edge.
    pub fn project_on_curve(&self, p: DVec3, curve: u32) -> Sample {
        match self.curves.closest(p, curve) {
            Some((side, along)) => {
                let sharp = self.across.get(side) != NONE;
                let sample = self.sample_on_side(side, along);
                if sharp { Sample { normal: DVec3::ZERO, ..sample } } else { sample }
            }
            None => Sample { position: p, normal: DVec3::ZERO, triangle: 0, size: 1.0 },
        }
    }

    /// Returns the sharp edge closest to `p`, as the number of its curve, if there is any.
    pub fn nearest_sharp_curve(&self, p: DVec3) -> Option<u32> {
        self.curves.nearest(p, |side| self.across.get(side) != NONE)
    }

    fn at_hit(&self, hit: Hit) -> Sample {
        self.sample(hit.triangle, barycentric(hit.point, self.mesh.corners(hit.triangle as usize)))
    }

    /// Returns the point closest to `p` on the whole surface.
    pub fn project_anywhere(&self, p: DVec3) -> Sample {
        match self.bvh.closest(&self.mesh, p) {
            Some(hit) => self.at_hit(hit),
            None => Sample { position: p, normal: DVec3::ZERO, triangle: 0, size: 1.0 },
        }
    }

    /// Returns the point closest to `p` among those where the surface faces the same way as `normal`; if there is none, the
    /// closest of all.
    pub fn project_facing(&self, p: DVec3, normal: DVec3) -> Sample {
        let faces = |t: u32| self.mesh.area_vector(t as usize).dot(normal) > 0.0;
        let hit = self.bvh.closest_where(&self.mesh, p, f64::INFINITY, faces);
        hit.map_or_else(|| self.project_anywhere(p), |hit| self.at_hit(hit))
    }

    /// Returns the point closest to `p` on the whole surface if it is farther than `distance`; otherwise the search ends
    /// early.
    pub fn foot_farther_than(&self, p: DVec3, distance: f64) -> Option<Sample> {
        let square = distance * distance;
        let hit = self.bvh.closest_or_near(&self.mesh, p, square, f64::INFINITY, |_| true)?;
        (hit.distance_squared > square).then(|| self.at_hit(hit))
    }

    /// Returns the distance through the interior from `p` on the surface, against the `normal` there, to a face on the other
    /// side; `None` if there is none within `farthest`.
    pub fn thickness_at(&self, p: DVec3, normal: DVec3, farthest: f64) -> Option<f64> {
        let faces_away = |t: u32| {
            let own = self.mesh.area_vector(t as usize);
            own.dot(-normal) > OPPOSITE * own.length()
        };
        self.bvh.along_ray(&self.mesh, p, -normal, farthest, faces_away)
    }

    /// Returns the triangles whose bounding boxes overlap the cube around `p` with half width `reach`, sorted.
    pub fn triangles_near(&self, p: DVec3, reach: f64) -> Vec<u32> {
        let mut near = Vec::new();
        self.bvh.in_box(&self.mesh, &Aabb { lo: p - reach, hi: p + reach }, |t| near.push(t));
        near.sort_unstable();
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::testing;
    use glam::{DVec2, dvec3};

    /// A sheet of `n` by `n` squares over the unit square, with height `f`.
    fn sheet(n: u32, f: impl Fn(f64, f64) -> f64) -> Domain {
        Domain::new(testing::sheet(n, f).try_into().unwrap())
    }

    #[test]
    fn following_a_step_on_a_smooth_surface_ends_as_near_as_a_search() {
        let domain = sheet(40, |x, y| 0.05 * (7.0 * x).sin() * (6.0 * y).cos());
        let mut rng = stream(1, Stage::Candidates);
        for _ in 0..2000 {
            let t = (unit(&mut rng) * domain.mesh.triangles.len() as f64) as u32;
            let from = domain.sample(t, [0.2, 0.5, 0.3]);
            let way = 0.3 * dvec3(unit(&mut rng) - 0.5, unit(&mut rng) - 0.5, 0.0).reject_from_normalized(from.normal);
            let end = from.position + way;
            if end.truncate().clamp(DVec2::splat(0.05), DVec2::splat(0.95)) != end.truncate() {
                continue;
            }
            let (walked, searched) = (domain.follow(&from, way), domain.project(end, from.normal, t));
            // Over a valley, each facet may have a foot. Edges are 0.025 long.
            let (walked, searched) = (end.distance(walked.position), end.distance(searched.position));
            assert!(walked <= searched + 1e-4, "{walked} {searched}");
        }
    }

    #[test]
    fn a_walk_that_a_fold_stops_is_not_believed() {
        // A narrow ditch: the walk would stay on its near side.
        let domain = sheet(60, |x, _| if (0.48..0.52).contains(&x) { -0.5 } else { 0.0 });
        let from = domain.project(dvec3(0.4, 0.5, 0.0), DVec3::Z, 0);
        let there = domain.follow(&from, dvec3(0.2, 0.0, 0.0));
        assert!(there.position.distance(dvec3(0.6, 0.5, 0.0)) < 1e-9, "{there:?}");
    }
}
