//! The pipeline from mesh to mesh on shapes of all kinds: what comes out has the topology of what went in.

use crate::common::*;
use glam::{DVec3, dvec3};
use proptest::prelude::*;
use spectral_remesh::stages::pipeline::{Remeshed, remesh};
use spectral_remesh::stages::prepare::repair::Repairs;
use spectral_remesh::stages::quality::distance::distance;
use spectral_remesh::stages::quality::shape::shape;
use spectral_remesh::stages::spatial::bvh::Bvh;
use spectral_remesh::stages::surface::features::Features;
use spectral_remesh::{Density, Error, Fault, Grading, MaxError, Mesh, Monitor, Options, Values};

fn points(n: usize) -> Options {
    Options { density: Density::Points(n), ..Options::default() }
}

/// Remeshes and holds the result to all that is promised of any input.
#[track_caller]
fn check_with(name: &str, input: &Mesh, options: &Options) -> Remeshed {
    let made = remesh(input, options, &()).unwrap_or_else(|e| panic!("{name}, {options:?}: {e}"));
    assert!(made.has_topology(), "{name}, {options:?}: {:?} became {:?}", made.repaired, made.output);
    let t = audit(&made.mesh);
    assert_eq!((t.euler, t.components), (made.repaired.euler, made.repaired.components), "{name}");
    if made.mesh.positions.len() != made.wanted {
        // A piece of the topology of a sphere has at least four vertices, one of a torus seven, and so on.
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

/// All vertices lie on the input, or off it by a share of an edge where sheets had to part.
#[track_caller]
fn on_the_surface(name: &str, input: &Mesh, mesh: &Mesh) {
    let bvh = Bvh::new(input);
    let largest = input.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    // The foot on a sliver has half of the digits.
    let exact = 1e-7 * input.diagonal() + 1e-15 * largest;
    let tolerance = exact + 0.15 * shape(mesh).unwrap().edge_max;
    for &p in &mesh.positions {
        let hit = bvh.closest(input, p).unwrap();
        assert!(hit.distance_squared.sqrt() <= tolerance, "{name}: {p} is {} off", hit.distance_squared.sqrt());
    }
}

/// No vertex of the input is farther from the result than `reach` spacings.
#[track_caller]
fn covers(name: &str, input: &Mesh, made: &Remeshed, reach: f64) {
    let bvh = Bvh::new(&made.mesh);
    for t in input.triangles.iter().flatten() {
        let hit = bvh.closest(&made.mesh, input.positions[*t as usize]).unwrap();
        let off = hit.distance_squared.sqrt() / made.spacing;
        assert!(off <= reach, "{name}, {}: vertex {t} is {off} spacings off", made.wanted);
    }
}

/// Four and ten vertices, some, and many.
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

#[test]
fn solids() {
    at_all_counts("sphere", &sphere(4, DVec3::ZERO, 1.0));
    at_all_counts("box", &cuboid(dvec3(1.0, 2.0, 3.0)));
    at_all_counts("cylinder", &cylinder(24, 1.0, 1.0, 2.0));
    at_all_counts("cone", &cylinder(40, 1.0, 0.0, 2.0));
    at_all_counts("tetrahedron", &cylinder(3, 1.0, 0.0, 1.0));
}

#[test]
fn handles() {
    at_all_counts("torus", &torus(40, 20, 3.0, 1.0));
    at_all_counts("thin torus", &torus(60, 6, 3.0, 0.02));
    at_all_counts("frame", &frame(4));
    at_all_counts("cage", &cage());
}

#[test]
fn thin_things() {
    at_all_counts("plate of 12 triangles", &cuboid(dvec3(1.0, 1.0, 0.005)));
    at_all_counts("plate of many triangles", &plate(20, 0.005));
    at_all_counts("foil", &plate(12, 1e-6));
    at_all_counts("rod", &cuboid(dvec3(0.01, 0.01, 1.0)));
    at_all_counts("needles", &cylinder(100, 0.05, 0.05, 10.0));
    // The tip is thinner than a hundredth of a spacing over several spacings: some of it is lost.
    for n in [4, 10, 150] {
        check("thorn", &thorn(), n);
    }
    covers("thorn", &thorn(), &check("thorn", &thorn(), 1000), 10.0);
}

#[test]
fn sheets_that_nearly_touch() {
    let inner = |gap: f64| inside_out(sphere(4, DVec3::ZERO, 1.0 - gap));
    at_all_counts("spheres in one another", &together(&[sphere(4, DVec3::ZERO, 1.0), inner(0.002)]));
    let beside = sphere(4, dvec3(2.002, 0.0, 0.0), 1.0);
    at_all_counts("spheres beside one another", &together(&[sphere(4, DVec3::ZERO, 1.0), beside]));
    at_all_counts("spiral", &spiral(160, 20, 0.003));
    at_all_counts("wide spiral", &spiral(160, 20, 0.05));
}

#[test]
fn sheets_nearer_than_the_triangles_are_high_do_not_cross() {
    let shell = |gap: f64| together(&[sphere(5, DVec3::ZERO, 1.0), inside_out(sphere(5, DVec3::ZERO, 1.0 - gap))]);
    let socket = together(&[inside_out(sphere(5, DVec3::ZERO, 1.0)), sphere(5, DVec3::ZERO, 0.997)]);
    let beside = together(&[sphere(4, DVec3::ZERO, 1.0), sphere(4, 2.002 * DVec3::X, 1.0)]);
    for (name, input) in
        [("thick shell", shell(0.01)), ("thin shell", shell(0.002)), ("socket", socket), ("beside", beside)]
    {
        let made = check(name, &input, 500);
        assert!(made.verified() && made.self_intersections.is_empty(), "{name}: {:?}", made.self_intersections);
        assert_eq!(made.self_intersections_of_input, None, "{name}");
    }
}

/// Where the input crosses itself the result does so, too, and nothing is bent for it.
#[test]
fn crossings_of_the_input_stay_and_are_told() {
    let input = together(&[sphere(4, DVec3::ZERO, 1.0), sphere(4, DVec3::X, 1.0)]);
    let made = check_with("spheres", &input, &Options { optimize: false, ..points(800) });
    assert!(made.self_intersections.len() > 20 && made.self_intersections_of_input > Some(20) && made.verified());
    assert!(made.notes.iter().any(|note| note.contains("intersect")), "{:?}", made.notes);
    let bvh = Bvh::new(&input);
    // The fit takes them off the surface by some thousandths, parting sheets would by 0.15 of an edge, 0.03.
    assert!(made.mesh.positions.iter().all(|&p| bvh.closest(&input, p).unwrap().distance_squared < 0.01 * 0.01));
}

/// Many needles of open ends would take a hundred times the wanted vertices for their boundaries.
#[test]
#[ignore = "slow"]
fn a_boundary_that_is_long_for_its_area_ends_in_time() {
    let needle = |i: i32| cells(&[[i, 0, 0], [i, 1, 0]]);
    let mut needles = together(&(0..20).map(|i| soup(&needle(2 * i))).collect::<Vec<_>>());
    needles.triangles = needles.triangles.into_iter().step_by(2).collect();
    let made = check("needles", &moved(needles, |p| p * dvec3(1e-4, 200.0, 1e-4)), 400);
    assert!(made.repaired.boundary_loops > 20);
}

#[test]
fn many_pieces() {
    let input = ten_spheres();
    at_all_counts("ten spheres", &input);
    let made = check("ten spheres", &input, 3000);
    assert_eq!(made.output.components, 10);
    let dust: Vec<Mesh> = (0..300).map(|i| sphere(0, dvec3(f64::from(i), 0.0, 0.0), 0.01)).collect();
    at_all_counts("dust", &together(&dust));
}

#[test]
fn open_surfaces() {
    at_all_counts("sheet", &sheet(30, 20));
    at_all_counts("sieve", &sieve(36));
    at_all_counts("annulus", &annulus(40, 5, 0.6));
    at_all_counts("narrow annulus", &annulus(90, 1, 0.99));
    at_all_counts("square", &grid(1, 1, Ends::Open, Ends::Open, |u, v| dvec3(u, v, 0.0)));
    at_all_counts("triangle", &Mesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] });
    for n in [4, 10, 150, 1000] {
        check("ribbon", &ribbon(), n);
    }
}

/// Every edge of it is sharp and its triangles face everywhere; there are as many vertices as are wanted all the same.
#[test]
fn a_crumpled_ball() {
    let ball = noisy(sphere(4, DVec3::ZERO, 1.0), 0.15, &mut random(3));
    for n in [10, 50, 400] {
        let made = remesh(&ball, &points(n), &()).unwrap();
        assert!(made.has_topology() && made.mesh.positions.len() == n, "{n}: {:?}", made.output);
        assert_eq!(made.sharp_curves, 0);
        assert!(made.notes.iter().any(|note| note.contains("sharp edges")), "{:?}", made.notes);
    }
}

/// What is too thin for its samples is triangulated as the input is; that must not spoil the piece beside it.
#[test]
fn a_hair_beside_a_ball() {
    let hair = moved(cylinder(8, 0.004, 0.004, 3.0), |p| p + 2.0 * DVec3::X);
    let input = together(&[sphere(5, DVec3::ZERO, 1.0), hair]);
    check_with("hair", &input, &Options { features: Features::Smooth, ..points(3000) });
}

fn thorn() -> Mesh {
    cylinder(50, 0.02, 0.0, 10.0)
}

fn ribbon() -> Mesh {
    grid(50, 1, Ends::Open, Ends::Open, |u, v| dvec3(u, 0.001 * v, 0.0))
}

#[test]
fn the_ends_of_a_ribbon_stay_where_they_are() {
    covers("ribbon", &ribbon(), &check("ribbon", &ribbon(), 1500), 2.0);
}

#[test]
fn surfaces_without_two_sides_are_cut_and_stay_manifold() {
    for (name, input) in
        [("moebius", moebius(40, 4)), ("narrow moebius", moebius(12, 1)), ("klein bottle", klein_bottle(40, 20))]
    {
        at_all_counts(name, &input);
        assert!(check(name, &input, 300).repairs.unorientable_edges > 0);
    }
}

/// Quality and topology do not depend on where the input is, how large it is and how it is turned.
#[test]
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

/// A scale by a power of two is exact: the same result to the last bit.
#[test]
fn a_scale_by_a_power_of_two_changes_no_digit() {
    let input = cage();
    let scaled = moved(input.clone(), |p| 1024.0 * p);
    let (a, b) = (check("cage", &input, 500), check("large cage", &scaled, 500));
    assert_eq!(moved(a.mesh, |p| 1024.0 * p), b.mesh);
}

#[test]
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
fn a_length_means_a_number_of_vertices() {
    let input = sphere(4, DVec3::ZERO, 1.0);
    for density in [Density::EdgeLength(0.15), Density::SigmaP(0.13)] {
        let made = check_with("sphere", &input, &Options { density, ..Options::default() });
        assert!((500..800).contains(&made.wanted), "{density:?}: {}", made.wanted);
    }
}

/// Separate triangles whose corners rounding parted are one surface; cracks are told with what closes them.
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
    let note = made.notes.iter().find(|note| note.contains("--weld 1.01e-3 closes it"));
    assert!(note.is_some() && made.output.components == 2, "{:?}", made.notes);
    let closed = check_with("closed", &halves(1e-3), &Options { weld: Some(1.01e-3), ..points(300) });
    assert_eq!((closed.output.components, closed.notes.len()), (1, 1));
}

/// Inputs that are no manifold, and what has to be done to them.
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

/// A solid that touches itself along an edge and at a corner, and one whose insides do.
#[test]
fn surfaces_that_touch_themselves() {
    let ring = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 2, 0], [0, 2, 0], [0, 1, 0]];
    at_all_counts("ring closed by an edge", &cells(&ring));
    let block = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]);
    let holes = |touching: [i32; 3]| block.clone().filter(move |&c| c != [1, 1, 1] && c != touching);
    at_all_counts("caves that meet at an edge", &cells(&holes([2, 2, 1]).collect::<Vec<_>>()));
    at_all_counts("caves that meet at a corner", &cells(&holes([2, 2, 2]).collect::<Vec<_>>()));
}

/// Triangles between a few points at random: nothing about such a mesh is in order.
#[test]
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

/// A sphere and a field over it that grows threefold from its lowest point to its highest.
fn sphere_with_field() -> (Mesh, fn(DVec3) -> f64) {
    (sphere(5, DVec3::ZERO, 1.0), |p| 0.08 * (1.0 + 0.5 * p.z))
}

fn at_vertices(mesh: &Mesh, field: impl Fn(DVec3) -> f64) -> Vec<f64> {
    mesh.positions.iter().map(|&p| field(p)).collect()
}

/// The lengths of the edges of `mesh`, in those that `field` has at their middles.
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

/// The vertices of a field are not those of the repaired input: its lengths are found again by place.
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

#[test]
fn a_graded_result_has_the_same_bytes_with_any_number_of_threads() {
    let input = together(&[cylinder(40, 1.0, 0.3, 3.0), sphere(4, 3.0 * DVec3::X, 1.0)]);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| check_with("graded", &input, &Options { grading: Grading::Curvature(1.0), ..points(900) }).mesh)
    };
    assert!(with(1) == with(3));
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
    refused(&cube, &field(&[1.0; 7]), "field of edge lengths: 7 values for the 8 vertices");
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        refused(&cube, &field(&[1.0, 1.0, bad, 1.0, 1.0, 1.0, 1.0, 1.0]), "field of edge lengths: vertex 2");
    }
    refused(&cube, &Options { density: Density::OfField, ..Options::default() }, "field of edge lengths");
    refused(&cube, &Options { density: Density::OfField, ..field(&[1e-6; 8]) }, "field of edge lengths");
    for error in [MaxError::Length(0.0), MaxError::OfDiagonal(f64::NAN)] {
        refused(&cube, &Options { max_error: Some(error), ..Options::default() }, "error bound");
    }
    refused(&cube, &Options { density: Density::Auto, ..Options::default() }, "how many");
    for length in [1e-9, 1e9] {
        refused(&cube, &Options { density: Density::EdgeLength(length), ..Options::default() }, "edge length");
    }
}

/// The bound of the distance is one of the samples, too, and not kept by too few points; those chosen keep it.
#[test]
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

/// Cubes of six tetrahedra each, every tetrahedron written as if it were a skew square.
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
    assert!(cause.contains("more than two faces") && remedy.contains("outside"), "{cause}; {remedy}");
}

/// A monitor that stops at the stage of a name.
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

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_torus_stays_one(
        n in 3u32..40, m in 3u32..20, thickness in 0.01f64..0.9, noise in 0.0f64..0.2,
        wanted in 4usize..400, seed in any::<u64>(),
    ) {
        let input = noisy(torus(n, m, 1.0, thickness), noise * thickness, &mut random(seed));
        let made = check_with("torus", &input, &Options { seed, ..points(wanted) });
        prop_assert_eq!((made.output.euler, made.output.components), (0, 1));
    }

    #[test]
    fn any_sphere_stays_one(
        level in 0u32..4, squeeze in 0.001f64..1.0, noise in 0.0f64..0.3, wanted in 3usize..400, seed in any::<u64>(),
    ) {
        let ball = moved(noisy(sphere(level, DVec3::ZERO, 1.0), noise, &mut random(seed)), |p| p * dvec3(1.0, 1.0, squeeze));
        let made = check_with("sphere", &ball, &Options { seed, ..points(wanted) });
        prop_assert_eq!((made.output.euler, made.output.components), (2, 1));
    }

    #[test]
    fn any_sheet_stays_one(
        n in 1u32..30, m in 1u32..30, width in 0.001f64..1.0, noise in 0.0f64..0.1, wanted in 3usize..400,
        seed in any::<u64>(),
    ) {
        // Noise across of more than a share of the width would crumple a strip to what is farther off its own middle
        // than vertices may be.
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
