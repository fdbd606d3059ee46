//! Edges of a mesh through points that cross a sharp edge of the surface.
//!
//! They form chains along the sharp edges. Short chains, and those that are nowhere clear, are noise or details.

use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::mesh::sides::lower_first;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::sharpen::planes::{BETTER, Tangent, meeting};
use glam::DVec3;

/// Maximum angle between the planes of both patches, in degrees: the edge of a blade cannot be told from a thin wall.
const MOST: f64 = 165.0;

/// How many times better one-sided planes fit than others along a clear chain.
const CLEAR: f64 = 3.5;

/// Edge of the mesh that crosses a sharp edge.
pub(super) struct Crossing {
    pub ends: [u32; 2],
    /// Share of the edge before the crossing.
    pub share: f64,
}

/// The edges in clear chains.
pub(super) struct Crossings {
    pub all: Vec<Crossing>,
    /// For each side of the mesh, its crossing; [`NONE`] if there is none.
    pub of_side: Vec<u32>,
    /// Share of all edges that seem to cross a sharp edge.
    pub share: f64,
}

impl Crossings {
    /// Finds the edges that cross sharp edges of at least `angle` degrees, in chains that are clear over the length `shortest`.
    pub fn find(mesh: &Mesh, tangents: &[Tangent], angle: f64, shortest: f64) -> Crossings {
        let twin = twins(&mesh.triangles);
        let mut crossings = Crossings { all: Vec::new(), of_side: vec![NONE; twin.len()], share: 0.0 };
        for side in (0..twin.len() as u32).filter(|&side| side < twin[side as usize]) {
            let Some(crossing) = crossing(mesh, tangents, side, angle) else { continue };
            let number = crossings.all.len() as u32;
            let sides = [side, twin[side as usize]].into_iter().filter(|&s| s != NONE);
            sides.for_each(|s| crossings.of_side[s as usize] = number);
            crossings.all.push(crossing);
        }
        crossings.keep_chains(mesh, tangents, shortest);
        crossings
    }

    /// Keeps the chains that are clear over the length `shortest`.
    fn keep_chains(&mut self, mesh: &Mesh, tangents: &[Tangent], shortest: f64) {
        let at = |c: u32| {
            let Crossing { ends: [a, b], share } = self.all[c as usize];
            mesh.positions[a as usize].lerp(mesh.positions[b as usize], share)
        };
        let is_clear = |c: u32| self.all[c as usize].ends.iter().all(|&v| tangents[v as usize].better > CLEAR);
        let mut chains = UnionFind::new(self.all.len());
        let mut links = Vec::new();
        for crossings in self.of_side.as_chunks::<3>().0 {
            let mut found = crossings.iter().copied().filter(|&c| c != NONE);
            let Some(first) = found.next() else { continue };
            for next in found {
                chains.join(first, next);
                links.push([first, next]);
            }
        }
        let mut lengths = vec![0.0; self.all.len()];
        for [a, b] in links.into_iter().filter(|link| link.iter().all(|&c| is_clear(c))) {
            lengths[chains.find(a) as usize] += at(a).distance(at(b));
        }
        let (before, mut kept) = (self.all.len(), Vec::new());
        let mut number = vec![NONE; before];
        for (c, crossing) in (0..).zip(self.all.drain(..)) {
            if lengths[chains.find(c) as usize] >= shortest {
                number[c as usize] = kept.len() as u32;
                kept.push(crossing);
            }
        }
        self.share = kept.len() as f64 / before.max(1) as f64;
        self.all = kept;
        self.of_side.iter_mut().filter(|c| **c != NONE).for_each(|c| *c = number[*c as usize]);
    }
}

/// Returns where an edge crosses a sharp edge of at least `angle` degrees, if it does.
fn crossing(mesh: &Mesh, tangents: &[Tangent], side: u32, angle: f64) -> Option<Crossing> {
    let ends = lower_first(mesh.ends(side));
    if ends.iter().any(|&v| tangents[v as usize].better < BETTER) {
        return None;
    }
    let [a, b] = ends.map(|v| tangents[v as usize].plane);
    // Both patches are below each other's plane at a ridge, and above at a valley.
    let is_edge =
        (angle..=MOST).contains(&angle_between(a.normal, b.normal)) && a.height(b.mean) * b.height(a.mean) > 0.0;
    if !is_edge {
        return None;
    }
    let [p, q] = ends.map(|v| mesh.positions[v as usize]);
    let on_edge = meeting([a, b].into_iter(), 0.5 * (p + q));
    let along = a.normal.cross(b.normal).normalize();
    let [from_p, from_q] = [p, q].map(|p| (p - on_edge).reject_from_normalized(along).length());
    // The planes meet near the edge.
    (from_p + from_q <= 2.0 * p.distance(q)).then(|| Crossing { ends, share: from_p / (from_p + from_q) })
}

/// Returns the angle between two vectors, in degrees.
pub(super) fn angle_between(a: DVec3, b: DVec3) -> f64 {
    math::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
}
