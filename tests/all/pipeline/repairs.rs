//! Inputs that are not oriented manifolds.

use super::*;
use glam::{DVec3, dvec3};

#[test]
#[ignore = "slow"]
fn surfaces_without_two_sides_are_cut_and_stay_manifold() {
    for (name, input) in
        [("moebius", moebius(40, 4)), ("narrow moebius", moebius(12, 1)), ("klein bottle", klein_bottle(40, 20))]
    {
        at_all_counts(name, &input);
        assert!(check(name, &input, 300).repairs.unorientable_edges > 0);
    }
}

/// Separate triangles whose corners rounding moved apart become one surface; wider cracks are reported with the option that
/// closes them.
#[test]
fn seams_that_rounding_opened_are_closed() {
    let apart = |gap: f64| noisy(soup(&torus(30, 15, 3.0, 1.0)), gap, &mut random(3));
    let made = check("rounded", &apart(1e-6), 500);
    assert_eq!((made.output.euler, made.output.components, made.output.boundary_loops), (0, 1, 0));
    assert!(made.repairs.seam_vertices > 2000 && made.verified());

    let halves = |gap: f64| {
        let [left, right] = [-1.0, 0.0].map(|x| moved(sheet(10, 10), |p| dvec3(p.x + x, p.y, 0.0)));
        together(&[moved(left, |p| p - dvec3(gap, 0.0, 0.0)), right])
    };
    for (weld, components) in [(None, 1), (Some(0.0), 2)] {
        let made = check_with("seam", &halves(1e-7), &Options { weld, ..points(300) });
        assert_eq!(made.output.components, components);
    }
    let made = check("crack", &halves(1e-3), 300);
    let note = made.notes.iter().find(|note| note.contains("a weld distance of 1.01e-3 closes it"));
    assert!(note.is_some() && made.output.components == 2, "{:?}", made.notes);
    let closed = check_with("closed", &halves(1e-3), &Options { weld: Some(1.01e-3), ..points(300) });
    assert_eq!((closed.output.components, closed.notes.len()), (1, 1));
}

/// Inputs that are not manifold, and the repairs that they need.
#[test]
fn broken_inputs_are_mended_and_the_repairs_reported() {
    let cube = || cells(&[[0; 3]]);
    let mut fin = cube();
    fin.positions.push(dvec3(0.5, -1.0, -1.0));
    fin.triangles.push([0, 1, 8]);
    let made = check("fin", &fin, 200);
    assert_eq!((made.repairs.cut_edges, made.output.components), (1, 2));

    for (name, other) in [("edge", [1, 1, 0]), ("corner", [1, 1, 1])] {
        let made = check(name, &cells(&[[0; 3], other]), 200);
        assert_eq!((made.output.components, made.output.euler), (2, 4), "{name}");
        assert!(made.repairs.split_vertices > 0, "{name}");
    }

    let corners = [dvec3(0., 0., 0.), dvec3(1., 0., 0.), dvec3(0., 1., 0.), dvec3(-1., 0., 0.), dvec3(0., -1., 0.)];
    let bow_tie = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 3, 4]] };
    let made = check("bow tie", &bow_tie, 200);
    assert_eq!((made.repairs.split_vertices, made.output.components), (1, 2));

    let mut copies = torus(20, 10, 3.0, 1.0);
    copies.triangles.extend(copies.triangles.clone().iter().take(50).map(|&[a, b, c]| [b, c, a]));
    let made = check("copies", &copies, 200);
    assert_eq!((made.repairs.duplicate_triangles, made.output.euler), (50, 0));

    let places = (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]);
    let listed = together(&places.map(|place| cells(&[place])).collect::<Vec<Mesh>>());
    let made = check("volume", &listed, 500);
    assert_eq!((made.repairs.faces_between_cells, made.output.euler, made.sharp_curves), (64 * 12 - 192, 2, 12));
    assert!((volume(&made.mesh) - 64.0).abs() < 1e-9 && made.notes[0].contains("between the cells"));

    let mut flipped = torus(20, 10, 3.0, 1.0);
    flipped.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
    let made = check("flipped", &flipped, 500);
    assert!(made.repairs.flipped_triangles > 100 && volume(&made.mesh) > 0.0 && made.output.euler == 0);

    let mut flat = soup(&frame(2));
    let base = flat.positions.len() as u32;
    flat.positions.extend([DVec3::ZERO, DVec3::ZERO, 2.0 * DVec3::X, 9.0 * DVec3::Y]);
    flat.triangles.extend([[base, base + 1, base + 2], [0, 0, 1], [base, base, base]]);
    let made = check("soup", &flat, 300);
    assert_eq!((made.repairs.degenerate_triangles, made.repairs.unused_vertices), (3, 1));
    assert_eq!((made.output.euler, made.output.components), (-2, 1));
}

/// A block with vertices that rounding moved off its edges, as when a program cuts one body out of another: the triangles
/// between these vertices and the edge have no area, and hence no normal.
#[test]
fn caps_that_rounding_made_leave_no_slivers() {
    let mut input = cuboid(dvec3(3.0, 10.0, 17.0));
    let sides = input.triangles.clone();
    for (number, sign) in [(0, 1.0), (5, -1.0), (8, 1.0)] {
        let [a, b, top] = sides[number];
        let [from, to] = [a, b].map(|v| input.positions[v as usize]);
        let first = input.positions.len() as u32;
        let aside = (input.positions[top as usize] - from).normalize();
        input.positions.extend([0.2, 0.45, 0.5, 0.9].map(|along| from.lerp(to, along) + 1e-15 * sign * along * aside));
        let points = [a, first, first + 1, first + 2, first + 3, b];
        input.triangles[number] = [a, first, top];
        input.triangles.extend(points.windows(2).skip(1).map(|ends| [ends[0], ends[1], top]));
        input.triangles.extend(points.windows(2).skip(1).map(|ends| [a, ends[1], ends[0]]));
    }
    for count in [500, 3000] {
        let made = check("caps", &input, count);
        assert_eq!((made.repairs.needles, made.sharp_curves, made.output.euler), (12, 12, 2));
        let theta_min = shape(&made.mesh).unwrap().theta_min;
        assert!(made.verified() && theta_min > 30.0, "{theta_min}");
    }
}

#[test]
fn a_flake_beside_a_body_is_left_out_and_told() {
    let mut input = cuboid(DVec3::ONE);
    let first = input.positions.len() as u32;
    input.positions.extend([[0.2, 0.3, 1.5], [0.21, 0.3, 1.5], [0.205, 0.300001, 1.5]].map(DVec3::from));
    input.triangles.push([0, 1, 2].map(|k| first + k));
    let made = check("flake", &input, 1500);
    assert_eq!((made.repaired.components, made.output.components, made.output.boundary_loops), (1, 1, 0));
    let told = |note: &String| note.contains("1 component of the input is not in the result: the largest, near (0.20");
    assert!(made.notes.iter().any(told), "{:?}", made.notes);
}

#[test]
fn a_fin_at_an_edge_of_a_body_is_left_out_and_told() {
    let mut input = cuboid(DVec3::ONE);
    let [a, b, _] = input.triangles[0];
    let middle = input.positions[a as usize].midpoint(input.positions[b as usize]);
    input.triangles.push([b, a, input.positions.len() as u32]);
    input.positions.push(middle - 0.005 * dvec3(1.0, 2.0, 3.0));
    let made = check("fin", &input, 1500);
    assert_eq!((made.repaired.components, made.output.components, made.output.boundary_loops), (1, 1, 0));
    assert!(
        made.notes.iter().any(|note| note.contains("1 component of the input is not in the result")),
        "{:?}",
        made.notes
    );
    assert!(shape(&made.mesh).unwrap().theta_min > 30.0);
}

#[test]
fn a_hole_far_smaller_than_edges_is_closed_and_told() {
    // A block with a triangular hole in one of its triangles, scaled down by `share`.
    let with_hole = |share: f64| {
        let mut input = cuboid(DVec3::ONE);
        let corners = input.triangles.pop().unwrap();
        let centre = corners.iter().map(|&v| input.positions[v as usize]).sum::<DVec3>() / 3.0;
        let rim = [0, 1, 2].map(|k| input.positions.len() as u32 + k);
        input.positions.extend(corners.map(|v| centre.lerp(input.positions[v as usize], share)));
        for (k, l) in [(0, 1), (1, 2), (2, 0)] {
            input.triangles.extend([[corners[k], corners[l], rim[l]], [corners[k], rim[l], rim[k]]]);
        }
        input
    };
    let made = check("pinhole", &with_hole(0.001), 1500);
    assert_eq!((made.repaired.boundary_loops, made.output.boundary_loops, made.output.euler), (0, 0, 2));
    let told = |note: &String| note.contains("1 hole is too small for edges of this length and therefore closed");
    assert!(made.notes.iter().any(told), "{:?}", made.notes);
    assert!(shape(&made.mesh).unwrap().theta_min > 30.0);
    let made = check("hole", &with_hole(0.2), 1500);
    assert!(made.output.boundary_loops == 1 && !made.notes.iter().any(told), "{:?}", made.notes);
}

/// A solid that touches itself along an edge and at a corner, and one whose inside does.
#[test]
#[ignore = "slow"]
fn surfaces_that_touch_themselves() {
    let ring = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 2, 0], [0, 2, 0], [0, 1, 0]];
    at_all_counts("ring closed by an edge", &cells(&ring));
    let block = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
    let holes = |touching: [i32; 3]| block.clone().filter(move |&c| c != [1, 1, 1] && c != touching);
    at_all_counts("caves that meet at an edge", &cells(&holes([2, 2, 1]).collect::<Vec<_>>()));
    at_all_counts("caves that meet at a corner", &cells(&holes([2, 2, 2]).collect::<Vec<_>>()));
}

/// Random triangles between a few points: such a mesh has every kind of fault.
#[test]
#[ignore = "slow"]
fn heaps_of_random_triangles() {
    for seed in 0..40 {
        let mut rng = random(seed);
        let vertices = 5 + (seed as usize % 6);
        let mut pick = |n: usize| (spectral_remesh::stages::base::rng::unit(&mut rng) * n as f64) as u32;
        let triangles: Vec<[u32; 3]> = (0..6 + seed % 20).map(|_| [0; 3].map(|_| pick(vertices))).collect();
        let positions = noisy(Mesh { positions: vec![DVec3::ZERO; vertices], triangles: vec![] }, 1.0, &mut rng);
        let input = Mesh { positions: positions.positions, triangles };
        check(&format!("heap {seed}"), &input, 60 + 10 * (seed as usize % 5));
    }
}
