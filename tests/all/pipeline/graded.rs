//! Edge lengths that differ from place to place.

use super::*;
use glam::{DVec3, dvec3};
use spectral_remesh::{Grading, Values};

/// Returns a sphere, and a field over it that grows threefold from its lowest point to its highest.
fn sphere_with_field() -> (Mesh, fn(DVec3) -> f64) {
    (sphere(5, DVec3::ZERO, 1.0), |p| 0.08 * (1.0 + 0.5 * p.z))
}

fn at_vertices(mesh: &Mesh, field: impl Fn(DVec3) -> f64) -> Vec<f64> {
    mesh.positions.iter().map(|&p| field(p)).collect()
}

/// Returns the edge lengths of `mesh`, relative to the target length that `field` gives at their midpoints.
fn relative_lengths(mesh: &Mesh, field: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let ends = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let ends = ends.map(|(a, b)| (mesh.positions[a as usize], mesh.positions[b as usize]));
    ends.map(|(a, b)| a.distance(b) / field((a + b) / 2.0)).collect()
}

#[test]
fn edges_follow_a_field() {
    let (input, field) = sphere_with_field();
    let grading = Grading::Field(Values::Given(at_vertices(&input, field)));
    for optimize in [true, false] {
        for density in [Density::OfField, Density::Points(1500)] {
            let made =
                check_with("graded", &input, &Options { density, grading: grading.clone(), optimize, ..points(9) });
            assert_eq!(made.mesh.positions.len(), made.wanted);
            let lengths = relative_lengths(&made.mesh, field);
            let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
            let off = lengths.iter().map(|l| (l / mean - 1.0).abs()).sum::<f64>() / lengths.len() as f64;
            assert!(off < 0.15, "{density:?}, {optimize}: {off}");
            assert!(density != Density::OfField || (mean - 1.0).abs() < 0.1, "{mean}");
            let [smallest, largest] = made.spacing_range;
            assert!((2.5..3.2).contains(&(largest / smallest)), "{smallest} {largest}");
        }
    }
}

/// The vertices of a field are not those of the repaired input: its lengths are matched by position.
#[test]
fn a_field_survives_repairs() {
    let (input, field) = sphere_with_field();
    let with = |input: &Mesh| {
        let grading = Grading::Field(Values::Given(at_vertices(input, field)));
        check_with("field", input, &Options { density: Density::OfField, grading, ..points(9) })
    };
    let mut turned = soup(&input);
    turned.positions.insert(0, DVec3::splat(9.0));
    turned.triangles.iter_mut().flatten().for_each(|v| *v += 1);
    turned.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
    let made = with(&turned);
    assert!(made.repairs.welded_vertices > 0 && made.repairs.flipped_triangles > 0);
    let lengths = relative_lengths(&made.mesh, field);
    assert!((lengths.iter().sum::<f64>() / lengths.len() as f64 - 1.0).abs() < 0.1);
    assert_eq!(made.wanted, with(&input).wanted);
}

#[test]
#[ignore = "slow"]
fn shapes_of_all_kinds_are_graded() {
    let shapes = [
        ("torus", torus(60, 20, 3.0, 0.5)),
        ("box", cuboid(dvec3(1.0, 2.0, 3.0))),
        ("cone", cylinder(40, 1.0, 0.0, 2.0)),
        ("plate", plate(12, 0.01)),
        ("sheet", sheet(30, 20)),
        ("sieve", sieve(24)),
        ("spheres", ten_spheres()),
    ];
    for (name, input) in shapes {
        for (adapt, optimize) in [(0.5, true), (1.0, true), (1.0, false)] {
            check_with(name, &input, &Options { grading: Grading::Curvature(adapt), optimize, ..points(800) });
        }
    }
}
