//! Estimates the normals of a cloud's points by fits to their neighbours.
//!
//! - A plane: its normal is the direction in which the neighbours of a point spread least. It is not oriented yet.
//!   Neighbours on a line do not determine a plane, so more of them are used.
//! - An algebraic sphere, u₀ + u·x + u₄ x·x = 0, whose gradient fits the normals of the neighbours best: with weights w that
//!   sum to one, u₄ = ½ (Σ w x·n - Σ w x · Σ w n) / (Σ w x·x - Σ w x · Σ w x), u = Σ w n - 2 u₄ Σ w x. With the point at the
//!   origin its normal is u. Only neighbours that face the same way count, so the other side of a thin sheet does not.
//!
//! Based on: H. Hoppe, T. DeRose, T. Duchamp, J. McDonald, W. Stuetzle, Surface reconstruction from unorganized points,
//! 1992, DOI 10.1145/133994.134011 (planes); G. Guennebaud, M. Germann, M. Gross, Dynamic sampling and rendering of
//! algebraic point set surfaces, 2008, DOI 10.1111/j.1467-8659.2008.01163.x (spheres).
//!
//! Cost: linear in points and neighbours.

use crate::base::math;
use crate::base::parallel;
use crate::geom::eigen::{eigen, scatter};
use crate::spatial::kdtree::{Neighbor, Neighbors};
use crate::spatial::knn_graph::NeighborGraph;
use glam::DVec3;

/// Number of neighbours that stabilise a fit where there is noise, or where points are few.
pub const MANY_NEIGHBORS: usize = 16;

/// Neighbours are on a line if their spread across it is less than this share of their spread along it. For half a disc, as
/// at a boundary, the share is one half.
const LINE: f64 = 0.3;

/// Maximum factor by which the number of neighbours grows before a line is accepted as one.
const MOST_ON_LINE: usize = 8;

/// The neighbours of each point that determine its normal.
pub enum Neighborhood<'a> {
    /// This many of the nearest ones.
    Nearest(&'a NeighborGraph, usize),
    /// All within a radius.
    Within(&'a Neighbors, f64),
}

impl Neighborhood<'_> {
    /// Calls `fit` with each point and its neighbours, in parallel.
    fn map(&self, points: &[DVec3], fit: impl Fn(u32, &[u32]) -> DVec3 + Sync) -> Vec<DVec3> {
        let all = 0..points.len() as u32;
        match *self {
            Neighborhood::Nearest(graph, count) => {
                parallel::map(all, |p| fit(p, &graph.of(p)[..count.min(graph.degree())]))
            }
            Neighborhood::Within(near, radius) => {
                parallel::map(all, |p| fit(p, &others(&near.within(points[p as usize], radius), p)))
            }
        }
    }
}

/// Returns the unoriented unit normal of the plane that fits point `p` and its `nearest` neighbours. If these are on a line,
/// through which there are many planes, as many more are taken as it takes, by a function that collects so many of the points
/// nearest to `p`, itself included. The points of a scanner's rows, and the vertices of many meshes, are closer to each other
/// in one direction than in the other.
pub fn plane_normal(
    points: &[DVec3],
    p: u32,
    nearest: &[u32],
    collect_nearest: impl Fn(usize, &mut Vec<Neighbor>),
) -> DVec3 {
    let (mut normal, mut is_line) = fitted_plane(points, p, nearest);
    let (mut count, mut found) = (nearest.len(), Vec::new());
    let most = MOST_ON_LINE * nearest.len();
    while is_line && count < most {
        count *= 2;
        collect_nearest(count + 1, &mut found);
        (normal, is_line) = fitted_plane(points, p, &others(&found, p));
    }
    normal
}

fn others(found: &[Neighbor], p: u32) -> Vec<u32> {
    found.iter().map(|n| n.point).filter(|&n| n != p).collect()
}

/// Returns the unoriented unit normal of the plane that fits a point and its neighbours, and whether these are on a line.
fn fitted_plane(points: &[DVec3], p: u32, neighbors: &[u32]) -> (DVec3, bool) {
    let ([_, across, along], [normal, ..]) = spread(points, p, neighbors);
    (normal, across <= math::square(LINE) * along)
}

/// Returns the principal values and directions of a point and its neighbours.
pub(super) fn spread(points: &[DVec3], p: u32, neighbors: &[u32]) -> ([f64; 3], [DVec3; 3]) {
    let here = points[p as usize];
    let offsets = neighbors.iter().map(|&n| points[n as usize] - here);
    eigen(scatter(std::iter::once(DVec3::ZERO).chain(offsets)).1)
}

/// Returns unoriented unit normals of planes through each point's neighbours; where these are on a line, through more of
/// them, which `near` finds.
pub fn plane_normals(points: &[DVec3], near: &Neighbors, neighborhood: &Neighborhood) -> Vec<DVec3> {
    neighborhood.map(points, |p, neighbors| {
        plane_normal(points, p, neighbors, |count, found| near.collect_nearest(points[p as usize], count, found))
    })
}

/// Returns unit normals of spheres fitted to the neighbours and their normals, with the orientation of `normals`.
pub fn sphere_normals(points: &[DVec3], normals: &[DVec3], neighborhood: &Neighborhood) -> Vec<DVec3> {
    neighborhood.map(points, |p, neighbors| sphere_normal(points, normals, p, neighbors))
}

fn sphere_normal(points: &[DVec3], normals: &[DVec3], p: u32, neighbors: &[u32]) -> DVec3 {
    let (here, normal) = (points[p as usize], normals[p as usize]);
    let reach = neighbors.last().map_or(1.0, |&n| points[n as usize].distance(here)).max(f64::MIN_POSITIVE);
    let mut fit = SphereFit::default();
    fit.add(DVec3::ZERO, normal, 1.0);
    for &n in neighbors {
        let (offset, other) = ((points[n as usize] - here) / reach, normals[n as usize]);
        if normal.dot(other) > 0.0 {
            fit.add(offset, other, math::square((1.0 - offset.length_squared()).max(0.0)));
        }
    }
    fit.gradient_at_origin().try_normalize().filter(|g| g.dot(normal) > 0.0).unwrap_or(normal)
}

/// Weighted sums over points x with normals n that determine an algebraic sphere.
#[derive(Default)]
struct SphereFit {
    weight: f64,
    x: DVec3,
    n: DVec3,
    x_dot_x: f64,
    x_dot_n: f64,
}

impl SphereFit {
    fn add(&mut self, x: DVec3, n: DVec3, weight: f64) {
        self.weight += weight;
        self.x += weight * x;
        self.n += weight * n;
        self.x_dot_x += weight * x.length_squared();
        self.x_dot_n += weight * x.dot(n);
    }

    /// Returns u, the gradient of the sphere at the origin.
    fn gradient_at_origin(&self) -> DVec3 {
        let (x, n) = (self.x / self.weight, self.n / self.weight);
        let spread = self.x_dot_x / self.weight - x.length_squared();
        if spread <= 0.0 {
            return n;
        }
        let u4 = 0.5 * (self.x_dot_n / self.weight - x.dot(n)) / spread;
        n - 2.0 * u4 * x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};

    /// Random points of the unit sphere.
    fn sphere(count: usize) -> Vec<DVec3> {
        let mut rng = stream(1, Stage::Scan);
        (0..count)
            .map(|_| {
                let (z, turn) = (2.0 * unit(&mut rng) - 1.0, std::f64::consts::TAU * unit(&mut rng));
                let r = (1.0 - z * z).sqrt();
                DVec3::new(r * turn.cos(), r * turn.sin(), z)
            })
            .collect()
    }

    #[test]
    fn planes_find_normals_but_for_their_side_and_spheres_find_them_better() {
        let points = sphere(2000);
        let near = Neighbors::new(&points);
        let graph = NeighborGraph::new(&points, &near, 12);
        let nearest = Neighborhood::Nearest(&graph, 12);
        let mut normals = plane_normals(&points, &near, &nearest);
        let off = |normals: &[DVec3]| {
            let angles = normals.iter().zip(&points).map(|(n, p)| n.dot(*p).abs().min(1.0).acos().to_degrees());
            angles.sum::<f64>() / points.len() as f64
        };
        assert!(off(&normals) < 2.0, "{}", off(&normals));
        normals.iter_mut().zip(&points).for_each(|(n, p)| *n *= n.dot(*p).signum());
        let better = sphere_normals(&points, &normals, &nearest);
        assert!(off(&better) < 0.7 * off(&normals), "{} {}", off(&better), off(&normals));
        assert!(better.iter().zip(&points).all(|(n, p)| n.dot(*p) > 0.0));
    }

    #[test]
    fn rows_far_apart_have_the_normals_of_their_surface() {
        // Rows along a cylinder of radius 20, eight times as far apart as the points in them.
        let point = |i: u32| {
            let turn = f64::from(i % 60) * std::f64::consts::TAU / 400.0;
            DVec3::new(20.0 * turn.cos(), 20.0 * turn.sin(), 2.5 * f64::from(i / 60))
        };
        let points: Vec<DVec3> = (0..600).map(point).collect();
        let near = Neighbors::new(&points);
        let graph = NeighborGraph::new(&points, &near, 16);
        for (n, p) in plane_normals(&points, &near, &Neighborhood::Nearest(&graph, 8)).iter().zip(&points) {
            assert!(n.dot(p.with_z(0.0) / 20.0).abs() > 0.95, "{n} at {p}");
        }
    }

    #[test]
    fn a_radius_says_as_much_as_a_count() {
        let points = sphere(2000);
        let near = Neighbors::new(&points);
        let normals = plane_normals(&points, &near, &Neighborhood::Within(&near, 0.15));
        assert!(normals.iter().zip(&points).all(|(n, p)| n.dot(*p).abs() > 0.97));
    }

    #[test]
    fn the_other_side_of_a_thin_sheet_does_not_count() {
        let grid = |z: f64| (0..400).map(move |i| DVec3::new(f64::from(i % 20), f64::from(i / 20), z));
        let points: Vec<DVec3> = grid(0.0).chain(grid(0.3)).collect();
        let side = |i: usize| if i < 400 { -DVec3::Z } else { DVec3::Z };
        let tilted: Vec<DVec3> = (0..800).map(|i| (side(i) + 0.1 * DVec3::X).normalize()).collect();
        let graph = NeighborGraph::new(&points, &Neighbors::new(&points), 16);
        for (i, n) in sphere_normals(&points, &tilted, &Neighborhood::Nearest(&graph, 16)).into_iter().enumerate() {
            assert!(n.dot(side(i)) > 0.99);
        }
    }
}
