//! Splits long edges of a mesh without changing its shape.
//!
//! Stages that walk over triangles visit all samples of a triangle, which is only cheap if the triangle is not much larger
//! than the sample spacing. In CAD models, triangles may be as large as the part.
//!
//! Cost: linear in the result. Each pass halves the edges that are too long.

use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::sides::lower_first;
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// Halves the edges longer than `longest` until none are left, or until the mesh has `most` triangles.
///
/// The mesh remains a manifold of the same topology: both faces of an edge get the same new vertex.
pub fn refine(mesh: &mut OrientedManifold, longest: f64, most: usize) {
    let is_long = |_: u32, _: u32, length: f64| length > longest;
    while mesh.triangles.len() < most && !halve_edges(mesh, is_long).is_empty() {}
}

/// Halves those of `edges` that are longer than `longest`, as [`refine`] does. Edges are given by their ends, the lower
/// first; the halves replace them in `edges`.
pub fn refine_edges(mesh: &mut OrientedManifold, edges: &mut HashSet<[u32; 2]>, longest: f64, most: usize) {
    while mesh.triangles.len() < most {
        let first = mesh.positions.len() as u32;
        let ends = halve_edges(mesh, |a, b, length| length > longest && edges.contains(&lower_first([a, b])));
        if ends.is_empty() {
            break;
        }
        for (middle, [a, b]) in (first..).zip(ends) {
            edges.remove(&lower_first([a, b]));
            edges.extend([[a, middle], [b, middle]]);
        }
    }
}

/// Halves once every edge for whose ends and length `is_long` holds, independently of the order of the ends. Returns the
/// ends of the split edge for each new vertex; new vertices come after all others.
pub fn halve_edges(mesh: &mut OrientedManifold, is_long: impl Fn(u32, u32, f64) -> bool) -> Vec<[u32; 2]> {
    split_where(mesh, |a, b, length| is_long(a, b, length).then_some(0.5))
}

/// Splits each of `edges`, given by their ends with the lower first, at the given fraction of the way from the lower end.
/// Returns the ends of the split edge for each new vertex; new vertices come after all others.
pub fn split_edges(mesh: &mut OrientedManifold, edges: &HashMap<[u32; 2], f64>) -> Vec<[u32; 2]> {
    split_where(mesh, |a, b, _| {
        let along = edges.get(&lower_first([a, b]));
        along.map(|along| if a < b { *along } else { 1.0 - along })
    })
}

/// Splits once every edge for whose ends and length `place` returns a fraction of the way from the first end to the second.
fn split_where(mesh: &mut OrientedManifold, place: impl Fn(u32, u32, f64) -> Option<f64>) -> Vec<[u32; 2]> {
    // Only used for lookups, never iterated: the numbers of new vertices follow the order of the triangles.
    let mut inner: HashMap<[u32; 2], u32> = HashMap::new();
    let mut ends = Vec::new();
    for t in 0..mesh.triangles.len() {
        let corners = mesh.triangles[t];
        let on_sides = [0, 1, 2].map(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let length = mesh.positions[a as usize].distance(mesh.positions[b as usize]);
            place(a, b, length).map(|along| {
                *inner.entry(lower_first([a, b])).or_insert_with(|| {
                    ends.push([a, b]);
                    mesh.insert_on_edge([a, b], along)
                })
            })
        });
        if on_sides != [None; 3] {
            let parts = parts(mesh.triangles[t], on_sides, &mesh.positions);
            mesh.split_triangle(t, &parts);
        }
    }
    ends
}

/// Returns the parts of a triangle that is split at vertices on its sides: `on_sides[k]` is on the side from corner `k` to the
/// next one. If two of the sides are split, the shorter diagonal of the quadrilateral is chosen.
pub fn parts(corners: [u32; 3], on_sides: [Option<u32>; 3], positions: &[DVec3]) -> Vec<[u32; 3]> {
    if let [Some(p), Some(q), Some(r)] = on_sides {
        let [a, b, c] = corners;
        return vec![[p, q, r], [a, p, r], [p, b, q], [r, q, c]];
    }
    // Side 0 is split and, if two sides are, side 1 is the other one.
    let k = (0..3).find(|&k| on_sides[k].is_some() && on_sides[(k + 2) % 3].is_none()).unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let length = |v: u32, w: u32| positions[v as usize].distance_squared(positions[w as usize]);
    match (on_sides[k], on_sides[(k + 1) % 3]) {
        (Some(p), Some(q)) if length(p, c) <= length(a, q) => vec![[p, b, q], [p, q, c], [p, c, a]],
        (Some(p), Some(q)) => vec![[p, b, q], [a, p, q], [a, q, c]],
        (Some(p), None) => vec![[p, b, c], [a, p, c]],
        (None, _) => vec![corners],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::mesh::triangle_mesh::Mesh;
    use glam::dvec3;

    #[test]
    fn a_long_thin_prism_keeps_area_and_topology_and_knows_where_it_came_from() {
        let p = |x: f64, y: f64, z: f64| dvec3(x, y, z);
        let source = Mesh {
            positions: vec![p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 40.)],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        };
        let mut mesh = OrientedManifold::try_from(source.clone()).unwrap();
        refine(&mut mesh, 0.3, usize::MAX);
        assert!((mesh.area() / source.area() - 1.0).abs() < 1e-12);
        let t = topology(mesh.positions.len(), &mesh.triangles);
        assert!(t.is_manifold() && t.is_oriented() && t.euler == 2);
        let longest = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        assert!(
            longest.map(|(a, b)| mesh.positions[a as usize].distance(mesh.positions[b as usize])).all(|l| l <= 0.3)
        );
        let blend = |[a, b, c]: [DVec3; 3], [u, v, w]: [f64; 3]| a * u + b * v + c * w;
        for (t, &corners) in (0..).zip(&mesh.triangles) {
            let origin = mesh.provenance().origin(t, corners, [0.5, 0.3, 0.2], &source.triangles);
            let (here, there) = (mesh.corners(t as usize), source.corners(origin.triangle as usize));
            assert!(blend(here, [0.5, 0.3, 0.2]).distance(blend(there, origin.weights)) < 1e-12);
        }
    }

    #[test]
    fn a_fine_mesh_stays_as_it_is() {
        let positions = vec![dvec3(0., 0., 0.), dvec3(1., 0., 0.), dvec3(0., 1., 0.)];
        let mut mesh = OrientedManifold::try_from(Mesh { positions, triangles: vec![[0, 1, 2]] }).unwrap();
        let before = mesh.clone();
        refine(&mut mesh, 1.5, usize::MAX);
        assert_eq!(mesh, before);
    }

    #[test]
    fn a_triangle_is_split_at_the_points_on_its_sides() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X / 2.0, DVec3::new(0.5, 0.5, 0.0), DVec3::Y / 4.0];
        let area = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|v| positions[v as usize]);
            0.5 * (b - a).cross(c - a).z
        };
        for (at, count) in [
            ([None, None, None], 1),
            ([Some(3), None, None], 2),
            ([None, Some(4), None], 2),
            ([Some(3), Some(4), None], 3),
            ([Some(3), None, Some(5)], 3),
            ([None, Some(4), Some(5)], 3),
            ([Some(3), Some(4), Some(5)], 4),
        ] {
            let found = parts([0, 1, 2], at, &positions);
            assert_eq!(found.len(), count);
            assert!(found.iter().map(area).all(|area| area > 0.0), "{found:?}");
            assert!((found.iter().map(area).sum::<f64>() - 0.5).abs() < 1e-12, "{found:?}");
        }
    }
}
