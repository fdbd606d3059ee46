//! Slides vertices within flat parts of a mesh and along its straight edges, where that leaves its surface unchanged.
//!
//! The search for good angles moves only vertices of the worst triangles, one after the other, which costs quality on
//! average, and so does exchanging vertices. Here, all vertices that are free to move do so together, down the energy of
//! relaxation. The worst triangle is a bound for all: none gets worse than that, or than the modest goal, whichever is
//! higher.
//!
//! Cost: that of relaxation.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::geom::triangle::{quality, smallest_angle};
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::angles::{Goal, corners_around};
use crate::optimize::crossings::longest_edge;
use crate::optimize::relax::relaxing_steps;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

/// Sine of the largest angle between the step of a vertex and the triangles around it.
const FLAT: f64 = 0.01;

/// Maximum distance of a sliding vertex from the surface, in lengths of its longest edge: a mesh of few triangles may be
/// flat where the surface is not.
const FARTHEST: f64 = 0.05;

/// Number of rounds, after which vertices move by less than a hundredth of an edge.
const ROUNDS: usize = 8;

/// Number of times a step that would spoil a triangle is halved before the vertex stays.
const HALVINGS: usize = 4;

/// Slides those vertices of `mesh` that can; returns whether there are any. `spacing` is the target edge length at samples
/// of size 1.
pub fn slide(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<bool> {
    let least = Least::of(mesh.triangles().map(|t| mesh.corners(t)));
    let least = Least {
        angle: least.angle.clamp(Goal::MODEST.smallest_angle, Goal::GOOD.smallest_angle),
        quality: least.quality.clamp(Goal::MODEST.quality, Goal::GOOD.quality),
    };
    let mut any = false;
    for _ in 0..ROUNDS {
        check(monitor)?;
        let free: Vec<Free> = parallel::map(0..mesh.connectivity.vertex_bound(), |v| free(mesh, v, locked));
        let locked = &VertexSet::new(mesh, |v| free[v as usize] == Free::Not);
        let classes = mesh.colour_classes(locked);
        if classes.is_empty() {
            break;
        }
        any = true;
        let steps = relaxing_steps(mesh, locked, spacing);
        for class in classes {
            let way = |v: u32| free[v as usize].part_of(steps[v as usize]);
            mesh.move_all(&class, |mesh, v| slid(domain, mesh, v, way(v), least));
        }
    }
    Ok(any)
}

/// The smallest angle of some triangles, in degrees, and their minimum quality.
#[derive(Clone, Copy)]
struct Least {
    angle: f64,
    quality: f64,
}

impl Least {
    fn of(triangles: impl Iterator<Item = [DVec3; 3]>) -> Least {
        let most = Least { angle: f64::INFINITY, quality: f64::INFINITY };
        triangles
            .map(|corners| Least { angle: smallest_angle(corners), quality: quality(corners) })
            .fold(most, Least::min)
    }

    /// Returns the lesser of each.
    fn min(self, other: Least) -> Least {
        Least { angle: self.angle.min(other.angle), quality: self.quality.min(other.quality) }
    }

    fn is_at_least(self, other: Least) -> bool {
        self.angle >= other.angle && self.quality >= other.quality
    }
}

/// How a vertex can move without taking the triangles around it out of their planes.
#[derive(Clone, Copy, PartialEq)]
enum Free {
    Not,
    /// Along an edge with this unit direction.
    Along(DVec3),
    /// In the plane with this normal.
    Within(DVec3),
}

impl Free {
    /// Returns the part of a step that is allowed.
    fn part_of(self, way: DVec3) -> DVec3 {
        match self {
            Free::Not => DVec3::ZERO,
            Free::Along(direction) => way.project_onto_normalized(direction),
            Free::Within(normal) => way.reject_from_normalized(normal),
        }
    }
}

/// Returns how `v` can slide: in the plane of the triangles around it, or along the line that two such planes share, which
/// is the curve if `v` is on one.
fn free(mesh: &Manifold, v: u32, locked: &VertexSet) -> Free {
    if !mesh.connectivity.has_vertex(v) || !mesh.can_move(v, locked) {
        return Free::Not;
    }
    let area_vectors = || {
        mesh.connectivity.outgoing(v).map(|h| {
            let [p, q, r] = mesh.corners(h / 3);
            (q - p).cross(r - p)
        })
    };
    let normals = || area_vectors().map(DVec3::normalize_or_zero);
    let lies_in_all = |way: DVec3| normals().all(|n| n.dot(way).abs() <= FLAT);
    let along = |way: DVec3| if lies_in_all(way) { Free::Along(way) } else { Free::Not };
    if let Some(curve) = mesh.along(v) {
        return along(curve);
    }
    let normal = area_vectors().sum::<DVec3>().normalize_or_zero();
    let off = |n: DVec3| n.cross(normal).length_squared();
    let farthest = normals().fold(normal, |a, b| if off(b) > off(a) { b } else { a });
    if off(farthest) <= FLAT * FLAT {
        return Free::Within(normal);
    }
    // The mean of the normals of two planes is perpendicular to the line that they share, as both normals are.
    along(normal.cross(farthest).normalize_or_zero())
}

/// Returns where the step `way` takes `v`.
fn slid(domain: &Domain, mesh: &Manifold, v: u32, mut way: DVec3, least: Least) -> Sample {
    let here = *mesh.sample(v);
    if way == DVec3::ZERO || !way.is_finite() {
        return here;
    }
    let least = least.min(Least::of(corners_around(mesh, v, here.position)));
    let farthest = FARTHEST * longest_edge(mesh, v);
    for _ in 0..HALVINGS {
        let at = mesh.place_after(domain, v, way, &here);
        let there = Sample { position: here.position + way, ..at };
        let is_near = at.position.distance(there.position) <= farthest;
        if is_near && mesh.may_move(v, &there) && Least::of(corners_around(mesh, v, there.position)).is_at_least(least)
        {
            return there;
        }
        way *= 0.5;
    }
    here
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::half_edge::OnCurve;
    use crate::testing::sheet;
    use glam::dvec3;

    const SPACING: f64 = 0.1;

    /// A mesh of uneven triangles over a sheet of this height above the unit square, with a locked boundary.
    fn uneven(height: impl Fn(f64, f64) -> f64 + Copy) -> (Domain, Manifold) {
        let domain = Domain::new(sheet(20, height).try_into().unwrap());
        let mut made = sheet(10, height);
        let is_inside = |x: f64| x > 0.01 && x < 0.99;
        for (i, p) in made.positions.iter_mut().enumerate() {
            if is_inside(p.x) && is_inside(p.y) {
                let (sin, cos) = (i as f64 * 2.4).sin_cos();
                // Vertices on the ridge in the middle remain there.
                let x = if (p.x - 0.5).abs() < 0.01 { 0.5 } else { p.x + 0.3 * SPACING * cos };
                let y = p.y + 0.3 * SPACING * sin;
                *p = dvec3(x, y, height(x, y));
            }
        }
        let samples = made.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &made.triangles);
        mesh.lock_boundary();
        (domain, mesh)
    }

    fn slid(domain: &Domain, mesh: &Manifold) -> Manifold {
        let mut slid = mesh.clone();
        assert!(slide(domain, &mut slid, &VertexSet::EMPTY, SPACING, &()).unwrap());
        slid
    }

    fn mean_quality(mesh: &Manifold) -> f64 {
        let qualities: Vec<f64> = mesh.triangles().map(|t| quality(mesh.corners(t))).collect();
        qualities.iter().sum::<f64>() / qualities.len() as f64
    }

    fn least(mesh: &Manifold) -> Least {
        Least::of(mesh.triangles().map(|t| mesh.corners(t)))
    }

    #[test]
    fn a_flat_sheet_gets_better_triangles_and_no_worse_worst_one() {
        let (domain, mesh) = uneven(|_, _| 0.0);
        let after = slid(&domain, &mesh);
        assert!(mean_quality(&after) > mean_quality(&mesh) + 0.05, "{}", mean_quality(&after));
        assert!(least(&after).is_at_least(least(&mesh)));
        assert!(after.samples().iter().all(|s| s.position.z.abs() < 1e-12));
    }

    #[test]
    fn a_roof_stays_as_it_is() {
        let height = |x: f64, _: f64| 0.5 - (x - 0.5).abs();
        let (domain, mut mesh) = uneven(height);
        let before = slid(&domain, &mesh);
        let is_on_ridge = |v: u32| (mesh.position(v).x - 0.5).abs() < 1e-9;
        let on_ridge: Vec<u32> = (0..mesh.connectivity.vertex_bound()).filter(|&v| is_on_ridge(v)).collect();
        let moved =
            on_ridge.iter().filter(|&&v| before.position(v).distance(mesh.position(v)) > 1e-3 * SPACING).count();
        assert!(moved > on_ridge.len() / 2, "{moved}");
        assert!(before.samples().iter().all(|s| (s.position.z - height(s.position.x, 0.0)).abs() < 1e-9));
        let corner = on_ridge[on_ridge.len() / 2];
        mesh.mark_curves(&[], [corner]);
        assert_eq!(mesh.connectivity.curve_at(corner), OnCurve::Corner);
        assert_eq!(slid(&domain, &mesh).position(corner), mesh.position(corner));
    }

    #[test]
    fn nothing_moves_where_that_would_bend_the_surface() {
        let (domain, mesh) = uneven(|x, y| x * x + 2.0 * y * y);
        let mut after = mesh.clone();
        assert!(!slide(&domain, &mut after, &VertexSet::EMPTY, SPACING, &()).unwrap());
        assert_eq!(after.to_mesh().positions, mesh.to_mesh().positions);
    }
}
