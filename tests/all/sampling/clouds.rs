//! Sampling of points without triangles.

use super::*;
use crate::common::noisy;

fn subset(points: &Points, n: usize) -> Sampled {
    sample_points(points, &SampleOptions { scan_only: true, ..count(n) }, &()).unwrap()
}

#[test]
fn a_subset_of_a_cloud() {
    let ball = sphere(5, DVec3::ZERO, 1.0);
    let without = subset(&cloud(ball.positions.clone()), 400);
    assert_eq!(without.points.positions().len(), 400);
    // Missing normals are estimated, all of them pointing outwards.
    let facing = |(p, n): (&DVec3, &DVec3)| n.dot(*p);
    let sides: Vec<f64> = without.points.positions().iter().zip(without.points.normals()).map(facing).collect();
    assert!(sides.iter().all(|side| *side > 0.99), "{sides:?}");
    let with = Points::new(ball.positions.clone(), ball.positions.iter().map(|p| 3.0 * *p).collect()).unwrap();
    let options = SampleOptions { scan_only: true, sigma_n: 0.5, ..count(400) };
    let both = sample_points(&with, &options, &()).unwrap();
    assert_eq!(both.points.positions().len(), 400);
    assert!(both.points.normals().iter().all(|n| (n.length() - 1.0).abs() < 1e-12));
}

#[test]
fn a_subset_is_numbered_as_in_the_input_also_where_points_are_dropped() {
    let mut positions = sphere(5, DVec3::ZERO, 1.0).positions;
    positions.insert(0, positions[7]);
    positions.insert(0, DVec3::splat(9.0));
    let made = subset(&cloud(positions.clone()), 500);
    let indices = made.indices.unwrap();
    assert!(indices.iter().zip(made.points.positions()).all(|(&i, p)| *p == positions[i as usize]));
    assert!(!indices.contains(&0));
    let summary = made.cloud.unwrap();
    assert_eq!((summary.duplicates, summary.outliers), (1, 1));
}

#[test]
fn blue_noise_on_a_cloud() {
    let centre = dvec3(1e3, -2e3, 5.0);
    let ball = sphere(6, centre, 20.0);
    let given = Points::new(ball.positions.clone(), ball.positions.iter().map(|p| *p - centre).collect()).unwrap();
    // Also without normals, and with more samples than points.
    for (points, n) in [(&given, 300), (&given, 1000), (&cloud(ball.positions.clone()), 1000), (&given, 6000)] {
        let made = sample_points(points, &count(n), &()).unwrap();
        assert_eq!((made.points.positions().len(), made.points.normals().len(), made.wanted), (n, n, Some(n)));
        assert!(made.indices.is_none() && made.notes.is_empty(), "{:?}", made.notes);
        for (p, normal) in made.points.positions().iter().zip(made.points.normals()) {
            let out = (*p - centre) / 20.0;
            assert!((out.length() - 1.0).abs() < 3e-3 && normal.dot(out) > 0.99, "{p} {normal}");
        }
        let rho = poisson_disk_radius(&Space, made.points.positions(), ball.area());
        assert!(rho > 0.7, "{n}: {rho}");
    }
}

#[test]
fn samples_of_points_without_normals_look_outwards_and_upwards() {
    let balls = [dvec3(-3.0, 0.0, 0.0), dvec3(3.0, 1.0, 0.0)].map(|centre| (centre, sphere(4, centre, 1.0)));
    let ground = (0..900).map(|i| dvec3(f64::from(i % 30), f64::from(i / 30), f64::from(i % 7) * 0.02 - 20.0) * 0.1);
    let positions = balls.iter().flat_map(|(_, ball)| ball.positions.clone()).chain(ground).collect();
    let made = sample_points(&cloud(positions), &count(600), &()).unwrap();
    for (p, normal) in made.points.positions().iter().zip(made.points.normals()) {
        let near = balls.iter().find(|(centre, _)| p.distance(*centre) < 1.5);
        let out = near.map_or(DVec3::Z, |(centre, _)| *p - *centre);
        assert!(normal.dot(out) > 0.9, "{p} {normal}");
    }
}

#[test]
fn noise_of_a_cloud_is_not_sampled() {
    let ball = noisy(sphere(6, DVec3::ZERO, 1.0), 0.015, &mut random(8));
    let given = Points::new(ball.positions.clone(), ball.positions.clone()).unwrap();
    let cloud = CloudOptions { smooth: Some(4.0), ..CloudOptions::default() };
    let made = sample_points(&given, &SampleOptions { cloud, ..count(800) }, &()).unwrap();
    let off = |points: &[DVec3]| {
        (points.iter().map(|p| (p.length() - 1.0).powi(2)).sum::<f64>() / points.len() as f64).sqrt()
    };
    assert!(off(made.points.positions()) < 0.4 * off(&ball.positions), "{}", off(made.points.positions()));
}

/// Samples stay on an open sheet, and on each side of a thin plate.
#[test]
fn samples_keep_to_the_sheet_of_the_cloud() {
    let square =
        |z: f64, n: i32| (0..n * n).map(move |i| dvec3(f64::from(i % n), f64::from(i / n), z) / f64::from(n - 1));
    let positions: Vec<DVec3> = square(0.0, 50).chain(square(0.5, 50)).collect();
    let normals = positions.iter().map(|p| if p.z > 0.0 { DVec3::Z } else { DVec3::NEG_Z }).collect();
    let made = sample_points(&Points::new(positions, normals).unwrap(), &count(600), &()).unwrap();
    for (p, n) in made.points.positions().iter().zip(made.points.normals()) {
        assert!(p.truncate().clamp(glam::DVec2::ZERO, glam::DVec2::ONE).distance(p.truncate()) < 0.04, "{p}");
        assert!(p.z.min(0.5 / 49.0 - p.z).abs() < 1e-3, "{p}");
        let side = if p.z > 0.25 / 49.0 { DVec3::Z } else { DVec3::NEG_Z };
        assert!(n.distance(side) < 1e-9, "{n}");
    }
}

#[test]
fn the_samples_of_a_cloud_gather_where_it_bends_for_any_number_of_threads() {
    let mesh = ellipsoid();
    let points = points_of_mesh(&mesh);
    let with = |threads, sigma_n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sample_points(&points, &SampleOptions { sigma_n, ..count(700) }, &()).unwrap())
    };
    let one = with(1, 0.3);
    assert_eq!(one, with(4, 0.3));
    grows(&[at_tips(with(2, f64::INFINITY).points.positions()), at_tips(one.points.positions())], 1.1);
}

#[test]
fn poor_clouds() {
    let line: Vec<DVec3> = (0..300).map(|i| f64::from(i) * dvec3(1.0, 2.0, -1.0)).collect();
    assert_eq!(subset(&cloud(line.clone()), 30).points.positions().len(), 30);
    assert_eq!(subset(&cloud(line), 300).points.positions().len(), 300);
    let heap = subset(&cloud(vec![DVec3::ONE; 50]), 10);
    assert_eq!(heap.points.positions().len(), 1);
    assert!(heap.notes[0].contains("1 sample instead of 10"), "{:?}", heap.notes);
    assert_eq!(subset(&cloud(vec![DVec3::ONE]), 3).points.positions().len(), 1);
    let apart: Vec<DVec3> = unit_points::<3>(400, 5).into_iter().map(DVec3::from).collect();
    let both = apart.iter().copied().chain(apart.iter().map(|p| *p + 1e6)).collect();
    assert_eq!(subset(&cloud(both), 200).points.positions().len(), 200);
}
