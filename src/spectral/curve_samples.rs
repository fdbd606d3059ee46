//! Samples the curves of a surface: its boundary and its sharp edges. The samples are evenly spaced, as the measure (paper,
//! section 3) makes them in one dimension; lengths are relative to the wanted size.
//!
//! Corners become points as they are, and interface edges get no points between their ends. Every smooth patch gets its own
//! samples of the points along its boundary, so that it is sampled and triangulated by itself; [`CurveSamples::point`] says
//! which samples are the same point.
//!
//! Cost: linear in the sides on curves, and one sort of the points.

use crate::mesh::half_edge::{OnCurve, next};
use crate::mesh::sides::lower_first;
use crate::mesh::topology::NONE;
use crate::surface::domain::{Domain, Sample};
use crate::surface::feature_curves::Curve;
use std::collections::BTreeMap;

/// Samples on the curves of a surface.
#[derive(Debug, Clone, Default)]
pub struct CurveSamples {
    /// Samples of each patch, loop by loop, in the order along each loop.
    pub samples: Vec<Sample>,
    /// For each sample, the side `3 t + k` of the domain that it lies on, and how far along, in 0..1.
    pub sites: Vec<(u32, f64)>,
    /// For each sample, the next one on its loop; the patch is to the left of the way there.
    pub successor: Vec<u32>,
    /// For each sample, the number of its point.
    pub point: Vec<u32>,
    /// Pairs of consecutive points along a curve, and the curve or interface.
    pub edges: Vec<([u32; 2], OnCurve)>,
    /// Points that are corners.
    pub corners: Vec<u32>,
}

/// Minimum number of points of a closed curve, and of samples of a loop: with fewer it would enclose nothing.
const FEWEST: usize = 3;

/// A point on a side of the domain: the side, how far along, and the number of the point.
type OnSide = (u32, f64, u32);

/// Samples all curves at distances of about `spacing` times the wanted size along them.
pub fn sample_curves(domain: &Domain, spacing: f64) -> CurveSamples {
    let loops = domain.boundary_loops();
    let counts = counts(domain, &loops, spacing);
    let mut result = CurveSamples::default();
    let mut corner_points = BTreeMap::new();
    let mut on_sides: Vec<OnSide> = Vec::new();
    let mut points = 0;
    for (number, curve) in (0u32..).zip(&domain.curves.list) {
        let count = counts[number as usize];
        let mut corner = |at: u32| {
            *corner_points.entry(at).or_insert_with(|| {
                points += 1;
                points - 1
            })
        };
        let ends = (!curve.closed).then(|| curve_ends(domain, curve).map(&mut corner));
        let inner = if curve.closed { count } else { count - 1 } as u32;
        let own: Vec<u32> = (points..points + inner).collect();
        points += inner;
        place(domain, curve, count, &own, &mut on_sides);
        let chain: Vec<u32> = match ends {
            Some([first, last]) => [first].into_iter().chain(own).chain([last]).collect(),
            None => own.iter().chain(own.first()).copied().collect(),
        };
        let name = if curve.interface { OnCurve::Interface } else { OnCurve::Curve(number) };
        result.edges.extend(chain.windows(2).map(|pair| ([pair[0], pair[1]], name)));
    }
    on_sides.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    result.corners = corner_points.values().copied().collect();
    for sides in &loops {
        sample_loop(domain, sides, &on_sides, &corner_points, &mut result);
    }
    result
}

/// Returns the number of edges that each curve becomes: its relative length in spacings, but enough that no two curves
/// become the same edge and every loop encloses something.
fn counts(domain: &Domain, loops: &[Vec<u32>], spacing: f64) -> Vec<usize> {
    let curves = &domain.curves.list;
    let mut between: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    let key = |curve: &Curve| lower_first(curve_ends(domain, curve));
    curves.iter().filter(|c| !c.closed).for_each(|c| *between.entry(key(c)).or_default() += 1);
    let fewest = |curve: &Curve| {
        if curve.closed || key(curve)[0] == key(curve)[1] { FEWEST } else { 1 + usize::from(between[&key(curve)] > 1) }
    };
    let wanted = |curve: &Curve| {
        if curve.interface {
            return 1;
        }
        let length: f64 = curve.sides.iter().map(|&s| length(domain, s)).sum();
        ((length / spacing).round() as usize).max(fewest(curve))
    };
    let mut counts: Vec<usize> = curves.iter().map(wanted).collect();
    for sides in loops {
        // Each curve, as often as the loop runs along it.
        let starts = sides.iter().filter(|&&s| is_first(domain, s)).map(|&s| domain.curves.of_side(s) as usize);
        let along: Vec<usize> = starts.collect();
        let may_grow = along.iter().any(|&c| !curves[c].interface);
        while may_grow && along.iter().map(|&c| counts[c]).sum::<usize>() < FEWEST {
            along.iter().filter(|&&c| !curves[c].interface).for_each(|&c| counts[c] += 1);
        }
    }
    counts
}

/// Returns whether `side` is the first one on its curve along a loop.
fn is_first(domain: &Domain, side: u32) -> bool {
    let curve = &domain.curves.list[domain.curves.of_side(side) as usize];
    let last = curve.sides[curve.sides.len() - 1];
    side == curve.sides[0] || domain.across.get(last) == side
}

/// Returns the length of `side`, relative to the wanted size along it.
fn length(domain: &Domain, side: u32) -> f64 {
    let ends = domain.mesh.ends(side);
    let [a, b] = ends.map(|v| domain.mesh.positions[v as usize]);
    let [size_a, size_b] = ends.map(|v| domain.size_at(v));
    2.0 * a.distance(b) / (size_a + size_b)
}

/// Returns the vertices where `curve` begins and ends, by their numbers before the cut.
fn curve_ends(domain: &Domain, curve: &Curve) -> [u32; 2] {
    let last = curve.sides[curve.sides.len() - 1];
    [curve.sides[0], next(last)].map(|s| domain.original[domain.mesh.origin(s) as usize])
}

/// Places `points` evenly on the sides of a curve that is divided into `count` edges.
fn place(domain: &Domain, curve: &Curve, count: usize, points: &[u32], on_sides: &mut Vec<OnSide>) {
    let lengths: Vec<f64> = curve.sides.iter().map(|&s| length(domain, s)).collect();
    let total: f64 = lengths.iter().sum();
    let first = if curve.closed { 0.5 } else { 1.0 };
    let (mut covered, mut i) = (0.0, 0);
    for (k, &point) in points.iter().enumerate() {
        let at = total * (k as f64 + first) / count as f64;
        while i + 1 < lengths.len() && covered + lengths[i] < at {
            covered += lengths[i];
            i += 1;
        }
        let along = ((at - covered) / lengths[i].max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let side = curve.sides[i];
        on_sides.push((side, along, point));
        if domain.across.get(side) != NONE {
            on_sides.push((domain.across.get(side), 1.0 - along, point));
        }
    }
}

/// Adds the samples of the patch to the left of the loop `sides`.
fn sample_loop(
    domain: &Domain,
    sides: &[u32],
    on_sides: &[OnSide],
    corner_points: &BTreeMap<u32, u32>,
    result: &mut CurveSamples,
) {
    let first = result.samples.len() as u32;
    for &side in sides {
        let at = domain.mesh.origin(side);
        let begin = on_sides.partition_point(|p| p.0 < side);
        let at_corner = domain.curves.is_corner(at).then(|| (side, 0.0, corner_points[&domain.original[at as usize]]));
        for (_, along, point) in
            at_corner.into_iter().chain(on_sides[begin..].iter().copied().take_while(|p| p.0 == side))
        {
            result.samples.push(domain.sample_on_side(side, along));
            result.sites.push((side, along));
            result.point.push(point);
        }
    }
    let count = result.samples.len() as u32 - first;
    result.successor.extend((0..count).map(|k| first + (k + 1) % count));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::prepare::repair::repair;
    use crate::surface::features::Features;
    use crate::testing::cube;
    use approx::assert_relative_eq;

    #[test]
    fn each_face_of_a_cube_gets_its_own_samples_of_the_same_points() {
        let domain = Domain::with_features(cube().try_into().unwrap(), Features::Automatic, 0.25);
        let made = sample_curves(&domain, 0.25);
        assert_eq!((made.samples.len(), made.edges.len(), made.corners.len()), (6 * 16, 12 * 4, 8));
        for (i, a) in made.samples.iter().enumerate() {
            for j in (0..i).filter(|&j| made.point[j] == made.point[i]) {
                assert!(a.position.distance(made.samples[j].position) < 1e-12);
                assert_ne!(domain.patch_of(a.triangle), domain.patch_of(made.samples[j].triangle));
            }
            let along = made.samples[made.successor[i] as usize].position;
            assert_relative_eq!(a.position.distance(along), 0.25, epsilon = 1e-12);
        }
    }

    #[test]
    fn curves_too_short_for_the_spacing_still_bound_something() {
        let domain = Domain::with_features(cube().try_into().unwrap(), Features::Automatic, 2.0);
        let made = sample_curves(&domain, 2.0);
        assert_eq!((made.samples.len(), made.edges.len(), made.corners.len()), (24, 12, 8));
        let open = Domain::new(repair(&Mesh { triangles: cube().triangles[..2].to_vec(), ..cube() }).0);
        assert_eq!(sample_curves(&open, 10.0).samples.len(), 4);
    }
}
