//! Transfer of attributes from input to output: numbers, labels, colours, texture coordinates, materials.

use crate::common::{Ends, cells, grid, inside_out, moved, plate, random, sphere, together};
use glam::{DVec2, DVec3, dvec2, dvec3};
use spectral_remesh::stages::base::rng::unit;
use spectral_remesh::stages::mesh::attributes::{Attribute, Attributes, Scalar};
use spectral_remesh::stages::mesh::materials::{Material, Materials};
use spectral_remesh::stages::mesh::provenance::{Origins, PointOnTriangle};
use spectral_remesh::stages::pipeline::Remeshed;
use spectral_remesh::stages::pipeline::remesh;
use spectral_remesh::stages::transfer::vertex::{self, Carried};
use spectral_remesh::{Density, Mesh, Options};
use std::f64::consts::TAU;

/// Returns one attribute, with the values of `f` at the vertices.
fn of_places<const N: usize>(mesh: &Mesh, name: &str, scalar: Scalar, f: impl Fn(DVec3) -> [f64; N]) -> Attributes {
    let values = mesh.positions.iter().flat_map(|&p| f(p)).collect();
    let attribute = Attribute { name: name.into(), components: N, values, scalar };
    Attributes { vertex: vec![attribute], ..Attributes::default() }
}

fn remeshed(input: &Mesh, points: usize) -> Remeshed {
    let options = Options { density: Density::Points(points), ..Options::default() };
    let result = remesh(input, &options, &()).unwrap();
    assert!(result.verified(), "{:?}", result.notes);
    result
}

/// Transfers the attributes of `input` to the result made from it.
fn carry(input: &Mesh, attributes: &Attributes, output: &Remeshed) -> Carried {
    vertex::carry(input, attributes, &output.mesh, &output.origins)
}

/// Checks that everything was transferred without notes, and returns the attributes.
#[track_caller]
fn whole(carried: Carried) -> Attributes {
    assert!(carried.lost.is_empty() && carried.notes.is_empty(), "{:?} {:?}", carried.lost, carried.notes);
    carried.attributes
}

fn flat(n: u32) -> Mesh {
    grid(n, n, Ends::Open, Ends::Open, |u, v| dvec3(u, v, 0.0))
}

#[test]
fn a_linear_function_on_a_plane_is_exact() {
    let input = flat(13);
    let f = |p: DVec3| [3.0 * p.x - 2.0 * p.y + 0.7, p.x];
    let output = remeshed(&input, 500);
    let carried = whole(carry(&input, &of_places(&input, "h", Scalar::F64, f), &output));
    for (p, values) in output.mesh.positions.iter().zip(carried.vertex[0].values.chunks_exact(2)) {
        assert!((0..2).all(|k| (values[k] - f(*p)[k]).abs() < 1e-9), "{p} {values:?}");
    }
}

#[test]
fn labels_stay_whole_and_are_those_below() {
    let input = sphere(4, DVec3::ZERO, 1.0);
    let octant = |p: DVec3| f64::from(p.x > 0.0) + 2.0 * f64::from(p.y > 0.0) + 4.0 * f64::from(p.z > 0.0);
    let attributes = of_places(&input, "part", Scalar::U8, |p| [10.0 * octant(p)]);
    let output = remeshed(&input, 800);
    let carried = whole(carry(&input, &attributes, &output));
    for (&p, &label) in output.mesh.positions.iter().zip(&carried.vertex[0].values) {
        assert!((0..8).any(|o| label == 10.0 * f64::from(o)));
        // Edges of the input have a length of about 0.1.
        assert!(p.abs().min_element() < 0.12 || label == 10.0 * octant(p), "{p} {label}");
    }
}

#[test]
fn colours_of_a_sphere_stay_bytes_and_do_not_depend_on_threads() {
    let input = sphere(5, dvec3(3.0, 0.0, 0.0), 2.0);
    let f = |p: DVec3| (0.5 * (p - dvec3(3.0, 0.0, 0.0))).to_array().map(|x| (127.5 + 127.0 * x).round());
    let attributes = of_places(&input, "color", Scalar::U8, f);
    let output = remeshed(&input, 2000);
    let with_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        whole(pool.install(|| carry(&input, &attributes, &output)))
    };
    let carried = with_threads(1);
    assert!(carried == with_threads(2) && carried == with_threads(4));
    for (&p, color) in output.mesh.positions.iter().zip(carried.vertex[0].values.chunks_exact(3)) {
        let expected = f(p);
        assert!((0..3).all(|k| color[k].fract() == 0.0 && (color[k] - expected[k]).abs() <= 2.0), "{color:?}");
    }
}

#[test]
fn the_other_side_of_a_thin_plate_is_another_one() {
    let input = plate(12, 0.004);
    let attributes = of_places(&input, "side", Scalar::F64, |p| [f64::from(p.z > 0.002)]);
    for input in [input.clone(), inside_out(input)] {
        let output = remeshed(&input, 600);
        let carried = whole(carry(&input, &attributes, &output));
        let flips = output.mesh.positions.iter().zip(&carried.vertex[0].values);
        assert!(
            flips.clone().all(|(p, &side)| (side - f64::from(p.z > 0.002)).abs() < 1e-9 || p.z > 0.0 && p.z < 0.004)
        );
    }
}

#[test]
fn normals_are_those_of_the_output() {
    let input = sphere(3, DVec3::ZERO, 1.0);
    let attributes = of_places(&input, "normal", Scalar::F32, |_| [0.0, 0.0, 1.0]);
    let output = remeshed(&input, 500);
    let normals = whole(carry(&input, &attributes, &output)).normals();
    assert!(output.mesh.positions.iter().zip(&normals).all(|(p, n)| n.dot(p.normalize()) > 0.99));
}

#[test]
fn what_cannot_be_carried_is_named() {
    let input = sphere(2, DVec3::ZERO, 1.0);
    let mut attributes = of_places(&input, "good", Scalar::F32, |p| [p.x]);
    let mut bad = attributes.vertex[0].clone();
    (bad.name, bad.values[7]) = ("bad".into(), f64::NAN);
    attributes.vertex.push(bad);
    let corner = |v: u32| (0..).zip(&input.triangles).find_map(|(t, c)| Some((t, c.iter().position(|&w| w == v)?)));
    let point = |(triangle, k)| PointOnTriangle { triangle, weights: [0, 1, 2].map(|i| f64::from(i == k)) };
    let vertices = (0..input.positions.len() as u32).map(|v| point(corner(v).unwrap())).collect();
    let origins = Origins { vertices, triangles: vec![] };
    let carried = vertex::carry(&input, &attributes, &input, &origins);
    assert_eq!(carried.attributes.names(), ["good"]);
    assert_eq!(carried.attributes.vertex[0].values, attributes.vertex[0].values);
    assert!(
        carried.lost[0].name == "bad" && carried.lost[0].cause.starts_with("vertex 7 has NaN"),
        "{:?}",
        carried.lost
    );
    assert_eq!(vertex::carry(&input, &Attributes::default(), &input, &origins), Carried::default());
}

/// Returns the side of the unit cube nearest to a point, and its place in an atlas of six squares.
fn on_cube(p: DVec3) -> (u32, DVec2) {
    let q = p - 0.5;
    let axis = (0..3).max_by(|&a, &b| q[a].abs().total_cmp(&q[b].abs())).unwrap();
    let side = 2 * axis as u32 + u32::from(q[axis] > 0.0);
    (side, dvec2(p[(axis + 1) % 3] + 1.5 * f64::from(side), p[(axis + 2) % 3]))
}

#[test]
fn a_cube_keeps_its_seams_and_its_materials() {
    let input = cells(&[[0; 3]]);
    let middle = |mesh: &Mesh, t: usize| mesh.corners(t).into_iter().sum::<DVec3>() / 3.0;
    let side = |mesh: &Mesh, t: usize| on_cube(middle(mesh, t)).0;
    let on_side = |side: u32, p: DVec3| {
        let axis = side as usize / 2;
        dvec2(p[(axis + 1) % 3] + 1.5 * f64::from(side), p[(axis + 2) % 3])
    };
    let all = 0..input.triangles.len();
    let texture = all.clone().map(|t| input.corners(t).map(|p| on_side(side(&input, t), p))).collect();
    let of_triangle = all.map(|t| side(&input, t)).collect();
    let list = (0..6).map(|s| Material::named(&s.to_string())).collect();
    let materials = Some(Materials { list, of_triangle, ..Materials::default() });
    let output = remeshed(&input, 900);
    let carried = whole(carry(&input, &Attributes { texture, materials, ..Attributes::default() }, &output));
    for t in 0..output.mesh.triangles.len() {
        let side = side(&output.mesh, t);
        assert_eq!(carried.materials.as_ref().unwrap().of_triangle[t], side);
        for (p, at) in output.mesh.corners(t).into_iter().zip(carried.texture[t]) {
            assert!(at.distance(on_side(side, p)) < 1e-6, "{p} {at}");
        }
    }
}

/// Returns a tube around z with a texture rolled around it once, so that both sides of its only seam belong to one chart.
fn tube(n: u32, m: u32) -> (Mesh, Attributes) {
    let open = grid(n, m, Ends::Open, Ends::Open, |u, v| dvec3(u, v, 0.0));
    let texture = (0..open.triangles.len()).map(|t| open.corners(t).map(DVec3::truncate)).collect();
    let roll = |p: DVec3| {
        // The last column has exactly the positions of the first one.
        let angle = if p.x == 1.0 { 0.0 } else { TAU * p.x };
        dvec3(angle.cos(), angle.sin(), 3.0 * p.y)
    };
    (moved(open, roll), Attributes { texture, ..Attributes::default() })
}

#[test]
fn a_seam_within_one_chart_is_kept() {
    for (n, m, points) in [(80, 40, 700), (12, 4, 700), (300, 100, 300)] {
        let (input, attributes) = tube(n, m);
        let output = remeshed(&input, points);
        let carried = whole(carry(&input, &attributes, &output));
        for (t, texture) in carried.texture.iter().enumerate() {
            // An edge spans at most a fifth of the circumference.
            let width = (0..3).map(|k| (texture[k].x - texture[(k + 1) % 3].x).abs()).fold(0.0, f64::max);
            assert!(width < 0.2, "{n} {texture:?}");
            for (p, at) in output.mesh.corners(t).into_iter().zip(texture) {
                let turn = p.y.atan2(p.x) / TAU;
                let off = (at.x - turn - (at.x - turn).round()).abs().max((at.y - p.z / 3.0).abs());
                assert!(off < 0.02, "{n} {p} {at} {off}");
            }
        }
        let seam = carried.texture.iter().flatten().filter(|at| at.x < 0.05 || at.x > 0.95).count();
        assert!(seam > 10, "{seam}");
    }
}

#[test]
fn triangles_that_a_seam_distorts_are_counted() {
    // Every triangle of the input is a separate chart.
    let input = sphere(3, DVec3::ZERO, 1.0);
    let mut rng = random(1);
    let mut place = || DVec2::splat(100.0 * unit(&mut rng));
    let texture = input.triangles.iter().map(|_| place()).map(|at| [at, at + DVec2::X, at + DVec2::Y]).collect();
    let carried = carry(&input, &Attributes { texture, ..Attributes::default() }, &remeshed(&input, 60));
    assert!(carried.notes[0].contains("triangles, all at seams, have distorted texture coordinates"));
    assert!(carried.attributes.texture.iter().flatten().all(|at| at.is_finite()));
}

#[test]
fn triangles_without_texture_stay_without() {
    let [left, right] = [flat(8), moved(flat(8), |p| p + dvec3(3.0, 0.0, 0.0))];
    let input = together(&[left, right]);
    let flat = |p: DVec3| if p.x < 2.0 { p.truncate() } else { DVec2::NAN };
    let texture = (0..input.triangles.len()).map(|t| input.corners(t).map(flat)).collect();
    let output = remeshed(&input, 300);
    let carried = whole(carry(&input, &Attributes { texture, ..Attributes::default() }, &output));
    for (t, texture) in carried.texture.iter().enumerate() {
        let found = output.mesh.corners(t).into_iter().zip(texture);
        assert!(found.clone().all(|(p, at)| if p.x < 2.0 { at.distance(p.truncate()) < 1e-9 } else { at.is_nan() }));
    }
}
