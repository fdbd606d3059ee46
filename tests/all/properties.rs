//! For any input and options: a verified result is sound, any other result says why, and every run ends.
//!
//! `REMESH_CASES=2000 cargo test --release --test all properties` tries more cases, and `REMESH_CASES=17..18` tries one again.

use crate::cases::Case;
use crate::common::{annulus, cage, cells, frame, klein_bottle, sphere, together, torus};
use crate::sound::{Kind, crossing, kind};
use glam::DVec3;
use spectral_remesh::stages::base::rng::unit;
use std::panic::catch_unwind;
use std::time::Duration;

/// Number of cases tried by default, and the bytes of one case.
const CASES: &str = "50";
const BYTES: usize = 160;

/// Time limit, far above what any case takes, and the additional time per point.
const TIME: Duration = Duration::from_secs(60);
const TIME_OF_POINT: Duration = Duration::from_millis(10);

/// Returns the bytes of a case, the same on every machine.
fn bytes(case: u64) -> Vec<u8> {
    let mut rng = crate::common::random(case);
    (0..BYTES).map(|_| (256.0 * unit(&mut rng)) as u8).collect()
}

#[test]
#[ignore = "slow"]
fn any_job_is_verified_or_says_why_it_is_not() {
    let asked = std::env::var("REMESH_CASES").unwrap_or(CASES.into());
    let number = |text: &str| text.parse::<u64>().unwrap_or_else(|e| panic!("REMESH_CASES={asked}: {e}"));
    let (first, end) = asked.split_once("..").map_or_else(|| (0, number(&asked)), |(a, b)| (number(a), number(b)));
    // The cases that are always tried have few points; some of the others have many.
    let most_points = |case: u64| match case {
        0..50 => 500,
        _ if case.is_multiple_of(25) => 50_000,
        _ => 3000,
    };
    let run = |case| {
        let most_points = most_points(case);
        Case::new(&bytes(case), most_points).run(TIME + most_points as u32 * TIME_OF_POINT);
    };
    let fails = |case: &u64| catch_unwind(|| run(*case)).is_err();
    let failed: Vec<u64> = (first..end).filter(fails).collect();
    assert!(failed.is_empty(), "cases {failed:?} of {first}..{end}");
}

#[test]
fn kinds_are_counted() {
    let of = |euler, components, boundary_loops| Ok(Kind { euler, components, boundary_loops });
    assert_eq!(kind(&sphere(1, DVec3::ZERO, 1.0)), of(2, 1, 0));
    assert_eq!(kind(&torus(5, 4, 1.0, 0.3)), of(0, 1, 0));
    assert_eq!(kind(&frame(3)), of(-4, 1, 0));
    assert_eq!(kind(&cage()), of(-8, 1, 0));
    assert_eq!(kind(&annulus(6, 2, 0.5)), of(0, 1, 2));
    assert_eq!(kind(&together(&[annulus(6, 2, 0.5), cage()])), of(-8, 2, 2));
    for (cell, fault) in [([1, 1, 0], "two triangles have the edge"), ([1, 1, 1], "no single fan")] {
        let fault_of = kind(&cells(&[[0; 3], cell])).unwrap_err();
        assert!(fault_of.contains(fault), "{fault_of}");
    }
}

#[test]
fn faces_that_cross_are_found() {
    assert_eq!(crossing(&torus(20, 10, 1.0, 0.3)), None);
    assert_eq!(crossing(&cells(&[[0; 3], [1, 1, 0]])), None);
    assert!(crossing(&klein_bottle(30, 13)).is_some());
    assert!(crossing(&together(&[sphere(1, DVec3::ZERO, 1.0), sphere(1, DVec3::splat(0.5), 1.0)])).is_some());
}
