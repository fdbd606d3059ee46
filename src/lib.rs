//! Remeshing by spectral sampling: from a triangle mesh as it comes to one with the wanted number of vertices, evenly
//! spread, with triangles close to equilateral, of the same shape and the same topology.
//!
//! The points are those of *Spectral sampling of manifolds* (A. C. Öztireli, M. Alexa, M. Gross, 2010,
//! [DOI 10.1145/1882261.1866190](https://doi.org/10.1145/1882261.1866190)); how they become a mesh is told by the
//! modules. Everything is one call, [`remesh()`]:
//!
//! ```
//! use glam::{DVec3, dvec3};
//! use spectral_remesh::{Density, Mesh, Options, remesh};
//!
//! // A sphere: the faces of a tetrahedron, each split in four five times and pushed outwards. Every triangle has
//! // vertices of its own; they are welded on the way.
//! let [a, b, c, d] = [dvec3(1., 1., 1.), dvec3(-1., -1., 1.), dvec3(-1., 1., -1.), dvec3(1., -1., -1.)];
//! let mut faces = [[a, c, b], [a, d, c], [a, b, d], [d, b, c]].map(|f| f.map(DVec3::normalize)).to_vec();
//! for _ in 0..5 {
//!     let split = |[a, b, c]: [DVec3; 3]| {
//!         let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
//!         [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
//!     };
//!     faces = faces.into_iter().flat_map(split).collect();
//! }
//! let sphere = Mesh {
//!     triangles: (0..faces.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
//!     positions: faces.concat(),
//! };
//!
//! let options = Options { density: Density::Points(400), ..Options::default() };
//! let result = remesh(&sphere, &options, &())?;
//! assert!(result.verified());
//! assert_eq!(result.mesh.positions.len(), 400);
//! assert_eq!(result.output.euler, 2);
//! # Ok::<(), spectral_remesh::Error>(())
//! ```
//!
//! # The way of the data
//!
//! 1. [`io`] makes a [`Mesh`] of the bytes of a file: positions and triples of indices, nothing merged; beside it what
//!    its vertices, corners and triangles have, as [`mesh::attributes`].
//! 2. [`prepare::repair`] makes an oriented 2-manifold of it and counts what that took; [`surface::domain`] adds what it
//!    takes to walk over it and to find back to it.
//! 3. [`spectral`] covers it with candidates, and a randomized scan keeps those that add to the spectrum of the samples
//!    so far. Boundaries and sharp edges are sampled as curves.
//! 4. [`triangulate`] joins the samples by Delaunay stars along the surface to a manifold of the same topology.
//! 5. [`optimize`] arranges a coarse mesh first, with gradient ascent in [`spectral`], refines it to exactly the wanted
//!    number of vertices, mends triangles and crossings, and fits the vertices to the surface.
//! 6. [`transfer::vertex`] carries colours, texture coordinates and other attributes of the input over to the result.
//! 7. [`quality`] measures the result, [`report`] says how good it is, [`io`] writes it.
//!
//! [`sample()`] ends after the samples: points with normals, as gradient ascent without a mesh leaves them
//! ([`spectral::free_ascent`]), or a subset of the input's points ([`sample_points`] for a cloud). All of the sampler works in
//! any dimension, on whatever is a [`surface::submanifold::Submanifold`].
//!
//! Only [`pipeline`] knows that order. Each stage takes plain data and can be used by itself; here it is the sampler
//! alone:
//!
//! ```
//! use glam::{DVec3, dvec3};
//! use spectral_remesh::Mesh;
//! use spectral_remesh::base::rng::{Stage, stream};
//! use spectral_remesh::spectral::{candidates::candidates, curve_samples::sample_curves, scan::linear_scan};
//! use spectral_remesh::surface::domain::Domain;
//!
//! // A unit square, which is an oriented manifold already. (Others go through `prepare::repair::repair` first.)
//! let square = Mesh {
//!     positions: vec![DVec3::ZERO, DVec3::X, dvec3(1., 1., 0.), DVec3::Y],
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//! };
//! let domain = Domain::new(square);
//! let (spacing, seed) = (0.05, 1);
//! let rim = sample_curves(&domain, spacing).samples;
//! let candidates = candidates(&domain, 10_000, &mut stream(seed, Stage::Candidates));
//! let sigma = 0.866 * spacing;
//! let samples = linear_scan(&domain, &candidates, &rim, sigma, seed, &())?;
//!
//! assert_eq!(samples[..rim.len()], rim);
//! // At hexagonal packing that spacing means 462 points of a unit square; the rim takes a part of it.
//! assert!((350..550).contains(&samples.len()), "{}", samples.len());
//! // With the threshold of the scan, 1/2, no two that it keeps are nearer than √(ln 2 / 2) σp.
//! let nearest = |i: usize| samples[..i].iter().map(|s| s.position.distance(samples[i].position)).fold(1.0, f64::min);
//! assert!((rim.len()..samples.len()).all(|i| nearest(i) > 0.58 * sigma));
//! # Ok::<(), spectral_remesh::Error>(())
//! ```
//!
//! # Conventions
//!
//! - Computations are in f64. Lengths are in the units of the mesh where it is not said that they are in mean spacings
//!   or in percent of a diagonal; angles in degrees in what is reported.
//! - Corners of triangles go counter-clockwise seen from outside. Side `k` of triangle `t` runs from its corner `k` to
//!   the next one, and has the number `3 t + k`.
//! - What fails is an [`Error`], which names place, cause and remedy. What is merely not as wished (a missed count, a
//!   topology that differs) is a field of the result: ask [`Remeshed::verified`].
//! - The same input, options and seed give the same result with any number of threads. The threads are those of the
//!   `rayon` pool that the call is made in.
//!
//! # What the library never does
//!
//! It does not print, and it reads no clock: progress, times and cancelling are for the caller's [`Monitor`] to care
//! about (a [`Stopwatch`] is one that reads the clock for its owner). It opens no files, except in `io::file`, which is
//! there with the feature `fs` only. It holds no state between calls.
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `fs` | `io::file`: meshes by the name of their file, written beside the target and renamed |
//! | `laz` (default) | compressed LAS files can be read |
//! | `cli` (default) | `cli`: all of the command line tool; implies `fs` |
//!
//! Without default features readers and writers work on bytes only.

#![warn(missing_docs)]

pub mod base;
#[cfg(feature = "cli")]
pub mod cli;
pub mod contour;
pub mod geom;
pub mod io;
pub mod manifold;
pub mod mesh;
pub mod optimize;
pub mod pipeline;
pub mod prepare;
pub mod quality;
pub mod report;
pub mod spatial;
pub mod spectral;
pub mod surface;
pub mod transfer;
pub mod triangulate;

pub use base::error::{Error, Place, Result};
pub use base::monitor::{Monitor, Stopwatch};
pub use mesh::points::Points;
pub use mesh::triangle_mesh::Mesh;
pub use pipeline::{
    CloudOptions, Density, Deviation, MaxError, Options, ReconstructOptions, Reconstructed, Remeshed, SampleOptions,
    Sampled, Selection, Signal, mesh_of_points, points_of_mesh, reconstruct, remesh, sample, sample_points,
};
