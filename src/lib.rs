//! Remeshing by spectral sampling: turns a triangle mesh or a point cloud, in whatever state it comes, into a mesh with the
//! target number of vertices. The vertices are evenly spread, the triangles close to equilateral, and shape and topology are
//! kept.
//!
//! The sampling method is that of *Spectral sampling of manifolds* (A. C. Öztireli, M. Alexa, M. Gross, 2010,
//! [DOI 10.1145/1882261.1866190](https://doi.org/10.1145/1882261.1866190)). A single call, [`remesh()`], does the whole job:
//!
//! ```
//! use spectral_remesh::{Input, Options, remesh};
//!
//! // A cube of six squares, two triangles each.
//! let positions: Vec<[f64; 3]> = (0..8).map(|v| [v & 1, v >> 1 & 1, v >> 2].map(f64::from)).collect();
//! let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
//! let triangles: Vec<[u32; 3]> = squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
//!
//! let outcome = remesh(&Input::mesh(&positions, &triangles), &Options::points(400).into(), &())?;
//! assert!(outcome.verified());
//! assert_eq!(outcome.positions().len(), 400);
//!
//! // The origin of each vertex: a triangle of the input and barycentric coordinates in it.
//! for (position, origin) in outcome.positions().iter().zip(&outcome.origins) {
//!     let at = |k: usize| (0..3).map(|i| origin.weights[i] * positions[origin.vertices[i] as usize][k]).sum::<f64>();
//!     assert!((0..3).all(|k| (at(k) - position[k]).abs() < 1e-9));
//! }
//! # Ok::<(), spectral_remesh::Error>(())
//! ```
//!
//! [`Input`] is a mesh or a set of points, with [`Attributes`]; [`RemeshOptions`] say what to make of it; [`Outcome`] holds
//! the mesh, its attributes, its origins and the [`report`]. [`remesh_levels()`] makes one mesh for each level of detail,
//! [`sample()`] points without triangles, [`reconstruct()`] dense triangles from a point cloud, and [`quality()`] the
//! quality figures of any mesh. [`io`] reads and writes files.
//!
//! [`stages`] contains the building blocks of these calls: each stage takes plain data and can be used by itself. This is
//! the sampler alone:
//!
//! ```
//! use glam::{DVec3, dvec3};
//! use spectral_remesh::Mesh;
//! use spectral_remesh::stages::mesh::oriented_manifold::OrientedManifold;
//! use spectral_remesh::stages::spectral::{candidates::candidates, curve_samples::sample_curves, scan::linear_scan};
//! use spectral_remesh::stages::surface::domain::Domain;
//!
//! // A unit square, which already is an oriented manifold. (Other meshes go through `prepare::repair::repair` first.)
//! let square = Mesh {
//!     positions: vec![DVec3::ZERO, DVec3::X, dvec3(1., 1., 0.), DVec3::Y],
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//! };
//! let domain = Domain::new(OrientedManifold::try_from(square)?);
//! let (spacing, seed) = (0.05, 1);
//! let rim = sample_curves(&domain, spacing).samples;
//! let candidates = candidates(&domain, 10_000, seed);
//! let sigma = 0.866 * spacing;
//! let samples = linear_scan(&domain, &candidates, &rim, sigma, seed, &())?;
//!
//! assert_eq!(samples[..rim.len()], rim);
//! // At hexagonal packing, a unit square has 462 points at this spacing; the rim takes up some of them.
//! assert!((350..550).contains(&samples.len()), "{}", samples.len());
//! // With the scan's threshold, 1/2, no two samples that it keeps are closer than √(ln 2 / 2) σp.
//! let nearest = |i: usize| samples[..i].iter().map(|s| s.position.distance(samples[i].position)).fold(1.0, f64::min);
//! assert!((rim.len()..samples.len()).all(|i| nearest(i) > 0.58 * sigma));
//! # Ok::<(), spectral_remesh::Error>(())
//! ```
//!
//! # Conventions
//!
//! - Computations are in f64. Lengths are in the units of the mesh, unless stated to be in mean spacings or in percent of a
//!   diagonal; reported angles are in degrees.
//! - Triangle corners are in counter-clockwise order seen from outside. Side `k` of triangle `t` runs from its corner `k` to
//!   the next one; its number is `3 t + k`.
//! - A failure is an [`Error`], which names place, cause and remedy. Whatever merely misses a wish (the vertex count is off,
//!   the topology differs) is a field of the result: see [`Outcome::verified`].
//! - The same input, options and seed give the same result with any number of threads. Threads come from the `rayon` pool in
//!   which the call is made.
//!
//! # What the library never does
//!
//! It does not print and does not read the clock: progress, timing and cancelling are up to the caller's [`Monitor`]
//! ([`Stopwatch`] is one that reads the clock for the caller). Only `io::file`, `large` and `stages::tiles` open files, and
//! these exist only with the feature `fs`. It keeps no state between calls.
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `fs` | `io::file`: reads and writes meshes by file name; outputs are written beside the target, then renamed; `large`: jobs on files larger than memory |
//! | `e57` (default) | reads E57 files |
//! | `laz` (default) | reads compressed LAS files |
//! | `cli` (default) | `cli`: the whole command line tool; implies `fs` |
//!
//! Without default features, readers and writers work on bytes only.

#![warn(missing_docs)]
// The last bits of shapes built by tests may differ between machines.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

#[doc(hidden)]
pub mod base;
#[cfg(feature = "cli")]
pub mod cli;
#[doc(hidden)]
pub mod contour;
#[doc(hidden)]
pub mod geom;
pub mod io;
#[doc(hidden)]
pub mod job;
#[doc(hidden)]
pub mod manifold;
#[doc(hidden)]
pub mod mesh;
#[doc(hidden)]
pub mod optimize;
#[doc(hidden)]
pub mod picture;
#[doc(hidden)]
pub mod pipeline;
#[doc(hidden)]
pub mod prepare;
#[doc(hidden)]
pub mod quality;
pub mod report;
#[doc(hidden)]
pub mod spatial;
#[doc(hidden)]
pub mod spectral;
#[doc(hidden)]
pub mod surface;
#[cfg(test)]
mod testing;
#[cfg(feature = "fs")]
#[doc(hidden)]
pub mod tiles;
#[doc(hidden)]
pub mod transfer;
#[doc(hidden)]
pub mod triangulate;

/// The stages, each of which can be used by itself. This module is exempt from semantic versioning: names and arguments
/// change whenever a stage is improved.
pub mod stages {
    #[cfg(feature = "fs")]
    #[doc(inline)]
    pub use crate::tiles;
    #[doc(inline)]
    pub use crate::{
        base, contour, geom, manifold, mesh, optimize, picture, pipeline, prepare, quality, spatial, spectral, surface,
        transfer, triangulate,
    };
}

/// The vector crate that positions and options use.
pub use glam;

pub use base::error::{Error, Fault, Place, Result, Setting};
pub use base::monitor::{Monitor, Stopwatch};
#[cfg(feature = "fs")]
pub use job::large;
pub use job::{
    Carry, Input, Origin, Outcome, RemeshOptions, quality, reconstruct, remesh, remesh_levels, sample, settings,
    with_threads, words,
};
pub use mesh::attributes::{Attribute, Attributes, Lost, Scalar};
pub use mesh::materials::{Alpha, Image, Look, Material, Materials, Sampler, Statement, Texture, Transform, Use};
pub use mesh::parts::{Part, Parts};
pub use mesh::points::Points;
pub use mesh::provenance::PointOnTriangle;
pub use mesh::triangle_mesh::Mesh;
pub use pipeline::{
    CloudOptions, Density, Edges, Grading, MaxError, NormalFit, NormalNeighborhood, Options, ReconstructOptions,
    Reconstructed, SMOOTHING_SUPPORT, SampleDensity, SampleLevel, SampleOptions, Sampled, Selection, Signal, Values,
};
pub use surface::features::Features;
