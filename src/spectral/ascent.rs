//! Gradient ascent on the measure (paper, section 6.2): each sample moves to where it contributes more,
//! x ← x + ½ ∇s(x) in the units of the kernel, tangentially, and back on the surface.
//!
//! Departures from the paper: the samples are the vertices of a manifold already. Their two-rings are the
//! neighbourhoods, so nothing is searched, and a step that would turn a triangle against the surface is halved, so the
//! topology cannot be lost. Flips after each sweep keep the mesh Delaunay. Steps may be longer than the paper's.
//!
//! Cost: about a microsecond a vertex and sweep.
//!
//! Vertices on a curve, of the boundary or a sharp edge, move along it; corners stay where they are.

use crate::base::error::Result;
use crate::base::progress::{Monitor, check};
use crate::spectral::measure::{GRADIENT_NEIGHBOURS, gradient};
use crate::surface::connectivity::next;
use crate::surface::domain::Domain;
use crate::surface::manifold::Manifold;
use crate::surface::motion::move_vertices;
use glam::DVec3;

/// How an ascent goes.
#[derive(Debug, Clone, Copy)]
pub struct Climb {
    /// Width of the kernel where the wanted size is 1, in the units of the domain.
    pub sigma: f64,
    /// Share of the gradient that a vertex goes at once: [`PAPER_STEP`] or [`LONG_STEP`].
    pub step: f64,
    /// Rounds over all vertices.
    pub sweeps: usize,
}

/// The paper's step.
pub const PAPER_STEP: f64 = 0.5;

/// A step that orders as much in two sweeps as the paper's in three. With 1 the vertices oscillate.
pub const LONG_STEP: f64 = 0.75;

/// The longest way of a vertex in one sweep, in kernel widths.
const MOST_STEP: f64 = 0.5;

/// Kernel width of the ascent in mean spacings: narrower ones leave clusters, wider ones blur the gradient.
pub const SIGMA_OF_SPACING: f64 = 0.94;

/// Moves all vertices of `mesh` that are not fixed.
pub fn ascend(domain: &Domain, mesh: &mut Manifold, climb: Climb, monitor: &dyn Monitor) -> Result<()> {
    mesh.make_delaunay();
    for sweep in 0..climb.sweeps {
        check(monitor)?;
        move_vertices(domain, mesh, |mesh, v| way_up(mesh, v, climb));
        mesh.make_delaunay();
        monitor.progress((sweep + 1) as f64 / climb.sweeps as f64);
    }
    Ok(())
}

/// Where vertex `v` wants to go: up the gradient.
fn way_up(mesh: &Manifold, v: u32, Climb { sigma, step, .. }: Climb) -> DVec3 {
    let mut offsets = [DVec3::ZERO; GRADIENT_NEIGHBOURS];
    let found = nearest(mesh, v);
    for (offset, &(_, w)) in offsets.iter_mut().zip(found.list()) {
        *offset = (mesh.position(w) - mesh.position(v)) / (sigma * mean_size(mesh, v, w));
    }
    let sigma = sigma * mesh.samples[v as usize].size;
    let way = (step * sigma * gradient(&offsets[..found.count])).clamp_length_max(MOST_STEP * sigma);
    mesh.along(v).map_or(way, |along| way.project_onto_normalized(along))
}

/// The size that is wanted between two vertices. Were it that of one of them, all would move to where sizes are larger.
#[inline]
fn mean_size(mesh: &Manifold, v: u32, w: u32) -> f64 {
    0.5 * (mesh.samples[v as usize].size + mesh.samples[w as usize].size)
}

/// The nearest vertices, for the size wanted there, of the two-ring of `v`; of the second ring only those that face the
/// same way.
fn nearest(mesh: &Manifold, v: u32) -> Nearest {
    let (c, here) = (&mesh.connectivity, &mesh.samples[v as usize]);
    let mut found = Nearest::default();
    let mut add = |w: u32| {
        let size = mean_size(mesh, v, w);
        found.add(here.position.distance_squared(mesh.position(w)) / (size * size), w)
    };
    c.ring(v).for_each(&mut add);
    let mut add_facing = |w: u32| {
        if mesh.samples[w as usize].normal.dot(here.normal) >= 0.0 {
            add(w);
        }
    };
    if c.is_boundary(v) {
        c.ring(v).for_each(|w| c.ring(w).filter(|&w| w != v).for_each(&mut add_facing));
        return found;
    }
    for out in c.outgoing(v) {
        let w = c.target(out);
        if c.is_boundary(w) {
            c.ring(w).filter(|&w| w != v).for_each(&mut add_facing);
            continue;
        }
        // Around `w`, from beyond the triangle on the left of `out` to that on its right.
        let last = c.apex(c.twin(out));
        let mut across = c.twin(next(out));
        while c.apex(across) != last {
            add_facing(c.apex(across));
            across = c.twin(next(across));
        }
    }
    found
}

/// Vertices in the order of their relative distance, then their number.
#[derive(Default)]
struct Nearest {
    list: [(f64, u32); GRADIENT_NEIGHBOURS],
    count: usize,
}

impl Nearest {
    /// Takes note of `v` at that squared relative distance if it is near enough and not known.
    #[inline]
    fn add(&mut self, distance: f64, v: u32) {
        if self.count == GRADIENT_NEIGHBOURS && distance > self.list[GRADIENT_NEIGHBOURS - 1].0 {
            return;
        }
        let mut place = self.count;
        while place > 0 && (distance, v) < self.list[place - 1] {
            place -= 1;
        }
        let is_known = place > 0 && self.list[place - 1].1 == v;
        if place < GRADIENT_NEIGHBOURS && !is_known {
            self.count = (self.count + 1).min(GRADIENT_NEIGHBOURS);
            self.list.copy_within(place..self.count - 1, place + 1);
            self.list[place] = (distance, v);
        }
    }

    fn list(&self) -> &[(f64, u32)] {
        &self.list[..self.count]
    }
}
