//! Base mesh: a few well-arranged vertices that cover a whole cloud. When its triangles are split evenly, the vertices are
//! well arranged everywhere, even where separately made pieces meet: most have six neighbours.
//!
//! Based on: M. Eck, T. DeRose, T. Duchamp, H. Hoppe, M. Lounsbery, W. Stuetzle, Multiresolution analysis of arbitrary
//! meshes, 1995, DOI 10.1145/218380.218440, who remesh this way. Departure: here the base mesh only gives the initial
//! vertices, not the triangles.

use crate::base::error::Result;
use crate::base::monitor::Monitor;
use crate::mesh::normals::vertex_normals;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::cloud::mesh_of_points;
use crate::pipeline::cloud::options::CloudOptions;
use crate::pipeline::density::{Density, FEWEST_POINTS};
use crate::pipeline::options::Options;
use crate::pipeline::pieces::outline::Outline;
use crate::pipeline::remesh::remesh;
use crate::surface::features::Features;
use glam::DVec3;

/// Approximate maximum number of vertices of a base mesh: an outline has five points for each.
pub const MOST_OF_BASE: usize = 20_000;

/// Returns the number of parts into which each edge of a base mesh is split to give about `wanted` vertices.
fn parts(wanted: usize) -> usize {
    (wanted as f64 / MOST_OF_BASE as f64).sqrt().ceil().max(1.0) as usize
}

/// Returns the base mesh for `wanted` vertices on the surface through an outline.
///
/// # Errors
/// Those of [`mesh_of_points`] and [`remesh`].
pub fn base_mesh(outline: &Outline, wanted: usize, seed: u64, monitor: &dyn Monitor) -> Result<Mesh> {
    let through = mesh_of_points(outline.points(), &CloudOptions::default(), monitor)?;
    // Each triangle is split into the square of this number of triangles.
    let density = Density::Points((wanted / parts(wanted).pow(2)).max(FEWEST_POINTS));
    let options = Options { density, seed, features: Features::Smooth, of_points: true, ..Options::default() };
    Ok(remesh(&through.mesh, &options, monitor)?.mesh)
}

/// Vertex of a split base mesh: its position on the flat triangles, and the unit normal there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position on the base mesh.
    pub position: DVec3,
    /// Unit normal at the position.
    pub normal: DVec3,
}

/// Returns the vertices of `base`, and those that split its edges and triangles for `wanted` vertices, of the triangles for
/// which `near` holds. The relative order of any two nodes is the same in every call.
pub fn nodes(base: &Mesh, wanted: usize, near: impl Fn([DVec3; 3]) -> bool) -> Vec<Node> {
    let normals = vertex_normals(base);
    let twin = twins(&base.triangles);
    let parts = parts(wanted) as u32;
    let mut is_taken = vec![false; base.positions.len()];
    let mut nodes = Vec::new();
    for t in (0..base.triangles.len()).filter(|&t| near(base.corners(t))) {
        let corners = base.triangles[t];
        let owns = |side: usize| {
            let h = (3 * t + side) as u32;
            twin[h as usize] == NONE || h < twin[h as usize]
        };
        for [i, j] in (0..=parts).flat_map(|i| (0..=parts - i).map(move |j| [i, j])) {
            let weights = [parts - i - j, i, j];
            let is_own = match weights.map(|w| w == 0) {
                // Corners are added below, for all selected triangles.
                [true, true, _] | [true, _, true] | [_, true, true] => continue,
                [_, _, true] => owns(0),
                [true, ..] => owns(1),
                [_, true, _] => owns(2),
                _ => true,
            };
            if is_own {
                let blend =
                    |of: &[DVec3]| (0..3).map(|k| f64::from(weights[k]) * of[corners[k] as usize]).sum::<DVec3>();
                let normal = blend(&normals).normalize_or_zero();
                nodes.push(Node { position: blend(&base.positions) / f64::from(parts), normal });
            }
        }
        corners.iter().for_each(|&v| is_taken[v as usize] = true);
    }
    let taken = (0..is_taken.len()).filter(|&v| is_taken[v]);
    nodes.extend(taken.map(|v| Node { position: base.positions[v], normal: normals[v] }));
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::points::Points;
    use crate::testing::{grid, sphere};

    #[test]
    fn triangles_are_split_evenly() {
        let base = sphere();
        let (v, t) = (base.positions.len(), base.triangles.len());
        for (wanted, parts) in [(20_000, 1), (20_001, 2), (300_000, 4)] {
            let all = nodes(&base, wanted, |_| true);
            // There are three edges for every two triangles.
            assert_eq!(all.len(), v + 3 * t / 2 * (parts - 1) + t * (parts - 1) * parts.saturating_sub(2) / 2);
            let mut places: Vec<[u64; 3]> = all.iter().map(|node| node.position.to_array().map(f64::to_bits)).collect();
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), all.len());
            assert!(all.iter().all(|node| node.normal.dot(node.position.normalize()) > 0.99));
        }
    }

    #[test]
    fn a_part_has_the_nodes_of_the_whole_in_their_order() {
        let base = grid(8, 8, |u, v| DVec3::new(u, v, 0.0));
        let all = nodes(&base, 60_000, |_| true);
        let part = nodes(&base, 60_000, |corners| corners.iter().any(|p| p.x < 0.4));
        let mut rest = all.iter();
        assert!(part.iter().all(|node| rest.any(|other| other == node)));
        // Every node of the whole that lies in the part is also in the part's list.
        let there = |nodes: &[Node]| nodes.iter().filter(|node| node.position.x < 0.4).count();
        assert!(part.len() < all.len() && there(&part) == there(&all));
    }

    #[test]
    fn a_base_mesh_is_of_the_surface_through_the_outline() {
        let Mesh { positions, .. } = grid(60, 60, |u, v| DVec3::new(u, v, 0.1 * (3.0 * u).sin()));
        let outline = Outline::new(Points::from_pairs(positions.into_iter().map(|p| (p, DVec3::Z))));
        let base = base_mesh(&outline, 30_000, 0, &()).unwrap();
        assert_eq!(base.positions.len(), 7500);
        assert!((base.area() - 1.04).abs() < 0.02, "{}", base.area());
    }
}
