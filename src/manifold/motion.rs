//! Moves the vertices of a manifold over its domain, all of them once, by steps that a rule gives. A step is tangential and
//! projected back onto the surface; vertices on a feature curve stay on it. A step that would turn a triangle against the
//! surface is halved until it does not.
//!
//! Vertices of one colour, no two of them adjacent, move at the same time, so the result does not depend on the number of
//! threads.

use crate::manifold::Manifold;
use crate::manifold::facing::FacingGuard;
use crate::manifold::vertex_set::VertexSet;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use rayon::prelude::*;

/// How often a step that would fold the mesh is halved before the vertex stays.
const HALVINGS: usize = 4;

/// Vertices that one task moves.
const CHUNK: usize = 64;

/// Moves all vertices that are not `locked` once. `way` gives the step of each.
pub fn move_vertices(
    domain: &Domain,
    mesh: &mut Manifold,
    locked: &VertexSet,
    way: impl Fn(&Manifold, u32) -> DVec3 + Sync + Send,
) {
    for class in mesh.colour_classes(locked) {
        let moved: Vec<Sample> =
            class.par_iter().with_min_len(CHUNK).map(|&v| step(domain, mesh, v, way(mesh, v))).collect();
        for (&v, sample) in class.iter().zip(moved) {
            mesh.samples[v as usize] = sample;
        }
    }
}

/// Where the step `way` takes vertex `v`.
fn step(domain: &Domain, mesh: &Manifold, v: u32, way: DVec3) -> Sample {
    let here = mesh.samples[v as usize];
    let on_curve = mesh.connectivity.is_on_curve(v);
    let mut way = if on_curve { way } else { way.reject_from_normalized(here.normal) };
    if !way.is_finite() || way == DVec3::ZERO {
        return here;
    }
    for _ in 0..HALVINGS {
        let there = mesh.place_after(domain, v, way, &here);
        if mesh.move_keeps_facing(v, &there, FacingGuard::SOUND) {
            return there;
        }
        way *= 0.5;
    }
    here
}
