//! Dense triangulation of the robust implicit surface of points, without a wanted number of vertices.

use crate::base::error::{Error, Result, Setting};
use crate::base::monitor::{Monitor, check};
use crate::contour::extract::extract;
use crate::contour::lattice::{BYTES_PER_VERTEX, Lattice};
use crate::mesh::points::Points;
use crate::mesh::topology::{Topology, topology};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::cloud::options::CloudOptions;
use crate::pipeline::cloud::summary::CloudSummary;
use crate::pipeline::cloud::{Prepared, mean, no_surface, prepared};
use crate::pipeline::density::check_length;
use crate::prepare::outside::face_outwards;
use crate::prepare::repair::repair;
use crate::surface::implicit::Rimls;

/// Options of reconstruction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReconstructOptions {
    /// Edge length of the cells, in the units of the input. Default: half the mean spacing of the points.
    pub resolution: Option<f64>,
    /// How to treat the points. Where nothing is smoothed, the support radius is
    /// [`INTERPOLATING_SUPPORT`](crate::pipeline::INTERPOLATING_SUPPORT); [`CloudOptions::fill_holes`] has no effect.
    pub cloud: CloudOptions,
}

/// Default edge length of a cell, in mean spacings of the points.
const DEFAULT_RESOLUTION: f64 = 0.5;

/// Maximum number of lattice vertices: those of 10 GB.
const MOST_VERTICES: usize = 20_000_000;

/// Number of lattice vertices per square of the edge length: measured.
const VERTICES_PER_SQUARE: f64 = 4.0;

/// Surface reconstructed from points.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconstructed {
    /// Oriented manifold, closed where the cloud is.
    pub mesh: Mesh,
    /// Topology of the mesh.
    pub topology: Topology,
    /// Summary of how the points were used.
    pub cloud: CloudSummary,
    /// Mean spacing of the points, in their units.
    pub spacing: f64,
    /// Edge length of the cells that was used, in the units of the input.
    pub resolution: f64,
    /// Support radius of the points, in their spacings.
    pub support: f64,
}

impl ReconstructOptions {
    /// Refuses options with which no surface can be made.
    ///
    /// # Errors
    /// [`Error::Option`] for a resolution that is not positive, and those of [`CloudOptions::validate`].
    pub fn validate(&self) -> Result<()> {
        self.resolution.map_or(Ok(()), |length| check_length(Setting::Resolution, length))?;
        self.cloud.validate()
    }
}

/// Returns the vertices of `mesh` that triangles use, with its normals there.
pub fn points_of_mesh(mesh: &Mesh) -> Points {
    let normals = mesh.vertex_area_vectors();
    let vertices = mesh.positions.iter().copied().zip(normals).zip(mesh.used_vertices());
    Points::from_pairs(vertices.filter(|(_, is_used)| *is_used).map(|(vertex, _)| vertex))
}

/// Reconstructs the robust implicit surface of `points` (Öztireli, Guennebaud, Gross 2009) as triangles about as large as
/// the cells from which it is extracted.
///
/// # Errors
/// [`Error::Mesh`] for points that no surface goes through: too few, all in one place or on a line; [`Error::Option`] for
/// options out of range, and for a resolution that would take an unreasonable amount of memory; [`Error::Cancelled`] if the
/// monitor asks for it.
pub fn reconstruct(points: &Points, options: &ReconstructOptions, monitor: &dyn Monitor) -> Result<Reconstructed> {
    options.validate()?;
    let prepared = prepared(points, &options.cloud, monitor)?;
    let support = prepared.support();
    let has_no_outside = prepared.has_no_outside();
    let area = prepared.area();
    let Prepared { points, near, mut spacings, summary, .. } = prepared;
    let count = points.positions().len();
    let spacing = mean(&spacings);
    let resolution = options.resolution.unwrap_or(DEFAULT_RESOLUTION * spacing);
    refuse_too_small(resolution, area)?;
    spacings.iter_mut().for_each(|s| *s = s.max(resolution));

    monitor.stage("extract");
    let surface = Rimls::new(points.positions(), points.normals(), &near, &spacings, support);
    let lattice = Lattice::around(points.positions(), surface.largest_support(), resolution);
    let lattice = lattice.ok_or_else(|| too_small(resolution, f64::INFINITY))?;
    let mesh = extract(&surface, &lattice, MOST_VERTICES, monitor)?;
    check(monitor)?;
    // Where two parts of the boundary meet at a vertex, each gets its own vertex.
    let mut mesh = repair(&mesh).0.into_mesh();
    if mesh.triangles.is_empty() {
        return Err(no_surface(count));
    }
    if has_no_outside {
        face_outwards(&mut mesh);
    }
    let topology = topology(mesh.positions.len(), &mesh.triangles);
    Ok(Reconstructed { mesh, topology, cloud: summary, spacing, resolution, support })
}

/// Refuses cells so small that too many are needed.
fn refuse_too_small(resolution: f64, area: f64) -> Result<()> {
    let vertices = VERTICES_PER_SQUARE * area / (resolution * resolution);
    if vertices > MOST_VERTICES as f64 { Err(too_small(resolution, vertices)) } else { Ok(()) }
}

fn too_small(resolution: f64, vertices: f64) -> Error {
    let cause = format!(
        "cells of {resolution} would have about {vertices:.1e} corners near the surface, which take {:.0} GB",
        vertices * BYTES_PER_VERTEX as f64 / 1e9
    );
    Error::Option { option: Setting::Resolution, cause, remedy: "give a larger length".into() }
}
