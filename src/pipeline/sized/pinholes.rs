//! Closes pinholes: holes so small compared with the edges that triangles at them would have no computable angles. Repair
//! leaves them where it takes apart knots of tiny faces.
//!
//! Cost: linear in the triangles if there is a boundary.

use crate::mesh::half_edge::next;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::sides::lower_first;
use crate::mesh::topology::{NONE, components, twins};
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use rustc_hash::FxHashSet;

/// Length of the boundary loop below which a hole is a pinhole, in spacings: samples on it would be a twentieth apart.
const LONGEST: f64 = 0.15;

/// Pinholes that were closed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pinholes {
    /// Number of pinholes.
    pub count: usize,
    /// Point of the one with the longest boundary loop, in the units of the mesh.
    pub place: DVec3,
}

/// Closes the pinholes of `surface`, for edges of length `spacing`.
pub(in crate::pipeline) fn close_pinholes(surface: &mut OrientedManifold, spacing: f64) -> Pinholes {
    let mut loops = short_loops(surface, LONGEST * spacing);
    if loops.is_empty() {
        return Pinholes::default();
    }
    loops.sort_by(|a, b| b.length.total_cmp(&a.length));
    without_whole_components(surface, &mut loops);
    let edges = edges_between(surface, loops.iter().flat_map(|boundary| &boundary.sides));
    let mut closed = Pinholes::default();
    for boundary in loops {
        let Some(filling) = boundary.filling(surface, &edges) else { continue };
        if closed.count == 0 {
            closed.place = surface.positions[surface.origin(boundary.sides[0]) as usize];
        }
        closed.count += 1;
        filling.into_iter().for_each(|triangle| surface.add_beside(triangle, boundary.sides[0] / 3));
    }
    closed
}

/// Boundary loop around a hole: each side begins where the previous one ends.
struct BoundaryLoop {
    sides: Vec<u32>,
    length: f64,
}

impl BoundaryLoop {
    /// Returns triangles that close the hole, as a fan around the first vertex of the loop that none of these `edges`
    /// connects to another one except its neighbours; `None` if there is none.
    fn filling(&self, mesh: &Mesh, edges: &FxHashSet<[u32; 2]>) -> Option<Vec<[u32; 3]>> {
        let vertices: Vec<u32> = self.sides.iter().map(|&side| mesh.origin(side)).collect();
        let count = vertices.len();
        let from = |first: usize| vertices.iter().cycle().skip(first).take(count).copied().collect::<Vec<u32>>();
        let is_free = |fan: &Vec<u32>| fan[2..count - 1].iter().all(|&v| !edges.contains(&lower_first([fan[0], v])));
        let fan = (0..count).map(from).find(is_free)?;
        Some(fan[1..].windows(2).map(|ends| [fan[0], ends[1], ends[0]]).collect())
    }
}

/// Returns the boundary loops that are shorter than `most`.
fn short_loops(mesh: &Mesh, most: f64) -> Vec<BoundaryLoop> {
    let twin = twins(&mesh.triangles);
    let mut is_seen = vec![false; twin.len()];
    let mut loops = Vec::new();
    for first in (0..twin.len() as u32).filter(|&side| twin[side as usize] == NONE) {
        let mut boundary = BoundaryLoop { sides: Vec::new(), length: 0.0 };
        let mut side = first;
        while !is_seen[side as usize] {
            is_seen[side as usize] = true;
            let [from, to] = mesh.segment(side);
            boundary.length += from.distance(to);
            boundary.sides.push(side);
            side = next(side);
            while twin[side as usize] != NONE {
                side = next(twin[side as usize]);
            }
        }
        if boundary.sides.len() > 2 && boundary.length < most {
            loops.push(boundary);
        }
    }
    loops
}

/// Removes the loops around whole components: those whose component has less area than a square with a side as long as the
/// loop.
fn without_whole_components(mesh: &Mesh, loops: &mut Vec<BoundaryLoop>) {
    let component = components(mesh.positions.len(), &mesh.triangles);
    let areas = mesh.component_areas(&component);
    let area_of = |first: u32| areas[component[mesh.origin(first) as usize] as usize];
    loops.retain(|boundary| area_of(boundary.sides[0]) > boundary.length * boundary.length);
}

/// Returns the edges of `mesh` whose ends are both origins of `sides`.
fn edges_between<'a>(mesh: &Mesh, sides: impl Iterator<Item = &'a u32>) -> FxHashSet<[u32; 2]> {
    let mut is_on_loop = vec![false; mesh.positions.len()];
    sides.for_each(|&side| is_on_loop[mesh.origin(side) as usize] = true);
    let all = (0..3 * mesh.triangles.len() as u32).map(|side| mesh.ends(side));
    all.filter(|ends| ends.iter().all(|&v| is_on_loop[v as usize])).map(lower_first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::testing::{joined, sphere};
    use glam::dvec3;

    const SPACING: f64 = 0.1;

    /// Returns a sphere with a hole whose boundary has the given length and `sides` sides, at least three.
    fn with_hole(length: f64, sides: usize) -> Mesh {
        let mut mesh = sphere();
        let [a, b, c] = mesh.triangles.pop().unwrap();
        let corners = [a, b, c].map(|v| mesh.positions[v as usize]);
        let centre = corners.into_iter().sum::<DVec3>() / 3.0;
        let radius = length / (2.0 * sides as f64 * (std::f64::consts::PI / sides as f64).sin());
        let along = (corners[0] - centre).normalize();
        let aside = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize().cross(along);
        let first = mesh.positions.len() as u32;
        for k in 0..sides {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / sides as f64).sin_cos();
            mesh.positions.push(centre + radius * (cos * along + sin * aside));
        }
        // A strip between the corners and the hole.
        let (outer, mut at) = ([a, b, c], 0);
        for k in 0..sides as u32 {
            let [from, to] = [k, (k + 1) % sides as u32].map(|k| first + k);
            let next_at = 3 * (k as usize + 1) / sides;
            mesh.triangles.push([outer[at % 3], to, from]);
            for corner in at..next_at {
                mesh.triangles.push([outer[corner % 3], outer[(corner + 1) % 3], to]);
            }
            at = next_at;
        }
        mesh
    }

    fn closed(mesh: Mesh) -> (Pinholes, OrientedManifold) {
        let mut mesh = mesh.try_into().unwrap();
        (close_pinholes(&mut mesh, SPACING), mesh)
    }

    #[test]
    fn holes_that_edges_cannot_show_are_closed() {
        for sides in [3, 4, 7] {
            let (pinholes, mesh) = closed(with_hole(0.1 * SPACING, sides));
            assert_eq!(pinholes.count, 1);
            let found = topology(mesh.positions.len(), &mesh.triangles);
            assert!(found.is_manifold() && found.is_oriented());
            assert_eq!((found.euler, found.boundary_loops), (2, 0));
            let last = mesh.triangles.len() as u32 - 1;
            assert!(mesh.segment(3 * last).into_iter().all(|p| p.distance(pinholes.place) < 0.1 * SPACING));
            // The added triangles come from a triangle at the hole.
            let source = mesh.provenance().triangle(last) as usize;
            assert!(mesh.corners(source).into_iter().any(|p| p.distance(pinholes.place) < 0.1 * SPACING));
        }
    }

    #[test]
    fn holes_that_edges_can_show_and_whole_components_stay() {
        let (pinholes, mesh) = closed(with_hole(0.2 * SPACING, 5));
        assert_eq!((pinholes, mesh.triangles.len()), (Pinholes::default(), with_hole(1.0, 5).triangles.len()));
        let small = Mesh {
            positions: [DVec3::ZERO, dvec3(0.002, 0.0, 0.0), dvec3(0.0, 0.002, 0.0)].into(),
            triangles: vec![[0, 1, 2]],
        };
        let (pinholes, mesh) = closed(joined([small, sphere()]));
        assert_eq!((pinholes.count, mesh.triangles.len()), (0, sphere().triangles.len() + 1));
    }

    #[test]
    fn no_edge_is_made_twice() {
        // A triangle that protrudes into the hole has an edge between two corners of the remaining hole.
        let mesh = with_hole(0.1 * SPACING, 3);
        let last = mesh.positions.len() as u32;
        let [a, b, c] = [3, 2, 1].map(|k| mesh.positions[(last - k) as usize]);
        for [from, to] in [[3, 2], [2, 1], [1, 3]] {
            let mut mesh = mesh.clone();
            mesh.positions.push((a + b + c) / 3.0);
            mesh.triangles.push([last - from, last - to, last]);
            let (pinholes, mesh) = closed(mesh);
            assert_eq!(pinholes.count, 1);
            assert!(topology(mesh.positions.len(), &mesh.triangles).is_manifold());
        }
    }
}
