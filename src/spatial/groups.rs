//! Groups of a mesh's triangles, such as its smooth patches, and the closest point on one group.
//!
//! In a cluster of thousands of pieces, very many triangles of other groups may be nearer, and a search in the hierarchy of
//! all triangles would visit them. So each group is stored as short runs with a bounding box each, up to a size above which
//! the hierarchy is faster.
//!
//! Cost: four bytes per triangle, and six for a box. A search tests one box per run, and some ten triangles.

use crate::base::csr::Csr;
use crate::geom::aabb::Aabb;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::{Bvh, Hit};
use glam::DVec3;

/// Number of triangles up to which all triangles of a group are tested; number of triangles in a run; number of triangles
/// above which a group is searched in the hierarchy of all triangles.
const FEW: usize = 32;
const RUN: usize = 8;
const MANY: usize = 256;

/// The triangles of each group.
#[derive(Default)]
pub struct Groups {
    triangles: Csr<u32>,
    /// The boxes of the runs of each group that is searched by runs.
    boxes: Csr<Aabb>,
}

impl Groups {
    /// Builds `count` groups; each triangle of `mesh`, with the hierarchy `bvh`, belongs to one.
    pub fn new((mesh, bvh): (&Mesh, &Bvh), count: usize, group_of: impl Fn(u32) -> u32) -> Groups {
        // In the order of the hierarchy, the triangles of a run are near each other.
        let triangles = Csr::new(count, || bvh.order().iter().map(|&t| (group_of(t), t)));
        let bounds = |run: &[u32]| {
            run.iter().flat_map(|&t| mesh.corners(t as usize)).fold(Aabb::EMPTY, |all, p| all.join(&Aabb::at(p)))
        };
        let of_group = |group: u32| triangles.row(group).chunks(RUN).map(move |run| (group, bounds(run)));
        let has_boxes = |group: &u32| (FEW + 1..=MANY).contains(&triangles.row(*group).len());
        let all: Vec<(u32, Aabb)> = (0..triangles.rows() as u32).filter(has_boxes).flat_map(of_group).collect();
        let boxes = Csr::new(triangles.rows(), || all.iter().copied());
        Groups { triangles, boxes }
    }

    /// The number of groups.
    pub fn count(&self) -> usize {
        self.triangles.rows()
    }

    /// Returns the closest point to `p` on the triangles of `group` for which `accept` holds, like [`Bvh::closest_where`] in
    /// the hierarchy `bvh` of all triangles of `mesh`. `is_own` holds for the triangles of the group.
    pub fn closest(
        &self,
        (mesh, bvh): (&Mesh, &Bvh),
        (group, is_own): (u32, impl Fn(u32) -> bool),
        p: DVec3,
        max_distance_squared: f64,
        accept: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let own = self.triangles.row(group);
        if own.len() > MANY {
            return bvh.closest_where(mesh, p, max_distance_squared, |t| is_own(t) && accept(t));
        }
        let mut best = Hit::none(p, max_distance_squared);
        let look_at = |run: &[u32], best: &mut Hit| {
            run.iter().filter(|&&t| accept(t)).for_each(|&t| best.or_nearer(mesh, t, p));
        };
        if own.len() <= FEW {
            look_at(own, &mut best);
            return best.found();
        }
        let boxes = self.boxes.row(group);
        let distance = |k: usize| boxes[k].distance_squared(p);
        let run = |k: usize| &own[RUN * k..own.len().min(RUN * (k + 1))];
        // After the nearest run, most other runs are too far away.
        let nearest = (1..boxes.len()).fold(0, |nearest, k| if distance(k) < distance(nearest) { k } else { nearest });
        look_at(run(nearest), &mut best);
        for k in (0..boxes.len()).filter(|&k| k != nearest) {
            if distance(k) <= best.distance_squared {
                look_at(run(k), &mut best);
            }
        }
        best.found()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::testing::sphere;
    use glam::dvec3;

    #[test]
    fn the_closest_of_a_group_is_that_of_all_which_are_accepted() {
        let mesh = sphere();
        let bvh = Bvh::new(&mesh);
        let mut rng = stream(5, Stage::Scan);
        for count in [1, 2, 7, mesh.triangles.len() as u32 / 3] {
            let group_of = |t: u32| t % count;
            let groups = Groups::new((&mesh, &bvh), count as usize, group_of);
            assert_eq!(groups.count(), count as usize);
            for q in 0..100 {
                let p = 1.5 * dvec3(unit(&mut rng), unit(&mut rng), unit(&mut rng));
                let group = q % count;
                for most in [0.05, f64::INFINITY] {
                    let (is_own, accept) = (|t: u32| group_of(t) == group, |t: u32| !t.is_multiple_of(5));
                    let found = groups.closest((&mesh, &bvh), (group, is_own), p, most, accept);
                    assert_eq!(found, bvh.closest_where(&mesh, p, most, |t| is_own(t) && accept(t)));
                }
            }
        }
    }
}
