//! Clouds with more points than are useful: which of them are kept, for any order of the points.

use glam::{DVec3, dvec3};
use spectral_remesh::io::file::{read_at_most, read_file, write_points_file};
use spectral_remesh::stages::base::rng::{Stage, stream, unit};
use spectral_remesh::{
    Attribute, Attributes, Input, Points, SampleDensity, SampleOptions, Scalar, sample, with_threads,
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

#[test]
fn what_is_kept_of_a_file_are_points_of_it_with_all_that_they_have() {
    let (_folder, path) = file(30_000);
    let all = read_file(&path, None).unwrap();
    let some = read_at_most(&path, None, Some(1000)).unwrap();
    let thinned = some.thinned.unwrap();
    let kept = &thinned.numbers;
    assert!(thinned.points == 30_000 && (700..=1000).contains(&kept.len()), "{}", kept.len());
    let of_all: Vec<DVec3> = kept.iter().map(|&p| all.mesh.positions[p as usize]).collect();
    assert!(some.mesh.positions == of_all && some.attributes == all.attributes.of_vertices(kept));
    assert!(all.attributes.vertex.len() == 2 && some.notes == all.notes);
    for wanted in [None, Some(30_000)] {
        assert!(read_at_most(&path, None, wanted).unwrap() == all, "{wanted:?}");
    }
    let text = path.with_extension("xyz");
    let (points, attributes) = torus(30_000);
    write_points_file(&text, &points, &attributes, None).unwrap();
    let of_text = read_at_most(&text, None, Some(1000)).unwrap();
    assert!(of_text.thinned.unwrap().numbers == *kept && of_text.mesh == some.mesh);
    assert!(read_at_most(&text, None, Some(30_000)).unwrap().thinned.is_none());
}

#[test]
fn a_file_that_is_cut_short_or_has_a_point_nowhere_is_told_as_ever() {
    let (_folder, path) = file(3000);
    let bytes = fs::read(&path).unwrap();
    let message = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let [all, some] = [None, Some(100)].map(|wanted| read_at_most(&path, None, wanted).unwrap_err().to_string());
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
    let some = read_at_most(&path, None, Some(3 * 200 + 300_000)).unwrap();
    assert!(some.thinned.is_some() && sampled(&Input::from(&some), 2) == one);
}
