//! The pipeline from mesh to mesh on shapes of all kinds: the result has the topology of the input.

mod any_shape;
mod graded;
mod invariance;
mod repairs;
mod requests;
mod shapes;

use crate::common::*;
use spectral_remesh::stages::pipeline::{Remeshed, remesh};
use spectral_remesh::stages::quality::shape::shape;
use spectral_remesh::stages::spatial::bvh::Bvh;
use spectral_remesh::{Density, Mesh, Options};

fn points(n: usize) -> Options {
    Options { density: Density::Points(n), ..Options::default() }
}

/// Remeshes, and checks everything that is promised for any input.
#[track_caller]
fn check_with(name: &str, input: &Mesh, options: &Options) -> Remeshed {
    let made = remesh(input, options, &()).unwrap_or_else(|e| panic!("{name}, {options:?}: {e}"));
    assert!(made.has_topology(), "{name}, {options:?}: {:?} became {:?}", made.repaired, made.output);
    let t = audit(&made.mesh);
    assert_eq!((t.euler, t.components), (made.repaired.euler, made.repaired.components), "{name}");
    if made.mesh.positions.len() != made.wanted {
        // A component with the topology of a sphere needs at least four vertices, a torus seven, and so on.
        let few = made.wanted < 150 + 4 * made.repaired.components;
        let excused = made.mesh.positions.len() > made.wanted && few && !made.notes.is_empty();
        assert!(excused, "{name}: {} of {}", made.mesh.positions.len(), made.wanted);
    }
    on_the_surface(name, input, &made.mesh);
    made
}

#[track_caller]
fn check(name: &str, input: &Mesh, n: usize) -> Remeshed {
    check_with(name, input, &points(n))
}

/// Checks that all vertices lie on the input, or off it by a fraction of an edge where sheets had to be separated.
#[track_caller]
fn on_the_surface(name: &str, input: &Mesh, mesh: &Mesh) {
    let bvh = Bvh::new(input);
    let largest = input.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    // On a sliver, only half of the digits of a foot are correct.
    let exact = 1e-7 * input.diagonal() + 1e-15 * largest;
    let tolerance = exact + 0.15 * shape(mesh).unwrap().edge_max;
    for &p in &mesh.positions {
        let hit = bvh.closest(input, p).unwrap();
        assert!(hit.distance_squared.sqrt() <= tolerance, "{name}: {p} is {} off", hit.distance_squared.sqrt());
    }
}

/// Checks that no vertex of the input is farther than `reach` spacings from the result.
#[track_caller]
fn covers(name: &str, input: &Mesh, made: &Remeshed, reach: f64) {
    let bvh = Bvh::new(&made.mesh);
    for t in input.triangles.iter().flatten() {
        let hit = bvh.closest(&made.mesh, input.positions[*t as usize]).unwrap();
        let off = hit.distance_squared.sqrt() / made.spacing;
        assert!(off <= reach, "{name}, {}: vertex {t} is {off} spacings off", made.wanted);
    }
}

/// Checks four vertices, ten, some, and many.
#[track_caller]
fn at_all_counts(name: &str, input: &Mesh) {
    for n in [4, 10, 150, 1000] {
        let made = check(name, input, n);
        if n >= 1000 {
            covers(name, input, &made, 2.0);
            let (before, after) = (volume(input), volume(&made.mesh));
            let solid = made.repaired.boundary_loops == 0 && before > 1e-3 * input.diagonal().powi(3);
            assert!(!solid || after > 0.5 * before, "{name}: volume {before} became {after}");
        }
    }
}
