//! Requests that are fulfilled, refused or cancelled.

use super::*;
use glam::{DVec3, dvec3};
use spectral_remesh::stages::quality::distance::distance;
use spectral_remesh::{Error, Fault, Grading, MaxError, Monitor, Values};

#[test]
fn a_length_means_a_number_of_vertices() {
    let input = sphere(4, DVec3::ZERO, 1.0);
    for density in [Density::EdgeLength(0.15), Density::SigmaP(0.13)] {
        let made = check_with("sphere", &input, &Options { density, ..Options::default() });
        assert!((500..800).contains(&made.wanted), "{density:?}: {}", made.wanted);
    }
}

#[track_caller]
fn refused(input: &Mesh, options: &Options, words: &str) {
    let text = remesh(input, options, &()).expect_err(words).to_string();
    assert!(text.contains(words), "{text:?} does not say {words:?}");
}

#[test]
fn what_cannot_be_remeshed_is_refused_with_a_reason() {
    let cube = cells(&[[0; 3]]);
    refused(&Mesh::default(), &points(100), "no faces");
    refused(&Mesh { positions: cube.positions.clone(), triangles: vec![] }, &points(100), "8 points and no faces");
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let mut input = cube.clone();
        input.positions[5].y = bad;
        refused(&input, &points(100), "vertex 5");
    }
    let mut input = cube.clone();
    input.triangles[7][1] = 8;
    refused(&input, &points(100), "triangle 7");
    let at_one_place = Mesh { positions: vec![DVec3::ONE; 3], triangles: vec![[0, 1, 2]] };
    refused(&at_one_place, &points(100), "area");
    for scale in [1e-3, 1.0, 1e5] {
        let line = |p: DVec3| scale * (dvec3(0.1, 0.7, -0.3) * (p.x + 2.0 * p.y + 5.0 * p.z) + dvec3(0.3, 0.1, 0.2));
        refused(&moved(cube.clone(), line), &points(100), "area");
    }
    for n in [0, 2, 10_000_000] {
        refused(&cube, &points(n), "points");
    }
    for length in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        refused(&cube, &Options { density: Density::EdgeLength(length), ..Options::default() }, "edge length");
        refused(&cube, &Options { density: Density::SigmaP(length), ..Options::default() }, "kernel width σp");
    }
    for adapt in [f64::NAN, -0.1, 1.5] {
        refused(&cube, &Options { grading: Grading::Curvature(adapt), ..points(100) }, "adaptivity");
    }
    let field = |lengths: &[f64]| Options { grading: Grading::Field(Values::Given(lengths.to_vec())), ..points(100) };
    refused(&cube, &field(&[1.0; 7]), "sizing field: 7 values are given for the 8 vertices");
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        refused(&cube, &field(&[1.0, 1.0, bad, 1.0, 1.0, 1.0, 1.0, 1.0]), "sizing field: vertex 2");
    }
    refused(&cube, &Options { density: Density::OfField, ..Options::default() }, "sizing field");
    refused(&cube, &Options { density: Density::OfField, ..field(&[1e-6; 8]) }, "sizing field");
    for error in [MaxError::Length(0.0), MaxError::OfDiagonal(f64::NAN)] {
        refused(&cube, &Options { max_error: Some(error), ..Options::default() }, "error bound");
    }
    refused(&cube, &Options { density: Density::Auto, ..Options::default() }, "the number needed");
    for length in [1e-9, 1e9] {
        refused(&cube, &Options { density: Density::EdgeLength(length), ..Options::default() }, "edge length");
    }
}

/// The bound of the distance also bounds the distance of samples. Too few points do not keep the requested bound; the
/// automatically chosen number does.
#[test]
#[ignore = "slow"]
fn the_error_is_bounded() {
    let ball = sphere(4, DVec3::ZERO, 1.0);
    let within = |density, share| {
        let options = Options { density, max_error: Some(MaxError::OfDiagonal(share)), ..Options::default() };
        let made = check_with("bounded", &ball, &options);
        let deviation = made.deviation.expect("a bound was asked for");
        let sampled = distance(&made.mesh, &ball, 20_000, 0).unwrap().hausdorff / 100.0 * ball.diagonal();
        assert!(
            deviation.reached >= sampled * (1.0 - 1e-9) && deviation.reached <= 1.3 * sampled,
            "{deviation:?} {sampled}"
        );
        assert_eq!(made.verified(), deviation.is_allowed());
        made
    };
    let made = within(Density::Points(500), 0.001);
    assert!(!made.verified() && made.notes.iter().any(|note| note.contains("more points")), "{:?}", made.notes);
    let made = within(Density::Auto, 0.001);
    assert!(made.verified() && made.notes.is_empty(), "{:?}", made.notes);
    let fewer = within(Density::Points(made.wanted * 3 / 4), 0.001);
    assert!(!fewer.verified(), "{} of {}", fewer.wanted, made.wanted);
}

/// Returns cubes of six tetrahedra each, with every tetrahedron written as a skew quadrilateral.
fn tetrahedra_as_squares(n: u32) -> Mesh {
    let at = |x: u32, y: u32, z: u32| (x * (n + 1) + y) * (n + 1) + z;
    let lattice = |m: u32| (0..m).flat_map(move |x| (0..m).flat_map(move |y| (0..m).map(move |z| [x, y, z])));
    let positions = lattice(n + 1).map(|[x, y, z]| dvec3(x.into(), y.into(), z.into())).collect();
    let mut triangles = Vec::new();
    for [x, y, z] in lattice(n) {
        let corner = |bits: u32| at(x + (bits & 1), y + (bits >> 1 & 1), z + (bits >> 2));
        for [i, j] in [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]] {
            let [a, b, c, d] = [0, i, j, 7].map(corner);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh { positions, triangles }
}

#[test]
fn the_inside_of_a_volume_is_refused() {
    let made = remesh(&tetrahedra_as_squares(10), &points(500), &());
    let Err(Error::Mesh { fault: Fault::NoSurface, cause, remedy }) = made else {
        panic!("{:?}", made.map(|m| m.output))
    };
    assert!(cause.contains("three or more faces") && remedy.contains("outer surface"), "{cause}; {remedy}");
}

/// A monitor that cancels at the stage with this name.
struct StopAt(&'static str, std::sync::atomic::AtomicBool);

impl Monitor for StopAt {
    fn stage(&self, name: &'static str) {
        if name == self.0 {
            self.1.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    }
    fn cancelled(&self) -> bool {
        self.1.load(std::sync::atomic::Ordering::Relaxed)
    }
}

#[test]
fn every_stage_can_be_stopped() {
    for stage in ["repair", "sample", "triangulate", "ascend", "relax", "improve angles", "fit"] {
        let made = remesh(&cage(), &points(300), &StopAt(stage, false.into()));
        assert_eq!(made.err(), Some(Error::Cancelled), "{stage}");
    }
}
