//! Sampling without triangulation: blue noise in any dimension, on meshes, and subsets of points.

#[path = "../../../examples/any_dimension/ten.rs"]
mod ten;

mod clouds;

use crate::common::{audit, cuboid, moved, random, sphere, together, torus};
use glam::{DVec3, dvec3};
use spectral_remesh::stages::base::rng::unit;
use spectral_remesh::stages::geom::vector::length_squared;
use spectral_remesh::stages::pipeline::{points_of_mesh, remesh, sample, sample_points};
use spectral_remesh::stages::spectral::ascent::{AscentParameters, PAPER_STEP};
use spectral_remesh::stages::spectral::free_ascent::ascend_freely;
use spectral_remesh::stages::spectral::subset::{scan, thin_or_fill};
use spectral_remesh::stages::surface::submanifold::{FlatTorus, Submanifold, UnitCube};
use spectral_remesh::{
    Attribute, Attributes, CloudOptions, Density, Grading, Input, Mesh, Options, Points, SampleDensity, SampleOptions,
    Sampled, Scalar, Signal, Values,
};
use std::f64::consts::TAU;

const SWEEPS: usize = 10;

/// Returns the radius of disks around `n` points on an area in hexagonal packing.
fn largest_radius(n: usize, area: f64) -> f64 {
    (area / (2.0 * 3f64.sqrt() * n as f64)).sqrt()
}

/// Returns ρ: half the distance of the closest pair of points, divided by the largest possible radius on that area.
fn poisson_disk_radius<S: Submanifold<D>, const D: usize>(manifold: &S, points: &[S::Point], area: f64) -> f64 {
    let places: Vec<[f64; D]> = points.iter().map(|p| manifold.coordinates(p)).collect();
    let pairs = (0..places.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let squares = pairs.map(|(i, j)| length_squared(&manifold.offset(&places[i], &places[j])));
    0.5 * squares.fold(f64::INFINITY, f64::min).sqrt() / largest_radius(points.len(), area)
}

/// Returns random points after ten sweeps with the kernel of section 7.1 of the paper: σ = 2.5 r for ρ = 0.75.
fn relaxed<S: Submanifold<D>, const D: usize>(manifold: &S, mut points: Vec<S::Point>, area: f64) -> Vec<S::Point> {
    let sigma = 2.5 * 0.75 * largest_radius(points.len(), area);
    ascend_freely(manifold, &mut points, AscentParameters { sigma, step: PAPER_STEP, sweeps: SWEEPS }, &()).unwrap();
    points
}

fn unit_points<const D: usize>(n: usize, seed: u64) -> Vec<[f64; D]> {
    let mut rng = random(seed);
    (0..n).map(|_| [0.0; D].map(|_: f64| unit(&mut rng))).collect()
}

#[test]
fn blue_noise_on_the_toroidal_square_is_that_of_the_paper() {
    let run = |seed| poisson_disk_radius(&FlatTorus, &relaxed(&FlatTorus, unit_points::<2>(1024, seed), 1.0), 1.0);
    let mean = (0..10).map(run).sum::<f64>() / 10.0;
    assert!(mean >= 0.79, "mean ρ {mean}");
}

/// Blue noise has no power below the main frequency, which is about √(2/√3) √N.
#[test]
fn low_frequencies_are_missing() {
    let points = relaxed(&FlatTorus, unit_points::<2>(400, 3), 1.0);
    let power = |f: [f64; 2]| {
        let phases = points.iter().map(|x| TAU * (f[0] * x[0] + f[1] * x[1]));
        let (sin, cos) = phases.map(f64::sin_cos).fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1));
        (sin * sin + cos * cos) / 400.0
    };
    let low = (1..=10).flat_map(|u| (0..=5).map(move |v| [f64::from(u), f64::from(v)]));
    let mean = low.map(power).sum::<f64>() / 60.0;
    assert!(mean < 0.03, "{mean}, random points have 1");
}

#[test]
fn a_square_with_borders_and_a_cube() {
    let square = relaxed(&UnitCube, unit_points::<2>(500, 1), 1.0);
    assert!(square.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
    assert!(poisson_disk_radius(&UnitCube, &square, 1.0) > 0.65);
    let mut cube = unit_points::<3>(500, 2);
    // Spacing in the densest packing of balls.
    let spacing = (2f64.sqrt() / 500.0).cbrt();
    let before = poisson_disk_radius(&FlatTorus, &cube, 1.0);
    ascend_freely(
        &FlatTorus,
        &mut cube,
        AscentParameters { sigma: 0.94 * spacing, step: PAPER_STEP, sweeps: SWEEPS },
        &(),
    )
    .unwrap();
    let nearest = poisson_disk_radius(&FlatTorus, &cube, 1.0) * 2.0 * largest_radius(500, 1.0) / spacing;
    assert!(nearest > 0.7, "{nearest} of the densest, {before} before");
}

#[test]
fn a_surface_in_ten_dimensions() {
    let (n, area) = (1000, ten::FiveCircles::area());
    let mut rng = random(4);
    let points: Vec<[f64; 2]> = (0..20 * n).map(|_| ten::FiveCircles::random(&mut rng)).collect();
    let relaxed = relaxed(&ten::FiveCircles, points[..n].to_vec(), area);
    let rho = poisson_disk_radius(&ten::FiveCircles, &relaxed, area);
    assert!(rho > 0.7, "{rho}");

    let sigma = 0.866 * 2.0 * largest_radius(n, area);
    let kept = scan(&ten::FiveCircles, &points, sigma, 7, &()).unwrap();
    assert!((900..1100).contains(&kept.len()), "{}", kept.len());
    for wanted in [850, 1150] {
        let exactly = thin_or_fill(&ten::FiveCircles, &points, &kept, sigma, wanted);
        let chosen: Vec<[f64; 2]> = exactly.iter().map(|&i| points[i as usize]).collect();
        assert_eq!(chosen.len(), wanted);
        assert!(poisson_disk_radius(&ten::FiveCircles, &chosen, area) > 0.4);
    }
}

fn sampled(mesh: &Mesh, options: &SampleOptions) -> Sampled {
    sample(mesh, options, &()).unwrap()
}

fn count(n: usize) -> SampleOptions {
    SampleOptions { density: SampleDensity::Points(n), ..SampleOptions::default() }
}

/// Space as a manifold of three dimensions.
struct Space;

impl Submanifold<3> for Space {
    type Point = DVec3;
    fn coordinates(&self, p: &DVec3) -> [f64; 3] {
        p.to_array()
    }
    fn step(&self, from: &DVec3, way: &[f64; 3]) -> DVec3 {
        *from + DVec3::from_array(*way)
    }
}

#[test]
fn exactly_as_many_samples_evenly_on_the_surface() {
    let centre = dvec3(1e3, -2e3, 5.0);
    let ball = sphere(6, centre, 20.0);
    for n in [3, 100, 999, 2000] {
        let Sampled { points, indices, wanted, notes, .. } = sampled(&ball, &count(n));
        assert_eq!((points.positions().len(), points.normals().len(), wanted), (n, n, Some(n)));
        assert!(indices.is_none() && notes.is_empty(), "{notes:?}");
        for (p, normal) in points.positions().iter().zip(points.normals()) {
            let out = (*p - centre) / 20.0;
            assert!((out.length() - 1.0).abs() < 1e-3 && normal.dot(out) > 0.999, "{p} {normal}");
        }
        let rho = poisson_disk_radius(&Space, points.positions(), ball.area());
        assert!(n == 3 || rho > 0.72, "{n}: {rho}");
    }
}

#[test]
fn the_samples_are_the_same_for_any_number_of_threads() {
    let ring = torus(90, 40, 1.0, 0.35);
    let options = SampleOptions { sigma_n: 0.6, levels: Some(3), ..count(700) };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sampled(&ring, &options))
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(5));
    assert_ne!(one, sampled(&ring, &SampleOptions { seed: 1, ..options }));
}

#[test]
fn a_subset_of_the_vertices_with_their_numbers() {
    let ball = sphere(5, DVec3::ZERO, 1.0);
    let Sampled { points, indices, candidates, .. } = sampled(&ball, &SampleOptions { scan_only: true, ..count(500) });
    let indices = indices.unwrap();
    assert_eq!((points.positions().len(), indices.len(), candidates), (500, 500, ball.positions.len()));
    assert!(indices.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(indices.iter().zip(points.positions()).all(|(&i, p)| *p == ball.positions[i as usize]));
    assert!(poisson_disk_radius(&Space, points.positions(), ball.area()) > 0.45);
}

#[test]
fn a_subset_has_the_attributes_of_its_points_but_its_own_numbers() {
    let ball = sphere(4, DVec3::ZERO, 1.0);
    let attribute = |name: &str| Attribute {
        name: name.into(),
        components: 1,
        values: ball.positions.iter().map(|p| p.z).collect(),
        scalar: Scalar::F64,
    };
    let attributes = Attributes { vertex: vec![attribute("height"), attribute("index")], ..Attributes::default() };
    let input = Input::from(&ball).with_attributes(&attributes);
    let of = |scan_only: bool| {
        let options = SampleOptions { scan_only, ..count(100) };
        spectral_remesh::sample(&input, &options, &()).unwrap()
    };
    let sampled = of(true);
    let heights: Vec<f64> = sampled.points.positions().iter().map(|p| p.z).collect();
    let found = sampled.attributes();
    assert_eq!(found.names(), ["index", "height"]);
    assert_eq!(found.get("height").unwrap().values, heights);
    assert_eq!(of(false).attributes().names(), ["height"]);
}

/// Returns the distance of each point to its nearest neighbour.
fn nearest(points: &[DVec3]) -> Vec<f64> {
    let others = |i: usize| (0..points.len()).filter(move |&j| j != i).map(move |j| points[i].distance(points[j]));
    (0..points.len()).map(|i| others(i).fold(f64::INFINITY, f64::min)).collect()
}

/// Returns the number of points within three spacings of places on the unit sphere: its standard deviation over its mean.
fn unevenness(points: &[DVec3], places: &[DVec3]) -> f64 {
    let reach = 6.0 * largest_radius(points.len(), 2.0 * TAU);
    let counts = places.iter().map(|p| points.iter().filter(|q| p.distance(**q) < reach).count() as f64);
    let (sum, squares) = counts.fold((0.0, 0.0), |s, n| (s.0 + n, s.1 + n * n));
    (places.len() as f64 * squares / (sum * sum) - 1.0).sqrt()
}

#[test]
fn any_first_part_of_progressive_samples_is_as_good_as_a_fresh_scan() {
    let ball = sphere(5, DVec3::ZERO, 1.0);
    let all = sampled(&ball, &SampleOptions { levels: Some(3), ..count(2000) });
    let points = all.points.positions();
    assert_eq!(all.levels.iter().map(|level| level.points).collect::<Vec<_>>(), [125, 500, 2000]);
    for level in &all.levels {
        let nearest = nearest(&points[..level.points]);
        let mean = nearest.iter().sum::<f64>() / nearest.len() as f64;
        let smallest = nearest.into_iter().fold(f64::INFINITY, f64::min);
        assert!((level.spacing - mean).abs() < 1e-9 && (level.smallest_distance - smallest).abs() < 1e-9);
    }
    for n in [2000, 1700, 1200, 1000, 800, 500, 350, 250, 180, 125, 90, 60] {
        let fresh = sampled(&ball, &SampleOptions { sweeps: 0, ..count(n) });
        let [first, fresh] = [&points[..n], fresh.points.positions()];
        let [of_first, of_fresh] = [first, fresh].map(|p| poisson_disk_radius(&Space, p, ball.area()));
        assert!(of_first > 0.9 * of_fresh, "{n}: radius {of_first}, of a fresh scan {of_fresh}");
        let [of_first, of_fresh] = [first, fresh].map(|p| unevenness(p, &ball.positions));
        assert!(of_first < 1.1 * of_fresh, "{n}: unevenness {of_first}, of a fresh scan {of_fresh}");
    }
}

#[test]
fn levels_change_the_order_and_not_the_samples() {
    let ring = torus(90, 40, 1.0, 0.35);
    for options in [count(700), SampleOptions { scan_only: true, sigma_n: 0.6, ..count(700) }] {
        let plain = sampled(&ring, &options);
        let ordered = sampled(&ring, &SampleOptions { levels: Some(2), ..options });
        let sorted = |made: &Sampled| {
            let mut places: Vec<[u64; 3]> =
                made.points.positions().iter().map(|p| p.to_array().map(f64::to_bits)).collect();
            places.sort_unstable();
            places
        };
        assert!(sorted(&plain) == sorted(&ordered) && plain.points != ordered.points);
        for (i, &number) in ordered.indices.iter().flatten().enumerate() {
            assert_eq!(ordered.points.positions()[i], ring.positions[number as usize]);
        }
    }
}

#[test]
fn a_line_and_many_components_have_levels_too() {
    let line: Vec<DVec3> = (0..300).map(|i| f64::from(i) * dvec3(1.0, 2.0, -1.0)).collect();
    let options = SampleOptions { scan_only: true, levels: Some(9), ..count(64) };
    let made = sample_points(&cloud(line), &options, &()).unwrap();
    assert_eq!(made.levels.iter().map(|level| level.points).collect::<Vec<_>>(), [4, 16, 64]);
    assert!(made.notes[0].contains("3 levels instead of 9"), "{:?}", made.notes);
    for level in &made.levels {
        assert!(level.smallest_distance > 0.5 * level.spacing, "{level:?}");
    }
    // Which of several balls, far from each other, comes first is determined only by their positions.
    let balls: Vec<Mesh> =
        (0..36).map(|i| sphere(2, 20.0 * dvec3(f64::from(i % 6), f64::from(i / 6), 0.0), 1.0)).collect();
    let made = sampled(&together(&balls), &SampleOptions { levels: Some(1), ..count(720) });
    let first = nearest(&made.points.positions()[..9]);
    assert!(first.iter().all(|&distance| distance > 25.0), "{first:?}");
    let none = sample(&balls[0], &SampleOptions { levels: Some(0), ..count(100) }, &());
    assert!(none.unwrap_err().to_string().contains("give 1 or more"));
}

#[test]
fn a_kernel_that_is_too_narrow_or_too_wide_says_so() {
    let ball = sphere(4, DVec3::ZERO, 1.0);
    let with = |sigma| {
        let density = SampleDensity::SigmaP(sigma);
        sampled(&ball, &SampleOptions { density, scan_only: true, ..SampleOptions::default() })
    };
    let narrow = with(1e-6);
    assert_eq!(narrow.points.positions().len(), ball.positions.len());
    assert!(narrow.notes[0].contains("all 1026 points are kept"), "{:?}", narrow.notes);
    let wide = with(10.0);
    assert!(wide.points.positions().len() < 5 && wide.notes[0].contains("only"), "{:?}", wide.notes);
    let fine = with(0.2);
    assert!(fine.notes.is_empty() && (200..500).contains(&fine.points.positions().len()));
}

fn cloud(positions: Vec<DVec3>) -> Points {
    Points::without_normals(positions)
}

#[track_caller]
fn refused(points: &Points, options: &SampleOptions, words: &str) {
    let said = sample_points(points, options, &()).unwrap_err().to_string();
    assert!(said.contains(words), "{said}");
}

#[test]
fn a_mesh_without_area_is_no_surface() {
    let line = Mesh { positions: vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], triangles: vec![[0, 1, 2]] };
    for scan_only in [true, false] {
        let said = sample(&line, &SampleOptions { scan_only, ..count(10) }, &()).unwrap_err().to_string();
        assert!(said.contains("no area"), "{said}");
    }
}

#[test]
fn what_cannot_be_sampled_is_refused() {
    let some = cloud(unit_points::<2>(50, 1).into_iter().map(|[x, y]| DVec3::new(x, y, 0.0)).collect());
    let subset = SampleOptions { scan_only: true, ..count(10) };
    let line = cloud((0..50).map(|i| f64::from(i) * DVec3::ONE).collect());
    refused(&line, &count(10), "on a line");
    refused(&line, &SampleOptions { sigma_n: 0.5, ..subset.clone() }, "on a line");
    refused(&some, &SampleOptions { density: SampleDensity::SigmaP(1e-7), ..count(10) }, "this width would give");
    refused(&some, &SampleOptions { sigma_n: 0.0, ..subset.clone() }, "kernel width σn: 0 is not a kernel width");
    refused(&some, &SampleOptions { sigma_n: f64::NAN, ..subset.clone() }, "not a kernel width");
    let signal = |values, sigma| {
        let signals = vec![Signal { values: Values::Given(values), sigma }];
        SampleOptions { signals, ..subset.clone() }
    };
    refused(&some, &signal(vec![1.0; 49], 1.0), "49 values are given for the 50 vertices");
    refused(&some, &signal(vec![1.0; 50], -1.0), "signals: -1 is not a kernel width");
    refused(&some, &signal(vec![f64::NAN; 50], 1.0), "vertex 0 has the value NaN");
    refused(&cloud(vec![]), &subset, "no points");
    refused(&cloud(vec![DVec3::NAN]), &subset, "vertex 0");
}

/// Returns an ellipsoid three times as long as wide, with the largest curvature at its tips.
fn ellipsoid() -> Mesh {
    moved(sphere(6, DVec3::ZERO, 1.0), |p| p * dvec3(3.0, 1.0, 1.0))
}

/// Returns the share of points for which `is_inside` holds.
fn share(points: &[DVec3], is_inside: impl Fn(&DVec3) -> bool) -> f64 {
    points.iter().filter(|p| is_inside(p)).count() as f64 / points.len() as f64
}

fn at_tips(points: &[DVec3]) -> f64 {
    share(points, |p| p.x.abs() > 2.7)
}

#[track_caller]
fn grows(shares: &[f64], by: f64) {
    assert!(shares.windows(2).all(|pair| pair[1] > by * pair[0]), "{shares:?}");
}

#[test]
#[ignore = "slow"]
fn samples_gather_where_the_surface_bends_as_sigma_n_falls() {
    let mesh = ellipsoid();
    let share = |sigma_n| {
        let points = sampled(&mesh, &SampleOptions { sigma_n, ..count(1000) }).points.positions().to_vec();
        assert_eq!(points.len(), 1000);
        at_tips(&points)
    };
    grows(&[f64::INFINITY, 0.4, 0.2, 0.1].map(share), 1.1);
}

fn kernel(sigma_n: f64) -> Grading {
    Grading::Kernel { sigma_n, signals: vec![] }
}

#[test]
#[ignore = "slow"]
fn vertices_gather_where_the_surface_bends_as_sigma_n_falls() {
    let mesh = ellipsoid();
    for optimize in [true, false] {
        let share = |sigma_n| {
            let options =
                Options { density: Density::Points(1000), grading: kernel(sigma_n), optimize, ..Options::default() };
            let made = remesh(&mesh, &options, &()).unwrap();
            assert!(made.verified(), "{:?}", made.notes);
            assert_eq!((audit(&made.mesh).euler, made.mesh.positions.len()), (2, 1000));
            at_tips(&made.mesh.positions)
        };
        grows(&[f64::INFINITY, 0.4, 0.2, 0.1].map(share), 1.1);
    }
}

#[test]
fn a_width_that_is_given_decides_the_number_of_vertices() {
    let mesh = ellipsoid();
    let with = |sigma_n| {
        let options = Options { density: Density::SigmaP(0.2), grading: kernel(sigma_n), ..Options::default() };
        let made = remesh(&mesh, &options, &()).unwrap();
        assert_eq!((made.verified(), made.mesh.positions.len()), (true, made.wanted));
        assert!((made.sigma_p - 0.2).abs() < 1e-12);
        made.wanted
    };
    assert!(with(0.2) > with(f64::INFINITY) + 50);
}

/// Samples gather at the sharp edges of a cube and are not drawn away by its flat sides.
#[test]
fn samples_gather_at_features() {
    let cube = cuboid(DVec3::ONE);
    let at_edges = |points: &[DVec3]| {
        let near = |x: f64| !(0.05..0.95).contains(&x);
        share(points, |p| p.to_array().into_iter().filter(|&x| near(x)).count() >= 2)
    };
    let share = |sigma_n| at_edges(sampled(&cube, &SampleOptions { sigma_n, ..count(1500) }).points.positions());
    grows(&[f64::INFINITY, 1.0, 0.5].map(share), 1.2);
}

/// Returns a ball with a value at each vertex, which changes from -1 to 1 around the equator.
fn striped() -> (Mesh, Vec<f64>) {
    let ball = sphere(6, DVec3::ZERO, 1.0);
    let values = ball.positions.iter().map(|p| (p.z / 0.2).clamp(-1.0, 1.0)).collect();
    (ball, values)
}

fn at_equator(points: &[DVec3]) -> f64 {
    share(points, |p| p.z.abs() < 0.2)
}

#[test]
fn samples_follow_a_property() {
    let (ball, values) = striped();
    let signals = |sigma| vec![Signal { values: Values::Given(values.clone()), sigma }];
    let of_samples = |sigma| {
        let made = sampled(&ball, &SampleOptions { signals: signals(sigma), ..count(800) });
        assert_eq!(made.points.positions().len(), 800);
        at_equator(made.points.positions())
    };
    grows(&[1e9, 0.5, 0.2].map(of_samples), 1.2);
    let of_subset = |sigma| {
        let options = SampleOptions { signals: signals(sigma), scan_only: true, ..count(800) };
        at_equator(sampled(&ball, &options).points.positions())
    };
    grows(&[1e9, 0.5, 0.2].map(of_subset), 1.2);
    let of_vertices = |sigma| {
        let grading = Grading::Kernel { sigma_n: f64::INFINITY, signals: signals(sigma) };
        let options = Options { density: Density::Points(800), grading, ..Options::default() };
        let made = remesh(&ball, &options, &()).unwrap();
        assert_eq!((made.verified(), made.mesh.positions.len()), (true, 800));
        at_equator(&made.mesh.positions)
    };
    // Adjacent edge lengths must not differ by much, so the band is less sharp.
    grows(&[1e9, 0.5, 0.2].map(of_vertices), 1.1);
}

#[test]
fn a_width_below_zero_is_none() {
    let options = Options { grading: kernel(-0.5), ..Options::default() };
    assert!(options.validate().unwrap_err().to_string().contains("not a kernel width"));
}

/// Returns attributes of `mesh` whose values are known everywhere: its heat is x + 2 y, its side the sign of z.
fn heat_and_side(mesh: &Mesh) -> Attributes {
    let of = |name: &str, scalar, value: fn(DVec3) -> f64| Attribute {
        name: name.into(),
        components: 1,
        values: mesh.positions.iter().map(|&p| value(p)).collect(),
        scalar,
    };
    let heat = of("heat", Scalar::F32, |p| p.x + 2.0 * p.y);
    let side = of("label", Scalar::U8, |p| f64::from(p.z > 0.0));
    Attributes { vertex: vec![heat, side], ..Attributes::default() }
}

#[test]
fn samples_have_the_attributes_that_the_surface_has_there() {
    let mesh = sphere(4, DVec3::ZERO, 1.0);
    let cloud = Mesh { triangles: Vec::new(), ..sphere(5, DVec3::ZERO, 1.0) };
    for (input, farthest) in [(&mesh, 0.05), (&cloud, 0.1)] {
        let attributes = heat_and_side(input);
        let input = Input::from(input).with_attributes(&attributes);
        let sampled = spectral_remesh::sample(&input, &count(600), &()).unwrap();
        let positions = sampled.points.positions();
        let carried = sampled.attributes();
        assert_eq!(carried.names(), ["heat", "label"]);
        let heat = carried.numbers("heat").unwrap();
        let off = positions.iter().zip(&heat).map(|(p, heat)| (p.x + 2.0 * p.y - heat).abs()).fold(0.0, f64::max);
        assert!(heat.len() == 600 && off < farthest, "{off}");
        let side = carried.numbers("label").unwrap();
        let is_right = |(p, side): (&DVec3, &f64)| p.z.abs() < 0.1 || (*side == 1.0) == (p.z > 0.0);
        assert!(positions.iter().zip(&side).all(is_right));
    }
}

#[test]
fn attributes_that_samples_cannot_have_are_told() {
    let mesh = sphere(3, DVec3::ZERO, 1.0);
    let mut attributes = heat_and_side(&mesh);
    attributes.vertex[0].values[7] = f64::NAN;
    let input = Input::from(&mesh).with_attributes(&attributes);
    let sampled = spectral_remesh::sample(&input, &count(200), &()).unwrap();
    assert_eq!(sampled.attributes().names(), ["label"]);
    assert!(sampled.notes.iter().any(|note| note.starts_with("attribute heat is left out: vertex 7 has NaN")));
}
