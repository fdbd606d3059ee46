//! Removes slivers caused by feature curves: needles, with a short side, and caps, with a corner near the opposite side.
//!
//! Vertices on curves cannot leave them, so where curves are closer together than the target edge length, the triangles
//! between them are bad wherever the other vertices are. The ends of a needle's short side are merged, and the curve along
//! the long side of a cap bends to the opposite corner. Either moves a curve by less than a share of the target edge length.
//! Where two curves meet as a result, there is a corner afterwards.
//!
//! Cost: linear in the triangles per pass, plus a look at those around each sliver.

use crate::base::math;
use crate::geom::triangle::{area, smallest_angle};
use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::mesh::half_edge::OnCurve;
use glam::DVec3;

/// Angle in degrees below which a triangle is a sliver.
const SMALLEST: f64 = 20.0;

/// Maximum distance by which a vertex may merge or a curve bend, in target edge lengths.
const FARTHEST: f64 = 0.3;

/// The same across the rim of a wall: its two sides would meet in an edge, but only in places if parts of the wall are
/// thicker.
const FARTHEST_OF_WALL: f64 = 0.1;

/// Cosine of the angle between the sides of a wall: 120 degrees.
const OPPOSITE: f64 = -0.5;

/// Minimum total growth, in degrees, of the angles below [`SMALLEST`]. Where a curve bends, the squares of the deficits
/// count, so that two small angles are better than one of zero and a good one.
const LEAST_GAIN: f64 = 1.0;

/// Maximum number of passes: a sliver may be freed by removing another one.
const MOST_PASSES: usize = 4;

/// Removes slivers where that leaves better triangles. `spacing` is the target edge length.
pub fn remove_slivers(mesh: &mut Manifold, spacing: f64) {
    for _ in 0..MOST_PASSES {
        let angles = mesh.triangles().map(|t| (smallest_angle(mesh.corners(t)), t));
        let mut slivers: Vec<(f64, u32)> = angles.filter(|sliver| sliver.0 < SMALLEST).collect();
        slivers.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let is_there = |mesh: &Manifold, t: u32| mesh.connectivity.has_half_edge(3 * t);
        let mut removed = 0;
        for (_, t) in slivers {
            removed += usize::from(is_there(mesh, t) && (merge_ends(mesh, t, spacing) || bend_curve(mesh, t, spacing)));
        }
        if removed == 0 {
            break;
        }
    }
}

/// Returns by how many degrees the smallest angle of a triangle falls short of [`SMALLEST`].
fn deficit(mesh: &Manifold, corners: [u32; 3]) -> f64 {
    (SMALLEST - smallest_angle(corners.map(|v| mesh.position(v)))).max(0.0)
}

/// Merges the ends of the shortest side of triangle `t` if that is better; returns whether it was.
fn merge_ends(mesh: &mut Manifold, t: u32, spacing: f64) -> bool {
    let length = |h: u32| mesh.relative_length_squared(h);
    let h = (3 * t..3 * t + 3).min_by(|&g, &h| length(g).total_cmp(&length(h))).expect("a triangle has sides");
    if length(h) > FARTHEST * FARTHEST * spacing * spacing {
        return false;
    }
    let is_long = length(h) > FARTHEST_OF_WALL * FARTHEST_OF_WALL * spacing * spacing;
    if is_long && is_across_wall(mesh, h) {
        return false;
    }
    let ways = mesh.connectivity.both_sides(h).filter_map(|h| Some((gain_of_merging(mesh, h)?, h)));
    let best = ways.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    let Some((_, h)) = best.filter(|way| way.0 >= LEAST_GAIN) else { return false };
    mesh.merge(h);
    true
}

/// Returns whether the edge of `h` leads across the rim of a wall, from one curve to the other: the faces around one end are
/// turned against those around the other.
fn is_across_wall(mesh: &Manifold, h: u32) -> bool {
    let c = &mesh.connectivity;
    let [a, b] = [c.origin(h), c.target(h)];
    c.is_on_curve(a)
        && c.is_on_curve(b)
        && !c.is_curve_edge(h)
        && normal_without(mesh, a, &[b]).dot(normal_without(mesh, b, &[a])) < OPPOSITE
}

/// Returns the normal of the faces around `v` that have none of the vertices `others`.
fn normal_without(mesh: &Manifold, v: u32, others: &[u32]) -> DVec3 {
    let c = &mesh.connectivity;
    let own = c.outgoing(v).map(|out| c.triangle(out)).filter(|corners| !corners.iter().any(|v| others.contains(v)));
    let areas = own.map(|corners| {
        let [p, q, r] = corners.map(|v| mesh.position(v));
        (q - p).cross(r - p)
    });
    areas.sum::<DVec3>().normalize_or_zero()
}

/// Returns by how many degrees the small angles around grow if the origin of `h` merges into its target; `None` if it must
/// not.
fn gain_of_merging(mesh: &Manifold, h: u32) -> Option<f64> {
    let c = &mesh.connectivity;
    let rank = |v: u32| match c.curve_at(v) {
        OnCurve::No => 0,
        OnCurve::Curve(_) => 1,
        OnCurve::Corner | OnCurve::Interface => 2,
    };
    let origin = c.origin(h);
    if rank(origin) > rank(c.target(h)) || !c.can_merge(h) {
        return None;
    }
    let around = || c.outgoing(origin).map(|out| c.triangle(out));
    let facing = || around().map(|corners| mesh.agreement(corners)).fold(1.0, f64::min);
    if !FacingGuard::SOUND.allows(mesh.after_collapse(h).0, facing) {
        return None;
    }
    let before: f64 = around().map(|corners| deficit(mesh, corners)).sum();
    let after: f64 = mesh.left_by_collapse(h).map(|corners| deficit(mesh, corners)).sum();
    Some(before - after)
}

/// Bends the curve along the longest side of triangle `t` to the opposite corner if that is better; returns whether it was.
fn bend_curve(mesh: &mut Manifold, t: u32, spacing: f64) -> bool {
    let c = &mesh.connectivity;
    let length = |h: u32| mesh.length_squared(h);
    let h = (3 * t..3 * t + 3).max_by(|&g, &h| length(g).total_cmp(&length(h))).expect("a triangle has sides");
    let [a, b, top] = c.triangle(h);
    let farthest = FARTHEST * spacing * mesh.sample(top).size;
    let twice_area = 2.0 * area(mesh.corners(t));
    if !c.is_on_curve(top) || twice_area > farthest * length(h).sqrt() || !c.can_bend(h) {
        return false;
    }
    let bottom = c.apex(c.twin(h));
    let [p, q, r] = [b, a, bottom].map(|v| mesh.position(v));
    let beyond = (q - p).cross(r - p).normalize_or_zero();
    let is_tall = twice_area > FARTHEST_OF_WALL / FARTHEST * farthest * length(h).sqrt();
    if is_tall && normal_without(mesh, top, &[a, b]).dot(beyond) < OPPOSITE {
        return false;
    }
    let sum = |pair: [[u32; 3]; 2]| pair.map(|corners| math::square(deficit(mesh, corners))).iter().sum::<f64>();
    let gain = sum([[a, b, top], [b, a, bottom]]) - sum([[top, a, bottom], [bottom, b, top]]);
    if gain < SMALLEST * LEAST_GAIN || !mesh.flip_keeps_facing(h, FacingGuard::SOUND) {
        return false;
    }
    mesh.connectivity.bend(h);
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::surface::domain::Sample;
    use crate::testing::grid;
    use glam::dvec3;

    fn flat(positions: &[DVec3], triangles: &[[u32; 3]]) -> Manifold {
        let sample = |&position| Sample { position, normal: DVec3::Z, triangle: 0, size: 1.0 };
        Manifold::new(positions.iter().map(sample).collect(), triangles)
    }

    fn smallest(mesh: &Manifold) -> f64 {
        mesh.triangles().map(|t| smallest_angle(mesh.corners(t))).fold(180.0, f64::min)
    }

    /// A square of unit cells with two curves along its middle, at the distance `apart`.
    fn with_curves(apart: f64) -> Manifold {
        let row = |v: f64| (8.0 * v).round();
        let y = |v: f64| if row(v) < 5.0 { row(v) } else { row(v) - 1.0 + apart };
        let made = grid(8, 8, |u, v| dvec3(8.0 * u, y(v), 0.0));
        let mut mesh = flat(&made.positions, &made.triangles);
        let on = |mesh: &Manifold, v: u32, y: f64| (mesh.position(v).y - y).abs() < 1e-9;
        for (curve, y) in [(0, 4.0), (1, 4.0 + apart)] {
            let along =
                |&h: &u32| on(&mesh, mesh.connectivity.origin(h), y) && on(&mesh, mesh.connectivity.target(h), y);
            let ends = |h: u32| [mesh.connectivity.origin(h), mesh.connectivity.target(h)];
            let edges: Vec<_> = mesh.edges().filter(along).map(|h| (ends(h), OnCurve::Curve(curve))).collect();
            mesh.mark_curves(&edges, []);
        }
        mesh.lock_boundary();
        mesh
    }

    #[test]
    fn curves_that_are_too_near_meet() {
        let mut mesh = with_curves(0.15);
        assert!(smallest(&mesh) < 9.0);
        remove_slivers(&mut mesh, 1.0);
        assert!(smallest(&mesh) >= SMALLEST, "{}", smallest(&mesh));
        let left = mesh.to_mesh();
        let t = topology(left.positions.len(), &left.triangles);
        assert!(t.is_manifold() && (t.euler, t.boundary_loops) == (1, 1));
        let on_curves: f64 =
            mesh.edges().filter(|&h| mesh.connectivity.is_curve_edge(h)).map(|h| mesh.length_squared(h).sqrt()).sum();
        assert!((8.0..16.0).contains(&on_curves), "{on_curves}");
    }

    #[test]
    fn curves_that_run_together_become_one() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.5, 1e-9], [0.5, -0.9]].map(|[x, y]| dvec3(x, y, 0.0));
        let mut mesh = flat(&corners, &[[0, 1, 2], [1, 0, 3]]);
        mesh.mark_curves(
            &[([0, 1], OnCurve::Curve(0)), ([0, 2], OnCurve::Curve(1)), ([2, 1], OnCurve::Curve(1))],
            [0, 1],
        );
        remove_slivers(&mut mesh, 1.0);
        assert!(smallest(&mesh) > SMALLEST && mesh.triangles().count() == 2);
        let on_curves = |v: u32| mesh.connectivity.outgoing(v).filter(|&h| mesh.connectivity.is_curve_edge(h)).count();
        assert!(mesh.connectivity.is_corner(2) && on_curves(3) == 0);
    }

    #[test]
    fn curves_that_are_far_enough_stay() {
        let mut mesh = with_curves(0.5);
        remove_slivers(&mut mesh, 1.0);
        assert_eq!(mesh.connectivity.vertex_count(), 81);
        assert_eq!(mesh.edges().filter(|&h| mesh.connectivity.is_curve_edge(h)).count(), 16);
    }

    #[test]
    fn a_curve_bends_to_the_corner_of_a_cap() {
        let [a, b, top, bottom, above] = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.1], [1.0, -1.5], [1.0, 2.0]];
        let positions = [a, b, top, bottom, above].map(|[x, y]| dvec3(x, y, 0.0));
        let mut mesh = flat(&positions, &[[0, 1, 2], [1, 0, 3], [0, 2, 4], [2, 1, 4]]);
        mesh.mark_curves(&[([0, 1], OnCurve::Curve(7)), ([2, 4], OnCurve::Curve(8))], []);
        mesh.lock_boundary();
        mesh.connectivity.put_on_curve(2, OnCurve::Curve(8));
        remove_slivers(&mut mesh, 1.0);
        let c = &mesh.connectivity;
        assert!(smallest(&mesh) > SMALLEST && !c.are_adjacent(0, 1) && c.is_corner(2));
        let curve_to = |v: u32| c.curve(c.outgoing(2).find(|&h| c.target(h) == v).unwrap());
        assert_eq!([0, 1, 4, 3].map(curve_to), [OnCurve::Curve(7), OnCurve::Curve(7), OnCurve::Curve(8), OnCurve::No]);
    }
}
