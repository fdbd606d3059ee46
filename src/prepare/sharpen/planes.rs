//! Tangent planes of a mesh through points, each through points of one smooth patch only.
//!
//! The plane through all points around a vertex near a sharp edge is tilted, and fits poorly. The planes around vertices
//! farther from the edge fit well, and one of them also passes through this vertex: that of its own patch. Planes spread from
//! vertex to vertex, and each vertex keeps the one that fits best.
//!
//! Based on: M. Kuwahara, K. Hachimura, S. Eiho, M. Kinoshita, Processing of RI-angiocardiographic images, 1976, which smooths
//! images in the same way without blurring their edges.
//!
//! Cost: linear; a few passes over the neighbours of all vertices.

use crate::base::csr::Csr;
use crate::base::math;
use crate::base::parallel;
use crate::geom::eigen::{eigen, scatter};
use crate::geom::symmetric::Symmetric;
use crate::mesh::triangle_mesh::Mesh;
use glam::{DMat3, DVec3};

/// Passes over the neighbours in addition to one per ring: averages of averages reach less far than a disc.
const MORE_AVERAGES: usize = 1;

/// Number of further rings from which a vertex may get its plane: those around it all pass through points of both patches.
const MORE_RINGS: usize = 3;

/// Distance of points from a plane, in mean edge lengths, up to which they lie on it in any case, and from which they may
/// not. At an angle of 30 degrees, points within two rings are at about 0.09.
const FLAT: f64 = 0.002;
const BENT: f64 = 0.05;

/// Minimum of [`Tangent::better`] near a sharp edge.
pub(super) const BETTER: f64 = 1.5;

/// Distance of points from a plane, relative to that of the points through which it passes, up to which they belong to it.
const BELONGS: f64 = 3.0;

/// Minimum number of points of a plane.
const FEWEST: usize = 6;

/// Weight that keeps a vertex where it is, relative to that of a plane, and the number of steps to where planes meet. Planes
/// that hardly differ thus do not move it far along them.
const STAY: f64 = 0.03;
const STEPS: usize = 3;

/// Plane through some points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    /// Mean of the points.
    pub mean: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Root mean square of the distances of the points.
    distance: f64,
}

/// Tangent plane at a vertex, through points of its own patch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangent {
    pub plane: Plane,
    /// How many times better it fits than the plane through all points around; one if there is no sharp edge.
    pub better: f64,
}

impl Plane {
    /// Returns the plane through points with this mean and covariance, with a normal on the side of `facing`.
    fn of(mean: DVec3, covariance: DMat3, facing: DVec3) -> Plane {
        let ([least, ..], [normal, ..]) = eigen(covariance);
        Plane { mean, normal: normal * facing.dot(normal).signum(), distance: least.max(0.0).sqrt() }
    }

    /// Returns the distance of `p` from the plane, negative on the other side of its normal.
    pub fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p - self.mean)
    }

    /// Returns how badly the plane fits its points and `p`.
    fn misfit(&self, p: DVec3) -> f64 {
        (self.distance * self.distance + math::square(self.height(p))).sqrt()
    }
}

/// Weighted sums over points: of one, of their coordinates, and of the products of these.
#[derive(Clone, Copy, Default)]
struct Moments {
    weight: f64,
    sum: DVec3,
    squares: Symmetric,
}

impl Moments {
    fn of_point(p: DVec3) -> Moments {
        Moments { weight: 1.0, sum: p, squares: Symmetric::outer(p) }
    }

    fn mean_and_covariance(&self) -> (DVec3, DMat3) {
        let mean = self.sum / self.weight;
        let mut covariance = self.squares * self.weight.recip();
        covariance += Symmetric::outer(mean) * -1.0;
        (mean, covariance.matrix())
    }

    fn add(&mut self, other: &Moments, factor: f64) {
        self.weight += factor * other.weight;
        self.sum += factor * other.sum;
        self.squares += other.squares * factor;
    }
}

/// Returns the tangent plane at each vertex of `mesh`, through about `rings` rings of neighbours.
pub(super) fn tangents(mesh: &Mesh, neighbors: &Csr<u32>, rings: usize) -> Vec<Tangent> {
    let positions = &mesh.positions;
    let around = planes_around(mesh, neighbors, rings);
    let length = |v: usize| {
        let row = neighbors.row(v as u32);
        row.iter().map(|&w| positions[w as usize].distance(positions[v])).sum::<f64>() / row.len() as f64
    };
    let is_bent: Vec<bool> = parallel::map(0..positions.len(), |v| around[v].distance > BENT * length(v));
    let mut best = around.clone();
    for _ in 0..rings + MORE_RINGS {
        let better = |v: usize| {
            let around: &[u32] = if is_bent[v] { neighbors.row(v as u32) } else { &[] };
            let found = around.iter().map(|&w| best[w as usize]);
            let misfits = std::iter::once(best[v]).chain(found).map(|plane| (plane.misfit(positions[v]), plane));
            misfits.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(best[v], |(_, plane)| plane)
        };
        best = parallel::map(0..positions.len(), better);
    }
    let tangent = |near: &mut Vec<u32>, v: usize| {
        let misfit = best[v].misfit(positions[v]);
        if !is_bent[v] || BETTER * misfit > around[v].distance {
            return Tangent { plane: around[v], better: 1.0 };
        }
        let reach = BELONGS * misfit.max(FLAT * length(v));
        collect_rings(neighbors, v as u32, rings, near);
        near.retain(|&w| best[v].height(positions[w as usize]).abs() <= reach);
        let is_enough = near.len() >= FEWEST;
        let through = || {
            let (mean, squares) = scatter(near.iter().map(|&w| positions[w as usize]));
            Plane::of(mean, squares * (near.len() as f64).recip(), best[v].normal)
        };
        Tangent { plane: if is_enough { through() } else { best[v] }, better: around[v].distance / misfit }
    };
    parallel::map_with(0..positions.len(), Vec::new, tangent)
}

/// Returns the point where `planes` meet, nearest to `start`.
pub(super) fn meeting(planes: impl Iterator<Item = Plane> + Clone, start: DVec3) -> DVec3 {
    let mut squares = Symmetric::default();
    planes.clone().for_each(|plane| squares += Symmetric::outer(plane.normal));
    let stay = DMat3::from_diagonal(DVec3::splat(STAY * planes.clone().count() as f64));
    let step = (squares.matrix() + stay).inverse();
    (0..STEPS).fold(start, |p, _| p - step * planes.clone().map(|plane| plane.height(p) * plane.normal).sum::<DVec3>())
}

/// Returns the plane through the points around each vertex.
fn planes_around(mesh: &Mesh, neighbors: &Csr<u32>, rings: usize) -> Vec<Plane> {
    let middle = mesh.positions.iter().sum::<DVec3>() / mesh.positions.len() as f64;
    let mut moments: Vec<Moments> = mesh.positions.iter().map(|&p| Moments::of_point(p - middle)).collect();
    for _ in 0..rings + MORE_AVERAGES {
        let averaged = |v: usize| {
            let mut sum = moments[v];
            let row = neighbors.row(v as u32);
            row.iter().for_each(|&w| sum.add(&moments[w as usize], 1.0));
            let mut mean = Moments::default();
            mean.add(&sum, 1.0 / (1 + row.len()) as f64);
            mean
        };
        moments = parallel::map(0..moments.len(), averaged);
    }
    let normals = mesh.vertex_area_vectors();
    parallel::map(0..moments.len(), |v| {
        let (mean, covariance) = moments[v].mean_and_covariance();
        Plane::of(middle + mean, covariance, normals[v])
    })
}

/// Collects a vertex and its `rings` of neighbours.
fn collect_rings(neighbors: &Csr<u32>, v: u32, rings: usize, found: &mut Vec<u32>) {
    found.clear();
    found.push(v);
    let mut first = 0;
    for _ in 0..rings {
        let ring = first..found.len();
        first = found.len();
        for i in ring {
            for &w in neighbors.row(found[i]) {
                if !found.contains(&w) {
                    found.push(w);
                }
            }
        }
    }
}
