//! Benchmarks of single stages. The input is a bumpy sphere with ten times as many triangles as the result has points, which
//! are 10,000 by default.
//!
//!     cargo bench                      # all
//!     BENCH_POINTS=1000 cargo bench    # with this number of points
//!     cargo bench -- write             # only those whose names contain this word
//!     cargo bench -- --sample-count 50
//!
//! Times depend on the number of threads, `RAYON_NUM_THREADS`, by default one per core. `benches/compare` compares two
//! commits.

#![allow(clippy::disallowed_methods)]

use divan::{Bencher, Divan, black_box};
use glam::{DVec3, dvec3};
use spectral_remesh::io::{self, Format, NO_BUFFERS};
use spectral_remesh::stages::manifold::Manifold;
use spectral_remesh::stages::manifold::vertex_set::VertexSet;
use spectral_remesh::stages::mesh::attributes::{Attribute, Attributes, COLOR, Scalar};
use spectral_remesh::stages::mesh::provenance::{Origins, PointOnTriangle};
use spectral_remesh::stages::mesh::topology::{topology, twins};
use spectral_remesh::stages::optimize::angles::{Goal, improve_angles};
use spectral_remesh::stages::optimize::coarse_to_fine::coarsen;
use spectral_remesh::stages::optimize::counts::meet_count;
use spectral_remesh::stages::optimize::fit::fit;
use spectral_remesh::stages::optimize::relax::{Flips, relax};
use spectral_remesh::stages::optimize::self_intersections::resolve_self_intersections;
use spectral_remesh::stages::optimize::valence::remove_defects;
use spectral_remesh::stages::pipeline::{mesh_of_points, remesh};
use spectral_remesh::stages::prepare::repair::repair;
use spectral_remesh::stages::prepare::stitch::stitch;
use spectral_remesh::stages::quality::distance::{REPORT_SAMPLES, distance};
use spectral_remesh::stages::quality::shape::shape;
use spectral_remesh::stages::spatial::bvh::Bvh;
use spectral_remesh::stages::spectral::ascent::{AscentParameters, PAPER_STEP, ascend};
use spectral_remesh::stages::spectral::candidates::{Candidate, candidates};
use spectral_remesh::stages::spectral::scan::linear_scan;
use spectral_remesh::stages::surface::domain::{Domain, Sample};
use spectral_remesh::stages::transfer::vertex::carry;
use spectral_remesh::stages::triangulate::mutual_tessellation::{Insertion, mutual_tessellation};
use spectral_remesh::stages::triangulate::{Boundary, triangulate};
use spectral_remesh::{CloudOptions, Density, Mesh, Options, Points, Result};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

static POINTS: LazyLock<usize> = LazyLock::new(|| match std::env::var("BENCH_POINTS") {
    Ok(points) => points.parse().expect("BENCH_POINTS is a number"),
    Err(_) => 10_000,
});
const SEED: u64 = 0;
const SWEEPS: usize = 10;
const NO_BOUNDARY: Boundary = Boundary { sites: &[], successor: &[], spikes: 0 };

fn main() {
    LazyLock::force(&INPUTS);
    Divan::default().sample_count(10).config_with_args().main();
}

/// The input of each stage, made by the stages before it.
struct Inputs {
    mesh: Mesh,
    domain: Domain,
    spacing: f64,
    candidates: Vec<Candidate>,
    samples: Vec<Sample>,
    manifold: Manifold,
    result: Mesh,
    origins: Origins,
}

/// Returns where on `mesh`, the mesh of `domain`, these positions lie.
fn on(domain: &Domain, mesh: &Mesh, places: &[DVec3]) -> Vec<PointOnTriangle> {
    places.iter().map(|&p| domain.origin(&domain.project_anywhere(p), 0.0, &mesh.triangles)).collect()
}

fn centres(mesh: &Mesh) -> Vec<DVec3> {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t).into_iter().sum::<DVec3>() / 3.0).collect()
}

fn ascent(spacing: f64) -> AscentParameters {
    AscentParameters { sigma: spacing, step: PAPER_STEP, sweeps: SWEEPS }
}

static INPUTS: LazyLock<Inputs> = LazyLock::new(Inputs::new);

impl Inputs {
    fn new() -> Inputs {
        let rows = (2.56 * *POINTS as f64).sqrt() as u32;
        let mesh = bumpy_sphere(rows, 63 * rows / 32);
        let spacing = (2.0 * mesh.area() / (3f64.sqrt() * *POINTS as f64)).sqrt();
        let domain = Domain::new(repair(&mesh).0);
        let candidates = cover(&domain);
        let samples = scan(&domain, &candidates, spacing);
        let manifold = join(&domain, &samples, spacing);
        let mut spread = manifold.clone();
        ascend(&domain, &mut spread, &VertexSet::EMPTY, ascent(spacing), &()).expect("nobody cancels");
        let result = spread.to_mesh();
        let origins = Origins {
            vertices: on(&domain, &mesh, &result.positions),
            triangles: on(&domain, &mesh, &centres(&result)),
        };
        Inputs { result, origins, mesh, domain, spacing, candidates, samples, manifold }
    }
}

/// A closed surface of `2 columns (rows - 1)` triangles, which are narrow at the poles.
fn bumpy_sphere(rows: u32, columns: u32) -> Mesh {
    let bumps = |p: DVec3| p * (1.0 + 0.08 * (7.0 * p.x).sin() * (6.0 * p.y).sin() * (5.0 * p.z).cos());
    let place = |i: u32, j: u32| {
        let (polar, round) = (PI * f64::from(i) / f64::from(rows), TAU * f64::from(j) / f64::from(columns));
        bumps(dvec3(polar.sin() * round.cos(), polar.sin() * round.sin(), polar.cos()))
    };
    let rings = (1..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    let positions: Vec<DVec3> = rings.map(|(i, j)| place(i, j)).chain([bumps(DVec3::Z), bumps(DVec3::NEG_Z)]).collect();
    let at = |i: u32, j: u32| (i - 1) * columns + j % columns;
    let (top, bottom) = (positions.len() as u32 - 2, positions.len() as u32 - 1);
    let mut triangles = Vec::new();
    for j in 0..columns {
        triangles.push([top, at(1, j), at(1, j + 1)]);
        triangles.push([bottom, at(rows - 1, j + 1), at(rows - 1, j)]);
        for i in 1..rows - 1 {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    Mesh { positions, triangles }
}

fn cover(domain: &Domain) -> Vec<Candidate> {
    candidates(domain, 20 * *POINTS, SEED)
}

fn scan(domain: &Domain, candidates: &[Candidate], spacing: f64) -> Vec<Sample> {
    linear_scan(domain, candidates, &[], 0.866 * spacing, SEED, &()).expect("nobody cancels")
}

fn join(domain: &Domain, samples: &[Sample], spacing: f64) -> Manifold {
    triangulate(domain, samples, NO_BOUNDARY, spacing, &()).expect("nobody cancels").mesh
}

#[divan::bench]
fn s01_repair(bencher: Bencher) {
    bencher.bench(|| repair(black_box(&INPUTS.mesh)));
}

#[divan::bench]
fn s02_open_seams(bencher: Bencher) {
    bencher.bench(|| stitch(black_box(&INPUTS.mesh)));
}

#[divan::bench]
fn s03_topology(bencher: Bencher) {
    let mesh = &INPUTS.mesh;
    bencher.bench(|| topology(mesh.positions.len(), black_box(&mesh.triangles)));
}

#[divan::bench]
fn s04_domain(bencher: Bencher) {
    bencher.with_inputs(|| repair(&INPUTS.mesh).0).bench_values(Domain::new);
}

#[divan::bench]
fn s04_domain_hierarchy(bencher: Bencher) {
    bencher.bench(|| Bvh::new(black_box(&INPUTS.domain.mesh)));
}

#[divan::bench]
fn s04_domain_twins(bencher: Bencher) {
    bencher.bench(|| twins(black_box(&INPUTS.domain.mesh.triangles)));
}

#[divan::bench]
fn s05_candidates(bencher: Bencher) {
    bencher.bench(|| cover(black_box(&INPUTS.domain)));
}

#[divan::bench]
fn s06_linear_scan(bencher: Bencher) {
    let given = &*INPUTS;
    bencher.bench(|| scan(&given.domain, black_box(&given.candidates), given.spacing));
}

#[divan::bench]
fn s07_triangulate(bencher: Bencher) {
    let given = &*INPUTS;
    bencher.bench(|| join(&given.domain, black_box(&given.samples), given.spacing));
}

/// The fallback of [`s07_triangulate`], for the whole surface.
#[divan::bench]
fn s07_mutual_tessellation(bencher: Bencher) {
    let given = &*INPUTS;
    let piece: Vec<u32> = (0..given.domain.mesh.triangles.len() as u32).collect();
    let insertion = |&sample: &Sample| Insertion { sample, on_side: None, is_spike: false };
    let insertions: Vec<Insertion> = given.samples.iter().map(insertion).collect();
    bencher.bench(|| mutual_tessellation(&given.domain, &piece, black_box(&insertions)));
}

#[divan::bench]
fn s08_meet_count(bencher: Bencher) {
    let given = &*INPUTS;
    bencher.with_inputs(|| given.manifold.clone()).bench_values(|mut mesh| {
        meet_count(&given.domain, &mut mesh, *POINTS);
        mesh
    });
}

#[divan::bench]
fn s09_ascent(bencher: Bencher) {
    let given = &*INPUTS;
    bencher.with_inputs(|| given.manifold.clone()).bench_values(|mut mesh| {
        ascend(&given.domain, &mut mesh, &VertexSet::EMPTY, ascent(given.spacing), &()).expect("nobody cancels");
        mesh
    });
}

/// Measures one of the optimisation stages on the manifold that triangulation gives.
fn optimising(bencher: Bencher, stage: impl Fn(&Domain, &mut Manifold, f64) -> Result<()> + Sync) {
    let given = &*INPUTS;
    bencher.with_inputs(|| given.manifold.clone()).bench_values(|mut mesh| {
        stage(&given.domain, &mut mesh, given.spacing).expect("nobody cancels");
        mesh
    });
}

#[divan::bench]
fn s10_coarsen(bencher: Bencher) {
    optimising(bencher, |domain, mesh, spacing| {
        coarsen(domain, mesh, spacing, &VertexSet::EMPTY);
        Ok(())
    });
}

#[divan::bench]
fn s10_relax_one_round(bencher: Bencher) {
    optimising(bencher, |domain, mesh, spacing| {
        relax(domain, mesh, &VertexSet::EMPTY, spacing, Flips::Delaunay, 1, &())
    });
}

#[divan::bench]
fn s10_remove_defects(bencher: Bencher) {
    optimising(bencher, |_, mesh, _| {
        let everywhere = VertexSet::all(mesh);
        remove_defects(mesh, &VertexSet::EMPTY, &everywhere);
        Ok(())
    });
}

#[divan::bench]
fn s10_improve_angles(bencher: Bencher) {
    optimising(bencher, |domain, mesh, spacing| improve_angles(domain, mesh, Goal::GOOD, spacing, &()));
}

#[divan::bench]
fn s10_fit(bencher: Bencher) {
    optimising(bencher, |domain, mesh, spacing| {
        let all = (0..domain.mesh.positions.len() as u32).collect();
        fit(domain, mesh, all, Goal::GOOD, spacing, None, &()).map(drop)
    });
}

#[divan::bench]
fn s10_resolve_self_intersections(bencher: Bencher) {
    optimising(bencher, |domain, mesh, _| resolve_self_intersections(domain, mesh, &()));
}

#[divan::bench]
fn s11_report_shape(bencher: Bencher) {
    bencher.bench(|| shape(black_box(&INPUTS.result)));
}

#[divan::bench]
fn s11_report_distance(bencher: Bencher) {
    bencher.bench(|| distance(&INPUTS.result, black_box(&INPUTS.mesh), REPORT_SAMPLES, SEED));
}

/// The mesh through half of the candidates, ten per point, without their normals; smoothed or not.
#[divan::bench(args = [false, true])]
fn s11_mesh_of_points(bencher: Bencher, smooth: bool) {
    let all = INPUTS.candidates.iter().step_by(2).map(|c| c.sample(&INPUTS.domain).position);
    let points = Points::without_normals(all.collect());
    let options = CloudOptions { smooth: smooth.then_some(2.3), ..CloudOptions::default() };
    bencher.bench(|| mesh_of_points(black_box(&points), &options, &()).unwrap().mesh.triangles.len());
}

#[divan::bench]
fn s12_remesh_all(bencher: Bencher) {
    let options = Options { density: Density::Points(*POINTS), ..Options::default() };
    bencher.bench(|| remesh(black_box(&INPUTS.mesh), &options, &()).expect("the sphere can be remeshed"));
}

/// A colour per vertex, or texture coordinates per corner.
#[divan::bench(args = [false, true])]
fn s13_carry(bencher: Bencher, with_texture: bool) {
    let given = &*INPUTS;
    let values = given.mesh.positions.iter().flat_map(|p| p.to_array()).collect();
    let color = Attribute { name: COLOR.into(), components: 3, values, scalar: Scalar::F32 };
    let corners = |t: usize| given.mesh.corners(t).map(DVec3::truncate);
    let attributes = match with_texture {
        false => Attributes { vertex: vec![color], ..Attributes::default() },
        true => Attributes { texture: (0..given.mesh.triangles.len()).map(corners).collect(), ..Attributes::default() },
    };
    bencher.bench(|| carry(black_box(&given.mesh), &attributes, &given.result, &given.origins));
}

#[divan::bench(args = Format::OF_MESHES)]
fn s14_read(bencher: Bencher, format: Format) {
    let bytes = written(format);
    bencher
        .counter(divan::counter::BytesCount::new(bytes.len()))
        .bench(|| io::parse(black_box(&bytes), format, NO_BUFFERS).expect("what was written can be read"));
}

#[divan::bench(args = Format::OF_MESHES)]
fn s15_write(bencher: Bencher, format: Format) {
    bencher.bench(|| written(black_box(format)));
}

fn written(format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    io::write(&INPUTS.mesh, format, &mut bytes).expect("memory does not fail");
    bytes
}
