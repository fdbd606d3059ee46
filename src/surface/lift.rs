//! Surfaces in space as manifolds in more dimensions: x = [p, (σp/σn) n, (σp/σc) c]. A single kernel of width σp then covers
//! positions p, normals n and further signals c (paper, section 3).
//!
//! A step uses only its first three coordinates. To first order in the step, nothing is lost: offsets between neighbours are
//! tangential to the lifted surface, and the lift of a tangential step is that step with the resulting changes in the other
//! dimensions. So the gradient, a sum of such offsets, is the lift of its first three coordinates.
//!
//! Based on: Y.-K. Lai, Q.-Y. Zhou, S.-M. Hu, J. Wallner, H. Pottmann, Robust feature classification and editing, IEEE
//! Transactions on Visualization and Computer Graphics 13 (1), 2007 (the six dimensions).

use crate::geom::vector::difference;
use crate::mesh::points::Points;
use crate::surface::domain::{Domain, Sample};
use crate::surface::submanifold::Submanifold;
use glam::DVec3;

/// A surface in space.
pub trait Surface: Sync {
    /// Moves `from` by `way`, which is tangential or nearly so, and projects the result back onto the surface.
    fn follow(&self, from: &Sample, way: DVec3) -> Sample;

    /// Returns whether two nearby samples count as neighbours: only if they face the same way.
    fn joined(&self, one: &Sample, other: &Sample) -> bool {
        one.normal.dot(other.normal) >= 0.0
    }
}

impl Surface for Domain {
    fn follow(&self, from: &Sample, way: DVec3) -> Sample {
        Domain::follow(self, from, way.reject_from_normalized(from.normal))
    }

    fn joined(&self, one: &Sample, other: &Sample) -> bool {
        self.patch_of(one.triangle) == self.patch_of(other.triangle) && one.normal.dot(other.normal) >= 0.0
    }
}

/// Points without a known surface: they stay where they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BarePoints;

impl Surface for BarePoints {
    fn follow(&self, from: &Sample, _way: DVec3) -> Sample {
        *from
    }
}

/// Maximum number of signals besides position and normal.
pub const MOST_SIGNALS: usize = 4;

/// Writes the signals at a sample, multiplied by σp over their σ, to the slice, which is zero at the start.
pub type Signals<'a> = &'a (dyn Fn(&Sample, &mut [f64]) + Sync);

/// The quantities in the kernel besides the position.
#[derive(Clone, Copy, Default)]
pub struct Lift<'a> {
    /// σp/σn, a length; 0 for σn = ∞.
    pub normals: f64,
    /// Further signals, if there are any.
    pub signals: Option<Signals<'a>>,
}

impl Lift<'_> {
    /// Position only.
    pub const NONE: Lift<'static> = Lift { normals: 0.0, signals: None };

    /// Returns the first D coordinates of `sample`: position, normal, signals. D is 3, 6 or 6 + [`MOST_SIGNALS`].
    #[inline]
    pub fn coordinates<const D: usize>(&self, sample: &Sample) -> [f64; D] {
        let mut x = [0.0; D];
        x[..3].copy_from_slice(&sample.position.to_array());
        if D >= 6 {
            x[3..6].copy_from_slice(&(self.normals * sample.normal).to_array());
        }
        if let (true, Some(signals)) = (D > 6, self.signals) {
            signals(sample, &mut x[6..]);
        }
        x
    }

    /// Returns the offset from one sample to another. A point on a sharp edge has no normal: it takes that of the other
    /// sample.
    #[inline]
    pub fn offset<const D: usize>(&self, from: &Sample, to: &Sample) -> [f64; D] {
        let mut offset = difference(&self.coordinates::<D>(to), &self.coordinates(from));
        if D >= 6 && (from.normal == DVec3::ZERO || to.normal == DVec3::ZERO) {
            offset[3..6].fill(0.0);
        }
        offset
    }

    /// Kernel width at `sample`, relative to σp: the target edge length if only the position counts; otherwise 1, since the
    /// other dimensions determine the density of the samples.
    #[inline]
    pub fn width<const D: usize>(&self, sample: &Sample) -> f64 {
        if D == 3 { sample.size } else { 1.0 }
    }
}

/// A lifted surface.
pub struct Lifted<'a, S> {
    /// The surface.
    pub surface: &'a S,
    /// The quantities in the kernel besides the position.
    pub lift: Lift<'a>,
}

impl<S: Surface, const D: usize> Submanifold<D> for Lifted<'_, S> {
    type Point = Sample;

    fn coordinates(&self, point: &Sample) -> [f64; D] {
        self.lift.coordinates(point)
    }

    fn step(&self, from: &Sample, way: &[f64; D]) -> Sample {
        self.surface.follow(from, DVec3::from_slice(way))
    }

    fn joined(&self, one: &Sample, other: &Sample) -> bool {
        self.surface.joined(one, other)
    }
}

/// Returns the points as samples whose triangle is their number. Points without normals get a zero normal, for which all
/// points count as neighbours.
pub fn bare_samples(input: &Points) -> Vec<Sample> {
    let sample = |(i, &position): (usize, &DVec3)| Sample {
        position,
        normal: input.normals().get(i).map_or(DVec3::ZERO, |n| n.normalize_or_zero()),
        triangle: i as u32,
        size: 1.0,
    };
    input.positions().iter().enumerate().map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    fn sample(position: DVec3, normal: DVec3) -> Sample {
        Sample { position, normal, triangle: 7, size: 2.0 }
    }

    #[test]
    fn position_normal_and_signals_are_coordinates() {
        let values = |sample: &Sample, values: &mut [f64]| values[1] = f64::from(sample.triangle);
        let lift = Lift { normals: 0.5, signals: Some(&values) };
        let x: [f64; 10] = lift.coordinates(&sample(dvec3(1.0, 2.0, 3.0), DVec3::Z));
        assert_eq!(x, [1.0, 2.0, 3.0, 0.0, 0.0, 0.5, 0.0, 7.0, 0.0, 0.0]);
        let x: [f64; 3] = lift.coordinates(&sample(DVec3::X, DVec3::Z));
        assert_eq!(x, [1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_point_of_a_sharp_edge_turns_with_whoever_looks_at_it() {
        let lift = Lift { normals: 2.0, signals: None };
        let (up, side, edge) =
            (sample(DVec3::X, DVec3::Z), sample(DVec3::ZERO, DVec3::X), sample(DVec3::ZERO, DVec3::ZERO));
        assert_eq!(lift.offset::<6>(&up, &side), [-1.0, 0.0, 0.0, 2.0, 0.0, -2.0]);
        assert_eq!(lift.offset::<6>(&up, &edge), [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(lift.offset::<6>(&edge, &up), [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn wanted_lengths_are_for_the_plain_kernel() {
        let sample = sample(DVec3::X, DVec3::Z);
        assert_eq!([Lift::NONE.width::<3>(&sample), Lift::NONE.width::<6>(&sample)], [2.0, 1.0]);
    }
}
