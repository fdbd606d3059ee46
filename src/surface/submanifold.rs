//! What samples lie on, in any dimension: a manifold in a space of D dimensions, as the sampler sees it.

use crate::geom::vector::difference;

/// A manifold in D dimensions. Distances between points of it, a few kernel widths apart at most, are those of the space
/// around it.
pub trait Submanifold<const D: usize>: Sync {
    /// A point of it, with what is needed to find back to the manifold from nearby.
    type Point: Copy + Send + Sync;

    /// Where `point` is in the D dimensions of the kernel.
    fn coordinates(&self, point: &Self::Point) -> [f64; D];

    /// Where a step of `way` from `from` comes down: its tangential part, and back on the manifold.
    fn step(&self, from: &Self::Point, way: &[f64; D]) -> Self::Point;

    /// The way between two places: shorter than their difference where the space is periodic.
    fn offset(&self, from: &[f64; D], to: &[f64; D]) -> [f64; D] {
        difference(to, from)
    }

    /// `x`, and what it repeats as in a periodic space: all of them that come within `reach` of where points are.
    fn images(&self, x: &[f64; D], _reach: f64) -> Vec<[f64; D]> {
        vec![*x]
    }

    /// Whether two points count as neighbours if they are near: not those of two sheets that nearly touch.
    fn joined(&self, _one: &Self::Point, _other: &Self::Point) -> bool {
        true
    }
}

/// The unit square, cube and so on: at its border a step ends.
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
/// Its kernel must not reach around it: [`Submanifold::offset`] knows the shortest way only.
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
