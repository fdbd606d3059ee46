//! Projection on a domain: the closest points within a patch, on a curve and anywhere, by walks and by searches.

use super::{Domain, Sample};
use crate::geom::aabb::Aabb;
use crate::geom::triangle::{barycentric, closest_point};
use crate::mesh::half_edge::prev;
use crate::mesh::topology::NONE;
use crate::spatial::bvh::Hit;
use crate::spatial::foot::Foot;
use glam::DVec3;

/// Triangles that a step may lead over before searching from the root is cheaper.
const LONGEST_WALK: usize = 64;

/// How far from where it wants to be, in lengths of the step, a walk may end: surface that bends smoothly lies nearer,
/// a walk that got stuck at a fold does not.
const WALKED_OF_STEP: f64 = 0.6;

/// Least cosine between the way into the inside and the normal of a face that ends it: 60 degrees. Next to a sharp edge
/// that way runs along a face.
const OPPOSITE: f64 = 0.5;

impl Domain {
    /// The point closest to `p` among those where the surface faces the way of `normal`, so that the other side of a
    /// thin place is not taken for this one. `near` is a triangle known to be close by, of the patch that is meant.
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

    /// Where a step of `way` from `from`, tangential or about so, comes down on the surface: the point that is closest
    /// to its end among those around, found by walking from triangle to triangle.
    ///
    /// Where the walk cannot vouch for its end, as in a fold narrower than the step, [`Self::project`] searches instead.
    pub fn follow(&self, from: &Sample, way: DVec3) -> Sample {
        self.settle(&Sample { position: from.position + way, ..*from }, WALKED_OF_STEP * way.length())
    }

    /// The point of the surface closest to that of `off`, which lies off it, among those around: found by walking from
    /// its triangle, or by [`Self::project`] if the walk ends farther away than `reach`.
    pub fn settle(&self, off: &Sample, reach: f64) -> Sample {
        let agrees = |foot: &Foot| {
            foot.distance_squared <= reach * reach
                && self.mesh.area_vector(foot.triangle as usize).dot(off.normal) > 0.0
        };
        match self.walk(off.position, off.triangle).filter(agrees) {
            Some(foot) => self.sample(foot.triangle, foot.weights),
            None => self.project(off.position, off.normal, off.triangle),
        }
    }

    /// From triangle `t` on to triangles that are nearer to `p`, until none of those around is. `None` for a way that is
    /// too long, or leads to a sliver or a corner of the boundary.
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

    /// A foot nearer to `p` on a triangle that shares the side or the corner that `at` is on, or `at` if there is none.
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

    /// The foot of `p` on the triangle across `side` if it is nearer than `at`.
    fn nearer_across(&self, p: DVec3, at: Foot, side: u32) -> Option<Foot> {
        match self.twin[side as usize] {
            NONE => Some(at),
            twin => Foot::on_triangle(&self.mesh, p, twin / 3)
                .map(|other| if other.distance_squared < at.distance_squared { other } else { at }),
        }
    }

    /// The point of curve `curve` closest to `p`. Its normal is zero on a sharp edge.
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

    fn at_hit(&self, hit: Hit) -> Sample {
        self.sample(hit.triangle, barycentric(hit.point, self.mesh.corners(hit.triangle as usize)))
    }

    /// The point closest to `p` on the whole surface.
    pub fn project_anywhere(&self, p: DVec3) -> Sample {
        match self.bvh.closest(&self.mesh, p) {
            Some(hit) => self.at_hit(hit),
            None => Sample { position: p, normal: DVec3::ZERO, triangle: 0, size: 1.0 },
        }
    }

    /// The point closest to `p` among those where the surface faces the way of `normal`; the closest of all if there is
    /// none.
    pub fn project_facing(&self, p: DVec3, normal: DVec3) -> Sample {
        let faces = |t: u32| self.mesh.area_vector(t as usize).dot(normal) > 0.0;
        let hit = self.bvh.closest_where(&self.mesh, p, f64::INFINITY, faces);
        hit.map_or_else(|| self.project_anywhere(p), |hit| self.at_hit(hit))
    }

    /// The point closest to `p` on the whole surface if it is farther away than `distance`; the search ends early if it is not.
    pub fn foot_farther_than(&self, p: DVec3, distance: f64) -> Option<Sample> {
        let square = distance * distance;
        let hit = self.bvh.closest_or_near(&self.mesh, p, square, f64::INFINITY, |_| true)?;
        (hit.distance_squared > square).then(|| self.at_hit(hit))
    }

    /// The way through the inside from `p` on the surface, against the `normal` there, to a face on the other side; `None` if there is
    /// none within `farthest`.
    pub fn thickness_at(&self, p: DVec3, normal: DVec3, farthest: f64) -> Option<f64> {
        let faces_away = |t: u32| {
            let own = self.mesh.area_vector(t as usize);
            own.dot(-normal) > OPPOSITE * own.length()
        };
        self.bvh.along_ray(&self.mesh, p, -normal, farthest, faces_away)
    }

    /// The triangles whose bounding boxes reach into the cube around `p`, whose sides are `reach` away, in increasing order.
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

    /// A sheet of `n` by `n` squares over the unit square at the height that `f` says.
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
            // Over a valley each facet may have a foot; an edge is 0.025 long.
            let (walked, searched) = (end.distance(walked.position), end.distance(searched.position));
            assert!(walked <= searched + 1e-4, "{walked} {searched}");
        }
    }

    #[test]
    fn a_walk_that_a_fold_stops_is_not_believed() {
        // Down into a narrow ditch and up again: the walk would stay on the near side of it.
        let domain = sheet(60, |x, _| if (0.48..0.52).contains(&x) { -0.5 } else { 0.0 });
        let from = domain.project(dvec3(0.4, 0.5, 0.0), DVec3::Z, 0);
        let there = domain.follow(&from, dvec3(0.2, 0.0, 0.0));
        assert!(there.position.distance(dvec3(0.6, 0.5, 0.0)) < 1e-9, "{there:?}");
    }
}
