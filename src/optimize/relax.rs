//! Tangential relaxation: every vertex moves to where its neighbours, as springs, pull and push it.
//!
//! The way of a vertex with edges e is the mean of e - β d e / |e|. With β = 0 it ends at the average of the neighbours,
//! which evens out angles, but lets the vertices drain from every tip of the surface, as conformal maps do. With β = 1
//! the edges are springs of the rest length d, and the mesh keeps its density. So β is high where the surface bends
//! within an edge or the edges have left their length, and low elsewhere.
//!
//! Vertices on a curve, of the boundary or a sharp edge, move along it.
//!
//! Cost: a microsecond or two a vertex and round.

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::surface::domain::Domain;
use crate::surface::manifold::Manifold;
use crate::surface::motion::move_vertices;
use glam::DVec3;

/// How stiff the springs are: β.
#[derive(Debug, Clone, Copy)]
pub enum Stiffness {
    /// The same everywhere.
    Even(f64),
    /// Between 0 and 1 as the place needs it.
    AsNeeded,
}

/// Relaxes all vertices of `mesh` for `rounds` rounds, with Delaunay flips after each. `spacing` is the rest length.
pub fn relax(
    domain: &Domain,
    mesh: &mut Manifold,
    spacing: f64,
    stiffness: Stiffness,
    rounds: usize,
    monitor: &dyn Monitor,
) -> Result<()> {
    mesh.make_delaunay();
    for _ in 0..rounds {
        check(monitor)?;
        move_vertices(domain, mesh, || (), |mesh, v, ()| pull(mesh, v, spacing, stiffness));
        mesh.make_delaunay();
    }
    Ok(())
}

/// The way of vertex `v`.
fn pull(mesh: &Manifold, v: u32, spacing: f64, stiffness: Stiffness) -> DVec3 {
    let c = &mesh.connectivity;
    let here = mesh.position(v);
    let beta = match stiffness {
        Stiffness::Even(beta) => beta,
        Stiffness::AsNeeded => needed(mesh, v, spacing),
    };
    let (sum, count) = c.ring(v).fold((DVec3::ZERO, 0), |(sum, n), w| {
        let edge = mesh.position(w) - here;
        (sum + edge - beta * spacing * edge.normalize_or_zero(), n + 1)
    });
    let way = sum / f64::from(count);
    mesh.along(v).map_or(way, |along| way.project_onto_normalized(along))
}

/// β where it is not the same everywhere.
fn needed(mesh: &Manifold, v: u32, spacing: f64) -> f64 {
    let c = &mesh.connectivity;
    let here = &mesh.samples[v as usize];
    let (mut length, mut bend, mut n) = (0.0, 0.0f64, 0.0);
    for w in c.ring(v) {
        let there = &mesh.samples[w as usize];
        length += there.position.distance(here.position);
        if here.normal != DVec3::ZERO && there.normal != DVec3::ZERO {
            bend = bend.max(1.0 - there.normal.dot(here.normal));
        }
        n += 1.0;
    }
    let stretch = (length / n / spacing - 1.0).abs();
    ((stretch - STRETCH.0) / STRETCH.1).max((bend - BEND.0) / BEND.1).clamp(0.0, 1.0)
}

/// Where β begins to rise and over what range: the relative change of the mean edge length, and one minus the cosine of
/// the turn of the surface along an edge.
const STRETCH: (f64, f64) = (0.06, 0.15);
const BEND: (f64, f64) = (0.1, 0.3);
