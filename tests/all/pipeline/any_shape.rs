//! Random shapes.

use super::*;
use glam::{DVec3, dvec3};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
#[ignore = "slow"]
    fn any_torus_stays_one(
        n in 3u32..40, m in 3u32..20, thickness in 0.01f64..0.9, noise in 0.0f64..0.2,
        wanted in 4usize..400, seed in any::<u64>(),
    ) {
        let input = noisy(torus(n, m, 1.0, thickness), noise * thickness, &mut random(seed));
        let made = check_with("torus", &input, &Options { seed, ..points(wanted) });
        prop_assert_eq!((made.output.euler, made.output.components), (0, 1));
    }

    #[test]
#[ignore = "slow"]
    fn any_sphere_stays_one(
        level in 0u32..4, squeeze in 0.001f64..1.0, noise in 0.0f64..0.3, wanted in 3usize..400, seed in any::<u64>(),
    ) {
        let ball = moved(noisy(sphere(level, DVec3::ZERO, 1.0), noise, &mut random(seed)), |p| p * dvec3(1.0, 1.0, squeeze));
        let made = check_with("sphere", &ball, &Options { seed, ..points(wanted) });
        prop_assert_eq!((made.output.euler, made.output.components), (2, 1));
    }

    #[test]
    #[ignore = "slow"]
    fn any_sheet_stays_one(
        n in 1u32..30, m in 1u32..30, width in 0.001f64..1.0, noise in 0.0f64..0.1, wanted in 3usize..400,
        seed in any::<u64>(),
    ) {
        // Noise above a share of the width would crumple the strip so much that vertices would be farther from it than
        // allowed.
        let across = dvec3(1.0, width, width);
        let input = moved(noisy(sheet(n, m), noise, &mut random(seed)), |p| p * across);
        let made = check_with("sheet", &input, &Options { seed, ..points(wanted) });
        prop_assert_eq!((made.output.euler, made.output.boundary_loops), (1, 1));
    }

    #[test]
    fn any_cells_become_a_manifold(
        places in prop::collection::vec((0i32..4, 0i32..4, 0i32..4), 1..30), wanted in 10usize..300,
    ) {
        let places: Vec<[i32; 3]> = places.into_iter().map(<[i32; 3]>::from).collect();
        let made = check("cells", &cells(&places), wanted);
        prop_assert_eq!(made.output.boundary_loops, 0);
    }
}
