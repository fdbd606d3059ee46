//! How thick a cloud is, and noise that is stronger than its spacing taken out of it.
//!
//! The thickness of some neighbouring points is how far they spread along the direction of their least spread, as a share
//! of the second least. For points of a surface without noise the nearest neighbours are flat and more of them less so,
//! since the surface bends. For noisy ones it is the other way: the nearest are a ball, and the more there are the more
//! they are a sheet again. Points that fill a volume are a ball at any number. So the least number of neighbours that are
//! flat is the scale at which there is a surface.
//!
//! Noise goes by moving each point onto the plane through so many neighbours, as moving least squares of degree one do,
//! from where it then is once more, since those far from the surface have neighbours on their side only at first. What
//! bends is moved inwards by about the same in each round, so what a third round takes is given back for both.
//!
//! Based on: M. Alexa et al., Computing and rendering point set surfaces, 2003, DOI 10.1109/TVCG.2003.1175093 (projection);
//! M. Pauly, M. Gross, L. Kobbelt, Efficient simplification of point-sampled surfaces, 2002,
//! DOI 10.1109/VISUAL.2002.1183771 (surface variation over growing neighbourhoods).
//!
//! Cost: a look at a thousand points for each number of neighbours; a query for each point in each round. Limits: details
//! smaller than the neighbourhoods go with the noise.

use crate::base::parallel;
use crate::geom::eigen::{eigen, scatter};
use crate::spatial::kdtree::Neighbors;
use glam::DVec3;

/// At what number of neighbours a cloud is a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flatness {
    /// With the nearest few neighbours, or it cannot be told.
    AtOnce,
    /// With these, too, but more neighbours are flatter: there is some noise.
    NotQuite,
    /// With this many: the noise is larger than the spacing.
    At(usize),
    /// With no number: the points fill a volume.
    Never,
}

/// Numbers of neighbours that are looked at: this one, twice as many and so on.
const FEWEST: usize = 8;
const MOST: usize = 512;

/// Neighbours are at most this share of all points: more bend with the whole of it.
const SHARE: usize = 4;

/// Points whose neighbours are looked at.
const LOOKED_AT: usize = 1000;

/// Neighbours of at most this thickness are flat. Eight points of a surface with noise of a third of their spacing have it.
const FLAT: f64 = 0.4;

/// Eight points of a surface with noise of an eighth of their spacing have this thickness.
const NOISE: f64 = 0.2;

/// A larger thickness at any number is that of a volume: eight random points of one have 0.65, and more of them more.
const SOLID: f64 = 0.55;

/// The least number of neighbours that are flat, around half of the points.
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

/// The median thickness of the `count` nearest neighbours of points.
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

/// The mean of the `count` points nearest to `p`, and the principal values and directions of their spread.
fn plane(points: &[DVec3], near: &Neighbors, p: DVec3, count: usize) -> (DVec3, ([f64; 3], [DVec3; 3])) {
    let mut found = Vec::new();
    near.collect_nearest(p, count, &mut found);
    let (offset, scatter) = scatter(found.iter().map(|n| points[n.point as usize] - p));
    (p + offset, eigen(scatter))
}

/// The points on the surface that so many neighbours are flat around.
pub fn flattened(points: &[DVec3], count: usize) -> Vec<DVec3> {
    let once = onto_planes(points, count);
    let twice = onto_planes(&once, count);
    let again = onto_planes(&twice, count);
    twice.iter().zip(&again).map(|(twice, again)| *twice + 2.0 * (*twice - *again)).collect()
}

/// Each point moved onto the plane through the `count` points around it.
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
