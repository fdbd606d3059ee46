//! Makes inputs and options of all kinds from arbitrary bytes, for the property tests and for the fuzzing in `fuzz/`, and
//! checks the job on them.

use crate::common::*;
use crate::sound::{Kind, crossing, kind};
use glam::{DVec3, dvec3};
use spectral_remesh::{
    Carry, CloudOptions, Density, Error, Features, Grading, Input, MaxError, Mesh, Monitor, Options, RemeshOptions,
    Values, remesh,
};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Decisions, one per byte; zeros after the last byte.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn next(&mut self) -> u32 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first.into()
    }

    /// Returns a number in `low..=high`.
    fn among(&mut self, low: u32, high: u32) -> u32 {
        low + self.next() % (high - low + 1)
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.next() as usize % all.len()]
    }

    /// Returns a number from 0 to 1.
    fn share(&mut self) -> f64 {
        f64::from(self.next()) / 255.0
    }

    fn vector(&mut self) -> DVec3 {
        dvec3(self.share(), self.share(), self.share())
    }
}

/// An input with its options.
#[derive(Debug)]
pub struct Case {
    pub mesh: Mesh,
    pub options: RemeshOptions,
    /// The topology of the shape before damage that repair should undo; `None` if it is not known. A shape with known
    /// topology does not intersect itself.
    pub kind: Option<Kind>,
}

impl Case {
    /// Returns the case encoded by these bytes, with at most `most_points` points.
    pub fn new(bytes: &[u8], most_points: usize) -> Case {
        let bytes = &mut Bytes(bytes);
        let (mut mesh, mut is_known) = shape(bytes);
        let kind = kind(&mesh).ok();
        is_known &= kind.is_some() && damage(bytes, &mut mesh);
        let options = options(bytes, most_points, mesh.positions.len());
        if bytes.next() % 16 == 1 {
            mesh.triangles.clear();
            is_known = false;
        }
        Case { mesh: placed(bytes, mesh), options, kind: kind.filter(|_| is_known) }
    }

    /// Remeshes the case. Panics if the job does not end within `time`, or if the result is not what it claims to be.
    pub fn run(&self, time: Duration) {
        let positions: Vec<[f64; 3]> = self.mesh.positions.iter().map(|p| p.to_array()).collect();
        let input = Input::mesh(&positions, &self.mesh.triangles);
        let until = Until { end: Instant::now() + time, stages: Mutex::default() };
        let outcome = match remesh(&input, &self.options, &until) {
            Err(Error::Cancelled) => {
                let faces = self.mesh.triangles.len();
                panic!(
                    "{faces} triangles take more than {time:?}, after {:?}, {:?}",
                    until.stages, self.options.surface
                )
            }
            Err(error) => {
                let message = error.to_string();
                assert!(message.contains("; ") && !message.contains(['\n', '\r']), "{message:?}");
                return;
            }
            Ok(outcome) => outcome,
        };
        assert_eq!(outcome.origins.len(), outcome.mesh.positions.len());
        for origin in &outcome.origins {
            assert!(origin.vertices.iter().all(|&v| (v as usize) < self.mesh.positions.len()), "{origin:?}");
            assert!(origin.weights.iter().all(|w| (0.0..=1.0 + 1e-9).contains(w)), "{origin:?}");
        }
        if !outcome.verified() {
            assert!(outcome.shortcomings.iter().all(|phrase| !phrase.is_empty()));
            assert!(outcome.mesh.positions.iter().all(|p| p.is_finite()));
            return;
        }
        let found = kind(&outcome.mesh).unwrap_or_else(|fault| panic!("verified, but {fault}"));
        if let Density::Points(wanted) = self.options.surface.density
            && outcome.mesh.positions.len() != wanted
        {
            assert!(!outcome.notes.is_empty(), "{} vertices instead of {wanted}", outcome.mesh.positions.len());
        }
        if let Some(report) = &outcome.report {
            // If nothing was repaired, the result must have the topology of the input, however the input was made.
            if report.repairs == Some(Default::default())
                && let Ok(own) = kind(&self.mesh)
            {
                assert_eq!(found, own, "verified, and nothing was repaired");
            }
            let crossing = crossing(&outcome.mesh).filter(|_| report.crossings.faces.is_empty());
            assert!(crossing.is_none(), "{crossing:?} cross, and the report says that none do");
        }
        if let Some(wanted) = self.kind {
            assert_eq!(found, wanted, "verified");
            let stays = self.options.surface.smooth.is_none() && crossing(&self.mesh).is_none();
            let crossing = crossing(&outcome.mesh).filter(|_| stays);
            let corners = crossing.map(|faces| faces.map(|t| outcome.mesh.corners(t as usize)));
            assert!(corners.is_none(), "verified, but these cross: {corners:?}, {:?}", self.options.surface);
        }
    }
}

/// A monitor that cancels after some time, and records the stages until then.
struct Until {
    end: Instant,
    stages: Mutex<Vec<&'static str>>,
}

impl Monitor for Until {
    fn stage(&self, name: &'static str) {
        self.stages.lock().expect("no thread panics here").push(name);
    }

    fn cancelled(&self) -> bool {
        Instant::now() > self.end
    }
}

/// Returns a shape of about unit size, and whether it is known not to intersect or touch itself.
fn shape(bytes: &mut Bytes) -> (Mesh, bool) {
    let one = |bytes: &mut Bytes| match bytes.next() % 12 {
        0 => (sphere(bytes.among(0, 3), DVec3::ZERO, 0.5), true),
        1 => (torus(bytes.among(3, 24), bytes.among(3, 16), 0.5, 0.05 + 0.35 * bytes.share()), true),
        2 => (moved(frame(bytes.among(1, 5) as i32), |p| 0.2 * p), true),
        3 => (moved(cage(), |p| p / 3.0), true),
        4 => (cylinder(bytes.among(3, 24), 0.5, bytes.one_of(&[0.5, 0.0, 0.1]), 0.02 + bytes.share()), true),
        5 => (sheet(bytes.among(1, 16), bytes.among(1, 16)), true),
        6 => (sieve(12), true),
        7 => (annulus(bytes.among(3, 24), bytes.among(1, 6), 0.1 + 0.8 * bytes.share()), true),
        8 => (plate(bytes.among(1, 6) as i32, bytes.one_of(&[0.1, 0.01, 1e-3])), true),
        9 => (cells_of(bytes), false),
        10 => (moved(moebius(bytes.among(6, 24), bytes.among(1, 4)), |p| 0.25 * p), false),
        _ => (triangles(bytes), false),
    };
    let (mut mesh, mut is_known) = one(bytes);
    // Separate bodies, side by side or one inside the other.
    for i in 0..bytes.one_of(&[0, 0, 0, 0, 1, 2]) {
        let (other, other_is_known) = one(bytes);
        let apart = dvec3(0.0, 0.0, 3.0 * f64::from(i + 1));
        mesh = together(&[mesh, moved(other, |p| p + apart)]);
        is_known &= other_is_known;
    }
    (mesh, is_known)
}

/// Returns unit cells, some of which may meet only at an edge or a corner.
fn cells_of(bytes: &mut Bytes) -> Mesh {
    let bits = (0..4).fold(0, |bits, _| bits << 8 | bytes.next());
    let places: Vec<[i32; 3]> =
        (0..27).filter(|i| bits >> i & 1 == 1).map(|i| [i % 3, i / 3 % 3, i / 9]).chain([[0; 3]]).collect();
    moved(cells(&places), |p| p / 3.0)
}

/// Returns triangles between points of a coarse lattice, which may meet in any way.
fn triangles(bytes: &mut Bytes) -> Mesh {
    let side = bytes.among(2, 4);
    let count = bytes.among(1, 40);
    let places = (0..side.pow(3)).map(|i| dvec3((i % side).into(), (i / side % side).into(), (i / side / side).into()));
    let triangles = (0..count).map(|_| [0; 3].map(|_| bytes.next() % side.pow(3))).collect();
    Mesh { positions: places.map(|p| p / f64::from(side)).collect(), triangles }
}

/// Damages a mesh. Returns whether its topology stays the same.
fn damage(bytes: &mut Bytes, mesh: &mut Mesh) -> bool {
    let mut stays = true;
    for _ in 0..bytes.one_of(&[0, 0, 1, 1, 2, 4]) {
        let kind = bytes.next() % 11;
        let some = bytes.next() as usize % mesh.triangles.len();
        let [a, b, c] = mesh.triangles[some];
        match kind {
            0 => *mesh = soup(mesh),
            1 => *mesh = shuffled(mesh, &mut random(bytes.next().into())),
            // The same face twice.
            2 => mesh.triangles.push([b, c, a]),
            // Faces without area.
            3 => mesh.triangles.extend([[a, a, b], [c, c, c]]),
            // Flipped faces.
            4 => mesh.triangles.iter_mut().skip(some).step_by(3).for_each(|t| t.swap(1, 2)),
            // A vertex on an edge, which the adjacent face lacks; a sheet attached to an edge; a hole; noise; a copy nearby.
            5 => {
                let middle = (mesh.positions[a as usize] + mesh.positions[b as usize]) / 2.0;
                let m = mesh.positions.len() as u32;
                mesh.positions.push(middle);
                mesh.triangles[some] = [a, m, c];
                mesh.triangles.push([m, b, c]);
                stays = false;
            }
            6 => {
                let tip = mesh.positions.len() as u32;
                mesh.positions.push(1.5 * bytes.vector() - 0.25);
                mesh.triangles.push([a, b, tip]);
                stays = false;
            }
            7 => {
                mesh.triangles.swap_remove(some);
                stays = false;
                if mesh.triangles.is_empty() {
                    return false;
                }
            }
            8 => {
                let size = bytes.one_of(&[1e-14, 1e-9, 1e-4, 0.03, 0.3]);
                *mesh = noisy(std::mem::take(mesh), size, &mut random(bytes.next().into()));
                stays = false;
            }
            // A vertex that rounding moved off an edge, and the triangle of almost no height between them.
            9 => {
                let along = bytes.share().clamp(1e-9, 1.0 - 1e-9);
                let [from, to, apex] = [a, b, c].map(|v| mesh.positions[v as usize]);
                let m = mesh.positions.len() as u32;
                mesh.positions.push(from.lerp(to, along).lerp(apex, bytes.one_of(&[0.0, 1e-16, -1e-12, 1e-9, 1e-5])));
                mesh.triangles[some] = [a, m, c];
                mesh.triangles.extend([[m, b, c], [a, b, m]]);
            }
            _ => {
                let shift = bytes.one_of(&[0.0, 1e-9, 1e-3, 0.1, 1.0]) * DVec3::X;
                *mesh = together(&[mesh.clone(), moved(mesh.clone(), |p| p + shift)]);
                stays = false;
            }
        }
    }
    stays
}

/// Returns the mesh scaled, squeezed, rotated and moved, which costs a few bits of its coordinates.
fn placed(bytes: &mut Bytes, mesh: Mesh) -> Mesh {
    let squeeze = dvec3(1.0, 1.0, bytes.one_of(&[1.0, 1.0, 1.0, 0.1, 1e-2]));
    let (axis, angle) = (bytes.vector() + dvec3(0.1, 0.0, 0.0), bytes.one_of(&[0.0, 0.0, 1.0, 2.0]));
    let mesh = rotated(moved(mesh, |p| p * squeeze), axis, angle);
    let offset = bytes.one_of(&[0.0, 0.0, 0.0, 1.0, 100.0, 1e4]) * DVec3::ONE;
    let scale = bytes.one_of(&[1.0, 1.0, 1.0, 1e-3, 1e3, 1e-9, 1e9]);
    moved(mesh, |p| scale * (p + offset))
}

/// Returns options for a mesh with this number of vertices.
fn options(bytes: &mut Bytes, most_points: usize, vertices: usize) -> RemeshOptions {
    let share = bytes.share();
    let points = (4.0 * (most_points as f64 / 4.0).powf(share)) as usize;
    let features = [Features::Automatic, Features::Automatic, Features::Smooth, Features::Degrees(30.0)];
    let features = features[bytes.next() as usize % 4].clone();
    let lengths = |bytes: &mut Bytes| (0..vertices).map(|_| 0.01 + bytes.share()).collect::<Vec<_>>();
    let grading = match bytes.next() % 12 {
        0 | 1 => Grading::Curvature(bytes.share()),
        2 => Grading::Field(Values::Given(lengths(bytes))),
        3 => Grading::Kernel { sigma_n: 0.5 + bytes.share(), signals: Vec::new() },
        _ => Grading::Even,
    };
    let rare = |bytes: &mut Bytes, one_in: u32| bytes.next() % one_in == 1;
    let surface = Options {
        density: Density::Points(points),
        seed: bytes.next().into(),
        features,
        grading,
        smooth: rare(bytes, 12).then_some(3.0),
        max_error: rare(bytes, 8).then_some(MaxError::OfDiagonal(0.01)),
        optimize: !rare(bytes, 16),
        ..Options::default()
    };
    RemeshOptions { surface, cloud: CloudOptions::default(), carry: Carry::All, without_report: rare(bytes, 2) }
}
