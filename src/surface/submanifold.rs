//! The manifolds that samples lie on, in any dimension, as the sampler sees them.

use crate::geom::vector::difference;

/// A manifold embedded in D dimensions. Distances between its points, at most a few kernel widths apart, are those of the
/// embedding space.
pub trait Submanifold<const D: usize>: Sync {
    /// A point of the manifold, with the data needed to project a nearby place back.
    type Point: Copy + Send + Sync;

    /// Returns the coordinates of `point` in the D dimensions of the kernel.
    fn coordinates(&self, point: &Self::Point) -> [f64; D];

    /// Moves `from` by the tangential part of `way`, and projects the result back onto the manifold.
    fn step(&self, from: &Self::Point, way: &[f64; D]) -> Self::Point;

    /// Returns the offset between two places: shorter than their difference where the space is periodic.
    fn offset(&self, from: &[f64; D], to: &[f64; D]) -> [f64; D] {
        difference(to, from)
    }

    /// Returns `x` and its periodic images, as far as these are within `reach` of the space that contains the points.
    fn images(&self, x: &[f64; D], _reach: f64) -> Vec<[f64; D]> {
        vec![*x]
    }

    /// Returns whether two nearby points count as neighbours; points of two sheets that nearly touch do not.
    fn joined(&self, _one: &Self::Point, _other: &Self::Point) -> bool {
        true
    }
}

/// The unit square, cube and so on. A step ends at its border.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitCube<const D: usize>;

impl<const D: usize> Submanifold<D> for UnitCube<D> {
    type Point = [f64; D];

    fn coordinates(&self, point: &[f64; D]) -> [f64; D] {
        *point
    }

    fn step(&self, from: &[f64; D], way: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|i| (from[i] + way[i]).clamp(0.0, 1.0))
    }
}

/// The unit square, cube and so on with opposite sides joined: a flat torus.
///
/// Its kernel must not reach around it: [`Submanifold::offset`] only gives the shortest offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlatTorus<const D: usize>;

impl<const D: usize> Submanifold<D> for FlatTorus<D> {
    type Point = [f64; D];

    fn coordinates(&self, point: &[f64; D]) -> [f64; D] {
        *point
    }

    fn step(&self, from: &[f64; D], way: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|i| (from[i] + way[i]).rem_euclid(1.0))
    }

    fn offset(&self, from: &[f64; D], to: &[f64; D]) -> [f64; D] {
        difference(to, from).map(|x| x - x.round())
    }

    fn images(&self, x: &[f64; D], reach: f64) -> Vec<[f64; D]> {
        let mut all = vec![*x];
        for axis in 0..D {
            let shifts = [1.0, -1.0].into_iter().filter(|shift| (-reach..=1.0 + reach).contains(&(x[axis] + shift)));
            let shifted = |shift: f64| {
                all.iter().map(move |y| {
                    let mut y = *y;
                    y[axis] += shift;
                    y
                })
            };
            let more: Vec<[f64; D]> = shifts.flat_map(shifted).collect();
            all.extend(more);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torus_has_no_border() {
        assert_eq!(FlatTorus.step(&[0.75, 0.5], &[0.5, -0.75]), [0.25, 0.75]);
        assert_eq!(FlatTorus.offset(&[0.875, 0.5], &[0.125, 0.25]), [0.25, -0.25]);
        assert_eq!(FlatTorus.images(&[0.5, 0.5], 0.25), [[0.5, 0.5]]);
        let corner = FlatTorus.images(&[0.125, 0.875], 0.25);
        assert_eq!(corner, [[0.125, 0.875], [1.125, 0.875], [0.125, -0.125], [1.125, -0.125]]);
    }

    #[test]
    fn a_square_ends_at_its_border() {
        assert_eq!(UnitCube.step(&[0.75, 0.5], &[0.5, -0.25]), [1.0, 0.25]);
    }
}
