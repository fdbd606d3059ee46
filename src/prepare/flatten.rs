//! Measures the thickness of a cloud, and removes noise that is stronger than its spacing.
//!
//! The thickness of some neighbouring points is their spread in the direction of least spread, relative to the second least.
//! On a surface without noise, the nearest neighbours are flat, and larger neighbourhoods less so, since the surface bends.
//! On a noisy one it is the other way round: the nearest neighbours form a ball, and the more there are, the more they
//! resemble a sheet again. Points that fill a volume form a ball at any number. So the smallest flat neighbourhood is the
//! scale at which there is a surface.
//!
//! Noise is removed by moving each point onto the plane through that many neighbours, as in moving least squares of degree
//! one. This is repeated once from the new positions, since points far from the surface have neighbours only on their side
//! at first. Each round moves curved regions inwards by about the same amount, so the displacement of a third round is given
//! back for both.
//!
//! Based on: M. Alexa et al., Computing and rendering point set surfaces, 2003, DOI 10.1109/TVCG.2003.1175093 (projection);
//! M. Pauly, M. Gross, L. Kobbelt, Efficient simplification of point-sampled surfaces, 2002,
//! DOI 10.1109/VISUAL.2002.1183771 (surface variation over growing neighbourhoods).
//!
//! Cost: a thousand points are examined for each number of neighbours; one query per point and round. Limits: details
//! smaller than the neighbourhoods are removed with the noise.

use crate::base::parallel;
use crate::geom::eigen::{eigen, scatter};
use crate::spatial::kdtree::Neighbors;
use glam::DVec3;

/// Number of neighbours at which a cloud is a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flatness {
    /// The nearest few, or it cannot be told.
    AtOnce,
    /// The nearest few, but more neighbours are flatter: there is some noise.
    NotQuite,
    /// This many: the noise is larger than the spacing.
    At(usize),
    /// None: the points fill a volume.
    Never,
}

/// Numbers of neighbours examined: the first one, doubled up to the second.
const FEWEST: usize = 8;
const MOST: usize = 512;

/// At most one in this many of all points is a neighbour: larger neighbourhoods bend with the whole cloud.
const SHARE: usize = 4;

/// Number of points whose neighbours are examined.
const LOOKED_AT: usize = 1000;

/// Maximum thickness of flat neighbours: that of eight points of a surface with noise of a third of their spacing.
const FLAT: f64 = 0.4;

/// Thickness of eight points of a surface with noise of an eighth of their spacing.
const NOISE: f64 = 0.2;

/// Points whose thickness is larger at every number of neighbours fill a volume: eight random points of one have 0.65, and
/// more of them more.
const SOLID: f64 = 0.55;

/// Finds the smallest number of neighbours that are flat, around half of the points.
pub fn flatness(points: &[DVec3], near: &Neighbors) -> Flatness {
    let most = MOST.min(points.len() / SHARE);
    let mut least = 0.0f64;
    let mut count = FEWEST;
    while count <= most {
        let found = thickness(points, near, count);
        if found <= FLAT {
            let is_noisy = || found > NOISE && thickness(points, near, 2 * count) < found;
            return match count {
                FEWEST if is_noisy() => Flatness::NotQuite,
                FEWEST => Flatness::AtOnce,
                _ => Flatness::At(count),
            };
        }
        least = if count == FEWEST { found } else { least.min(found) };
        count *= 2;
    }
    if least > SOLID { Flatness::Never } else { Flatness::AtOnce }
}

/// Returns the median thickness of the `count` nearest neighbours, over some of the points.
fn thickness(points: &[DVec3], near: &Neighbors, count: usize) -> f64 {
    let step = points.len().div_ceil(LOOKED_AT);
    let of_point = |i: usize| {
        let ([least, middle, _], _) = plane(points, near, points[step * i], count).1;
        (least.max(0.0) / middle.max(f64::MIN_POSITIVE)).sqrt()
    };
    let mut found = parallel::map(0..points.len().div_ceil(step), of_point);
    found.sort_unstable_by(f64::total_cmp);
    found[found.len() / 2]
}

/// Returns the mean of the `count` points nearest to `p`, and the principal values and directions of their spread.
fn plane(points: &[DVec3], near: &Neighbors, p: DVec3, count: usize) -> (DVec3, ([f64; 3], [DVec3; 3])) {
    let mut found = Vec::new();
    near.collect_nearest(p, count, &mut found);
    let (offset, scatter) = scatter(found.iter().map(|n| points[n.point as usize] - p));
    (p + offset, eigen(scatter))
}

/// Moves the points onto the surface at the scale at which `count` neighbours are flat.
pub fn flattened(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let once = onto_planes(points, count);
    let twice = onto_planes(&once, count);
    let again = onto_planes(&twice, count);
    twice.iter().zip(&again).map(|(twice, again)| *twice + 2.0 * (*twice - *again)).collect()
}

/// Moves each point onto the plane through the `count` points nearest to it.
fn onto_planes(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let near = Neighbors::new(points);
    let moved = |p: &DVec3| {
        let (mean, (_, directions)) = plane(points, &near, *p, count);
        *p - (*p - mean).dot(directions[0]) * directions[0]
    };
    parallel::map(points, moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::testing::random_point;

    /// Random points near the unit sphere, uniformly within `half` of it.
    fn shell(count: usize, half: f64) -> Vec<DVec3> {
        let mut rng = stream(5, Stage::Candidates);
        let mut points = Vec::new();
        while points.len() < count {
            let p = 2.0 * random_point(&mut rng) - 1.0;
            if (0.1..1.0).contains(&p.length()) {
                points.push(p.normalize() * (1.0 + half * (2.0 * unit(&mut rng) - 1.0)));
            }
        }
        points
    }

    fn of(points: &[DVec3]) -> Flatness {
        flatness(points, &Neighbors::new(points))
    }

    #[test]
    fn a_surface_a_noisy_one_and_a_volume_are_told_apart() {
        assert_eq!((of(&shell(4000, 0.0)), of(&shell(4000, 0.02))), (Flatness::AtOnce, Flatness::NotQuite));
        assert!(matches!(of(&shell(4000, 0.12)), Flatness::At(32..=256)), "{:?}", of(&shell(4000, 0.12)));
        let mut rng = stream(6, Stage::Candidates);
        let mut volume = |count: usize| -> Vec<DVec3> { (0..count).map(|_| random_point(&mut rng)).collect() };
        assert_eq!((of(&volume(3000)), of(&volume(100))), (Flatness::Never, Flatness::Never));
        // Too few to tell.
        assert_eq!((of(&volume(20)), of(&[])), (Flatness::AtOnce, Flatness::AtOnce));
    }

    #[test]
    fn noise_goes_and_the_radius_stays() {
        let points = shell(4000, 0.08);
        let Flatness::At(count) = of(&points) else { panic!("{:?}", of(&points)) };
        let flat = flattened(&points, count);
        let mean = flat.iter().map(|p| p.length()).sum::<f64>() / 4000.0;
        let noise = (flat.iter().map(|p| (p.length() - mean) * (p.length() - mean)).sum::<f64>() / 4000.0).sqrt();
        assert!((mean - 1.0).abs() < 0.01 && noise < 0.012, "{mean} {noise}");
        assert_eq!(of(&flat), Flatness::AtOnce);
    }
}
