//! The robust implicit surface of a point cloud.
//!
//! Let fᵢ = nᵢᵀ(x - pᵢ) be the residuals of the planes at the points. The surface is the zero set
//!
//! f(x) = Σ fᵢ φᵢ(x) w(rᵢ) wₙ(Δnᵢ) / Σ φᵢ(x) w(rᵢ) wₙ(Δnᵢ) = 0,
//!
//! where rᵢ = fᵢ - f and Δnᵢ = |nᵢ - ∇f| are those of the previous round, w and wₙ are Gaussians, and
//! φᵢ = (1 - |x - pᵢ|² / hᵢ²)⁴ within the support radius hᵢ of a point. Outliers, and points beyond a sharp edge, lose their
//! weight from round to round. The gradient treats w and wₙ as constants, as in the source. Departure: the first round
//! leaves out points that face away from the nearest one, which lie on the other side of a thin wall.
//!
//! Based on: A. C. Öztireli, G. Guennebaud, M. Gross, Feature preserving point set surfaces based on non-linear kernel
//! regression, 2009, DOI 10.1111/j.1467-8659.2009.01388.x, equations 5 to 8 and its pseudo-code; J. W. Tukey, Exploratory
//! data analysis, 1977 (twicing).
//!
//! Points that must stay close to the surface under the noise are projected twice. What the second projection removes was
//! not noise; since the first one removed about as much of it, that is added back ("twicing").
//!
//! Cost: a query and a sum over some forty points for each round of a value, a few rounds; a projection takes a few values.
//!
//! Limits: there is no surface outside the support of all points. Tangent planes lie outside a convex surface, so the
//! implicit one does, by about (h/4)² over the radius of curvature.

use crate::base::math;
use crate::base::parallel;
use crate::spatial::kdtree::{Neighbor, Neighbors};
use crate::surface::domain::Sample;
use crate::surface::lift::Surface;
use glam::DVec3;

/// Width of w, in support radii: about the level of the noise to be smoothed away (the source, section 5).
const SIGMA_R: f64 = 0.5;

/// Width of wₙ: sharp edges are kept, and noise of the normals is smoothed (the source, section 5).
const SIGMA_N: f64 = 0.8;

/// Maximum number of weighting rounds at one place, and of steps of a projection. More do not change the third digit.
const ROUNDS: usize = 3;
const STEPS: usize = 6;

/// Distance from the nearest point up to which the cloud is assumed to continue, in local spacings.
const BORDER: f64 = 0.9;

/// Factor by which the search radius exceeds what is needed, since the next query is usually nearby.
const SLACK: f64 = 1.1;

/// Shares of a step to try, the longest first, where the full step would cross a border.
const SHORTER: [f64; 3] = [1.0, 0.5, 0.25];

/// Accuracy of values and projections.
#[derive(Debug, Clone, Copy)]
struct Accuracy {
    /// A value or a projection has converged when a round changes it by less than this share of the nearest point's support
    /// radius.
    arrived: f64,
    /// Points farther away than this multiple of the nearest point's support radius do not count.
    farthest: f64,
}

/// For final positions.
const EXACT: Accuracy = Accuracy { arrived: 1e-4, farthest: 2.0 };

/// For a sample in motion, which is projected again after its next step. It takes half the time.
const PASSING: Accuracy = Accuracy { arrived: 1e-2, farthest: 1.0 };

/// The implicit surface of points with normals.
pub struct Rimls<'a> {
    /// Positions of the points.
    positions: &'a [DVec3],
    /// Their unit normals.
    normals: &'a [DVec3],
    /// Support radius of each point.
    supports: Vec<f64>,
    /// Support radius in spacings.
    support: f64,
    near: &'a Neighbors,
    longest: f64,
}

/// The points around the last place queried: working space for queries of one surface.
#[derive(Debug, Default)]
pub struct Found {
    /// All points within `radius` of `around`.
    all: Vec<Neighbor>,
    around: DVec3,
    radius: f64,
    /// The points that count at the place, the nearest first.
    list: Vec<Neighbor>,
}

/// f and ∇f at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Approximate signed distance to the surface, positive on the side that normals point to.
    pub f: f64,
    /// Gradient of f, of about unit length near the surface.
    pub gradient: DVec3,
    /// Weighted unit mean of the normals there: steadier than the gradient where there is noise.
    pub normal: DVec3,
}

impl<'a> Rimls<'a> {
    /// Creates the surface of points, each with a support radius of `support` times its spacing. `spacings` has the distance
    /// of each point to its neighbours; `near` indexes the positions.
    pub fn new(
        positions: &'a [DVec3],
        normals: &'a [DVec3],
        near: &'a Neighbors,
        spacings: &[f64],
        support: f64,
    ) -> Self {
        let supports: Vec<f64> = spacings.iter().map(|s| support * s).collect();
        let longest = supports.iter().copied().fold(0.0, f64::max);
        Rimls { positions, normals, supports, support, near, longest }
    }

    /// Returns the spacing of the points around point `p`.
    pub fn spacing(&self, p: u32) -> f64 {
        self.supports[p as usize] / self.support
    }

    /// Mean of [`Self::spacing`].
    pub fn mean_spacing(&self) -> f64 {
        self.supports.iter().sum::<f64>() / (self.support * self.supports.len() as f64)
    }

    /// Largest support radius of any point.
    pub fn largest_support(&self) -> f64 {
        self.longest
    }

    /// Returns the point nearest to `x` and its normal; `None` without points. `found` is working space.
    pub fn nearest(&self, x: DVec3, found: &mut Found) -> Option<(Neighbor, DVec3)> {
        self.nearest_point(x, found).map(|n| (n, self.normals[n.point as usize]))
    }

    /// Returns f and its gradient at `x`; `None` outside the support of all points. `found` is working space.
    pub fn value(&self, x: DVec3, found: &mut Found) -> Option<Value> {
        self.value_until(EXACT, x, found)
    }

    fn value_until(&self, accuracy: Accuracy, x: DVec3, found: &mut Found) -> Option<Value> {
        self.collect(accuracy, x, found);
        self.value_of(accuracy, x, &found.list, found.list.first()?.point)
    }

    /// Collects the points that values within `radius` of `centre` depend on.
    pub fn local(&self, centre: DVec3, radius: f64) -> Local {
        let mut local = Local::default();
        let found = &mut local.found;
        self.near.collect_nearest(centre, 1, found);
        let Some(distance) = found.first().map(|n| n.distance_squared.sqrt()) else { return local };
        // These include the nearest point of any place in the ball.
        self.near.collect_within(centre, distance + 2.0 * radius, found);
        let longest = found.iter().map(|n| self.supports[n.point as usize]).fold(0.0, f64::max);
        let support = (2.0 * longest).min(self.longest);
        if distance <= support + radius {
            self.near.collect_within(centre, support + radius, found);
            local.points.extend(found.iter().map(|n| n.point));
            local.points.sort_unstable();
        }
        local
    }

    /// Returns [`Self::value`] at a place in the ball of `local`, and the nearest point.
    pub fn value_in(&self, local: &mut Local, x: DVec3) -> Option<(Value, Neighbor)> {
        let Local { points, found } = local;
        let neighbor =
            |&point: &u32| Neighbor { point, distance_squared: self.positions[point as usize].distance_squared(x) };
        found.clear();
        found.extend(points.iter().map(neighbor));
        let nearest = *found.iter().min_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared))?;
        let radius = self.radius(EXACT, nearest.point);
        let counts = |n: &Neighbor| n.distance_squared < math::square(radius.min(self.supports[n.point as usize]));
        found.retain(counts);
        Some((self.value_of(EXACT, x, found, nearest.point)?, nearest))
    }

    /// Maximum distance of the points that count at a place whose nearest point is `nearest`. The points around that one
    /// have support radii close to its own.
    fn radius(&self, accuracy: Accuracy, nearest: u32) -> f64 {
        (accuracy.farthest * self.supports[nearest as usize]).min(self.longest)
    }

    /// Projects `x` onto the surface; returns the point and the unit normal there, or `None` outside the support of all
    /// points. `found` is working space.
    pub fn project(&self, x: DVec3, found: &mut Found) -> Option<(DVec3, DVec3)> {
        self.project_until(EXACT, x, found)
    }

    /// [`Self::project`], until a step is shorter than the given share of the support radius.
    fn project_until(&self, accuracy: Accuracy, x: DVec3, found: &mut Found) -> Option<(DVec3, DVec3)> {
        let mut at = x;
        let mut normal = DVec3::ZERO;
        for _ in 0..STEPS {
            let value = self.value_until(accuracy, at, found)?;
            let Value { f, gradient, .. } = value;
            let step = f * gradient / gradient.length_squared().max(f64::MIN_POSITIVE);
            let support = found.list.first().map_or(0.0, |n| self.supports[n.point as usize]);
            at -= step.clamp_length_max(support);
            normal = value.normal;
            if step.length() < accuracy.arrived * support {
                break;
            }
        }
        Some((at, normal))
    }

    /// Returns the sample of the surface near `x`, with the index of the nearest point as its triangle; `None` beyond the
    /// border of the cloud.
    pub fn sample(&self, x: DVec3) -> Option<Sample> {
        self.sample_until(EXACT, x, &mut Found::default())
    }

    fn sample_until(&self, accuracy: Accuracy, x: DVec3, found: &mut Found) -> Option<Sample> {
        let (position, normal) = self.project_until(accuracy, x, found)?;
        let (nearest, _) = self.nearest(position, found)?;
        let farthest = BORDER * self.spacing(nearest.point);
        let sample = Sample { position, normal, triangle: nearest.point, size: 1.0 };
        (nearest.distance_squared <= farthest * farthest).then_some(sample)
    }

    /// Returns, for each point, a nearby place that is on the surface to first order.
    pub fn seeds(&self) -> Vec<DVec3> {
        let seed = |found: &mut Found, &x: &DVec3| {
            let value = self.value(x, found).filter(|v| v.gradient != DVec3::ZERO);
            value.map_or(x, |Value { f, gradient, .. }| x - f * gradient / gradient.length_squared())
        };
        parallel::map_with(self.positions, Found::default, seed)
    }

    /// Returns the denoised points and their unit normals: projected, and moved back by what a second projection removes,
    /// which is not noise.
    pub fn smoothed(&self) -> (Vec<DVec3>, Vec<DVec3>) {
        let (once, normals) = self.projected();
        let near = Neighbors::new(&once);
        let surface =
            Rimls { positions: &once, normals: &normals, near: &near, supports: self.supports.clone(), ..*self };
        let (twice, softer) = surface.projected();
        let given_back = |(a, b): (&DVec3, DVec3)| 2.0 * *a - b;
        let positions = once.iter().zip(twice).map(given_back).collect();
        let sharper = normals.iter().zip(softer).map(given_back).map(DVec3::normalize_or_zero).collect();
        (positions, sharper)
    }

    /// Projects all points. A point outside the support of the surface keeps its place and normal.
    fn projected(&self) -> (Vec<DVec3>, Vec<DVec3>) {
        let project = |found: &mut Found, p: usize| {
            self.project(self.positions[p], found).unwrap_or((self.positions[p], self.normals[p]))
        };
        let projected = parallel::map_with(0..self.positions.len(), Found::default, project);
        projected.into_iter().unzip()
    }

    /// Collects the points whose support includes `x`, and the nearest one, in order of distance.
    fn collect(&self, accuracy: Accuracy, x: DVec3, found: &mut Found) {
        found.list.clear();
        let Some(nearest) = self.nearest_point(x, found) else { return };
        let radius = self.radius(accuracy, nearest.point);
        if nearest.distance_squared > radius * radius {
            return;
        }
        if found.around.distance(x) + radius > found.radius {
            self.look_around(x, SLACK * radius, found);
        }
        let counts = |n: &Neighbor| {
            let support = self.supports[n.point as usize].min(radius);
            n.point == nearest.point || n.distance_squared < support * support
        };
        found.list.extend(found.all.iter().map(|n| self.seen_from(x, n.point)).filter(counts));
        let list = &mut found.list;
        list.sort_unstable_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.point.cmp(&b.point)));
    }

    /// Finds all points within `radius` of `x`.
    fn look_around(&self, x: DVec3, radius: f64, found: &mut Found) {
        (found.around, found.radius) = (x, radius);
        self.near.collect_within(x, radius, &mut found.all);
    }

    /// Returns the point nearest to `x`, from the points found before if it is certain to be among them.
    fn nearest_point(&self, x: DVec3, found: &mut Found) -> Option<Neighbor> {
        let known = found.all.iter().map(|n| self.seen_from(x, n.point));
        let nearest =
            known.min_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.point.cmp(&b.point)));
        let is_certain = |n: &Neighbor| n.distance_squared.sqrt() + found.around.distance(x) < found.radius;
        nearest.filter(is_certain).or_else(|| {
            self.near.collect_nearest(x, 1, &mut found.list);
            found.list.pop()
        })
    }

    fn seen_from(&self, x: DVec3, point: u32) -> Neighbor {
        Neighbor { point, distance_squared: self.positions[point as usize].distance_squared(x) }
    }

    /// The first round leaves out points that face away from the nearest one: they are on the other side of a thin wall, and
    /// their planes would cancel those of this side.
    fn value_of(&self, accuracy: Accuracy, x: DVec3, found: &[Neighbor], nearest: u32) -> Option<Value> {
        let facing = self.normals[nearest as usize];
        let mut last: Option<Value> = None;
        for _ in 0..=ROUNDS {
            let mut sums = Sums::default();
            for n in found {
                let (p, support) = (n.point as usize, self.supports[n.point as usize]);
                let share = 1.0 - n.distance_squared / (support * support);
                if share <= 0.0 {
                    continue;
                }
                let (offset, normal) = (x - self.positions[p], self.normals[p]);
                let residual = normal.dot(offset);
                let at_first = if facing.dot(normal) < 0.0 { 0.0 } else { 1.0 };
                let robust = last.map_or(at_first, |last| {
                    let r = (residual - last.f) / (SIGMA_R * support);
                    let dn = normal.distance_squared(last.gradient) / (SIGMA_N * SIGMA_N);
                    math::gaussian(r * r + dn)
                });
                let cube = share * share * share;
                let slope = -8.0 * cube / (support * support) * offset;
                sums.add(robust * share * cube, robust * slope, residual, normal);
            }
            let value = sums.value()?;
            let has_converged = |last: Value| {
                (value.f - last.f).abs() < accuracy.arrived * self.supports[nearest as usize]
                    && value.gradient.distance_squared(last.gradient) < accuracy.arrived
            };
            if last.replace(value).is_some_and(has_converged) {
                break;
            }
        }
        last
    }
}

impl Surface for Rimls<'_> {
    /// Shortens a step that crosses the border of the cloud, or leaves it out. The result lies only near the surface;
    /// [`Rimls::sample`] gives final positions.
    fn follow(&self, from: &Sample, way: DVec3) -> Sample {
        let way = way.reject_from_normalized(from.normal);
        let mut found = Found::default();
        // The point that was nearest before is still near, so one search suffices.
        self.look_around(from.position + way, SLACK * self.radius(PASSING, from.triangle), &mut found);
        let place = |share: &f64| self.sample_until(PASSING, from.position + share * way, &mut found);
        SHORTER.iter().find_map(place).unwrap_or(*from)
    }
}

/// The points that values in a ball depend on, collected once for all of them.
#[derive(Debug, Default)]
pub struct Local {
    /// In ascending order.
    points: Vec<u32>,
    /// Working space.
    found: Vec<Neighbor>,
}

/// Weighted sums over points, from which a value is computed.
#[derive(Default)]
struct Sums {
    weight: f64,
    slope: DVec3,
    residual: f64,
    residual_slope: DVec3,
    normal: DVec3,
}

impl Sums {
    fn add(&mut self, weight: f64, slope: DVec3, residual: f64, normal: DVec3) {
        self.weight += weight;
        self.slope += slope;
        self.residual += weight * residual;
        self.residual_slope += residual * slope;
        self.normal += weight * normal;
    }

    fn value(&self) -> Option<Value> {
        let f = self.residual / self.weight;
        let gradient = (self.residual_slope - f * self.slope + self.normal) / self.weight;
        let normal = self.normal.try_normalize()?;
        (f.is_finite() && gradient.is_finite()).then_some(Value { f, gradient, normal })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Random, Stage, stream, unit};
    use approx::assert_relative_eq;

    /// Points of the unit sphere, arranged by the golden angle and moved along their normals by up to `noise`.
    fn sphere(count: u32, noise: f64, rng: &mut Random) -> (Vec<DVec3>, Vec<DVec3>) {
        (0..count)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
                let (sine, cosine) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
                let normal = DVec3::new((1.0 - z * z).sqrt() * cosine, (1.0 - z * z).sqrt() * sine, z);
                (normal * (1.0 + noise * (2.0 * unit(rng) - 1.0)), normal)
            })
            .unzip()
    }

    #[test]
    fn points_come_to_lie_on_the_sphere_and_noise_goes() {
        let mut rng = stream(1, Stage::Scan);
        let (positions, normals) = sphere(4000, 0.03, &mut rng);
        let near = Neighbors::new(&positions);
        let surface = Rimls::new(&positions, &normals, &near, &vec![0.06; positions.len()], 3.0);
        let off = |points: &[DVec3]| {
            (points.iter().map(|p| (p.length() - 1.0).powi(2)).sum::<f64>() / points.len() as f64).sqrt()
        };
        let (smooth, gradients) = surface.smoothed();
        assert!(off(&smooth) < 0.45 * off(&positions), "{} {}", off(&smooth), off(&positions));
        assert!(smooth.iter().zip(gradients).all(|(p, n)| p.normalize().dot(n) > 0.98));
    }

    #[test]
    fn what_bends_evenly_keeps_its_size() {
        let (positions, normals) = sphere(4000, 0.0, &mut stream(1, Stage::Scan));
        let near = Neighbors::new(&positions);
        let surface = Rimls::new(&positions, &normals, &near, &vec![0.06; positions.len()], 3.0);
        let off = |points: Vec<DVec3>| points.iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f64::max);
        let (once, twice) = (off(surface.projected().0), off(surface.smoothed().0));
        assert!(once > 1e-3 && twice < 0.1 * once, "{once} {twice}");
    }

    #[test]
    fn the_value_is_the_height_over_a_plane_and_the_gradient_its_normal() {
        let positions: Vec<DVec3> = (0..400).map(|i| DVec3::new(f64::from(i % 20), f64::from(i / 20), 2.0)).collect();
        let normals = vec![DVec3::Z; positions.len()];
        let near = Neighbors::new(&positions);
        let surface = Rimls::new(&positions, &normals, &near, &vec![1.0; positions.len()], 3.0);
        let Value { f, gradient, .. } = surface.value(DVec3::new(9.3, 8.6, 2.7), &mut Found::default()).unwrap();
        assert_relative_eq!(f, 0.7, epsilon = 1e-12);
        assert!(gradient.distance(DVec3::Z) < 1e-9);
        assert_eq!(surface.value(DVec3::new(9.3, 8.6, 6.0), &mut Found::default()), None);
    }

    #[test]
    fn a_step_comes_down_near_the_surface_and_not_beyond_its_border() {
        let (positions, normals) = sphere(4000, 0.0, &mut stream(1, Stage::Scan));
        let (positions, normals): (Vec<_>, Vec<_>) = positions.into_iter().zip(normals).filter(|p| p.0.x > 0.0).unzip();
        let near = Neighbors::new(&positions);
        let surface = Rimls::new(&positions, &normals, &near, &vec![0.06; positions.len()], 2.3);
        let from = surface.sample(DVec3::new(0.6, 0.8, 0.0)).unwrap();
        let inwards = surface.follow(&from, 0.1 * DVec3::new(0.8, -0.6, 0.0));
        assert!(
            (inwards.position.length() - 1.0).abs() < 2e-3 && (inwards.position.x - 0.68).abs() < 0.01,
            "{inwards:?}"
        );
        let over_border = surface.follow(&from, DVec3::new(-0.8, 0.6, 0.0));
        assert!(over_border.position.x > -0.06, "{over_border:?}");
    }

    #[test]
    fn values_in_a_ball_are_the_same() {
        let mut rng = stream(2, Stage::Scan);
        let (positions, normals) = sphere(900, 0.02, &mut rng);
        let near = Neighbors::new(&positions);
        let spacings: Vec<f64> = positions.iter().map(|p| 0.12 + 0.05 * p.x).collect();
        let surface = Rimls::new(&positions, &normals, &near, &spacings, 2.2);
        let mut found = Found::default();
        for centre in [DVec3::X, DVec3::new(-0.5, 0.8, 0.2), DVec3::new(0.0, 1.2, 0.0), DVec3::splat(9.0)] {
            let mut local = surface.local(centre, 0.2);
            for _ in 0..100 {
                let x = centre
                    + 0.2 * DVec3::new(unit(&mut rng), unit(&mut rng), unit(&mut rng)).normalize() * unit(&mut rng);
                let (one, other) = (surface.value(x, &mut found), surface.value_in(&mut local, x));
                assert_eq!(one.is_some(), other.is_some());
                let Some((one, (other, nearest))) = one.zip(other) else { continue };
                assert!((one.f - other.f).abs() < 1e-12 && nearest == found.list[0]);
            }
        }
    }

    #[test]
    fn a_sharp_edge_stays_one_and_an_outlier_has_no_say() {
        let side = |normal: DVec3, along: DVec3| {
            (0..900).map(move |i| (along * f64::from(i / 30) + DVec3::Y * f64::from(i % 30), normal))
        };
        let roof = side(DVec3::Z, DVec3::NEG_X).chain(side(DVec3::X, DVec3::NEG_Z).skip(30));
        let outlier = (DVec3::new(-6.0, 15.2, 0.9), DVec3::new(0.6, 0.0, 0.8));
        let (positions, normals): (Vec<DVec3>, Vec<DVec3>) = roof.chain([outlier]).unzip();
        let near = Neighbors::new(&positions);
        let surface = Rimls::new(&positions, &normals, &near, &vec![1.2; positions.len()], 3.0);
        let mut found = Found::default();
        let (beside_edge, _) = surface.project(DVec3::new(-1.0, 15.3, 0.3), &mut found).unwrap();
        assert!(beside_edge.z.abs() < 0.05, "{beside_edge}");
        let (below_outlier, _) = surface.project(DVec3::new(-6.0, 15.0, 0.3), &mut found).unwrap();
        assert!(below_outlier.z.abs() < 0.05, "{below_outlier}");
    }
}
