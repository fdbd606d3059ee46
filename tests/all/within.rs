//! Local resampling: a part is remeshed, the rest stays unchanged, and both fit together.

use crate::common::*;
use glam::{DVec2, DVec3, dvec2, dvec3};
use spectral_remesh::stages::geom::triangle::smallest_angle;
use spectral_remesh::stages::mesh::attributes::{Attribute, Attributes, Scalar};
use spectral_remesh::stages::mesh::materials::{Material, Materials};
use spectral_remesh::stages::mesh::submesh::Kept;
use spectral_remesh::stages::pipeline::{Remeshed, remesh};
use spectral_remesh::stages::transfer::vertex::carry;
use spectral_remesh::{Density, Mesh, Options, Selection};

const ALL: f64 = 1e9;

fn above(z: f64) -> Selection {
    Selection::Box([[-ALL, -ALL, z], [ALL, ALL, ALL]])
}

/// Selects the vertices of `mesh` where `f` holds.
fn places(mesh: &Mesh, f: impl Fn(DVec3) -> bool) -> Selection {
    Selection::Vertices(mesh.positions.iter().map(|&p| f(p)).collect())
}

fn part(selection: Selection, n: usize) -> Options {
    Options { density: Density::Points(n), part: Some(selection), ..Options::default() }
}

/// Remeshes a part of `input`, which needs no repair, and checks what is promised for all results.
#[track_caller]
fn check_with(input: &Mesh, options: &Options) -> (Remeshed, Kept) {
    let made = remesh(input, options, &()).unwrap();
    assert!(made.verified(), "{:?} became {:?}: {:?}", made.repaired, made.output, made.notes);
    assert_eq!(made.mesh.positions.len(), made.wanted, "{:?}", made.notes);
    audit(&made.mesh);
    let kept = made.kept.clone().unwrap();
    for (new, &old) in kept.vertices.iter().enumerate() {
        let bits = |p: DVec3| p.to_array().map(f64::to_bits);
        assert_eq!(bits(made.mesh.positions[new]), bits(input.positions[old as usize]));
    }
    for (new, &old) in kept.triangles.iter().enumerate() {
        let corners = made.mesh.triangles[new].map(|v| kept.vertices[v as usize]);
        assert_eq!(corners, input.triangles[old as usize]);
    }
    assert!(kept.vertices.is_sorted() && kept.triangles.is_sorted());
    (made, kept)
}

/// Calls [`check_with`] with `n` vertices inside the part.
#[track_caller]
fn check(input: &Mesh, selection: Selection, n: usize) -> (Remeshed, Kept) {
    let (made, kept) = check_with(input, &part(selection, n));
    assert_eq!(made.mesh.positions.len(), kept.vertices.len() + n);
    assert_eq!(made.edges.wanted.len(), n);
    (made, kept)
}

/// Returns the smallest angle of the new triangles in degrees: of all, and of those without a vertex on the interface.
fn angles(made: &Remeshed, kept: &Kept) -> [f64; 2] {
    let new = kept.triangles.len()..made.mesh.triangles.len();
    let is_new = |v: &u32| *v as usize >= kept.vertices.len();
    let inside = new.clone().filter(|&t| made.mesh.triangles[t].iter().all(is_new));
    let least = |triangles: &mut dyn Iterator<Item = usize>| {
        triangles.map(|t| smallest_angle(made.mesh.corners(t))).fold(180.0, f64::min)
    };
    [least(&mut new.clone()), least(&mut inside.into_iter())]
}

#[test]
fn the_cap_of_a_sphere_and_nothing_else() {
    let input = sphere(5, DVec3::ZERO, 1.0);
    for (n, least_at_seam) in [(150, 20.0), (600, 30.0), (3000, 30.0)] {
        let (made, kept) = check(&input, above(0.3), n);
        let outside = input.triangles.iter().filter(|t| t.iter().any(|&v| input.positions[v as usize].z < 0.3));
        assert_eq!(kept.triangles.len(), outside.count());
        let [at_seam, inside] = angles(&made, &kept);
        assert!(at_seam > least_at_seam && inside > 30.0, "{n}: {at_seam} at the seam, {inside} inside");
    }
}

#[test]
fn an_edge_length_is_that_of_the_part() {
    let input = sphere(5, DVec3::ZERO, 1.0);
    let options = Options { density: Density::EdgeLength(0.1), seed: 4, ..part(above(0.3), 3) };
    let (made, kept) = check_with(&input, &options);
    let new =
        (kept.triangles.len()..made.mesh.triangles.len()).filter(|&t| made.mesh.corners(t).iter().all(|p| p.z > 0.7));
    let lengths: Vec<f64> = new.map(|t| made.mesh.corners(t)).map(|[a, b, _]| a.distance(b)).collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    assert!((mean / 0.1 - 1.0).abs() < 0.08, "{mean}");
}

#[test]
fn two_pieces_of_selected_vertices() {
    let input = torus(90, 36, 1.0, 0.4);
    let (made, kept) = check(&input, places(&input, |p| p.x.abs() > 0.6), 1200);
    let new = &made.mesh.positions[kept.vertices.len()..];
    assert!(new.iter().any(|p| p.x > 0.8) && new.iter().any(|p| p.x < -0.8));
    assert!(new.iter().all(|p| p.x.abs() > 0.55));
    assert!(angles(&made, &kept)[1] > 30.0);
}

#[test]
fn a_part_up_to_the_rim_of_an_open_mesh() {
    let input = sheet(40, 40);
    let half = input.positions.iter().map(|p| p.x).sum::<f64>() / input.positions.len() as f64;
    let (made, kept) = check(&input, places(&input, |p| p.x > half), 400);
    assert_eq!(made.output.boundary_loops, 1);
    assert!(angles(&made, &kept)[1] > 30.0);
}

#[test]
fn sharp_edges_inside_stay_sharp() {
    let n = 12;
    let face = |u: DVec3, v: DVec3, at: DVec3| grid(n, n, Ends::Open, Ends::Open, move |a, b| at + a * u + b * v);
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    let o = DVec3::ZERO;
    let faces = [face(y, x, o), face(x, z, o), face(z, y, o), face(x, y, z), face(z, x, y), face(y, z, x)];
    let cube = spectral_remesh::stages::prepare::repair::repair(&together(&faces)).0.into_mesh();
    let (made, _) = check(&cube, Selection::Box([[0.45; 3], [2.0; 3]]), 300);
    assert_eq!(made.sharp_curves, 3);
    assert!((volume(&made.mesh) - 1.0).abs() < 1e-9, "{}", volume(&made.mesh));
}

#[test]
fn a_part_that_is_everything_is_no_part() {
    let input = sphere(4, DVec3::ZERO, 1.0);
    let all = remesh(&input, &part(above(-2.0), 300), &()).unwrap();
    let plain = remesh(&input, &Options { part: None, ..part(above(-2.0), 300) }, &()).unwrap();
    assert!(all.kept.is_none());
    assert_eq!(all.mesh, plain.mesh);
}

#[test]
fn a_part_that_is_nothing_is_one_line() {
    let input = sphere(2, DVec3::ZERO, 1.0);
    let message = |selection: Selection| remesh(&input, &part(selection, 100), &()).unwrap_err().to_string();
    let nothing = message(Selection::Box([[2.0; 3], [3.0; 3]]));
    assert!(nothing.contains("inside 2,2,2,3,3,3") && nothing.contains("within -1,-1,-1,1,1,1"), "{nothing}");
    assert!(message(places(&input, |p| p.z == 1.0)).contains("1 of 66 vertices are"));
    assert!(message(Selection::Box([[0.0, 3.0, 0.0], [1.0; 3]])).contains("it goes from 3 to 1 along y"));
    assert!(message(Selection::Vertices(vec![true; 5])).contains("5 marks are given for the 66 vertices"));
    let smoothed = Options { smooth: Some(2.0), ..part(above(0.0), 100) };
    assert!(remesh(&input, &smoothed, &()).unwrap_err().to_string().starts_with("support radius of smoothing: "));
}

#[test]
fn pieces_without_room_for_a_point_stay() {
    let input = sphere(5, DVec3::ZERO, 1.0);
    let triangle = input.triangles.iter().find(|t| t.iter().all(|&v| input.positions[v as usize].z < -0.5)).unwrap();
    let selected = (0..).zip(&input.positions).map(|(v, p)| p.z > 0.3 || triangle.contains(&v)).collect();
    let (made, _) = check(&input, Selection::Vertices(selected), 300);
    assert!(
        made.notes.iter().any(|note| note.contains("1 components of the part are left unchanged")),
        "{:?}",
        made.notes
    );
}

#[test]
fn what_is_repaired_stays_as_it_is_then() {
    let input = soup(&sphere(4, DVec3::ZERO, 1.0));
    let made = remesh(&input, &part(above(0.0), 300), &()).unwrap();
    assert!(made.verified() && made.repairs.welded_vertices > 0);
    let kept = made.kept.as_ref().unwrap();
    for (new, &old) in kept.triangles.iter().enumerate() {
        assert_eq!(made.mesh.corners(new), input.corners(old as usize));
    }
    assert!(made.notes.iter().any(|note| note.contains("the repaired input")));
}

#[test]
fn what_stays_has_the_attributes_that_it_had() {
    let input = sphere(4, DVec3::ZERO, 1.0);
    let mut rng = random(5);
    let mut number = || spectral_remesh::stages::base::rng::unit(&mut rng);
    let vertex = |name: &str, components: usize, values: Vec<f64>| Attribute {
        name: name.into(),
        components,
        values,
        scalar: Scalar::F64,
    };
    let count = input.positions.len();
    let heat = vertex("heat", 1, (0..count).map(|_| number()).collect());
    let normal = vertex("normal", 3, (0..3 * count).map(|_| number()).collect());
    let texture: Vec<[DVec2; 3]> =
        input.triangles.iter().map(|_| [0, 1, 2].map(|_| dvec2(number(), number()))).collect();
    let of_triangle: Vec<u32> = (0..input.triangles.len() as u32).map(|t| t % 2).collect();
    let list = ["a", "b"].map(Material::named).to_vec();
    let materials = Materials { list, of_triangle, ..Materials::default() };
    let attributes = Attributes { vertex: vec![heat, normal], texture, materials: Some(materials), parts: None };
    let (made, kept) = check(&input, above(0.2), 200);
    let mut carried = carry(&input, &attributes, &made.mesh, &made.origins);
    carried.keep(&input, &attributes, &made.mesh, &kept);
    let carried = carried.attributes;
    for (new, &old) in kept.vertices.iter().enumerate() {
        (0..2).for_each(|k| assert_eq!(carried.vertex[k].of(new), attributes.vertex[k].of(old as usize)));
    }
    let of = |attributes: &Attributes, t: usize| attributes.materials.as_ref().unwrap().of_triangle[t];
    for (new, &old) in kept.triangles.iter().enumerate() {
        assert_eq!(carried.texture[new], attributes.texture[old as usize]);
        assert_eq!(of(&carried, new), of(&attributes, old as usize));
    }
}

#[test]
#[ignore = "slow"]
fn rough_seams_fit_on_any_shape() {
    let mut rng = random(3);
    let shapes = [
        noisy(sphere(4, DVec3::ZERO, 1.0), 0.02, &mut rng),
        cylinder(40, 1.0, 0.5, 2.0),
        noisy(torus(60, 24, 1.0, 0.4), 0.01, &mut rng),
        noisy(sheet(30, 30), 0.005, &mut rng),
    ];
    for (k, input) in shapes.iter().enumerate() {
        for n in [40, 300, 1000] {
            let bounds = input.bounds().unwrap();
            let cut = bounds.lo + 0.37 * bounds.size();
            let side = dvec3(1.0, 0.3, 0.7);
            let selection = places(input, |p| (p - cut).dot(side) > 0.0);
            let made = remesh(input, &part(selection, n), &()).unwrap();
            assert!(made.has_topology(), "shape {k}, {n}: {:?}", made.notes);
            assert_eq!(made.mesh.positions.len(), made.wanted, "shape {k}, {n}: {:?}", made.notes);
        }
    }
}
