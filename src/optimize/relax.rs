//! Relaxation: moves all vertices tangentially, all at once, to where the triangles as a whole are best.
//!
//! The energy of a triangle of area A and sides a, b, c is
//!
//! ```text
//! 2 √(ε (E + ε))  +  κ/2 E²  +  λ/2 (A / A₀ + A₀ / A)        E = (a² + b² + c²) / (4 √3 A) - 1
//! ```
//!
//! E is 0 for an equilateral triangle of any size and grows with the square of its strain. The root makes the energy linear
//! in the strain, as quality and angles are, except for the smallest strains: strain concentrates at the unavoidable
//! irregular vertices, and the rows between them are straight. The square keeps it from concentrating in a few triangles
//! only. The last term is smallest at the area A₀ of an equilateral triangle with the mean edge length. Without it, vertices
//! would drain from the end of every spike of the surface, as in conformal maps.
//!
//! Each round is a Gauss-Newton step for all vertices at once (`newton.rs`): strain evens out over hundreds of edges, which
//! would take as many rounds with steps of single vertices. With the corners z₀, z₁, z₂ of a triangle as complex numbers in
//! its plane and ω a cube root of unity, E = |β|² / (2 √3 A) for β = z₀ + ω z₁ + ω² z₂.
//!
//! Based on: P. M. Knupp, Algebraic mesh quality metrics, 2001, DOI 10.1137/S1064827500371499 (shape and size of a
//! triangle); B. Lévy, S. Petitjean, N. Ray, J. Maillot, Least squares conformal maps, 2002, DOI 10.1145/566654.566590
//! (the square of β). Departures: shape and size are added instead of multiplied, so that their weights can be chosen;
//! the root.
//!
//! Vertices on a feature curve (boundary or sharp edge) move along it.
//!
//! Cost: a few microseconds per vertex and round.

use crate::base::error::Result;
use crate::base::math;
use crate::base::monitor::{Monitor, check};
use crate::manifold::Manifold;
use crate::manifold::motion::{move_vertices, move_vertices_where};
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::angles::Goal;
use crate::optimize::newton::{Strain, newton_step};
use crate::optimize::valence::Defects;
use crate::surface::domain::Domain;
use glam::DVec3;

/// Edge flips after each round of relaxation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flips {
    /// Flips all edges that are not Delaunay.
    Delaunay,
    /// Flips only those edges that are not Delaunay and whose flip does not raise the energy of irregular vertices, so that
    /// vertices find the room that a changed valence needs.
    KeepValence,
}

/// λ, weight of the size term. Less makes triangles better and edge lengths less even. Mean Q and edge CV of the horse with
/// 8,600 vertices: 0.967 and 0.091 with 0.2, 0.969 and 0.095 with 0.1, 0.971 and 0.099 with 0.05.
const SIZE_WEIGHT: f64 = 0.05;

/// κ, weight of the square term. More makes the worst triangles better and the mean worse. Mean Q of 64 CAD parts and of 17
/// other models: 0.921 and 0.9788 with 1, 0.923 and 0.9796 with 0.1, 0.924 and 0.9797 with 0, where single bad triangles are
/// neglected.
const SQUARE_WEIGHT: f64 = 0.1;

/// ε: smaller strains count quadratically, larger ones linearly. More makes lengths less even, less takes longer.
const SMALL_STRAIN: f64 = 0.003;

/// Minimum area of a triangle in the energy, as a share of A₀; keeps steps finite.
const LEAST_AREA: f64 = 0.03;

/// Number of rounds in [`relax_within`].
const ROUNDS_WITHIN: usize = 6;

/// Longest step of a vertex, in spacings. With twice as much, neighbours get in each other's way.
const LONGEST_STEP: f64 = 0.25;

/// Relaxes all vertices of `mesh` that are not `locked` for `rounds` rounds, with flips after each. `spacing` is the target
/// edge length at samples of size 1.
pub fn relax(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    spacing: f64,
    flips: Flips,
    rounds: usize,
    monitor: &dyn Monitor,
) -> Result<()> {
    flip(mesh, flips);
    for _ in 0..rounds {
        check(monitor)?;
        let steps = relaxing_steps(mesh, locked, spacing);
        move_vertices(domain, mesh, locked, |_, v| steps[v as usize]);
        flip(mesh, flips);
    }
    Ok(())
}

/// Relaxes all vertices of `mesh` that are not `locked`, without flips. Triangles stay within the `goal`, or get no further
/// outside.
pub fn relax_within(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    goal: Goal,
    spacing: f64,
    monitor: &dyn Monitor,
) -> Result<()> {
    for _ in 0..ROUNDS_WITHIN {
        check(monitor)?;
        let steps = relaxing_steps(mesh, locked, spacing);
        move_vertices_where(domain, mesh, locked, |_, v| steps[v as usize], |mesh, v, p| goal.is_kept(mesh, v, p));
    }
    Ok(())
}

/// Returns the steps of all vertices towards the minimum of the energy, by vertex number; zero for `locked` vertices.
pub(super) fn relaxing_steps(mesh: &Manifold, locked: &VertexSet, spacing: f64) -> Vec<DVec3> {
    let mut steps = newton_step(mesh, locked, spacing, |t| strain_of(mesh, t, spacing));
    for (step, sample) in steps.iter_mut().zip(mesh.samples()) {
        *step = step.clamp_length_max(LONGEST_STEP * spacing * sample.size);
    }
    steps
}

fn flip(mesh: &mut Manifold, flips: Flips) {
    match flips {
        Flips::Delaunay => mesh.make_delaunay(),
        Flips::KeepValence => Defects::new(mesh).flip_level(mesh),
    }
}

/// Returns the gradient, with respect to `v`, of the energy of the triangles around it, and the mean second derivative along
/// the surface.
pub(super) fn shape_gradient(mesh: &Manifold, v: u32, spacing: f64) -> (DVec3, f64) {
    let strains = mesh.connectivity.outgoing(v).map(|h| strain_of(mesh, mesh.connectivity.triangle(h), spacing));
    strains.fold((DVec3::ZERO, 0.0), |(gradient, stiffness), strain| {
        let squares: f64 = strain.forms.iter().map(|form| form[0].length_squared()).sum();
        (gradient + strain.gradient[0], stiffness + 0.5 * squares)
    })
}

#[inline(always)]
fn strain_of(mesh: &Manifold, corners: [u32; 3], spacing: f64) -> Strain {
    let size = corners.into_iter().map(|v| mesh.sample(v).size).sum::<f64>() / 3.0;
    strain(corners.map(|v| mesh.position(v)), spacing * size)
}

/// Returns the derivatives of the energy of a triangle with respect to its corners. Inlined, so that a caller that needs
/// only one corner does not pay for the others.
#[inline(always)]
fn strain([p, q, r]: [DVec3; 3], spacing: f64) -> Strain {
    let sides = [r - q, p - r, q - p];
    let area_vector = 0.5 * sides[2].cross(-sides[1]);
    let normal = area_vector.normalize_or_zero();
    let ideal = 0.25 * 3f64.sqrt() * spacing * spacing;
    let area = area_vector.length().max(LEAST_AREA * ideal);
    let to_area = sides.map(|side| 0.5 * normal.cross(side));
    // Real and imaginary parts of the derivative of β with respect to each corner; each is rotated by a third of a turn from
    // the one before.
    let x = sides[2].normalize_or_zero();
    let y = normal.cross(x);
    let (sin, cos) = (0.75f64.sqrt(), -0.5);
    let real = [x, cos * x - sin * y, cos * x + sin * y];
    let imaginary = [y, sin * x + cos * y, cos * y - sin * x];
    let beta = [real, imaginary].map(|form| form[1].dot(q - p) + form[2].dot(r - p));

    let shape = (beta[0] * beta[0] + beta[1] * beta[1]) / (2.0 * 3f64.sqrt() * area);
    let weight = (SMALL_STRAIN / (shape + SMALL_STRAIN)).sqrt() + SQUARE_WEIGHT * shape;
    let relative = area / ideal;
    let per_beta = weight / (3f64.sqrt() * area);
    let per_area = 0.5 * SIZE_WEIGHT * (1.0 - 1.0 / math::square(relative)) / ideal - weight * shape / area;
    let gradient = [0, 1, 2].map(|k| per_beta * (beta[0] * real[k] + beta[1] * imaginary[k]) + per_area * to_area[k]);
    let (of_beta, of_area) = (per_beta.sqrt(), (SIZE_WEIGHT / math::cube(relative)).sqrt() / ideal);
    let forms = [real.map(|f| of_beta * f), imaginary.map(|f| of_beta * f), to_area.map(|f| of_area * f)];
    Strain { gradient, forms }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::sheet;

    fn energy([p, a, b]: [DVec3; 3], spacing: f64) -> f64 {
        let area = 0.5 * (a - p).cross(b - p).length();
        let squares = p.distance_squared(a) + a.distance_squared(b) + b.distance_squared(p);
        let shape = squares / (4.0 * 3f64.sqrt() * area) - 1.0;
        let relative = area / (0.25 * 3f64.sqrt() * spacing * spacing);
        let root = 2.0 * (SMALL_STRAIN * (shape + SMALL_STRAIN)).sqrt();
        root + 0.5 * SQUARE_WEIGHT * shape * shape + 0.5 * SIZE_WEIGHT * (relative + 1.0 / relative)
    }

    #[test]
    fn the_gradient_is_that_of_the_energy() {
        let triangle = [DVec3::new(0.1, -0.2, 0.3), DVec3::new(1.2, 0.1, -0.1), DVec3::new(0.3, 0.9, 0.2)];
        let strain = strain(triangle, 0.8);
        for corner in 0..3 {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let at = |t: f64| {
                    let mut moved = triangle;
                    moved[corner] += t * axis;
                    energy(moved, 0.8)
                };
                let (difference, slope) = ((at(1e-6) - at(-1e-6)) / 2e-6, strain.gradient[corner].dot(axis));
                assert!((difference - slope).abs() < 1e-7, "{corner} {difference} {slope}");
            }
        }
    }

    #[test]
    fn the_gradient_is_zero_for_an_equilateral_triangle_of_the_right_size() {
        let d = 0.4;
        let triangle = [DVec3::ZERO, d * DVec3::X, d * DVec3::new(0.5, 0.75f64.sqrt(), 0.0)];
        let steepest =
            |spacing: f64| strain(triangle, spacing).gradient.map(DVec3::length).into_iter().fold(0.0, f64::max);
        assert!(steepest(d) < 1e-12);
        assert!(steepest(1.1 * d) > 0.01);
    }

    #[test]
    fn within_a_goal_the_mean_gets_better_and_no_triangle_that_misses_it_worse() {
        let domain = Domain::new(sheet(20, |_, _| 0.0).try_into().unwrap());
        let mut uneven = sheet(10, |_, _| 0.0);
        for (i, p) in uneven.positions.iter_mut().enumerate() {
            if (0.05..0.95).contains(&p.x) && (0.05..0.95).contains(&p.y) {
                let (sin, cos) = (i as f64 * 2.4).sin_cos();
                *p += 0.03 * DVec3::new(cos, sin, 0.0);
            }
        }
        let samples = uneven.positions.iter().map(|&p| domain.project_anywhere(p)).collect();
        let mut mesh = Manifold::new(samples, &uneven.triangles);
        mesh.lock_boundary();
        assert_eq!(Goal::within_reach(&mesh), Goal::MODEST);
        let figures = |mesh: &Manifold| (Goal::MODEST.worst_margin(mesh), Goal::MODEST.cost(mesh));
        let (worst, cost) = figures(&mesh);
        relax_within(&domain, &mut mesh, &VertexSet::EMPTY, Goal::MODEST, 0.1, &()).unwrap();
        let (worst_after, cost_after) = figures(&mesh);
        assert!(worst < 0.0 && worst_after >= worst && cost_after < 0.8 * cost, "{worst_after} {cost} {cost_after}");
        relax(&domain, &mut mesh, &VertexSet::EMPTY, 0.1, Flips::Delaunay, 3, &()).unwrap();
        assert_eq!(Goal::within_reach(&mesh), Goal::GOOD);
    }
}
