//! The Rust code of `docs/library.md`, compiled and run, and the guarantees of [`remesh()`].

use spectral_remesh::io::file::{read_file, write_file};
use spectral_remesh::{Input, Options, remesh};
use std::path::Path;

pub fn clean(from: &Path, to: &Path) -> spectral_remesh::Result<bool> {
    let loaded = read_file(from, None)?;
    let outcome = remesh(&Input::from(&loaded), &Options::points(2000).into(), &())?;
    write_file(to, &outcome.mesh, &outcome.attributes, None)?;
    Ok(outcome.verified())
}

use spectral_remesh::{Grading, RemeshOptions};

pub fn graded(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> spectral_remesh::Result<Vec<[f64; 3]>> {
    let surface = Options { grading: Grading::Curvature(1.0), ..Options::points(2000) };
    let options = RemeshOptions { surface, without_report: true, ..RemeshOptions::default() };
    Ok(remesh(&Input::mesh(positions, triangles), &options, &())?.positions().to_vec())
}

use crate::common::{cuboid, cylinder, plate, sheet, soup, sphere, together};
use glam::{DVec2, DVec3, dvec3};
use spectral_remesh::stages::geom::triangle::closest_point;
use spectral_remesh::{
    Attribute, Attributes, Density, Error, Fault, MaxError, Mesh, Monitor, Origin, Outcome, ReconstructOptions,
    SampleOptions, Scalar, Setting, quality, reconstruct, remesh_levels, sample,
};
use std::sync::Mutex;

#[test]
fn the_page_has_this_code() {
    let page = include_str!("../../docs/library.md");
    let blocks: Vec<&str> = page.split("```rust\n").skip(1).filter_map(|rest| rest.split("\n```").next()).collect();
    assert_eq!(blocks.len(), 2);
    blocks.iter().for_each(|block| assert!(include_str!("library.rs").contains(block), "{block}"));
}

#[test]
fn a_file_is_cleaned() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("blob.ply");
    let input = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/blob.obj");
    assert_eq!(clean(&input, &output), Ok(true));
    assert_eq!(read_file(&output, None).unwrap().mesh.positions.len(), 2000);
}

fn arrays(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| p.to_array()).collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    glam::DVec3::from(a).distance(b.into())
}

/// Returns the point of the input at which an origin lies.
fn place(origin: &Origin, positions: &[[f64; 3]]) -> [f64; 3] {
    let at = |k: usize| (0..3).map(|i| origin.weights[i] * positions[origin.vertices[i] as usize][k]).sum();
    [0, 1, 2].map(at)
}

#[test]
fn slices_are_graded() {
    let cone = cylinder(40, 1.0, 0.1, 2.0);
    assert_eq!(graded(&arrays(&cone), &cone.triangles).unwrap().len(), 2000);
}

/// Checks that vertices and triangles of a result are within `near` of their origins.
fn know_where_they_came_from(input: &Mesh, points: usize, near: f64) {
    let outcome = remesh(&Input::from(input), &Options::points(points).into(), &()).unwrap();
    assert!(outcome.verified(), "{:?}", outcome.shortcomings);
    assert_eq!((outcome.origins.len(), outcome.triangle_origins.len()), (points, outcome.triangles().len()));
    let positions = arrays(input);
    for (&position, origin) in outcome.positions().iter().zip(&outcome.origins) {
        assert_eq!(origin.vertices, input.triangles[origin.triangle.unwrap() as usize]);
        assert!((origin.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12 && origin.weights.iter().all(|&w| w >= 0.0));
        assert!(distance(position, place(origin, &positions)) < near, "{origin:?} {position:?}");
    }
    for (t, &origin) in outcome.triangle_origins.iter().enumerate() {
        let facing = outcome.mesh.area_vector(t).dot(input.area_vector(origin as usize));
        let [a, b, c] = input.corners(origin as usize);
        let centre = outcome.mesh.corners(t).into_iter().sum::<DVec3>() / 3.0;
        assert!(facing > 0.0 && centre.distance(closest_point(centre, [a, b, c])) < 1.5 * near);
    }
}

#[test]
fn every_vertex_and_triangle_knows_where_it_came_from() {
    // Repaired, refined, and cut along its sharp edges.
    let input = soup(&together(&[cuboid(dvec3(1.0, 2.0, 3.0)), sphere(3, 5.0 * DVec3::X, 1.0)]));
    know_where_they_came_from(&input, 1500, 0.02);
    // Coarsened.
    know_where_they_came_from(&sphere(7, DVec3::ZERO, 1.0), 500, 0.01);
}

#[test]
fn components_without_room_for_their_shape_are_told() {
    let small = |x: f64| sphere(2, x * DVec3::X, 0.02);
    let all: Vec<Mesh> = std::iter::once(sphere(4, DVec3::ZERO, 1.0)).chain((2..32).map(|x| small(x.into()))).collect();
    let warnings =
        |mesh: &Mesh, points: usize| remesh(&Input::from(mesh), &Options::points(points).into(), &()).unwrap().warnings;
    let told = warnings(&together(&all), 500);
    assert!(told.len() == 1 && told[0].starts_with("30 components are smaller"), "{told:?}");
    assert!(told[0].contains("0.04 % of the area") && told[0].contains("has 128 triangles"), "{told:?}");
    // Two spheres of the same size have room, and a flat square of two triangles stays as it was.
    assert!(warnings(&together(&[all[0].clone(), sphere(3, 3.0 * DVec3::X, 1.0)]), 500).is_empty());
    assert!(warnings(&together(&[all[0].clone(), sheet(1, 1)]), 100).is_empty());
}

#[test]
fn vertices_of_a_cloud_lie_between_its_points() {
    let positions = arrays(&sphere(4, DVec3::ZERO, 1.0));
    let values = positions.iter().flatten().map(|x| 0.5 + 0.5 * x).collect();
    let color = Attribute { name: "color".into(), components: 3, values, scalar: Scalar::F32 };
    let attributes = Attributes { vertex: vec![color], ..Attributes::default() };
    let input = Input::points(&positions).with_attributes(&attributes);
    let outcome = remesh(&input, &Options::points(500).into(), &()).unwrap();
    assert!(outcome.verified() && outcome.triangle_origins.is_empty());
    let colors = outcome.attributes.vertex[0].values.chunks_exact(3);
    for ((&position, origin), color) in outcome.positions().iter().zip(&outcome.origins).zip(colors) {
        assert_eq!(origin.triangle, None);
        assert!(distance(position, place(origin, &positions)) < 0.05);
        assert!((0..3).all(|k| (color[k] - 0.5 - 0.5 * position[k]).abs() < 0.03));
    }
}

#[test]
fn each_level_is_what_its_number_of_vertices_gives_alone() {
    // Separate triangles to join, and a cloud to mesh.
    let mesh = soup(&sphere(4, DVec3::ZERO, 1.0));
    let positions = arrays(&sphere(4, DVec3::ZERO, 1.0));
    for input in [Input::from(&mesh), Input::points(&positions)] {
        let mut levels = Vec::new();
        let keep = &mut |outcome| {
            levels.push(outcome);
            Ok(())
        };
        remesh_levels(&input, &Options::points(7).into(), &[600, 200, 60], keep, &()).unwrap();
        assert_eq!(levels.len(), 3);
        for (level, count) in levels.iter().zip([600, 200, 60]) {
            let alone = remesh(&input, &Options::points(count).into(), &()).unwrap();
            assert!(level.mesh == alone.mesh && level.origins == alone.origins && level.report == alone.report);
            assert!(level.of_points == alone.of_points && level.verified());
        }
    }
}

#[test]
fn levels_fall_and_may_be_given_up() {
    let mesh = sphere(3, DVec3::ZERO, 1.0);
    let made = |counts: &[usize], each: &mut dyn FnMut(Outcome) -> spectral_remesh::Result<()>| {
        remesh_levels(&Input::from(&mesh), &RemeshOptions::default(), counts, each, &())
    };
    for (counts, words) in [
        (&[][..], "no number"),
        (&[90, 2], "2 vertices"),
        (&[90, 100], "100 comes after 90"),
        (&[90, 90], "90 comes after"),
    ] {
        let error = made(counts, &mut |_| Ok(())).unwrap_err();
        assert!(matches!(error, Error::Option { option: Setting::Levels, .. }) && error.to_string().contains(words));
    }
    let mut count = 0;
    let stop = &mut |_| {
        count += 1;
        Err(Error::Cancelled)
    };
    assert_eq!((made(&[90, 50], stop), count), (Err(Error::Cancelled), 1));
}

#[test]
fn the_share_that_is_done_grows_over_all_levels() {
    #[derive(Default)]
    struct Shares(Mutex<Vec<f64>>);
    impl Monitor for Shares {
        fn progress(&self, done: f64) {
            self.0.lock().unwrap().push(done);
        }
    }
    let (mesh, monitor) = (sphere(3, DVec3::ZERO, 1.0), Shares::default());
    let mut after = Vec::new();
    let keep = &mut |_| {
        after.push(*monitor.0.lock().unwrap().last().unwrap());
        Ok(())
    };
    remesh_levels(&Input::from(&mesh), &RemeshOptions::default(), &[300, 100], keep, &monitor).unwrap();
    assert_eq!(after, [0.75, 1.0]);
    assert!(monitor.0.into_inner().unwrap().is_sorted());
}

#[test]
fn arrays_that_make_no_mesh_are_refused_by_every_job() {
    let mesh = sphere(1, DVec3::ZERO, 1.0);
    let faults = |mesh: &Mesh, attributes: &Attributes| {
        let input = &Input::from(mesh).with_attributes(attributes);
        let errors = [
            remesh(input, &Options::points(50).into(), &()).err(),
            sample(input, &SampleOptions::default(), &()).err(),
            reconstruct(input, &ReconstructOptions::default(), &()).err(),
            quality(input, None).err(),
            quality(&Input::from(&sphere(1, DVec3::ZERO, 1.0)), Some(input)).err(),
        ];
        errors.map(|error| match error {
            Some(Error::Mesh { fault, .. }) => fault,
            other => panic!("{other:?}"),
        })
    };
    let none = Attributes::default();
    let short = Attribute { name: "h".into(), components: 1, values: vec![0.0; 7], scalar: Scalar::F64 };
    assert_eq!(faults(&mesh, &Attributes { vertex: vec![short], ..none.clone() }), [Fault::Lengths; 5]);
    assert_eq!(faults(&mesh, &Attributes { texture: vec![[DVec2::ZERO; 3]; 7], ..none.clone() }), [Fault::Lengths; 5]);
    let missing = Mesh { triangles: vec![[0, 1, 18]], ..mesh.clone() };
    assert_eq!(faults(&missing, &none), [Fault::Indices; 5]);
    let mut unknown = mesh;
    unknown.positions[3].y = f64::NAN;
    assert_eq!(faults(&unknown, &none), [Fault::Coordinates; 5]);
}

/// A monitor that records every reported share of the work.
#[derive(Default)]
struct Shares(Mutex<Vec<f64>>);

impl Monitor for Shares {
    fn progress(&self, done: f64) {
        self.0.lock().unwrap().push(done);
    }
}

#[test]
#[ignore = "slow"]
fn progress_never_falls() {
    // A wall far thinner than the spacing takes several attempts, an error bound several vertex counts.
    let wall = plate(12, 0.004);
    let bounded = Options { density: Density::Auto, max_error: Some(MaxError::OfDiagonal(0.02)), ..Options::default() };
    let cloud = Input::points(&arrays(&sphere(3, DVec3::ZERO, 1.0)));
    let jobs =
        [(Input::from(&wall), Options::points(150)), (Input::from(&wall), bounded), (cloud, Options::points(300))];
    for (input, options) in jobs {
        let shares = Shares::default();
        remesh(&input, &options.into(), &shares).unwrap();
        let shares = shares.0.into_inner().unwrap();
        assert!(shares.is_sorted() && shares.len() > 20 && shares.last() == Some(&1.0), "{shares:?}");
    }
}
