//! Shape figures of a mesh's triangles.
//!
//! With S the area of a triangle, p half its perimeter and h its longest edge,
//!
//! ```text
//! Q = 6 S / (√3 p h)
//! ```
//!
//! is 1 for an equilateral triangle and 0 for one without area (Frey and Borouchaki, *Surface mesh quality evaluation*,
//! 1999, doi:10.1002/(SICI)1097-0207(19990510)45:1<101::AID-NME582>3.0.CO;2-4, as used in section 7.1 of *Spectral Sampling
//! of Manifolds*). θmin is the smallest angle of all triangles, "mean θmin" the mean of the smallest angles of the
//! triangles.
//!
//! Cost: linear, in parallel over fixed chunks, so the figures have the same bits with any number of threads.

use crate::base::parallel;
use crate::geom::triangle::{self, quality};
use crate::mesh::sides::{edges, sorted_sides};
use crate::mesh::triangle_mesh::Mesh;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Number of triangles per sum of one thread: fixed, because the order of summation affects the result.
const CHUNK: usize = 4096;

/// Shape figures of a mesh's triangles. Angles are in degrees, lengths in the units of the mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Smallest angle of all triangles.
    pub theta_min: f64,
    /// Mean of each triangle's smallest angle.
    pub theta_min_mean: f64,
    /// Largest angle of all triangles.
    pub theta_max: f64,
    /// Smallest Q of all triangles.
    pub q_min: f64,
    /// Mean Q.
    pub q_mean: f64,
    /// Triangles with an angle below 30 degrees, in percent.
    pub percent_below_30: f64,
    /// Triangles with an angle above 90 degrees, in percent.
    pub percent_above_90: f64,
    /// Mean length of the sides of all triangles: an edge between two triangles counts twice.
    pub edge_mean: f64,
    /// Shortest side.
    pub edge_min: f64,
    /// Longest side.
    pub edge_max: f64,
    /// Coefficient of variation of the sides: standard deviation over mean; 0 if all sides have zero length.
    pub edge_cv: f64,
    /// Number of interior vertices of each valence. Interior vertices are those whose edges all have exactly two triangles.
    pub valence: BTreeMap<u32, usize>,
    /// Interior vertices of valence 6, in percent; `None` if no vertex is interior.
    pub percent_valence_6: Option<f64>,
}

/// Returns the figures of all triangles of `mesh`, as they are; `None` if there are no triangles.
///
/// A triangle without area counts as having the angles 0, 0 and 180 degrees and Q = 0.
pub fn shape(mesh: &Mesh) -> Option<Shape> {
    let sum = |chunk: &[[u32; 3]]| -> Sums { chunk.iter().map(|t| Sums::of(mesh, *t)).sum() };
    let sums: Sums = parallel::blocks(&mesh.triangles[..], CHUNK, sum).into_iter().sum();
    if sums.triangles == 0 {
        return None;
    }
    let count = sums.triangles as f64;
    let edge_mean = sums.edges / (3.0 * count);
    let edge_deviation = (squared_deviations(mesh, edge_mean) / (3.0 * count)).sqrt();
    let valence = valence_histogram(mesh);
    Some(Shape {
        theta_min: sums.theta_min,
        theta_min_mean: sums.theta_min_sum / count,
        theta_max: sums.theta_max,
        q_min: sums.q_min,
        q_mean: sums.q_sum / count,
        percent_below_30: 100.0 * sums.below_30 as f64 / count,
        percent_above_90: 100.0 * sums.above_90 as f64 / count,
        edge_mean,
        edge_min: sums.edge_min,
        edge_max: sums.edge_max,
        edge_cv: if edge_mean > 0.0 { edge_deviation / edge_mean } else { 0.0 },
        percent_valence_6: percent_of(&valence, 6),
        valence,
    })
}

/// Figures gathered in one pass over the triangles.
struct Sums {
    triangles: usize,
    theta_min: f64,
    theta_min_sum: f64,
    theta_max: f64,
    q_min: f64,
    q_sum: f64,
    below_30: usize,
    above_90: usize,
    edges: f64,
    edge_min: f64,
    edge_max: f64,
}

impl Sums {
    /// Figures of no triangles.
    const NONE: Sums = Sums {
        triangles: 0,
        theta_min: f64::INFINITY,
        theta_min_sum: 0.0,
        theta_max: 0.0,
        q_min: f64::INFINITY,
        q_sum: 0.0,
        below_30: 0,
        above_90: 0,
        edges: 0.0,
        edge_min: f64::INFINITY,
        edge_max: 0.0,
    };

    /// Figures of one triangle.
    fn of(mesh: &Mesh, triangle: [u32; 3]) -> Sums {
        let corners = triangle.map(|v| mesh.positions[v as usize]);
        let (smallest, largest) = extreme_angles(corners);
        let q = quality(corners);
        let [a, b, c] = triangle::side_lengths(corners);
        Sums {
            triangles: 1,
            theta_min: smallest,
            theta_min_sum: smallest,
            theta_max: largest,
            q_min: q,
            q_sum: q,
            below_30: usize::from(smallest < 30.0),
            above_90: usize::from(largest > 90.0),
            edges: a + b + c,
            edge_min: a.min(b).min(c),
            edge_max: a.max(b).max(c),
        }
    }

    fn plus(self, other: Sums) -> Sums {
        Sums {
            triangles: self.triangles + other.triangles,
            theta_min: self.theta_min.min(other.theta_min),
            theta_min_sum: self.theta_min_sum + other.theta_min_sum,
            theta_max: self.theta_max.max(other.theta_max),
            q_min: self.q_min.min(other.q_min),
            q_sum: self.q_sum + other.q_sum,
            below_30: self.below_30 + other.below_30,
            above_90: self.above_90 + other.above_90,
            edges: self.edges + other.edges,
            edge_min: self.edge_min.min(other.edge_min),
            edge_max: self.edge_max.max(other.edge_max),
        }
    }
}

impl std::iter::Sum for Sums {
    fn sum<I: Iterator<Item = Sums>>(iter: I) -> Sums {
        iter.fold(Sums::NONE, Sums::plus)
    }
}

/// Returns the smallest and the largest angle, in degrees; 0 and 180 if there is no area.
pub fn extreme_angles(corners: [glam::DVec3; 3]) -> (f64, f64) {
    if triangle::area(corners) <= 0.0 {
        return (0.0, 180.0);
    }
    triangle::extreme_angles(corners)
}

/// Returns the sum over all sides of the squared difference to `mean`.
fn squared_deviations(mesh: &Mesh, mean: f64) -> f64 {
    let of = |t: &[u32; 3]| -> f64 {
        let sides = triangle::side_lengths(t.map(|v| mesh.positions[v as usize]));
        sides.iter().map(|side| (side - mean) * (side - mean)).sum()
    };
    parallel::blocks(&mesh.triangles[..], CHUNK, |chunk| chunk.iter().map(of).sum::<f64>()).iter().sum()
}

/// Returns the valence of each interior vertex; `None` for other vertices and for those that no triangle uses.
pub fn valences(mesh: &Mesh) -> Vec<Option<u32>> {
    let mut valence = vec![0u32; mesh.positions.len()];
    let mut interior = vec![true; mesh.positions.len()];
    for edge in edges(&sorted_sides(&mesh.triangles)) {
        for v in edge[0].ends() {
            valence[v as usize] += 1;
            interior[v as usize] &= edge.len() == 2;
        }
    }
    valence.into_iter().zip(interior).map(|(valence, interior)| (interior && valence > 0).then_some(valence)).collect()
}

/// Returns the number of interior vertices of each valence.
fn valence_histogram(mesh: &Mesh) -> BTreeMap<u32, usize> {
    let mut histogram = BTreeMap::new();
    for valence in valences(mesh).into_iter().flatten() {
        *histogram.entry(valence).or_default() += 1;
    }
    histogram
}

/// Returns the share of `valence` in a histogram, in percent.
fn percent_of(histogram: &BTreeMap<u32, usize>, valence: u32) -> Option<f64> {
    let all: usize = histogram.values().sum();
    (all > 0).then(|| 100.0 * *histogram.get(&valence).unwrap_or(&0) as f64 / all as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use glam::DVec3;

    fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh { positions: positions.iter().map(|&p| p.into()).collect(), triangles: triangles.to_vec() }
    }

    const OCTAHEDRON: [[f64; 3]; 6] =
        [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    const OCTAHEDRON_FACES: [[u32; 3]; 8] =
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

    #[test]
    fn equilateral_triangles_are_perfect() {
        let s = shape(&mesh(&OCTAHEDRON, &OCTAHEDRON_FACES)).unwrap();
        for angle in [s.theta_min, s.theta_min_mean, s.theta_max] {
            assert_relative_eq!(angle, 60.0, epsilon = 1e-12);
        }
        assert_relative_eq!(s.q_min, 1.0, epsilon = 1e-15);
        assert_relative_eq!(s.q_mean, 1.0, epsilon = 1e-15);
        assert_relative_eq!(s.edge_mean, 2f64.sqrt(), epsilon = 1e-15);
        assert!(s.edge_cv < 1e-12 && s.percent_below_30 == 0.0 && s.percent_above_90 == 0.0);
        assert_eq!((s.valence, s.percent_valence_6), (BTreeMap::from([(4, 6)]), Some(0.0)));
    }

    #[test]
    fn a_right_triangle_by_hand() {
        let s = shape(&mesh(&[[0., 0., 0.], [3., 0., 0.], [0., 4., 0.]], &[[0, 1, 2]])).unwrap();
        assert_relative_eq!(s.theta_min, 0.75f64.atan().to_degrees(), epsilon = 1e-12);
        assert_eq!((s.theta_max, s.percent_above_90, s.percent_below_30), (90.0, 0.0, 0.0));
        assert_relative_eq!(s.q_min, 6.0 * 6.0 / (3f64.sqrt() * 6.0 * 5.0), epsilon = 1e-15);
        assert_eq!((s.edge_min, s.edge_mean, s.edge_max), (3.0, 4.0, 5.0));
        assert_relative_eq!(s.edge_cv, (2.0f64 / 3.0).sqrt() / 4.0, epsilon = 1e-15);
        assert_eq!((s.valence.len(), s.percent_valence_6), (0, None));
    }

    #[test]
    fn triangles_without_area_are_the_worst_there_are() {
        let line = mesh(&[[0., 0., 0.], [1., 0., 0.], [2., 0., 0.]], &[[0, 1, 2], [0, 0, 1], [1, 1, 1]]);
        let s = shape(&line).unwrap();
        assert_eq!((s.theta_min, s.theta_max, s.q_min, s.q_mean), (0.0, 180.0, 0.0, 0.0));
        assert_eq!((s.percent_below_30, s.percent_above_90, s.edge_min), (100.0, 100.0, 0.0));
        let point = shape(&mesh(&[[1.; 3]], &[[0, 0, 0]])).unwrap();
        assert_eq!((point.edge_cv, point.q_min), (0.0, 0.0));
        assert_eq!(shape(&Mesh::default()), None);
    }

    #[test]
    fn boundary_vertices_have_no_valence_and_unused_ones_none_either() {
        let mut fan = mesh(&[[0.; 3]; 8], &[]);
        fan.triangles = (0..6).map(|k| [6, k, (k + 1) % 6]).collect();
        let s = shape(&fan).unwrap();
        assert_eq!((s.valence, s.percent_valence_6), (BTreeMap::from([(6, 1)]), Some(100.0)));
    }

    #[test]
    fn the_figures_have_the_same_bits_with_any_number_of_threads() {
        let n = 30_000u32;
        let at = |k: u32| DVec3::new(f64::from(k).sin(), f64::from(k).cos() * 3.0, f64::from(k % 7));
        let m =
            Mesh { positions: (0..n).map(at).collect(), triangles: (0..n - 2).map(|k| [k, k + 1, k + 2]).collect() };
        let with = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| shape(&m));
        assert_eq!(with(1), with(8));
    }
}
