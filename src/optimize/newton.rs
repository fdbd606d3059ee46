//! One Gauss-Newton step for all vertices of a mesh at once.
//!
//! Each vertex has two unknowns, its step along two axes of its tangent plane. On a curve it has one, along the curve; if
//! locked, it has none. The gradient of the energy is the sum of those of the triangles, its Hessian the sum of the squares
//! of linear forms that the triangles contribute. The equations are solved by conjugate gradients, preconditioned with the
//! blocks of the vertices, 2 x 2 each.
//!
//! Based on: J. Nocedal, S. J. Wright, Numerical Optimization, 2006, chapters 5 and 10, DOI 10.1007/978-0-387-40065-5.
//!
//! Cost: about a microsecond per vertex to set up, and a tenth of that for each of some ten to twenty iterations.

use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::{Connectivity, prev};
use glam::{DMat2, DVec2, DVec3};
use std::ops::Range;

/// The derivatives of the energy of a triangle.
pub(super) struct Strain {
    /// The gradient at each corner.
    pub gradient: [DVec3; 3],
    /// Three linear forms, whose squares sum to the Hessian; each is given by its coefficients for the steps of the corners.
    pub forms: [[DVec3; 3]; 3],
}

/// Damping added to the Hessian at each vertex, as a share of the contribution of six equilateral triangles of the target
/// size.
const DAMPING: f64 = 0.02;
const OF_REGULAR: f64 = 8.0;

/// Maximum number of iterations, and the share of the first residual at which they end: the next round starts from a better
/// place.
const MOST_ITERATIONS: usize = 25;
const TOLERANCE: f64 = 0.05;

/// Number of vertices per task.
const CHUNK: usize = 1024;

/// Returns the step of each vertex, by number; zero for those in `locked`. `strain_of` returns the strain of a triangle,
/// given its vertices; `spacing` is the target edge length at samples of size 1.
pub(super) fn newton_step(
    mesh: &Manifold,
    locked: &VertexSet,
    spacing: f64,
    strain_of: impl Fn([u32; 3]) -> Strain + Sync,
) -> Vec<DVec3> {
    let axes: Vec<[DVec3; 2]> = parallel::map(0..mesh.connectivity.vertex_bound(), |v| axes(mesh, locked, v));
    let steps = Equations::new(mesh, &axes, spacing, strain_of).solve();
    steps.iter().zip(axes).map(|(step, axes)| step.x * axes[0] + step.y * axes[1]).collect()
}

/// Returns the axes along which vertex `v` can move, with zero in place of those along which it cannot.
fn axes(mesh: &Manifold, locked: &VertexSet, v: u32) -> [DVec3; 2] {
    if !mesh.connectivity.has_vertex(v) || !mesh.can_move(v, locked) {
        return [DVec3::ZERO; 2];
    }
    match mesh.along(v) {
        Some(along) => [along, DVec3::ZERO],
        None => mesh.sample(v).normal.any_orthonormal_pair().into(),
    }
}

/// Returns whether vertex `v` can move along any of its axes.
fn moves(axes: &[[DVec3; 2]], v: u32) -> bool {
    axes[v as usize] != [DVec3::ZERO; 2]
}

/// The contribution of a triangle at one of its corners, in the axes of the vertices.
#[derive(Clone, Copy, Default)]
struct AtCorner {
    /// The negative gradient.
    force: DVec2,
    /// The block of the Hessian.
    own: DMat2,
}

/// Contributions of a triangle to the blocks between the origin and the target of each half-edge.
type Between = [DMat2; 3];

/// The Hessian as a sparse matrix of 2 x 2 blocks, and the negative gradient.
struct Equations {
    diagonal: Vec<DMat2>,
    /// The off-diagonal blocks, [`CHUNK`] rows together.
    chunks: Vec<Rows>,
    force: Vec<DVec2>,
}

/// Rows of a sparse matrix.
struct Rows {
    /// For each row, the end of its entries.
    end: Vec<u32>,
    /// The blocks, each with the vertex that it multiplies.
    entries: Vec<(u32, DMat2)>,
}

impl Rows {
    /// Returns the rows of these vertices; those of vertices that cannot move are empty.
    fn new(c: &Connectivity, axes: &[[DVec3; 2]], between: &[Between], vertices: Range<u32>) -> Rows {
        let mut rows =
            Rows { end: Vec::with_capacity(vertices.len()), entries: Vec::with_capacity(7 * vertices.len()) };
        for v in vertices {
            if c.has_vertex(v) && moves(axes, v) {
                rows.entries.extend(entries_of(c, v, between));
            }
            rows.end.push(rows.entries.len() as u32);
        }
        rows.entries.shrink_to_fit();
        rows
    }

    /// Returns the blocks of each row.
    fn iter(&self) -> impl Iterator<Item = &[(u32, DMat2)]> {
        let begin = std::iter::once(0).chain(self.end.iter().copied());
        begin.zip(&self.end).map(|(begin, &end)| &self.entries[begin as usize..end as usize])
    }
}

impl Equations {
    fn new(
        mesh: &Manifold,
        axes: &[[DVec3; 2]],
        spacing: f64,
        strain_of: impl Fn([u32; 3]) -> Strain + Sync,
    ) -> Equations {
        let c = &mesh.connectivity;
        let triangles = c.half_edge_bound() as usize / 3;
        let mut at_corners = vec![<[AtCorner; 3]>::default(); triangles];
        let mut between = vec![Between::default(); triangles];
        let chunks = at_corners.chunks_mut(CHUNK).zip(between.chunks_mut(CHUNK)).zip((0..).step_by(CHUNK));
        parallel::each(chunks, |((at_corners, between), first)| {
            for ((at_corners, between), t) in at_corners.iter_mut().zip(between).zip(first..) {
                let corners = c.has_half_edge(3 * t).then(|| c.triangle(3 * t));
                if let Some(corners) = corners.filter(|corners| corners.iter().any(|&v| moves(axes, v))) {
                    (*at_corners, *between) = shares(corners, axes, strain_of(corners));
                }
            }
        });
        let at_vertex = |v: u32| {
            let spacing = spacing * mesh.sample(v).size;
            let damping = DMat2::from_diagonal(DVec2::splat(DAMPING * OF_REGULAR / (spacing * spacing)));
            let around = c.has_vertex(v).then(|| c.outgoing(v)).into_iter().flatten();
            around.fold((damping, DVec2::ZERO), |(diagonal, force), h| {
                let AtCorner { force: more, own } = of_half_edge(&at_corners, h);
                (diagonal + own, force + more)
            })
        };
        let (diagonal, force) = parallel::map(0..c.vertex_bound(), at_vertex).into_iter().unzip();
        // Freed now, since the rows take as much memory again.
        drop(at_corners);
        let chunks = parallel::blocks(0..c.vertex_bound(), CHUNK, |vertices| Rows::new(c, axes, &between, vertices));
        Equations { diagonal, chunks, force }
    }

    /// Returns the solution, by conjugate gradients starting from zero.
    fn solve(&self) -> Vec<DVec2> {
        let inverse: Vec<DMat2> = parallel::map(&self.diagonal[..], DMat2::inverse);
        let mut image = vec![DVec2::ZERO; self.force.len()];
        let mut at = Iterate { x: image.clone(), residual: self.force.clone(), way: image.clone() };
        let mut square = at.advance(0.0, &image, &inverse);
        at.turn(0.0, &inverse);
        let goal = TOLERANCE * TOLERANCE * square;
        for _ in 0..MOST_ITERATIONS {
            if square <= goal {
                break;
            }
            let step = square / self.times(&at.way, &mut image);
            let before = std::mem::replace(&mut square, at.advance(step, &image, &inverse));
            at.turn(square / before, &inverse);
        }
        at.x
    }

    /// Writes the Hessian times `x` to `image`; returns the dot product of `image` and `x`.
    fn times(&self, x: &[DVec2], image: &mut [DVec2]) -> f64 {
        let chunks = image.chunks_mut(CHUNK).zip(&self.chunks).enumerate();
        let products = parallel::each(chunks, |(i, (image, rows))| {
            let mut product = 0.0;
            for ((image, entries), v) in image.iter_mut().zip(rows.iter()).zip(CHUNK * i..) {
                *image = entries.iter().fold(self.diagonal[v] * x[v], |sum, &(w, block)| sum + block * x[w as usize]);
                product += x[v].dot(*image);
            }
            product
        });
        products.into_iter().sum()
    }
}

/// The state of the conjugate gradients.
struct Iterate {
    x: Vec<DVec2>,
    residual: Vec<DVec2>,
    /// The search direction.
    way: Vec<DVec2>,
}

impl Iterate {
    /// Takes a step along the search direction, whose product with the Hessian is `image`; returns the preconditioned square
    /// of the new residual.
    fn advance(&mut self, step: f64, image: &[DVec2], inverse: &[DMat2]) -> f64 {
        let Iterate { x, residual, way } = self;
        let at = x.chunks_mut(CHUNK).zip(residual.chunks_mut(CHUNK)).zip(way.chunks(CHUNK));
        let chunks = at.zip(image.chunks(CHUNK)).zip(inverse.chunks(CHUNK));
        let squares = parallel::each(chunks, |((((x, residual), way), image), inverse)| {
            let mut square = 0.0;
            for (k, x) in x.iter_mut().enumerate() {
                *x += step * way[k];
                residual[k] -= step * image[k];
                square += residual[k].dot(inverse[k] * residual[k]);
            }
            square
        });
        squares.into_iter().sum()
    }

    /// Sets the search direction to the preconditioned residual plus this share of the previous direction.
    fn turn(&mut self, share: f64, inverse: &[DMat2]) {
        let residual = self.residual.chunks(CHUNK).zip(inverse.chunks(CHUNK));
        parallel::each(self.way.chunks_mut(CHUNK).zip(residual), |(way, (residual, inverse))| {
            for ((way, residual), inverse) in way.iter_mut().zip(residual).zip(inverse) {
                *way = *inverse * *residual + share * *way;
            }
        });
    }
}

/// Returns the value that belongs to half-edge `h`, or to its origin.
#[inline]
fn of_half_edge<T: Copy>(of_triangles: &[[T; 3]], h: u32) -> T {
    of_triangles[h as usize / 3][h as usize % 3]
}

/// Returns the contributions of a triangle at its corners, and between them.
fn shares(corners: [u32; 3], axes: &[[DVec3; 2]], strain: Strain) -> ([AtCorner; 3], Between) {
    let in_axes = |k: usize, v: DVec3| {
        let [x, y] = axes[corners[k] as usize];
        DVec2::new(v.dot(x), v.dot(y))
    };
    let forms = [0, 1, 2].map(|k| strain.forms.map(|form| in_axes(k, form[k])));
    let product = |a: [DVec2; 3], b: [DVec2; 3]| {
        a.iter().zip(b).map(|(&a, b)| DMat2::from_cols(a * b.x, a * b.y)).fold(DMat2::ZERO, |sum, block| sum + block)
    };
    (
        [0, 1, 2].map(|k| AtCorner { force: -in_axes(k, strain.gradient[k]), own: product(forms[k], forms[k]) }),
        [0, 1, 2].map(|k| product(forms[k], forms[(k + 1) % 3])),
    )
}

/// Returns the blocks between `v` and its neighbours: each edge has a contribution from the triangle on either side.
fn entries_of<'a>(c: &'a Connectivity, v: u32, between: &'a [Between]) -> impl Iterator<Item = (u32, DMat2)> + 'a {
    let back = |h: u32| of_half_edge(between, h).transpose();
    let outwards = c.outgoing(v).map(move |h| {
        let other = if c.has_twin(h) { back(c.twin(h)) } else { DMat2::ZERO };
        (c.target(h), of_half_edge(between, h) + other)
    });
    // The last edge around a boundary vertex has a triangle only on its right.
    let last = c.outgoing(v).map(prev).find(|&h| !c.has_twin(h));
    outwards.chain(last.map(move |h| (c.origin(h), back(h))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::domain::Sample;

    /// A flat ring of six triangles around the origin, with the central vertex at `middle`.
    fn ring(middle: DVec3) -> Manifold {
        let corner = |i: u32| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_3).sin_cos();
            DVec3::new(cos, sin, 0.0)
        };
        let places = std::iter::once(middle).chain((0..6).map(corner));
        let samples = places.map(|position| Sample { position, normal: DVec3::Z, triangle: 0, size: 1.0 }).collect();
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [0, 1 + i, 1 + (i + 1) % 6]).collect();
        Manifold::new(samples, &triangles)
    }

    /// Springs of zero rest length: half the squared lengths of the sides at the first corner.
    fn springs(mesh: &Manifold, [a, b, c]: [u32; 3]) -> Strain {
        let [a, b, c] = [a, b, c].map(|v| mesh.position(v));
        let gradient = [2.0 * a - b - c, b - a, c - a];
        let along = |axis: DVec3| [2f64.sqrt() * axis, -0.5f64.sqrt() * axis, -0.5f64.sqrt() * axis];
        Strain { gradient, forms: [along(DVec3::X), along(DVec3::Y), [DVec3::ZERO; 3]] }
    }

    #[test]
    fn a_quadratic_energy_is_least_after_one_step_but_for_the_damping() {
        let mesh = ring(DVec3::new(0.3, -0.2, 0.0));
        let ring = VertexSet::from_iter(1..7);
        let steps = newton_step(&mesh, &ring, 1e3, |t| springs(&mesh, t));
        assert!((mesh.position(0) + steps[0]).length() < 1e-6, "{:?}", steps[0]);
        assert!(steps[1..].iter().all(|step| *step == DVec3::ZERO));
    }

    #[test]
    fn the_blocks_are_those_of_a_symmetric_matrix() {
        let mesh = ring(DVec3::new(0.1, 0.1, 0.0));
        let axes: Vec<[DVec3; 2]> = (0..7).map(|v| super::axes(&mesh, &VertexSet::EMPTY, v)).collect();
        let equations = Equations::new(&mesh, &axes, 1.0, |t| springs(&mesh, t));
        let image_of = |i: usize| {
            let (mut x, mut image) = (vec![DVec2::ZERO; 7], vec![DVec2::ZERO; 7]);
            x[i / 2][i % 2] = 1.0;
            assert_eq!(equations.times(&x, &mut image), image[i / 2][i % 2]);
            image
        };
        let image: Vec<Vec<DVec2>> = (0..14).map(image_of).collect();
        for (i, j) in (0..14).flat_map(|i| (0..i).map(move |j| (i, j))) {
            assert!((image[i][j / 2][j % 2] - image[j][i / 2][i % 2]).abs() < 1e-12, "{i} {j}");
        }
    }
}
