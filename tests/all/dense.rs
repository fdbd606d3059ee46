//! Clouds with more points than are useful: which of them are kept, for any order of the points.

use glam::{DVec3, dvec3};
use spectral_remesh::io::file::{read_file, read_wanted, write_points_file};
use spectral_remesh::stages::base::rng::{Stage, stream, unit};
use spectral_remesh::stages::prepare::thin::Wanted;
use spectral_remesh::{
    Attribute, Attributes, Grading, Input, Options, Origin, Points, SampleDensity, SampleOptions, Scalar, Selection,
    Values, remesh, sample, with_threads,
};
use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

/// Returns random points of a torus with their normals, in coordinates that are exact in f32, and a number for each point.
fn torus(count: usize) -> (Points, Attributes) {
    let mut rng = stream(5, Stage::Candidates);
    let pairs = (0..count).map(|_| {
        let (u, v) = (TAU * unit(&mut rng), TAU * unit(&mut rng));
        let normal = dvec3(u.cos() * v.cos(), u.sin() * v.cos(), v.sin());
        (3.0 * dvec3(u.cos(), u.sin(), 0.0) + normal, normal)
    });
    let points = Points::from_pairs(pairs.map(|(p, n)| (p.as_vec3().as_dvec3(), n.as_vec3().as_dvec3())));
    let values = (0..count).map(|i| (i % 251) as f64).collect();
    let label = Attribute { name: "label".into(), components: 1, values, scalar: Scalar::U8 };
    (points, Attributes { vertex: vec![label], ..Attributes::default() })
}

/// Returns a temporary folder, and a file in it with `count` points.
fn file(count: usize) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.ply");
    let (points, attributes) = torus(count);
    write_points_file(&path, &points, &attributes, None).unwrap();
    (folder, path)
}

/// At most about this many points.
fn most(points: usize) -> Wanted {
    Wanted { points: Some(points), within: None }
}

#[test]
fn what_is_kept_of_a_file_are_points_of_it_with_all_that_they_have() {
    let (_folder, path) = file(30_000);
    let all = read_file(&path, None).unwrap();
    let some = read_wanted(&path, None, most(1000)).unwrap();
    let thinned = some.thinned.unwrap();
    let kept = &thinned.numbers;
    assert!(thinned.points == 30_000 && (700..=1000).contains(&kept.len()), "{}", kept.len());
    let of_all: Vec<DVec3> = kept.iter().map(|&p| all.mesh.positions[p as usize]).collect();
    assert!(some.mesh.positions == of_all && some.attributes == all.attributes.of_vertices(kept));
    assert!(all.attributes.vertex.len() == 2 && some.notes == all.notes);
    for wanted in [Wanted::default(), most(30_000)] {
        assert!(read_wanted(&path, None, wanted).unwrap() == all, "{wanted:?}");
    }
    let text = path.with_extension("xyz");
    let (points, attributes) = torus(30_000);
    write_points_file(&text, &points, &attributes, None).unwrap();
    let of_text = read_wanted(&text, None, most(1000)).unwrap();
    assert!(of_text.thinned.unwrap().numbers == *kept && of_text.mesh == some.mesh);
    assert!(read_wanted(&text, None, most(30_000)).unwrap().thinned.is_none());
}

#[test]
fn a_file_that_is_cut_short_or_has_a_point_nowhere_is_told_as_ever() {
    let (_folder, path) = file(3000);
    let bytes = fs::read(&path).unwrap();
    let message = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let [all, some] =
            [Wanted::default(), most(100)].map(|wanted| read_wanted(&path, None, wanted).unwrap_err().to_string());
        assert_eq!(all, some);
        all
    };
    assert!(message(&bytes[..bytes.len() - 5]).contains("bytes for at most 2999"));
    let mut nowhere = bytes.clone();
    let row = (bytes.len() - bytes.windows(11).position(|w| w == b"end_header\n").unwrap() - 11) / 3000;
    let at = bytes.len() - 7 * row;
    // This is NaN for any type of the first coordinate.
    nowhere[at..at + 8].fill(0xff);
    assert!(message(&nowhere).contains("not finite"));
}

#[test]
#[ignore = "slow"]
fn samples_of_a_dense_cloud_are_points_of_it_and_the_same_from_a_file_and_with_any_threads() {
    let (_folder, path) = file(360_000);
    let all = read_file(&path, None).unwrap();
    let options = SampleOptions { density: SampleDensity::Points(200), scan_only: true, ..SampleOptions::default() };
    let sampled =
        |input: &Input, threads| with_threads(Some(threads), || sample(input, &options, &())).unwrap().unwrap();
    let one = sampled(&Input::from(&all), 1);
    let cloud = one.cloud.as_ref().unwrap();
    assert!(cloud.thinned_from == 360_000 && cloud.points < 310_000 && cloud.cell > 0.0, "{cloud:?}");
    assert!(one.notes[0].contains("thinned to"), "{:?}", one.notes);
    let numbers = one.indices.as_ref().unwrap();
    let of_all = numbers.iter().map(|&p| all.mesh.positions[p as usize]);
    assert!(numbers.len() == 200 && of_all.eq(one.points.positions().iter().copied()));
    let labels: Vec<f64> = numbers.iter().map(|&p| f64::from(p % 251)).collect();
    assert_eq!(one.attributes().get("label").map(|label| &label.values), Some(&labels));
    assert!(sampled(&Input::from(&all), 2) == one);
    let some = read_wanted(&path, None, most(3 * 200 + 300_000)).unwrap();
    assert!(some.thinned.is_some() && sampled(&Input::from(&some), 2) == one);
}

/// All points in this box.
fn in_box(corners: [[f64; 3]; 2]) -> Wanted {
    Wanted { points: None, within: Some(corners.into()) }
}

/// A box that contains a quarter of the torus.
const BOX: [[f64; 3]; 2] = [[-9.0, 0.0, -9.0], [0.0, 9.0, 9.0]];

#[test]
fn of_a_cloud_only_the_points_in_a_box_are_remeshed() {
    let (_folder, path) = file(6000);
    let all = read_file(&path, None).unwrap();
    let part = Some(Selection::Box(BOX));
    // Values are given for all points.
    let lengths = Grading::Field(Values::Given(vec![0.3; 6000]));
    let surface = Options { part, grading: lengths, ..Options::points(300) };
    let of_all = remesh(&Input::from(&all), &surface.clone().into(), &()).unwrap();
    assert!(of_all.notes[0].contains("of 6000 points are inside the box"), "{:?}", of_all.notes);
    assert!(of_all.mesh.positions.iter().all(|p| p.x < 0.2 && p.y > -0.2));
    let some = read_wanted(&path, None, in_box(BOX)).unwrap();
    assert!(some.mesh.positions.iter().all(|p| p.x <= 0.0 && p.y >= 0.0) && some.mesh.positions.len() > 1000);
    let of_some = remesh(&Input::from(&some), &surface.into(), &()).unwrap();
    assert!(of_some.mesh == of_all.mesh && of_some.origins == of_all.origins && of_some.notes == of_all.notes);
    // Origins are numbers of points of the file.
    let place =
        |origin: &Origin| (0..3).map(|k| origin.weights[k] * all.mesh.positions[origin.vertices[k] as usize]).sum();
    let strays = of_all.origins.iter().zip(&of_all.mesh.positions).filter(|(o, p)| p.distance(place(o)) > 0.2).count();
    assert_eq!(strays, 0);
    let options = |points| SampleOptions {
        density: SampleDensity::Points(points),
        within: Some(BOX),
        scan_only: true,
        ..SampleOptions::default()
    };
    let sampled = sample(&Input::from(&all), &options(100), &()).unwrap();
    let of_file = |&p: &u32| all.mesh.positions[p as usize];
    assert!(sampled.indices.unwrap().iter().map(of_file).eq(sampled.points.positions().iter().copied()));
}

#[test]
fn a_box_without_points_and_a_box_for_a_mesh_are_one_line() {
    let (_folder, path) = file(3000);
    let all = read_file(&path, None).unwrap();
    let part = Some(Selection::Box([[9.0; 3], [10.0; 3]]));
    let surface = Options { part, ..Options::points(300) };
    let of_file = read_wanted(&path, None, in_box([[9.0; 3], [10.0; 3]])).unwrap_err().to_string();
    let of_all = remesh(&Input::from(&all), &surface.into(), &()).unwrap_err().to_string();
    for message in [of_file, of_all] {
        assert!(message.contains("none of the 3000 points is inside 9,9,9,10,10,10: those"), "{message}");
    }
    let mesh = Input::mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    let options = SampleOptions { within: Some(BOX), ..SampleOptions::default() };
    assert!(sample(&mesh, &options, &()).unwrap_err().to_string().contains("the input is a mesh"));
    let upside_down = SampleOptions { within: Some([[1.0; 3], [0.0; 3]]), ..SampleOptions::default() };
    assert!(sample(&Input::from(&all), &upside_down, &()).unwrap_err().to_string().contains("from 1 to 0 along x"));
}
