//! Sharp edges, corners and rims on shapes made for these tests: they stay where they were, and no triangle crosses them.

use crate::common::*;
use glam::{DVec3, dvec3};
use spectral_remesh::stages::pipeline::{Remeshed, remesh};
use spectral_remesh::stages::quality::shape::shape;
use spectral_remesh::stages::surface::features::Features;
use spectral_remesh::{Density, Grading, Mesh, Options, Values};
use std::f64::consts::TAU;

#[track_caller]
fn check_with(input: &Mesh, n: usize, features: Features) -> Remeshed {
    check_as(input, n, Options { features, ..Options::default() })
}

#[track_caller]
fn check_as(input: &Mesh, n: usize, options: Options) -> Remeshed {
    let made = remesh(input, &Options { density: Density::Points(n), ..options }, &()).unwrap();
    assert!(made.verified(), "{:?} became {:?}: {:?}", made.repaired, made.output, made.notes);
    assert!(made.self_intersections.is_empty());
    assert_eq!(made.mesh.positions.len(), n);
    audit(&made.mesh);
    made
}

#[track_caller]
fn check(input: &Mesh, n: usize) -> Remeshed {
    check_with(input, n, Features::Automatic)
}

/// Returns the distance from `p` to the nearest vertex.
fn nearest(mesh: &Mesh, p: DVec3) -> f64 {
    mesh.positions.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min)
}

/// Checks that every triangle lies in one of the planes `n · p = d`, given as (n, d), with n pointing outwards.
#[track_caller]
fn lies_in_planes(mesh: &Mesh, planes: &[(DVec3, f64)]) {
    for t in 0..mesh.triangles.len() {
        let corners = mesh.corners(t);
        let normal = mesh.area_vector(t).normalize();
        let lies =
            |&(n, d): &(DVec3, f64)| normal.dot(n) > 1.0 - 1e-9 && corners.iter().all(|p| (n.dot(*p) - d).abs() < 1e-9);
        assert!(planes.iter().any(lies), "triangle {t} at {corners:?}");
    }
}

/// Checks the smallest angle, the largest angle and the mean quality.
#[track_caller]
fn is_good(mesh: &Mesh, smallest: f64, largest: f64, mean: f64) {
    let s = shape(mesh).unwrap();
    assert!(s.theta_min >= smallest && s.theta_max <= largest && s.q_mean >= mean, "{s:?}");
}

fn box_planes(size: DVec3) -> Vec<(DVec3, f64)> {
    DVec3::AXES.into_iter().flat_map(|axis| [(axis, axis.dot(size)), (-axis, 0.0)]).collect()
}

#[test]
fn a_cube_keeps_its_corners_edges_and_faces() {
    for n in [100, 1000, 3000] {
        let size = DVec3::splat(2.0);
        let made = check(&cuboid(size), n);
        assert_eq!(made.sharp_curves, 12);
        lies_in_planes(&made.mesh, &box_planes(size));
        for corner in 0..8 {
            let p = DVec3::from_array([0, 1, 2].map(|k| if corner >> k & 1 == 1 { 2.0 } else { 0.0 }));
            assert!(nearest(&made.mesh, p) < 1e-12);
        }
        assert!((volume(&made.mesh) - 8.0).abs() < 1e-9);
        if n > 100 {
            is_good(&made.mesh, 30.0, 110.0, 0.94);
        }
    }
}

#[test]
fn a_cylinder_keeps_its_rims_which_have_no_corner() {
    let n = 120;
    let made = check(&cylinder(n, 1.0, 1.0, 2.0), 2500);
    assert_eq!(made.sharp_curves, 2);
    for t in 0..made.mesh.triangles.len() {
        let heights = made.mesh.corners(t).map(|p| p.z);
        let flat = made.mesh.area_vector(t).normalize().z.abs();
        let on_cap = heights.iter().all(|z| z.abs() < 1e-9) || heights.iter().all(|z| (z - 2.0).abs() < 1e-9);
        assert!(on_cap && flat > 1.0 - 1e-9 || !on_cap && flat < 0.1, "triangle {t} crosses a rim: {heights:?}");
    }
    is_good(&made.mesh, 30.0, 110.0, 0.95);
}

/// Returns a house of width 2 and length 3 whose roof has a dihedral angle of 20 degrees at the ridge.
fn house() -> Mesh {
    let rise = 10f64.to_radians().tan();
    let gable = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0 + rise), (0.0, 1.0)];
    let place = |i: u32| dvec3(3.0 * f64::from(i / 5), gable[i as usize % 5].0, gable[i as usize % 5].1);
    let positions = (0..10).map(place).collect();
    let sides = (0..5).flat_map(|i| {
        let (a, b) = (i, (i + 1) % 5);
        [[a, b + 5, b], [a, a + 5, b + 5]]
    });
    let ends = [[0, 1, 2], [0, 2, 3], [0, 3, 4]].into_iter();
    let back = ends.clone().map(|[a, b, c]| [a + 5, c + 5, b + 5]);
    inside_out(Mesh { positions, triangles: sides.chain(ends).chain(back).collect() })
}

#[test]
#[ignore = "slow"]
fn a_ridge_of_twenty_degrees_is_kept() {
    let input = house();
    let whole = volume(&input);
    let input = if whole < 0.0 { inside_out(input) } else { input };
    for features in [Features::Automatic, Features::Degrees(15.0)] {
        let made = check_with(&input, 2000, features);
        assert_eq!(made.sharp_curves, 15);
        assert!((volume(&made.mesh) - whole.abs()).abs() < 1e-9, "{} {whole}", volume(&made.mesh));
        is_good(&made.mesh, 30.0, 110.0, 0.94);
    }
    let smooth = check_with(&input, 2000, Features::Smooth);
    assert_eq!(smooth.sharp_curves, 0);
}

#[test]
fn a_threshold_above_all_edges_keeps_none() {
    assert_eq!(check_with(&house(), 800, Features::Degrees(100.0)).sharp_curves, 0);
    assert_eq!(check_with(&cuboid(DVec3::ONE), 800, Features::Degrees(80.0)).sharp_curves, 12);
}

#[test]
#[ignore = "slow"]
fn the_apex_of_a_cone_stays() {
    for top in [0.4, 1.0, 3.0] {
        // The seed determines how close to an apex a sample lies.
        let options = Options { seed: 6, ..Options::points(2000) };
        let made = remesh(&cylinder(120, 1.0, 0.0, top), &options, &()).unwrap();
        assert!(made.verified());
        assert_eq!(made.sharp_curves, 1);
        let off = nearest(&made.mesh, top * DVec3::Z) / made.spacing;
        assert!(off < 0.5, "a cone of height {top}: {off} spacings from the apex");
    }
}

#[test]
fn a_spike_ends_in_a_vertex_whatever_the_samples_are() {
    let (length, radius) = (3.0, 1.0);
    for seed in 0..4 {
        let made = check_as(&cylinder(120, radius, 0.0, length), 500, Options { seed, ..Options::default() });
        let off = nearest(&made.mesh, length * DVec3::Z);
        assert!(off < 1e-9, "seed {seed}: {off} from the apex");
        let [smallest, of_all] = [made.unforced_theta_min.unwrap(), shape(&made.mesh).unwrap().theta_min];
        // The two are measured in coordinates that are rounded differently.
        assert!(smallest > 30.0 && smallest > of_all - 1e-9, "seed {seed}: {smallest} {of_all}");
    }
}

/// A crease that ends inside a face: folded at one end, flat at the other.
#[test]
fn a_dart_ends_where_it_ends() {
    let fold = |u: f64, v: f64| dvec3(u, v, -(0.6 * (0.6 - u).max(0.0)) * (v - 0.5).abs());
    let input = grid(60, 60, Ends::Open, Ends::Open, fold);
    let made = check_with(&input, 2500, Features::Degrees(12.0));
    assert_eq!(made.output.boundary_loops, 1);
    assert!(made.sharp_curves >= 2, "{}", made.sharp_curves);
    let ridge = nearest(&made.mesh, dvec3(0.0, 0.5, 0.0));
    assert!(ridge < 1e-9, "the mouth of the dart is {ridge} off");
}

/// Six faces meet in the middle of a star of creases.
#[test]
fn curves_that_meet_in_a_corner_stay_joined() {
    let crease = |u: f64, v: f64| {
        let angle = (v - 0.5).atan2(u - 0.5);
        let away = (u - 0.5).hypot(v - 0.5);
        dvec3(u, v, 0.5 * away * (2.0 * (6.0 * angle / TAU - (6.0 * angle / TAU).round()).abs() - 0.5))
    };
    // Triangles in rings around the middle, so that edges lie on the creases.
    let n = 48;
    let ring = |r: u32, i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
        let r = f64::from(r) / 40.0;
        crease(0.5 + r * cos, 0.5 + r * sin)
    };
    let at = |r: u32, i: u32| 1 + (r - 1) * n + i % n;
    let positions = std::iter::once(crease(0.5, 0.5)).chain((1..=20).flat_map(|r| (0..n).map(move |i| ring(r, i))));
    let first = (0..n).map(|i| [0, at(1, i), at(1, i + 1)]);
    let rest = (1..20).flat_map(|r| {
        (0..n)
            .flat_map(move |i| [[at(r, i), at(r + 1, i), at(r + 1, i + 1)], [at(r, i), at(r + 1, i + 1), at(r, i + 1)]])
    });
    let input = Mesh { positions: positions.collect(), triangles: first.chain(rest).collect() };
    let made = check_with(&input, 2000, Features::Degrees(10.0));
    assert!(nearest(&made.mesh, crease(0.5, 0.5)) < 1e-12);
    assert!(made.sharp_curves >= 12, "{}", made.sharp_curves);
}

/// A bar with a thickness of two fifths of the spacing, and a block.
#[test]
fn edges_are_short_where_sharp_edges_are_near_each_other() {
    let strip = moved(cuboid(dvec3(1.0, 0.014, 0.014)), |p| p + dvec3(0.0, 0.0, 0.5));
    let input = together(&[cuboid(DVec3::ONE), moved(strip, |p| p + 2.0 * DVec3::X)]);
    let made = check(&input, 4000);
    let [least, most] = made.spacing_range;
    assert!(least < 0.6 * made.spacing && most > made.spacing, "{:?} {}", made.spacing_range, made.spacing);
    is_good(&made.mesh, 30.0, 125.0, 0.9);
}

#[test]
fn boxes_that_stand_on_each_other_touch_and_do_not_intersect() {
    let above = moved(cuboid(DVec3::splat(0.5)), |p| p + dvec3(0.1, 0.2, 1.0));
    let made = check(&together(&[cuboid(DVec3::ONE), above]), 1500);
    assert!(made.self_intersections.is_empty() && made.output.components == 2);
}

#[test]
fn bodies_that_touch_along_an_edge_share_no_place() {
    let beside = moved(cuboid(DVec3::ONE), |p| p + dvec3(1.0, 1.0, 0.0));
    let made = check(&together(&[cuboid(DVec3::ONE), beside]), 1500);
    let mut places: Vec<[u32; 3]> =
        made.mesh.positions.iter().map(|p| p.as_vec3().to_array().map(f32::to_bits)).collect();
    places.sort_unstable();
    places.dedup();
    assert_eq!((places.len(), made.output.components), (1500, 2));
}

#[test]
fn a_plate_a_tenth_of_the_spacing_thick_stays_two_sheets() {
    let n = 1500;
    // The spacing of `n` vertices on two unit squares.
    let spacing = (2.0 * 2.0 / (3f64.sqrt() * n as f64)).sqrt();
    let size = dvec3(1.0, 1.0, 0.1 * spacing);
    let made = check(&cuboid(size), n);
    let thick = volume(&made.mesh) / size.z;
    assert!((thick - 1.0).abs() < 0.02, "{thick} of the volume is left");
}

#[test]
fn two_spheres_a_thousandth_apart_stay_two() {
    let input = together(&[sphere(5, DVec3::ZERO, 0.5), sphere(5, 1.001 * DVec3::X, 0.5)]);
    for n in [300, 3000] {
        let made = check(&input, n);
        assert_eq!((made.output.components, made.output.euler), (2, 4));
    }
}

#[test]
fn scans_do_not_break_up_in_false_edges() {
    let noisy = noisy(sphere(5, DVec3::ZERO, 1.0), 0.004, &mut random(3));
    assert_eq!(check(&noisy, 1500).sharp_curves, 0);
    assert_eq!(check(&torus(60, 30, 3.0, 1.0), 1500).sharp_curves, 0);
}

/// Returns the end points of edges of a mesh.
fn ends(mesh: &Mesh, edges: &[[u32; 2]]) -> Vec<[DVec3; 2]> {
    edges.iter().map(|edge| edge.map(|v| mesh.positions[v as usize])).collect()
}

fn length(edges: &[[DVec3; 2]]) -> f64 {
    edges.iter().map(|[a, b]| a.distance(*b)).sum()
}

#[test]
fn the_sharp_edges_that_were_kept_are_known() {
    let made = check(&cuboid(DVec3::splat(2.0)), 600);
    let kept = ends(&made.mesh, &made.edges.sharp);
    assert!((length(&kept) - 24.0).abs() < 1e-9, "{}", length(&kept));
    let on_an_edge = |p: &DVec3| p.to_array().iter().filter(|x| **x == 0.0 || **x == 2.0).count() >= 2;
    assert!(kept.iter().flatten().all(on_an_edge) && made.edges.left_out.is_empty());
    let smooth = check_with(&cuboid(DVec3::splat(2.0)), 600, Features::Smooth);
    assert_eq!((smooth.edges.sharp.len(), smooth.edges.left_out.len()), (0, 0));
}

/// Returns a slice of a round cake, of the given angle and thickness.
fn slice(degrees: f64, thickness: f64) -> Mesh {
    let (sin, cos) = degrees.to_radians().sin_cos();
    prism(&[[0.0, 0.0], [1.0, 0.0], [cos, sin]], 0.0, thickness)
}

#[test]
fn where_two_sharp_edges_meet_at_a_small_angle_no_triangle_has_it() {
    let made = check(&slice(16.0, 0.3), 3000);
    let smallest = shape(&made.mesh).unwrap().theta_min;
    assert!(smallest > 28.0, "{smallest}");
    assert_eq!(made.left_out.patches, 2, "the tips above and below");
    for corner in [DVec3::ZERO, 0.3 * DVec3::Z] {
        assert!(nearest(&made.mesh, corner) < 1e-9, "{corner}");
    }
    assert!(made.left_out.deviation < 0.3 * made.spacing, "{:?}", made.left_out);
}

/// Before untangling, faces intersect at the tips of these slices.
#[test]
fn thin_slices_keep_their_corners() {
    for degrees in [5.0, 8.0] {
        let input = slice(degrees, 0.3);
        let made = check(&input, 3000);
        for corner in &input.positions {
            let off = nearest(&made.mesh, *corner);
            assert!(off < 1e-9, "{degrees} degrees: {off} from {corner}");
        }
    }
}

#[test]
fn the_angle_at_a_sharp_tip_of_the_boundary_is_told_apart() {
    let mut flat = slice(16.0, 1.0);
    flat.triangles.retain(|t| t.iter().all(|v| v % 2 == 0));
    flat.drop_unused();
    let made = check(&flat, 3000);
    let smallest = shape(&made.mesh).unwrap().theta_min;
    assert!(smallest < 16.01, "{smallest}");
    assert!(made.unforced_theta_min.unwrap() > 20.0, "{:?}", made.unforced_theta_min);
}

#[test]
fn the_sharp_edges_that_were_left_out_are_known() {
    // A step with a height of five thousandths on a slab.
    let step =
        moved(cells(&[[0; 3], [1, 0, 0], [0, 0, 1]]), |p| dvec3(5.0 + p.x, p.y, if p.z == 2.0 { 1.005 } else { p.z }));
    let made = check(&step, 500);
    let left_out = &made.edges.left_out;
    let is_on_step = |p: &DVec3| (p.x - 6.0).abs() < 1e-9 && (p.z - 1.0).abs() < 0.011;
    assert!(left_out.iter().flatten().any(is_on_step), "{left_out:?}");
    assert!(left_out.iter().flatten().all(|p| p.z > 0.99), "{left_out:?}");
    // The height of the step times the sine of its dihedral angle.
    let deviation = made.left_out.deviation;
    assert!(made.left_out.patches == 1 && (deviation - 0.005).abs() < 2e-4, "{:?}", made.left_out);
}

#[test]
fn the_lengths_that_were_wanted_are_known() {
    let sphere = sphere(4, DVec3::ZERO, 1.0);
    let even = check(&sphere, 500);
    assert_eq!(even.edges.wanted.len(), 500);
    assert!(even.edges.wanted.iter().all(|wanted| (wanted / even.spacing - 1.0).abs() < 1e-9));
    let lengths = sphere.positions.iter().map(|p| 0.1 * (2.0 + p.z)).collect();
    let grading = Grading::Field(Values::Given(lengths));
    let graded = remesh(&sphere, &Options { density: Density::OfField, grading, ..Options::default() }, &()).unwrap();
    for (p, wanted) in graded.mesh.positions.iter().zip(&graded.edges.wanted) {
        assert!((wanted - 0.1 * (2.0 + p.z)).abs() < 0.02, "{wanted} at {p}");
    }
}

/// The cube has 43,200 triangles, far smaller than those of the result.
#[test]
fn a_dense_cube_keeps_its_edges() {
    let n = 60;
    let all: Vec<[i32; 3]> = (0..n * n * n).map(|i| [i % n, i / n % n, i / (n * n)]).collect();
    let made = check(&moved(cells(&all), |p| p / f64::from(n)), 300);
    let faces = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|n| [(n, 1.0), (-n, 0.0)]);
    lies_in_planes(&made.mesh, &faces.collect::<Vec<_>>());
}

/// A million vertices, far from the origin and large or tiny: the figures are the same as at the origin.
#[test]
#[ignore = "slow"]
fn a_million_vertices_at_any_place_and_scale() {
    let torus = torus(1400, 720, 3.0, 1.0);
    for (size, place) in [(1.0, dvec3(1e6, -1e6, 1e6)), (1e-6, DVec3::ZERO)] {
        let made = check(&moved(torus.clone(), |p| size * p + place), 2000);
        assert_eq!((made.output.euler, made.sharp_curves), (0, 0));
        is_good(&made.mesh, 40.0, 90.0, 0.97);
    }
}

/// Returns a prism over a convex `outline`, from `bottom` to `top`.
fn prism(outline: &[[f64; 2]], bottom: f64, top: f64) -> Mesh {
    let n = outline.len() as u32;
    let positions = outline.iter().flat_map(|&[x, y]| [dvec3(x, y, bottom), dvec3(x, y, top)]).collect();
    let sides = (0..n).map(|i| (2 * i, 2 * ((i + 1) % n))).flat_map(|(a, b)| [[a, b, b + 1], [a, b + 1, a + 1]]);
    let ends = (1..n - 1).flat_map(|i| [[0, 2 * i + 2, 2 * i], [1, 2 * i + 1, 2 * i + 3]]);
    Mesh { positions, triangles: sides.chain(ends).collect() }
}

#[test]
#[ignore = "slow"]
fn a_wall_comes_out_sound_that_a_narrow_chamfer_parts_from_a_cavity() {
    // Hollow blocks with a chamfer a twelfth of the spacing wide: without the chamfer, the outer face may cut off an edge of
    // the cavity. Whether it does is a matter of chance.
    let wall = 0.005;
    for seed in 4..12 {
        let block = prism(&[[0., 0.], [10., 0.], [10., 10.], [0.05, 10.], [0., 9.95]], 0.0, 10.0);
        let top = 9.95 - wall;
        let cavity = prism(&[[wall, 5.], [5., 5.], [5., top], [wall, top]], 1.0, 9.0);
        let options = Options { seed, ..Options::default() };
        let made = check_as(&together(&[block, inside_out(cavity)]), 1500, options);
        assert_eq!(made.output.components, 2);
    }
}
