//! Point clouds: from raw points to a finished mesh.

use crate::common::cuboid;
use glam::{DVec3, dvec3};
use spectral_remesh::report::surface::SurfaceReport;
use spectral_remesh::stages::base::rng::{Random, Stage, stream, unit};
use spectral_remesh::stages::mesh::refine::refine;
use spectral_remesh::stages::mesh::topology::{Topology, topology};
use spectral_remesh::stages::pipeline::{CloudSummary, MeshOfPoints};
use spectral_remesh::stages::pipeline::{Remeshed, mesh_of_points, remesh};
use spectral_remesh::{
    CloudOptions, Density, Features, Input, MaxError, Mesh, Options, Outcome, Points, ReconstructOptions,
    RemeshOptions, SampleDensity, SampleOptions,
};
use std::f64::consts::TAU;

fn random() -> Random {
    stream(7, Stage::Candidates)
}

/// Returns a random point of the unit sphere.
fn on_sphere(rng: &mut Random) -> DVec3 {
    let (z, turn) = (2.0 * unit(rng) - 1.0, TAU * unit(rng));
    let r = (1.0 - z * z).sqrt();
    dvec3(r * turn.cos(), r * turn.sin(), z)
}

/// Returns random points of the unit sphere.
fn sphere(count: usize) -> Vec<DVec3> {
    let mut rng = random();
    (0..count).map(|_| on_sphere(&mut rng)).collect()
}

fn cloud(positions: Vec<DVec3>) -> Points {
    Points::without_normals(positions)
}

fn connected(points: &Points, options: &CloudOptions) -> MeshOfPoints {
    mesh_of_points(points, options, &()).unwrap()
}

fn connect(points: &Points) -> MeshOfPoints {
    connected(points, &CloudOptions::default())
}

fn kind(mesh: &Mesh) -> Topology {
    topology(mesh.positions.len(), &mesh.triangles)
}

/// Returns the Euler characteristic, components and boundary loops of a mesh, which must be an oriented manifold.
fn audit(mesh: &Mesh) -> (i64, usize, usize) {
    let t = kind(mesh);
    assert!(t.is_manifold() && t.is_oriented(), "{t:?}");
    (t.euler, t.components, t.boundary_loops)
}

/// Returns six times the volume enclosed by a closed mesh: positive if its faces point outwards.
fn volume(mesh: &Mesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum()
}

fn remeshed(points: &Points, wanted: usize) -> Remeshed {
    let options = Options { density: Density::Points(wanted), of_points: true, ..Options::default() };
    remesh(&connect(points).mesh, &options, &()).unwrap()
}

#[test]
fn random_points_without_normals_become_a_good_mesh() {
    let result = remeshed(&cloud(sphere(20_000)), 1_000);
    assert!(result.verified());
    assert_eq!(audit(&result.mesh), (2, 1, 0));
    assert_eq!(result.mesh.positions.len(), 1_000);
    assert!(volume(&result.mesh) > 0.0);
    let quality = spectral_remesh::stages::quality::shape::shape(&result.mesh).unwrap();
    assert!(quality.theta_min > 35.0 && quality.q_mean > 0.97, "{quality:?}");
    assert!(result.mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 0.01));
}

#[test]
fn given_normals_say_the_outside() {
    let positions = sphere(3_000);
    let inwards = Points::new(positions.clone(), positions.iter().map(|p| -3.0 * *p).collect()).unwrap();
    let made = connect(&inwards);
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    assert!(volume(&made.mesh) < 0.0);
    assert_eq!(made.summary, CloudSummary { points: 3_000, ..CloudSummary::default() });
}

#[test]
fn half_of_the_normals_flipped_and_some_of_no_length() {
    let positions = sphere(3_000);
    let mut rng = random();
    let mut normals: Vec<DVec3> = positions.iter().map(|p| if unit(&mut rng) < 0.5 { *p } else { -*p }).collect();
    normals[..100].fill(DVec3::ZERO);
    let made = connect(&Points::new(positions, normals).unwrap());
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    assert!(volume(&made.mesh) > 0.0);
    assert_eq!(made.summary.estimated_normals, 100);
    assert!((1_200..1_700).contains(&made.summary.turned_normals), "{:?}", made.summary);
}

#[test]
fn duplicates_and_strays_are_left_out_and_counted() {
    let mut positions = sphere(3_000);
    let copies = positions[..50].to_vec();
    positions.extend(copies);
    positions.extend([dvec3(1.8, 0.0, 0.0), dvec3(0.0, 0.0, 0.1), dvec3(-3.0, 2.0, 5.0)]);
    let made = connect(&cloud(positions.clone()));
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    assert_eq!((made.summary.duplicates, made.summary.outliers), (50, 3));
    // Every vertex of the mesh is the cloud point given by its origin.
    assert_eq!(made.mesh.positions.len(), made.source.len());
    for (v, &p) in made.mesh.positions.iter().zip(&made.source) {
        assert_eq!(*v, positions[p as usize]);
    }
}

#[test]
fn clouds_far_apart_are_pieces() {
    let near = sphere(1_500);
    let far: Vec<DVec3> = near.iter().map(|p| *p * 0.01 + dvec3(1000.0, 0.0, 0.0)).collect();
    let made = connect(&cloud([near, far].concat()));
    assert_eq!(audit(&made.mesh), (4, 2, 0));
}

#[test]
fn nested_spheres_and_thin_walls_have_two_sides() {
    let outer = sphere(12_000);
    let inner: Vec<DVec3> = sphere(11_000).into_iter().map(|p| p * 0.93).collect();
    let made = connect(&cloud([outer, inner].concat()));
    assert_eq!(audit(&made.mesh), (4, 2, 0));
    // A closed plate with a thickness of four spacings.
    let mut rng = random();
    let (half, area) = (dvec3(1.0, 1.0, 0.04), 4.0 + 4.0 + 4.0 * 0.16);
    let mut point = || {
        let side = unit(&mut rng) * area;
        let [u, v] = [2.0 * unit(&mut rng) - 1.0, 2.0 * unit(&mut rng) - 1.0];
        let sign = if unit(&mut rng) < 0.5 { 1.0 } else { -1.0 };
        let place = if side < 8.0 {
            dvec3(u, v, sign)
        } else if side < 8.32 {
            dvec3(sign, u, v)
        } else {
            dvec3(u, sign, v)
        };
        place * half
    };
    let plate = connect(&cloud((0..20_000).map(|_| point()).collect()));
    assert_eq!(audit(&plate.mesh), (2, 1, 0));
}

#[test]
fn a_sheet_has_a_boundary_and_looks_up() {
    let grid = (0..2_500).map(|i| dvec3(f64::from(i % 50), f64::from(i / 50), 3.0)).collect();
    let made = connect(&cloud(grid));
    assert_eq!(audit(&made.mesh), (1, 1, 1));
    assert!((0..made.mesh.triangles.len()).all(|t| made.mesh.area_vector(t).z > 0.0));
}

#[test]
fn holes_of_the_scan_stay_unless_they_are_to_be_filled() {
    let bowl: Vec<DVec3> = sphere(8_000).into_iter().filter(|p| p.z < 0.8).collect();
    let made = connect(&cloud(bowl.clone()));
    assert_eq!(audit(&made.mesh), (1, 1, 1));
    assert!(volume(&made.mesh) > 0.0);
    // The hole has a diameter of 1.2.
    let closed = connected(&cloud(bowl.clone()), &CloudOptions { fill_holes: 1.9, ..CloudOptions::default() });
    assert_eq!(audit(&closed.mesh), (2, 1, 0));
    let open = connected(&cloud(bowl), &CloudOptions { fill_holes: 1.0, ..CloudOptions::default() });
    assert_eq!(audit(&open.mesh), (1, 1, 1));
}

#[test]
fn density_may_change_by_a_thousand() {
    // The density falls gradually from the south pole to the north pole.
    let mut rng = random();
    let mut points = Vec::new();
    while points.len() < 30_000 {
        let p = on_sphere(&mut rng);
        if unit(&mut rng) < 1000f64.powf(-0.5 - 0.5 * p.z) {
            points.push(p);
        }
    }
    let made = connect(&cloud(points));
    assert_eq!(audit(&made.mesh), (2, 1, 0));
}

#[test]
fn noise_is_smoothed_away() {
    let mut rng = random();
    let mut noise = || (0..4).map(|_| unit(&mut rng) - 0.5).sum::<f64>() * 0.017;
    let noisy: Vec<DVec3> = sphere(8_000).into_iter().map(|p| p * (1.0 + noise())).collect();
    let off = |points: &[DVec3]| {
        (points.iter().map(|p| (p.length() - 1.0).powi(2)).sum::<f64>() / points.len() as f64).sqrt()
    };
    let made = connected(&cloud(noisy.clone()), &CloudOptions { smooth: Some(2.3), ..CloudOptions::default() });
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    assert!(off(&made.mesh.positions) < 0.5 * off(&noisy), "{} {}", off(&made.mesh.positions), off(&noisy));
}

#[test]
#[ignore = "slow"]
fn a_noisy_mesh_is_smoothed_on_the_way() {
    let mut rng = random();
    let mut mesh = connect(&cloud(sphere(6_000))).mesh;
    mesh.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.02 * (unit(&mut rng) - 0.5));
    let result = |smooth| {
        let options = Options { density: Density::Points(5_000), smooth, ..Options::default() };
        remesh(&mesh, &options, &()).unwrap().mesh
    };
    let roughness = |mesh: &Mesh| {
        let mean = mesh.positions.iter().map(|p| p.length()).sum::<f64>() / mesh.positions.len() as f64;
        mesh.positions.iter().map(|p| (p.length() - mean).abs()).sum::<f64>()
    };
    let (smooth, rough) = (roughness(&result(Some(2.7))), roughness(&result(None)));
    assert!(smooth < 0.6 * rough, "{smooth} {rough}");
}

#[test]
#[ignore = "slow"]
fn few_points_are_not_joined_by_flat_triangles() {
    let shape = |p: DVec3| p * dvec3(1.0, 0.8, 1.3);
    let points = cloud(sphere(1_500).into_iter().map(shape).collect());
    let off = |of_points| {
        let options = Options { density: Density::Points(6_000), of_points, ..Options::default() };
        let made = remesh(&connect(&points).mesh, &options, &()).unwrap();
        assert_eq!(audit(&made.mesh), (2, 1, 0));
        assert!(made.verified());
        let far = |p: &DVec3| (*p / dvec3(1.0, 0.8, 1.3)).length() - 1.0;
        made.mesh.positions.iter().map(|p| far(p).powi(2)).sum::<f64>().sqrt() / 6_000f64.sqrt()
    };
    let (bent, flat) = (off(true), off(false));
    assert!(bent < 0.5 * flat, "{bent} {flat}");
}

/// A slope of one in six whose heights are rounded to the lattice of its points.
#[test]
fn steps_of_points_on_a_lattice_are_no_sharp_edges() {
    let slope = |of_points| {
        let sheet = stepped_sheet(30, |x| (x / 6.0).round());
        let options = Options { density: Density::Points(1_000), of_points, ..Options::default() };
        remesh(&sheet, &options, &()).unwrap()
    };
    let (of_points, of_mesh) = (slope(true), slope(false));
    assert!(of_points.verified() && of_mesh.verified());
    assert_eq!(of_points.sharp_curves, 0);
    assert!(of_mesh.sharp_curves > 4, "a mesh means the steps that it has: {}", of_mesh.sharp_curves);
    let quality = spectral_remesh::stages::quality::shape::shape(&of_points.mesh).unwrap();
    assert!(quality.q_mean > 0.95, "{quality:?}");
}

/// Returns a sheet of `n` by `n` unit cells whose height depends on x.
fn stepped_sheet(n: u32, height: impl Fn(f64) -> f64) -> Mesh {
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let points = (0..=n).flat_map(|i| (0..=n).map(move |j| (f64::from(i), f64::from(j))));
    let positions = points.map(|(x, y)| dvec3(x, y, height(x))).collect();
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let halves = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    Mesh { positions, triangles: cells.flat_map(halves).collect() }
}

#[test]
fn between_few_points_edges_stay_sharp_and_faces_flat() {
    let options = Options { density: Density::Points(4_000), of_points: true, ..Options::default() };
    let mut cube = cuboid(DVec3::splat(2.0)).try_into().unwrap();
    refine(&mut cube, 0.3, 10_000);
    let made = remesh(&cube, &options, &()).unwrap();
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    assert_eq!(made.sharp_curves, 12);
    let off = |p: &DVec3| ((*p - 1.0).abs().max_element() - 1.0).abs();
    let farthest = made.mesh.positions.iter().map(off).fold(0.0, f64::max);
    assert!(farthest < 1e-3, "{farthest}");
}

/// Returns random points of the surface of a cube with sides of two.
fn on_cube(count: usize, noise: f64) -> Vec<[f64; 3]> {
    let mut rng = random();
    let point = |i: usize| {
        let [u, v, w] = [0; 3].map(|_| 2.0 * unit(&mut rng) - 1.0);
        let off = if i.is_multiple_of(2) { 1.0 } else { -1.0 } + noise * w;
        let mut point = [u, v, off];
        point.rotate_left(i / 2 % 3);
        point
    };
    (0..count).map(point).collect()
}

#[test]
fn edges_between_many_points_come_out_sharp_and_corners_where_sides_meet() {
    let length = |made: &Outcome| {
        let ends = |[a, b]: [u32; 2]| [a, b].map(|v| made.mesh.positions[v as usize]);
        made.edges.sharp.iter().map(|&edge| ends(edge)).map(|[a, b]| a.distance(b)).sum::<f64>()
    };
    // Without noise, and with some of a tenth of the point spacing.
    for (noise, most) in [(0.0, 1e-3), (0.003, 0.02)] {
        let positions = on_cube(20_000, noise);
        let made = spectral_remesh::remesh(&Input::points(&positions), &Options::points(600).into(), &()).unwrap();
        assert!(made.verified(), "{noise}");
        assert!((length(&made) - 24.0).abs() < 0.2, "{noise}: {}", length(&made));
        for corner in 0..8 {
            let corner = dvec3(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2)) * 2.0 - 1.0;
            let distances = made.mesh.positions.iter().map(|p| p.distance(corner));
            let nearest = distances.fold(f64::INFINITY, f64::min);
            assert!(nearest < most, "{noise}: {corner} is {nearest} away");
        }
    }
    let options = Options { features: Features::Smooth, ..Options::points(600) };
    let round = spectral_remesh::remesh(&Input::points(&on_cube(20_000, 0.0)), &options.into(), &()).unwrap();
    assert!(round.edges.sharp.is_empty());
}

#[test]
fn the_same_mesh_for_any_number_of_threads_scale_and_place() {
    let points = cloud(sphere(4_000));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| connect(&points).mesh)
    };
    assert_eq!(with(1), with(4));
    for (scale, offset) in [(1e-6, 0.0), (1e6, 1e9)] {
        let moved = points.positions().iter().map(|p| *p * scale + offset).collect();
        assert_eq!(audit(&connect(&cloud(moved)).mesh), (2, 1, 0), "{scale}");
    }
}

#[test]
fn no_surface_goes_through_them() {
    let refused = |positions: Vec<DVec3>, why: &str| {
        let error = mesh_of_points(&cloud(positions), &CloudOptions::default(), &()).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    };
    refused(vec![], "0 distinct points");
    refused(vec![DVec3::X], "at the same position");
    refused(vec![DVec3::X; 1_000], "at the same position");
    refused(vec![DVec3::X, DVec3::Y], "2 points lie on a line");
    refused(vec![DVec3::X, DVec3::Y, DVec3::ZERO], "3 distinct points are too few");
    refused((0..1_000).map(|i| dvec3(f64::from(i), 2.0 * f64::from(i), 1.0)).collect(), "1000 points lie on a line");
    refused(vec![dvec3(f64::NAN, 0.0, 0.0); 10], "point 0");
    let mut rng = random();
    let volume = (0..2_000).map(|_| dvec3(unit(&mut rng), unit(&mut rng), unit(&mut rng))).collect();
    refused(volume, "they fill a volume");
    let bad = |options: CloudOptions, name: &str| {
        let error = mesh_of_points(&cloud(sphere(100)), &options, &()).unwrap_err().to_string();
        assert!(error.starts_with(name), "{error}");
    };
    bad(CloudOptions { smooth: Some(0.1), ..CloudOptions::default() }, "support radius");
    bad(CloudOptions { fill_holes: -1.0, ..CloudOptions::default() }, "size of holes");
}

/// Returns the points with integer coordinates on the faces of a box, each with the normal of its face; points on an edge
/// occur once for each of its faces.
fn box_on_a_lattice(size: [i32; 3]) -> Vec<(DVec3, DVec3)> {
    let mut points = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (side, sign) in [(0, -1.0), (size[axis], 1.0)] {
            for (i, j) in (0..=size[u]).flat_map(|i| (0..=size[v]).map(move |j| (i, j))) {
                let (mut at, mut normal) = (DVec3::ZERO, DVec3::ZERO);
                (at[axis], at[u], at[v]) = (f64::from(side), f64::from(i), f64::from(j));
                normal[axis] = sign;
                points.push((at, normal));
            }
        }
    }
    points
}

#[test]
fn points_on_a_lattice_and_twice_at_edges_are_all_used() {
    let points = box_on_a_lattice([8, 30, 20]);
    let bare = cloud(points.iter().map(|p| p.0).collect());
    for points in [Points::from_pairs(points), bare] {
        let made = connect(&points);
        assert_eq!(audit(&made.mesh), (2, 1, 0));
        assert_eq!(made.summary.unused, 0);
        assert_eq!(volume(&made.mesh) / 6.0, 8.0 * 30.0 * 20.0);
    }
}

#[test]
fn noise_stronger_than_the_spacing_is_taken_out() {
    let mut rng = random();
    let noisy: Vec<DVec3> =
        sphere(6_000).into_iter().map(|p| p * (1.0 + 0.08 * (2.0 * unit(&mut rng) - 1.0))).collect();
    let positions: Vec<[f64; 3]> = noisy.iter().map(|p| p.to_array()).collect();
    let options = RemeshOptions::from(Options::points(1_000));
    let made = spectral_remesh::remesh(&Input::points(&positions), &options, &()).unwrap();
    assert!(made.verified(), "{:?}", made.shortcomings);
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    assert!(made.mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 0.04));
    assert!(made.notes.iter().any(|note| note.contains("noisy")), "{:?}", made.notes);
    let report = made.report.unwrap();
    assert!(report.cloud.is_some_and(|cloud| cloud.noisy && cloud.flattened_neighbors > 8));
    let coverage = report.coverage.unwrap();
    assert!(coverage.missed == 0 && coverage.points > 5_900 && coverage.largest > 0.04, "{coverage:?}");
}

#[test]
fn some_noise_is_smoothed_away_by_itself_and_told() {
    let mut rng = random();
    let noisy: Vec<DVec3> =
        sphere(6_000).into_iter().map(|p| p * (1.0 + 0.02 * (2.0 * unit(&mut rng) - 1.0))).collect();
    let positions: Vec<[f64; 3]> = noisy.iter().map(|p| p.to_array()).collect();
    let made = spectral_remesh::remesh(&Input::points(&positions), &Options::points(1_000).into(), &()).unwrap();
    assert!(made.verified(), "{:?}", made.shortcomings);
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    assert!(made.warnings.iter().any(|note| note.contains("a support radius of 2.7 spacings")), "{:?}", made.warnings);
    // Without noise, points stay where they are.
    assert_eq!(connect(&cloud(sphere(6_000))).summary.smoothed_by_itself, 0.0);
}

#[test]
fn noise_is_told_whatever_is_made_of_the_points_and_left_to_those_who_want_it() {
    let mut rng = random();
    let mut noise = || 1.0 + 0.03 * (2.0 * unit(&mut rng) - 1.0);
    let positions: Vec<[f64; 3]> = sphere(3_000).into_iter().map(|p| (noise() * p).to_array()).collect();
    let is_told = |notes: &[String]| notes.iter().any(|note| note.contains("a support radius of 2.7 spacings"));
    for (smooth, is_smoothed) in [(None, true), (Some(0.0), false)] {
        let cloud = CloudOptions { smooth, ..CloudOptions::default() };
        let options =
            SampleOptions { density: SampleDensity::Points(200), cloud: cloud.clone(), ..SampleOptions::default() };
        let sampled = spectral_remesh::sample(&Input::points(&positions), &options, &()).unwrap();
        assert_eq!(is_told(&sampled.notes), is_smoothed, "{:?}", sampled.notes);
        let options = ReconstructOptions { cloud: cloud.clone(), ..ReconstructOptions::default() };
        let dense = spectral_remesh::reconstruct(&Input::points(&positions), &options, &()).unwrap();
        let report = SurfaceReport::new(&dense, Vec::new(), String::new(), String::new());
        assert_eq!((is_told(&report.run.notes), dense.support), (is_smoothed, if is_smoothed { 2.7 } else { 2.3 }));
        let mesh = connected(&Points::without_normals(positions.iter().map(|&p| p.into()).collect()), &cloud).mesh;
        let stays = mesh.positions.iter().all(|p| positions.contains(&p.to_array()));
        assert_eq!(stays, !is_smoothed);
    }
}

/// Returns a sphere, and a sheet of 25 points beside it.
fn sphere_and_shred() -> Vec<DVec3> {
    let shred = (0..25).map(|i| dvec3(2.0, 0.05 * f64::from(i % 5), 0.05 * f64::from(i / 5)));
    sphere(3_000).into_iter().chain(shred).collect()
}

/// Returns points of an airborne scan: hills, and trees with points throughout their crowns, above ground that also has points.
fn forest() -> Vec<DVec3> {
    let mut rng = random();
    let ground = |x: f64, y: f64| 3.0 * (0.1 * x).sin() * (0.08 * y).cos();
    let mut points: Vec<DVec3> = (0..9000)
        .map(|_| [100.0 * unit(&mut rng), 90.0 * unit(&mut rng)])
        .map(|[x, y]| dvec3(x, y, ground(x, y)))
        .collect();
    for tree in 0..30 {
        let (x, y) = (f64::from(tree % 6) * 16.0 + 8.0, f64::from(tree / 6) * 17.0 + 9.0);
        let crown = (0..80).map(|_| 2.5 * on_sphere(&mut rng) * unit(&mut rng).cbrt());
        points.extend(crown.map(|p| p + dvec3(x, y, ground(x, y) + 9.0)));
    }
    points
}

#[test]
fn terrain_with_trees_is_one_sheet_as_seen_from_above() {
    let points: Vec<[f64; 3]> = forest().iter().map(DVec3::to_array).collect();
    let given = Input::points(&points);
    let surface = Options { density: Density::Points(1200), ..Options::default() };
    let meshed = |terrain| {
        let cloud = CloudOptions { terrain, ..CloudOptions::default() };
        let options = RemeshOptions { surface: surface.clone(), cloud, ..RemeshOptions::default() };
        spectral_remesh::remesh(&given, &options, &()).unwrap()
    };
    let by_itself = meshed(None);
    assert!(by_itself.shortcomings.is_empty(), "{:?}", by_itself.shortcomings);
    assert_eq!((audit(&by_itself.mesh), by_itself.mesh.positions.len()), ((1, 1, 1), 1200));
    assert!(by_itself.warnings[0].contains("look like terrain"), "{:?}", by_itself.warnings);
    // The mesh faces upwards and covers all of the ground, with the trees above it.
    let seen: f64 = (0..by_itself.mesh.triangles.len()).map(|t| by_itself.mesh.area_vector(t).z / 2.0).sum();
    assert!((8700.0..9000.0).contains(&seen), "{seen}");
    let trees = by_itself.mesh.positions.iter().filter(|p| p.z > 6.0).count();
    assert!((30..300).contains(&trees), "{trees}");
    let asked = meshed(Some(true));
    assert_eq!(asked.mesh, by_itself.mesh);
    assert!(!asked.warnings.iter().any(|w| w.contains("look like")));
    assert!(audit(&meshed(Some(false)).mesh).1 > 1);
}

#[test]
fn a_ball_is_no_terrain_unless_that_is_asked_for() {
    let ball: Vec<[f64; 3]> = sphere(20_000).iter().map(DVec3::to_array).collect();
    let options = RemeshOptions {
        surface: Options { density: Density::Points(500), ..Options::default() },
        cloud: CloudOptions { terrain: Some(true), ..CloudOptions::default() },
        ..RemeshOptions::default()
    };
    let dome = spectral_remesh::remesh(&Input::points(&ball), &options, &()).unwrap();
    assert_eq!(audit(&dome.mesh), (1, 1, 1));
    assert!(dome.mesh.positions.iter().all(|p| p.z > -0.5));
}

#[test]
fn points_on_shreds_are_counted_as_such() {
    let made = connect(&cloud(sphere_and_shred()));
    assert_eq!(audit(&made.mesh), (2, 1, 0));
    let CloudSummary { outliers, unused, in_shreds, shreds, .. } = made.summary;
    assert_eq!((outliers, unused, in_shreds, shreds), (0, 0, 25, 1));
}

#[test]
fn an_error_that_was_asked_for_is_to_all_points() {
    let positions: Vec<[f64; 3]> = sphere_and_shred().iter().map(|p| p.to_array()).collect();
    let error_of = |positions: &[[f64; 3]]| {
        let options = Options { max_error: Some(MaxError::Length(0.1)), ..Options::points(1_000) };
        let made = spectral_remesh::remesh(&Input::points(positions), &options.into(), &()).unwrap();
        let reached = made.report.as_ref().unwrap().deviation.unwrap().reached;
        assert_eq!(made.verified(), reached <= 0.1, "{:?}", made.shortcomings);
        assert_eq!(
            made.notes.iter().any(|note| note.contains("the largest distance to the input")),
            reached > 0.1,
            "{:?}",
            made.notes
        );
        reached
    };
    assert!(error_of(&positions[..3_000]) < 0.1);
    assert!((1.0..1.1).contains(&error_of(&positions)));
}
