//! Reconstruction: clouds become dense meshes of their implicit surface.

use crate::common::{audit, moved, noisy, random, sphere, together, torus, volume};
use glam::{DVec3, dvec3};
use spectral_remesh::stages::pipeline::INTERPOLATING_SUPPORT;
use spectral_remesh::stages::pipeline::{points_of_mesh, reconstruct};
use spectral_remesh::{CloudOptions, Error, Mesh, Points, ReconstructOptions, Reconstructed, Setting};
use std::f64::consts::PI;

fn with_normals(mesh: &Mesh) -> Points {
    points_of_mesh(mesh)
}

fn without_normals(mesh: &Mesh) -> Points {
    Points::without_normals(mesh.positions.clone())
}

fn made(points: &Points, options: &ReconstructOptions) -> Reconstructed {
    let made = reconstruct(points, options, &()).unwrap();
    assert_eq!(audit(&made.mesh), made.topology);
    made
}

fn at(resolution: f64) -> ReconstructOptions {
    ReconstructOptions { resolution: Some(resolution), ..ReconstructOptions::default() }
}

#[test]
fn a_ball_is_closed_round_and_faces_outwards() {
    let ball = sphere(5, dvec3(5.0, -3.0, 1.0), 2.0);
    for points in [with_normals(&ball), without_normals(&ball)] {
        let Reconstructed { mesh, topology, spacing, resolution, .. } = made(&points, &ReconstructOptions::default());
        assert_eq!((topology.euler, topology.boundary_loops, topology.components), (2, 0, 1));
        assert!((resolution - 0.5 * spacing).abs() < 1e-12);
        let off = |p: &DVec3| (p.distance(dvec3(5.0, -3.0, 1.0)) - 2.0).abs();
        // Planes through points with support radius h lie outside a ball of radius R by h² / 12 R on average.
        let outside = (INTERPOLATING_SUPPORT * spacing).powi(2) / (12.0 * 2.0);
        let farthest = mesh.positions.iter().map(off).fold(0.0, f64::max);
        assert!(farthest < 2.5 * outside, "{farthest} {outside}");
        assert!((volume(&mesh) / (4.0 * PI / 3.0 * 8.0) - 1.0).abs() < 0.02, "{}", volume(&mesh));
    }
}

#[test]
fn coarse_and_fine_cells() {
    let ball = with_normals(&sphere(4, DVec3::ZERO, 1.0));
    let faces = [0.4, 0.1, 0.03].map(|resolution| {
        let t = made(&ball, &at(resolution)).topology;
        assert_eq!((t.euler, t.boundary_loops), (2, 0), "{resolution}");
        t.faces as f64 * resolution * resolution
    });
    assert!(faces.iter().all(|f| (f / faces[1] - 1.0).abs() < 0.3), "{faces:?}");
}

#[test]
fn a_torus_and_nested_balls() {
    let ring = made(&without_normals(&torus(90, 40, 1.0, 0.4)), &ReconstructOptions::default());
    assert_eq!((ring.topology.euler, ring.topology.boundary_loops), (0, 0));
    assert!(volume(&ring.mesh) > 0.0);
    let inner = moved(sphere(4, DVec3::ZERO, 0.7), |p| p);
    let both = made(&with_normals(&together(&[sphere(5, DVec3::ZERO, 1.0), inner])), &ReconstructOptions::default());
    let t = both.topology;
    assert_eq!((t.euler, t.components, t.boundary_loops), (4, 2, 0));
}

/// The two sides of a disk that is hardly thicker than the support radius of its points.
#[test]
#[ignore = "slow"]
fn a_thin_wall_has_two_sides_and_no_others() {
    let flat = moved(sphere(5, DVec3::ZERO, 1.0), |p| p * dvec3(1.0, 1.0, 0.06));
    let normal = |p: &DVec3| *p / dvec3(1.0, 1.0, 0.06).powf(2.0);
    let points = Points::from_pairs(flat.positions.iter().map(|p| (*p, normal(p))));
    let t = made(&points, &at(0.01)).topology;
    assert_eq!((t.euler, t.components, t.boundary_loops), (2, 1, 0));
}

#[test]
fn an_open_cloud_has_a_border_near_its_own() {
    let half = |mesh: Mesh| mesh.positions.into_iter().filter(|p| p.z > -0.01).collect::<Vec<DVec3>>();
    let positions = half(sphere(5, DVec3::ZERO, 1.0));
    let Reconstructed { mesh, topology, spacing, .. } =
        made(&Points::from_pairs(positions.into_iter().map(|p| (p, p))), &ReconstructOptions::default());
    assert_eq!((topology.euler, topology.boundary_loops, topology.components), (1, 1, 1));
    let lowest = mesh.positions.iter().map(|p| p.z).fold(1.0, f64::min);
    assert!((-1.5 * spacing..0.0).contains(&lowest), "{lowest} {spacing}");
}

#[test]
fn noise_is_smoothed() {
    let ball = noisy(sphere(5, DVec3::ZERO, 1.0), 0.02, &mut random(3));
    let off = |mesh: &Mesh| {
        let square = |p: &DVec3| (p.length() - 1.0).powi(2);
        (mesh.positions.iter().map(square).sum::<f64>() / mesh.positions.len() as f64).sqrt()
    };
    let normals = sphere(5, DVec3::ZERO, 1.0).positions;
    let given = Points::new(ball.positions.clone(), normals).unwrap();
    for (points, most) in [(given, 0.5), (without_normals(&ball), 0.7)] {
        let cloud = CloudOptions { smooth: Some(2.2), ..CloudOptions::default() };
        let smooth = made(&points, &ReconstructOptions { resolution: Some(0.03), cloud });
        assert_eq!((smooth.topology.euler, smooth.topology.components), (2, 1));
        assert!(off(&smooth.mesh) < most * off(&ball), "{} {}", off(&smooth.mesh), off(&ball));
    }
}

/// Random points have gaps of three times their mean spacing.
#[test]
fn random_points_have_no_holes() {
    let ball = with_normals(&sphere(6, DVec3::ZERO, 1.0));
    let mut rng = random(6);
    let mut is_chosen = |_: &u32| spectral_remesh::stages::base::rng::unit(&mut rng) < 0.25;
    let chosen: Vec<u32> = (0..ball.positions().len() as u32).filter(|p| is_chosen(p)).collect();
    let t = made(&ball.pick(&chosen), &ReconstructOptions::default()).topology;
    assert_eq!((t.euler, t.components, t.boundary_loops), (2, 1, 0));
}

#[test]
fn the_mesh_is_the_same_for_any_number_of_threads() {
    let points = without_normals(&noisy(torus(60, 25, 1.0, 0.4), 0.01, &mut random(1)));
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| made(&points, &ReconstructOptions::default()))
    };
    assert_eq!(with(1), with(4));
}

#[track_caller]
fn refused(points: &Points, options: &ReconstructOptions, words: &str) -> Error {
    let error = reconstruct(points, options, &()).unwrap_err();
    assert!(error.to_string().contains(words), "{error}");
    error
}

#[test]
fn what_has_no_surface_is_refused() {
    let ball = with_normals(&sphere(3, DVec3::ZERO, 1.0));
    let default = ReconstructOptions::default();
    refused(&Points::default(), &default, "too few");
    let five = Points::without_normals(ball.positions()[..5].to_vec());
    refused(&five, &default, "5 distinct points are too few");
    let line = Points::without_normals((0..50).map(|i| f64::from(i) * DVec3::ONE).collect());
    refused(&line, &default, "on a line");
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(&ball, &at(length), "resolution: ");
    }
    let smooth = |w| ReconstructOptions {
        cloud: CloudOptions { smooth: Some(w), ..CloudOptions::default() },
        ..ReconstructOptions::default()
    };
    refused(&ball, &smooth(0.5), "support radius of smoothing: ");
    let said = refused(&ball, &at(1e-4), "corners near the surface");
    assert!(matches!(said, Error::Option { option: Setting::Resolution, .. }));
    refused(&ball, &at(1e-12), "corners near the surface");
    refused(&ball, &at(100.0), "");
}
