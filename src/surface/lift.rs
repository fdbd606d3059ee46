//! Surfaces in space as manifolds in more dimensions: x = [p, (σp/σn) n, (σp/σc) c], so that one kernel of width σp
//! works on positions p, normals n and further signals c at once (paper, section 3).
//!
//! A step goes along its first three coordinates only. To first order in the step nothing is lost: offsets between
//! neighbours are tangential to the lifted surface, the lift of a tangential step is that step with what it takes in the
//! other dimensions, and so the gradient, a sum of such offsets, is the lift of its first three coordinates.
//!
//! Based on: Y.-K. Lai, Q.-Y. Zhou, S.-M. Hu, J. Wallner, H. Pottmann, Robust feature classification and editing, IEEE
//! Transactions on Visualization and Computer Graphics 13 (1), 2007 (the six dimensions).

use crate::geom::vector::difference;
use crate::surface::domain::{Domain, Sample};
use crate::surface::submanifold::Submanifold;
use glam::DVec3;

/// A surface in space.
pub trait Surface: Sync {
    /// Where a step of `way` from `from`, tangential or about so, comes down on the surface.
    fn follow(&self, from: &Sample, way: DVec3) -> Sample;

    /// Whether two samples count as neighbours if they are near: those that face the same way.
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

/// Points of which nothing is known but themselves: they stay where they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BarePoints;

impl Surface for BarePoints {
    fn follow(&self, from: &Sample, _way: DVec3) -> Sample {
        *from
    }
}

/// Most signals beside position and normal.
pub const MOST_SIGNALS: usize = 4;

/// Gives the signals at a sample, in units of their σ over σp: fills the slice, whose rest is zero.
pub type Signals<'a> = &'a (dyn Fn(&Sample, &mut [f64]) + Sync);

/// What counts in the kernel beside the position.
#[derive(Clone, Copy, Default)]
pub struct Lift<'a> {
    /// σp/σn: a length; 0 for σn = ∞.
    pub normals: f64,
    /// Further signals, if there are any.
    pub signals: Option<Signals<'a>>,
}

impl Lift<'_> {
    /// Only the position counts.
    pub const NONE: Lift<'static> = Lift { normals: 0.0, signals: None };

    /// The first D coordinates of `sample`: the position, then the normal, then the signals. D is 3, 6 or
    /// 6 + [`MOST_SIGNALS`].
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

    /// The way from one sample to another. A point of a sharp edge has no normal, and turns with whoever looks at it.
    #[inline]
    pub fn offset<const D: usize>(&self, from: &Sample, to: &Sample) -> [f64; D] {
        let mut offset = difference(&self.coordinates::<D>(to), &self.coordinates(from));
        if D >= 6 && (from.normal == DVec3::ZERO || to.normal == DVec3::ZERO) {
            offset[3..6].fill(0.0);
        }
        offset
    }

    /// How much wider than σp the kernel is at `sample`: as its wanted edge length says, if only the position counts;
    /// else the other dimensions say how dense samples are.
    #[inline]
    pub fn width<const D: usize>(&self, sample: &Sample) -> f64 {
        if D == 3 { sample.size } else { 1.0 }
    }
}

/// A surface, lifted.
pub struct Lifted<'a, S> {
    /// The surface.
    pub surface: &'a S,
    /// What counts beside the position.
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
