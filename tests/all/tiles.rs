//! Clouds sampled tile by tile: the samples are the same for any tiling and similar to those of the whole cloud, and no
//! temporary files remain.

use glam::{DVec3, dvec3};
use spectral_remesh::io::file::{read_file, write_points_file};
use spectral_remesh::report::Report;
use spectral_remesh::stages::base::rng::{Stage, stream, unit};
use spectral_remesh::stages::transfer::vertex::Carried;
use spectral_remesh::tiles::{
    PlanOptions, TileFolder, make_plan, merge, merge_mesh, mesh_one, nearest_attributes, rounds, sample_one,
    sample_tiles,
};
use spectral_remesh::{
    Attribute, Attributes, Input, Mesh, Points, SampleDensity, SampleOptions, Sampled, Scalar, sample, with_threads,
};
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Returns a temporary folder and a file in it with random points of a torus around the origin, with or without normals.
fn cloud(count: usize, with_normals: bool) -> (tempfile::TempDir, PathBuf) {
    stretched(count, with_normals, 1.0)
}

/// Like [`cloud`], for a torus `length` times as long as it is wide.
fn stretched(count: usize, with_normals: bool, length: f64) -> (tempfile::TempDir, PathBuf) {
    let mut rng = stream(5, Stage::Candidates);
    let pairs: Vec<(DVec3, DVec3)> = (0..count)
        .map(|_| {
            let (u, v) = (TAU * unit(&mut rng), TAU * unit(&mut rng));
            let normal = dvec3(u.cos() * v.cos(), u.sin() * v.cos(), v.sin());
            let longer = dvec3(length, 1.0, 1.0);
            (longer * (3.0 * dvec3(u.cos(), u.sin(), 0.0) + normal), (normal / longer).normalize())
        })
        .collect();
    let points = Points::from_pairs(pairs);
    let points = if with_normals { points } else { Points::without_normals(points.positions().to_vec()) };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.ply");
    write_points_file(&path, &points, &Attributes::default(), None).unwrap();
    (folder, path)
}

fn options(points: usize, tiles: usize) -> PlanOptions {
    let sample = SampleOptions { density: SampleDensity::Points(points), sweeps: 3, ..SampleOptions::default() };
    PlanOptions { sample, memory: u64::MAX, tiles, sharp_edges: true }
}

/// Gives the points of a file colours that depend on their position, and a label for each side of the plane x = 0.
fn color(path: &Path) {
    let loaded = read_file(path, None).unwrap();
    let of_points = |name: &str, components: usize, scalar: Scalar, values: &dyn Fn(DVec3) -> Vec<f64>| {
        let values = loaded.mesh.positions.iter().flat_map(|&p| values(p)).collect();
        Attribute { name: name.into(), components, values, scalar }
    };
    let color = of_points("color", 3, Scalar::U8, &|p| color_at(p).to_array().map(f64::round).into());
    let side = of_points("label", 1, Scalar::U8, &|p| vec![f64::from(p.x > 0.0)]);
    let points = Points::new(loaded.mesh.positions.clone(), loaded.attributes.normals()).unwrap();
    let attributes = Attributes { vertex: vec![color, side], ..Attributes::default() };
    write_points_file(path, &points, &attributes, None).unwrap();
}

fn color_at(p: DVec3) -> DVec3 {
    128.0 + 100.0 * (p / dvec3(24.0, 4.0, 1.0))
}

/// Returns the samples of a file, without the notes on tiles, and the number of tiles.
fn tiled(path: &Path, options: &PlanOptions) -> (Sampled, usize) {
    let work = tempfile::tempdir().unwrap();
    let folder = TileFolder::at(work.path()).unwrap();
    let plan = make_plan(path, None, &folder, options, &()).unwrap();
    sample_tiles(&folder, None, &()).unwrap();
    (Sampled { notes: Vec::new(), ..merge(&folder, &()).unwrap() }, plan.tiles.len())
}

#[test]
#[ignore = "slow"]
fn any_tiling_gives_the_same_samples_on_any_number_of_threads() {
    let (_folder, path) = stretched(160_000, false, 8.0);
    color(&path);
    let (whole, one) = tiled(&path, &options(20_000, 1));
    assert_eq!((one, whole.points.positions().len()), (1, 20_000));
    for (least, threads) in [(2, 1), (8, 3)] {
        let (parts, tiles) = with_threads(Some(threads), || tiled(&path, &options(20_000, least))).unwrap();
        assert!(tiles >= least && parts == whole, "{tiles}");
    }
    let carried = whole.attributes();
    assert_eq!(carried.names(), ["color", "label"]);
    let colors = carried.get("color").unwrap();
    let places = whole.points.positions().iter().enumerate();
    let off: Vec<f64> =
        places.map(|(i, &p)| (DVec3::from_slice(colors.of(i)) - color_at(p)).abs().max_element()).collect();
    let (mean, farthest) = (off.iter().sum::<f64>() / off.len() as f64, off.into_iter().fold(0.0, f64::max));
    assert!(mean < 3.0 && farthest < 12.0, "{mean} {farthest}");
}

#[test]
fn tiles_in_a_box_are_of_the_points_in_it() {
    let (_folder, path) = cloud(30_000, true);
    let all = read_file(&path, None).unwrap().mesh.positions;
    let mut options = options(1000, 2);
    let within = Some([[-9.0, 0.5, -9.0], [9.0, 9.0, 9.0]]);
    options.sample = SampleOptions { within, scan_only: true, ..options.sample };
    let (sampled, _) = tiled(&path, &options);
    let (samples, numbers) = (sampled.points.positions(), sampled.indices.unwrap());
    assert!(samples.len() == 1000 && samples.iter().all(|p| p.y >= 0.5));
    assert!(numbers.iter().zip(samples).all(|(&number, p)| all[number as usize] == *p));
    options.sample.within = Some([[0.5; 3], [0.6; 3]]);
    let work = tempfile::tempdir().unwrap();
    let failed = make_plan(&path, None, &TileFolder::at(work.path()).unwrap(), &options, &()).unwrap_err().to_string();
    assert!(failed.contains("none of the 30000 points is inside 0.5,0.5,0.5,0.6,0.6,0.6"), "{failed}");
}

#[test]
#[ignore = "slow"]
fn any_tiling_gives_the_same_sound_mesh() {
    let (_folder, path) = stretched(80_000, true, 6.0);
    color(&path);
    let meshed = |tiles: usize, threads: usize| {
        let work = tempfile::tempdir().unwrap();
        let folder = TileFolder::at(work.path()).unwrap();
        let plan = make_plan(&path, None, &folder, &options(10_000, tiles), &()).unwrap();
        let made = |numbers: std::ops::Range<usize>| numbers.rev().try_for_each(|n| mesh_one(&folder, n, &()));
        sample_tiles(&folder, None, &()).unwrap();
        let mesh = with_threads(Some(threads), || {
            rounds(&plan).into_iter().try_for_each(made).unwrap();
            let mesh = merge_mesh(&folder).unwrap();
            let carried = nearest_attributes(&folder, &mesh, &()).unwrap();
            (mesh, carried)
        });
        (mesh.unwrap(), plan)
    };
    let ((mesh, carried), plan) = meshed(1, 2);
    // Pieces of all rounds contain triangles.
    assert!(plan.tiles.len() == 1 && rounds(&plan).len() == 5);
    let report = Report::of_pieces(&mesh, &carried, plan.wanted);
    let t = &report.output.topology;
    assert_eq!((t.vertices, t.euler, t.components, t.boundary_loops), (10_000, 0, 1, 0));
    assert!(report.faults().is_empty() && report.run.notes.len() == 1, "{:?}", report.run.notes);
    let shape = report.output.shape.unwrap();
    assert!(shape.theta_min > 30.0 && shape.q_mean > 0.97, "{shape:?}");
    let off =
        |p: DVec3| ((p.with_x(p.x / 6.0) - 3.0 * p.with_x(p.x / 6.0).with_z(0.0).normalize()).length() - 1.0).abs();
    let farthest = mesh.positions.iter().map(|&p| off(p)).fold(0.0, f64::max);
    assert!(farthest < 0.05 * shape.edge_mean, "{farthest} {}", shape.edge_mean);
    has_attributes_of_near_points(&mesh, &carried, shape.edge_mean);
    let (other, plan) = meshed(4, 1);
    assert!(plan.tiles.len() >= 4 && other == (mesh, carried));
}

/// Returns a temporary folder and a file in it with random points of a box around the origin.
fn boxed(count: usize, size: DVec3) -> (tempfile::TempDir, PathBuf) {
    let mut rng = stream(6, Stage::Candidates);
    let areas = [size.y * size.z, size.z * size.x, size.x * size.y];
    let positions = (0..count).map(|_| {
        let [u, v, w] = [0; 3].map(|_| unit(&mut rng) - 0.5);
        let chosen = unit(&mut rng) * areas.iter().sum::<f64>();
        let axis = if chosen < areas[0] { 0 } else { 1 + usize::from(chosen > areas[0] + areas[1]) };
        let mut point = dvec3(u, v, w);
        point[axis] = 0.5f64.copysign(point[axis]);
        size * point
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.ply");
    let points = Points::without_normals(positions.collect());
    write_points_file(&path, &points, &Attributes::default(), None).unwrap();
    (folder, path)
}

#[test]
#[ignore = "slow"]
fn sharp_edges_stay_in_any_tiling() {
    let size = dvec3(6.0, 1.0, 1.0);
    let (_folder, path) = boxed(200_000, size);
    let meshed = |tiles: usize, sharp_edges: bool| {
        let work = tempfile::tempdir().unwrap();
        let folder = TileFolder::at(work.path()).unwrap();
        let plan = make_plan(&path, None, &folder, &PlanOptions { sharp_edges, ..options(8_000, tiles) }, &()).unwrap();
        sample_tiles(&folder, None, &()).unwrap();
        let made = |numbers: std::ops::Range<usize>| numbers.rev().try_for_each(|n| mesh_one(&folder, n, &()));
        rounds(&plan).into_iter().try_for_each(made).unwrap();
        merge_mesh(&folder).unwrap()
    };
    let mesh = meshed(1, true);
    let report = Report::of_pieces(&mesh, &Carried::default(), Some(8_000));
    assert!(report.faults().is_empty() && report.output.topology.euler == 2, "{:?}", report.faults());
    // The two flat triangles of a side meet across each of its edges; cutting these off would cost volume.
    let volume = |mesh: &Mesh| {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum::<f64>() / 6.0
    };
    let [sharp, round] = [&mesh, &meshed(1, false)].map(|mesh| 6.0 - volume(mesh));
    assert!(sharp.abs() < 1e-3 && round > 0.01, "{sharp} {round}");
    for corner in 0..8 {
        let corner = size * (dvec3(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2)) - 0.5);
        let nearest = mesh.positions.iter().map(|p| p.distance(corner)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.01, "{corner}: {nearest}");
    }
    assert_eq!(meshed(4, true), mesh);
}

/// Checks that the vertices have about the colours and labels that [`color`] gives there, and newly computed normals.
fn has_attributes_of_near_points(mesh: &Mesh, Carried { attributes, lost, .. }: &Carried, edge: f64) {
    assert!(lost.is_empty() && attributes.names().len() == 3, "{:?} {lost:?}", attributes.names());
    let [colors, sides] = ["color", "label"].map(|name| attributes.get(name).unwrap());
    let near = color_at(DVec3::splat(0.7 * edge)) - color_at(DVec3::ZERO);
    for (v, &p) in mesh.positions.iter().enumerate() {
        let off = (DVec3::from_slice(colors.of(v)) - color_at(p)).abs();
        assert!(off.cmple(near + 0.5).all(), "{off} at {p}");
        assert!(p.x.abs() < 0.7 * edge || sides.of(v) == [f64::from(p.x > 0.0)], "{p}");
    }
    assert!(attributes.normals().iter().zip(&mesh.positions).all(|(n, p)| n.is_normalized() && n.z * p.z >= -0.01));
}

#[test]
#[ignore = "slow"]
fn a_subset_is_of_the_input_in_any_tiling() {
    let (_folder, path) = stretched(120_000, true, 8.0);
    color(&path);
    let scan_only = |tiles| {
        let mut options = options(8000, tiles);
        options.sample.scan_only = true;
        tiled(&path, &options)
    };
    let ((whole, _), (parts, tiles)) = (scan_only(1), scan_only(8));
    assert!(tiles >= 8 && parts == whole);
    let input = read_file(&path, None).unwrap();
    let all = &input.mesh.positions;
    let attributes = whole.attributes();
    let numbers = whole.indices.unwrap();
    assert_eq!(attributes.names(), ["index", "color", "label"]);
    assert_eq!(attributes.vertex[1..], input.attributes.of_vertices(&numbers).vertex[1..]);
    assert!(numbers.is_sorted() && numbers.len() == 8000);
    assert!(numbers.iter().zip(whole.points.positions()).all(|(&i, p)| all[i as usize] == *p));
}

/// Returns the mean and standard deviation of the distance of points to their nearest neighbour.
fn nearest(points: &[DVec3]) -> (f64, f64) {
    let near = spectral_remesh::stages::spatial::kdtree::Neighbors::new(points);
    let mut found = Vec::new();
    let distances: Vec<f64> = points
        .iter()
        .map(|&p| {
            near.collect_nearest(p, 2, &mut found);
            found[1].distance_squared.sqrt()
        })
        .collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    (mean, (distances.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / distances.len() as f64).sqrt())
}

#[test]
#[ignore = "slow"]
fn samples_are_like_those_of_the_whole() {
    let (_folder, path) = cloud(150_000, false);
    let mut by_tiles = options(10_000, 4);
    by_tiles.sample.sweeps = SampleOptions::default().sweeps;
    let (parts, tiles) = tiled(&path, &by_tiles);
    let whole = sample(&Input::from(&read_file(&path, None).unwrap()), &by_tiles.sample, &()).unwrap();
    assert_eq!((parts.points.positions().len(), tiles >= 4), (whole.points.positions().len(), true));
    let ((mean, deviation), (expected, usual)) = (nearest(parts.points.positions()), nearest(whole.points.positions()));
    assert!((mean / expected - 1.0).abs() < 0.01 && deviation < 1.3 * usual, "{mean} {expected} {deviation} {usual}");
    // Samples lie on the torus within a twentieth of their spacing, and their normals point outwards.
    let outwards = |p: DVec3| p - 3.0 * p.with_z(0.0).normalize();
    let off = parts.points.positions().iter().map(|p| (outwards(*p).length() - 1.0).abs()).fold(0.0, f64::max);
    assert!(off < 0.05 * mean, "{off} {mean}");
    let looks_outwards = |(p, n): (&DVec3, &DVec3)| outwards(*p).normalize().dot(*n) > 0.99;
    assert!(parts.points.positions().iter().zip(parts.points.normals()).all(looks_outwards));
}

#[test]
fn what_is_missing_in_a_folder_is_one_line() {
    let (home, path) = cloud(40_000, true);
    let folder = TileFolder::make(&home.path().join("work")).unwrap();
    let failed = |result: spectral_remesh::Result<()>, words: &str| {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("; ") && !message.contains('\n'), "{message}");
    };
    failed(TileFolder::at(&home.path().join("nowhere")).map(drop), "there is no such folder");
    failed(sample_one(&folder, 0, &()), "there is no plan in it");
    let plan = make_plan(&path, None, &folder, &options(3000, 4), &()).unwrap();
    failed(sample_one(&folder, plan.tiles.len(), &()), "there is no tile");
    failed(merge(&folder, &()).map(drop), "tile 0 is not sampled yet");
    failed(mesh_one(&folder, 1, &()), "piece 0 of the mesh is not made yet");
    mesh_one(&folder, 0, &()).unwrap();
    failed(mesh_one(&folder, 1, &()), "is not sampled yet");
    failed(merge_mesh(&folder).map(drop), "of the mesh is not made yet");
    let pieces = rounds(&plan).last().unwrap().end;
    failed(mesh_one(&folder, pieces, &()), "there is no piece");
    failed(mesh_one(&folder, pieces - 1, &()), "of the mesh is not made yet");
    let points = home.path().join("work/points");
    let bytes = fs::read(&points).unwrap();
    fs::write(&points, &bytes[..bytes.len() / 2]).unwrap();
    failed((0..plan.tiles.len()).try_for_each(|tile| sample_one(&folder, tile, &())), "shorter than it was");
    fs::write(&path, &fs::read(&path).unwrap()[..1000]).unwrap();
    failed(make_plan(&path, None, &folder, &options(3000, 4), &()).map(drop), "cannot be read in pieces");
    // An unfinished plan does not count as a plan: the last point of this file is not finite.
    let (_other, path) = cloud(40_000, true);
    let mut bytes = fs::read(&path).unwrap();
    let last = bytes.len() - 48;
    bytes[last..last + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    fs::write(&path, &bytes).unwrap();
    let unfinished = home.path().join("work/.remesh-unfinished");
    fs::write(&unfinished, "of a process that was killed").unwrap();
    failed(make_plan(&path, None, &folder, &options(3000, 4), &()).map(drop), "byte ");
    assert!(!folder.has_plan() && !unfinished.exists());
}

#[cfg(feature = "cli")]
mod command {
    use super::*;

    fn remesh(folder: &Path, words: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_remesh"));
        command.current_dir(folder).args(words.split(' ')).output().unwrap()
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort_unstable();
        names
    }

    #[test]
    fn out_of_core_and_by_hand_give_the_same_bytes_and_leave_nothing() {
        let (home, _) = cloud(60_000, false);
        let home = home.path();
        fs::create_dir(home.join("temp")).unwrap();
        let common = "--points 3000 --sweeps 3";
        let out = remesh(home, &format!("sample cloud.ply a.ply {common} --out-of-core --temp temp"));
        let said = String::from_utf8(out.stderr).unwrap();
        assert!(
            out.status.success() && said.contains("MB of temporary files in ") && said.contains("temp/.remesh-tiles-"),
            "{said}"
        );
        assert!(names(&home.join("temp")).is_empty());
        let planned = remesh(home, &format!("tiles plan cloud.ply work {common} --tiles 5"));
        let text = String::from_utf8(planned.stdout).unwrap();
        let tiles: usize = text.split(' ').next().unwrap().parse().expect(&text);
        assert!(tiles >= 5);
        for tile in (0..tiles).rev() {
            assert!(remesh(home, &format!("tiles sample work {tile} --threads 1")).status.success());
        }
        assert!(remesh(home, "tiles merge work b.ply").status.success());
        assert!(fs::read(home.join("a.ply")).unwrap() == fs::read(home.join("b.ply")).unwrap());
        let last = text.trim().rsplit(['-', ' ']).next().unwrap();
        assert!(
            remesh(home, "tiles merge work c.obj --mesh").status.code() == Some(1) && last.parse::<usize>().is_ok()
        );
        assert!(remesh(home, "tiles mesh work").status.success());
        let merged = remesh(home, "tiles merge work c.obj --mesh");
        let table = String::from_utf8(merged.stdout).unwrap();
        assert!(merged.status.success() && table.contains("Euler characteristic                  0"), "{table}");
        assert_eq!(read_file(&home.join("c.obj"), None).unwrap().mesh.positions.len(), 3000);
        let points = Points::without_normals(read_file(&home.join("cloud.ply"), None).unwrap().mesh.positions);
        write_points_file(&home.join("cloud.xyz"), &points, &Attributes::default(), None).unwrap();
        assert!(remesh(home, &format!("sample cloud.xyz c.ply {common} --out-of-core --temp temp")).status.success());
        assert!(
            fs::read(home.join("a.ply")).unwrap() == fs::read(home.join("c.ply")).unwrap(),
            "text has other samples"
        );
    }

    #[test]
    #[ignore = "slow"]
    fn a_mesh_that_is_too_large_for_the_memory_is_made_in_pieces() {
        let (home, _) = cloud(64_000, true);
        let home = home.path();
        fs::create_dir(home.join("temp")).unwrap();
        let line = "--points 21000 --memory 60M --temp temp";
        let out = remesh(home, &format!("cloud.ply a.ply {line}"));
        let (table, said) = (String::from_utf8(out.stdout).unwrap(), String::from_utf8(out.stderr).unwrap());
        assert!(out.status.success() && said.contains("MB of temporary files in "), "{said}");
        assert!(table.contains("made piece by piece") && names(&home.join("temp")).is_empty(), "{table}");
        for words in ["plan cloud.ply work --points 21000", "sample work", "mesh work", "merge work b.ply --mesh"] {
            assert!(remesh(home, &format!("tiles {words}")).status.success());
        }
        assert!(fs::read(home.join("a.ply")).unwrap() == fs::read(home.join("b.ply")).unwrap());
        assert_eq!(read_file(&home.join("a.ply"), None).unwrap().mesh.positions.len(), 21_000);
        // A cloud is meshed as a whole if a request rules out pieces, or if it is too noisy or too sparse for them.
        let smooth = read_file(&home.join("cloud.ply"), None).unwrap();
        let mut rng = stream(7, Stage::Candidates);
        let lifted = smooth.mesh.positions.iter().zip(smooth.attributes.normals());
        let thick = Points::without_normals(lifted.map(|(p, n)| *p + 0.3 * (unit(&mut rng) - 0.5) * n).collect());
        write_points_file(&home.join("thick.ply"), &thick, &Attributes::default(), None).unwrap();
        for words in ["cloud.ply --points 21000 --optimize 0", "thick.ply --points 21000", "cloud.ply --points 22000"] {
            let out = remesh(home, &words.replace(" --points", " c.ply --memory 60M --temp temp --points"));
            let table = String::from_utf8(out.stdout).unwrap();
            assert!(table.contains("vertices ") && !table.contains("made piece by piece"), "{table}");
        }
        assert!(remesh(home, "tiles plan thick.ply noisy --points 21000").status.success());
        let refused = String::from_utf8(remesh(home, "tiles mesh noisy 0").stderr).unwrap();
        assert!(refused.contains("noise of its points is larger than their distance"), "{refused}");
        // Finished work of an interrupted run is not repeated: here, its plan is recorded as belonging to this file.
        fs::rename(home.join("work"), home.join("temp/c.ply.remesh-tiles")).unwrap();
        let kept = TileFolder::at(&home.join("temp/c.ply.remesh-tiles")).unwrap();
        let sample = SampleOptions { density: SampleDensity::Points(21_000), ..SampleOptions::default() };
        kept.note(&home.join("cloud.ply"), &PlanOptions { sample, memory: 0, tiles: 1, sharp_edges: true }).unwrap();
        let out = remesh(home, &format!("cloud.ply c.ply {line} --resume"));
        assert!(out.status.success() && !String::from_utf8(out.stderr).unwrap().contains("temporary files"));
        assert!(fs::read(home.join("c.ply")).unwrap() == fs::read(home.join("b.ply")).unwrap());
        assert!(names(&home.join("temp")).is_empty());
    }

    #[test]
    #[ignore = "slow"]
    fn a_run_goes_on_from_what_is_finished() {
        let (home, path) = cloud(60_000, true);
        let home = home.path();
        let work = TileFolder::make(&home.join("a.ply.remesh-tiles")).unwrap();
        let mut options = options(3000, 5);
        make_plan(&path, None, &work, &options, &()).unwrap();
        work.note(&path, &options).unwrap();
        sample_one(&work, 1, &()).unwrap();
        let line = "sample cloud.ply a.ply --points 3000 --sweeps 3 --temp . --resume";
        let out = remesh(home, line);
        let text = String::from_utf8(out.stdout).unwrap();
        // A new plan would have one tile.
        assert!(out.status.success() && !text.contains("of which there were 1\n"), "{text}");
        assert_eq!(names(home), ["a.ply", "cloud.ply"]);
        options.tiles = 1;
        assert!(
            read_file(&home.join("a.ply"), None).unwrap().mesh.positions == tiled(&path, &options).0.points.positions()
        );
    }

    #[test]
    fn what_goes_wrong_is_one_line_and_leaves_nothing() {
        let (home, path) = cloud(60_000, true);
        let home = home.path();
        fs::create_dir(home.join("temp")).unwrap();
        let fails = |words: &str, status: i32, expected: &str| {
            let out = remesh(home, words);
            let said = String::from_utf8(out.stderr).unwrap();
            let lines: Vec<&str> = said.lines().filter(|line| !line.contains("MB of temporary files")).collect();
            assert_eq!((out.status.code(), lines.len()), (Some(status), 1), "{said}");
            assert!(lines[0].contains(expected), "{said}");
            assert!(names(&home.join("temp")).is_empty() && !home.join("a.ply").exists());
        };
        let line = "sample cloud.ply a.ply --points 3000 --out-of-core --temp";
        fails(&format!("{line} nowhere"), 1, "nowhere: there is no such folder; create it");
        fails(&format!("{line} temp --sigma-n 0.5"), 2, "--sigma-n: tiles are sampled evenly");
        fails(&format!("{line} temp --normal-neighbors 20"), 2, "--normal-neighbors: the normals of tiles");
        fails(&format!("{line} temp --normal-fit sphere"), 2, "--normal-fit: the normals of tiles");
        fails(&format!("{line} temp --levels 3"), 2, "--levels: tiles are in no progressive order");
        fails("sample cloud.ply a.ply --points 3000 --resume", 2, "--temp");
        fails("sample cloud.ply a.ply --points 3000 --out-of-core --memory much", 2, "400M");
        // A point that is not finite, in the middle of the file.
        let mut bytes = fs::read(&path).unwrap();
        let middle = bytes.len() - 30_000 * 48;
        bytes[middle..middle + 8].copy_from_slice(&f64::NAN.to_le_bytes());
        fs::write(&path, &bytes).unwrap();
        fails(&format!("{line} temp"), 1, "cloud.ply, byte ");
        fs::write(home.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
        fails("sample a.obj a.ply --points 3000 --out-of-core --temp temp", 1, "cannot be read in pieces");
    }

    #[cfg(unix)]
    #[test]
    #[ignore = "slow"]
    fn an_interrupt_leaves_no_temporary_files() {
        use std::io::{BufRead, BufReader};
        let (home, _) = cloud(300_000, false);
        let home = home.path();
        fs::create_dir(home.join("temp")).unwrap();
        let words = "sample cloud.ply a.ply --points 60000 --sweeps 5000 --out-of-core --temp temp -v";
        let mut running = Command::new(env!("CARGO_BIN_EXE_remesh"))
            .current_dir(home)
            .args(words.split(' '))
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(running.stderr.take().unwrap()).lines();
        assert!(said.any(|line| line.unwrap().ends_with(" s sample tiles")));
        assert_eq!(names(&home.join("temp")).len(), 1);
        let id = running.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let last = said.map(|line| line.unwrap()).last().unwrap();
        assert_eq!(running.wait().unwrap().code(), Some(130));
        assert!(last.contains("interrupted; no file was changed"), "{last}");
        assert!(names(&home.join("temp")).is_empty() && !home.join("a.ply").exists());
    }
}
