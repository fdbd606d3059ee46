//! Properties of the input on which the result does not depend.

use super::*;
use glam::{DVec3, dvec3};
use spectral_remesh::Grading;
use spectral_remesh::stages::prepare::repairs::Repairs;

/// Quality and topology do not depend on the position, size and orientation of the input.
#[test]
#[ignore = "slow"]
fn place_and_size_do_not_matter() {
    let input = torus(40, 20, 3.0, 1.0);
    let mean = |m: &Mesh| shape(m).unwrap().q_mean;
    let original = mean(&check("torus", &input, 700).mesh);
    for size in [1e-6, 1.0, 1e6] {
        let tiny = moved(input.clone(), |p| size * p);
        assert!((mean(&check("scaled", &tiny, 700).mesh) - original).abs() < 0.01);
        let away = moved(tiny.clone(), |p| p + size * dvec3(1e4, -2e4, 3e4));
        assert!((mean(&check("moved", &away, 700).mesh) - original).abs() < 0.01);
        let turned = rotated(tiny, dvec3(1.0, 2.0, 3.0), 1.0);
        assert!((mean(&check("turned", &turned, 700).mesh) - original).abs() < 0.01);
    }
}

/// Scaling by a power of two is exact: the result is the same to the last bit.
#[test]
fn a_scale_by_a_power_of_two_changes_no_digit() {
    let input = cage();
    let scaled = moved(input.clone(), |p| 1024.0 * p);
    let (a, b) = (check("cage", &input, 500), check("large cage", &scaled, 500));
    assert_eq!(moved(a.mesh, |p| 1024.0 * p), b.mesh);
}

#[test]
#[ignore = "slow"]
fn the_order_of_the_input_does_not_matter() {
    for seed in 0..3 {
        let mut rng = random(seed);
        for (name, input) in [("frame", frame(3)), ("sieve", sieve(24)), ("spheres", ten_spheres())] {
            let made = check(name, &shuffled(&input, &mut rng), 400);
            assert_eq!(made.repairs, Repairs::default());
            assert_eq!(made.output.euler, check(name, &input, 400).output.euler);
        }
    }
}

#[test]
fn the_same_bytes_with_any_number_of_threads_and_others_with_another_seed() {
    let input = together(&[plate(12, 0.01), moved(sieve(24), |p| p + DVec3::Z), sphere(4, 3.0 * DVec3::X, 1.0)]);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| check("mixed", &input, 1200).mesh)
    };
    let one = with(1);
    assert!(one == with(2) && one == with(8) && one == with(1));
    let other = check_with("mixed", &input, &Options { seed: 1, ..points(1200) });
    assert!(other.mesh != one);
}

#[test]
fn a_graded_result_has_the_same_bytes_with_any_number_of_threads() {
    let input = together(&[cylinder(40, 1.0, 0.3, 3.0), sphere(4, 3.0 * DVec3::X, 1.0)]);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| check_with("graded", &input, &Options { grading: Grading::Curvature(1.0), ..points(900) }).mesh)
    };
    assert!(with(1) == with(3));
}
