//! The neighbourhood of a vertex as a manifold of its own, to be changed and put back.

use crate::manifold::Manifold;
use crate::manifold::vertex_set::VertexSet;
use std::collections::BTreeMap;

/// The triangles around a vertex, with a boundary that stays.
#[derive(Debug, Clone)]
pub struct Neighborhood {
    /// The triangles. Vertices on the boundary are corners; the middle is vertex 0.
    pub mesh: Manifold,
    /// The number of each vertex in the whole.
    vertices: Vec<u32>,
    /// The number of each triangle in the whole, in increasing order.
    triangles: Vec<u32>,
}

impl Neighborhood {
    /// The triangles within `rings` rings around vertex `middle`, up to the next feature curves. `None` if `middle` is on a
    /// curve, or a curve ends among the triangles.
    pub fn around(whole: &Manifold, middle: u32, rings: usize) -> Option<Neighborhood> {
        let c = &whole.connectivity;
        let mut vertices = vec![middle];
        let mut number = BTreeMap::from([(middle, 0u32)]);
        let mut triangles = Vec::new();
        let mut begin = 0;
        for _ in 0..rings {
            let end = vertices.len();
            for i in begin..end {
                if c.is_on_curve(vertices[i]) || c.is_boundary(vertices[i]) {
                    continue;
                }
                for h in c.outgoing(vertices[i]) {
                    triangles.push(h / 3);
                    number.entry(c.target(h)).or_insert_with(|| {
                        vertices.push(c.target(h));
                        vertices.len() as u32 - 1
                    });
                }
            }
            begin = end;
        }
        triangles.sort_unstable();
        triangles.dedup();
        let inside = |h: u32| triangles.binary_search(&(h / 3)).is_ok();
        let sides = || triangles.iter().flat_map(|&t| 3 * t..3 * t + 3);
        if triangles.is_empty() || sides().any(|h| c.is_curve_edge(h) && c.has_twin(h) && inside(c.twin(h))) {
            return None;
        }
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| c.triangle(3 * t).map(|v| number[&v])).collect();
        let samples = vertices.iter().map(|&v| whole.samples[v as usize]).collect();
        let mut mesh = Manifold::new(samples, &corners);
        mesh.lock_boundary();
        Some(Neighborhood { mesh, vertices, triangles })
    }

    /// Whether it has the triangle with number `t` in the whole.
    pub fn has_triangle(&self, t: u32) -> bool {
        self.triangles.binary_search(&t).is_ok()
    }

    /// The vertices that are not on the boundary.
    pub fn free_vertices(&self) -> impl Iterator<Item = u32> {
        (0..self.mesh.connectivity.vertex_bound()).filter(|&v| self.mesh.can_move(v, &VertexSet::EMPTY))
    }

    /// Replaces its triangles in the whole, and marks them in `touched`. The counts of vertices and triangles must not
    /// have changed. Returns `false`, and does nothing, if one of the triangles is marked already or an edge would
    /// occur twice.
    pub fn put_back(&self, whole: &mut Manifold, touched: &mut [bool]) -> bool {
        if self.triangles.iter().any(|&t| touched[t as usize]) {
            return false;
        }
        let c = &self.mesh.connectivity;
        let triangles: Vec<[u32; 3]> =
            (0..self.triangles.len() as u32).map(|t| c.triangle(3 * t).map(|v| self.vertices[v as usize])).collect();
        if !whole.connectivity.replace(&self.triangles, &triangles) {
            return false;
        }
        for (&v, sample) in self.vertices.iter().zip(&self.mesh.samples) {
            whole.samples[v as usize] = *sample;
        }
        self.triangles.iter().for_each(|&t| touched[t as usize] = true);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::half_edge::OnCurve;
    use crate::mesh::topology::topology;
    use crate::surface::domain::Sample;
    use glam::DVec3;

    const WIDTH: u32 = 8;

    /// A flat square of `WIDTH` by `WIDTH` squares, each two triangles.
    fn square() -> Manifold {
        let at = |i: u32, j: u32| i * (WIDTH + 1) + j;
        let all = |n: u32| (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)));
        let sample = |(i, j)| Sample {
            position: DVec3::new(f64::from(i), f64::from(j), 0.0),
            normal: DVec3::Z,
            triangle: 0,
            size: 1.0,
        };
        let halves = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        let triangles: Vec<[u32; 3]> = all(WIDTH).flat_map(halves).collect();
        Manifold::new(all(WIDTH + 1).map(sample).collect(), &triangles)
    }

    const MIDDLE: u32 = 4 * (WIDTH + 1) + 4;

    fn untouched(mesh: &Manifold) -> Vec<bool> {
        vec![false; mesh.connectivity.half_edge_bound() as usize / 3]
    }

    #[test]
    fn an_unchanged_neighborhood_put_back_changes_nothing() {
        let mut mesh = square();
        let before = mesh.to_mesh();
        let neighborhood = Neighborhood::around(&mesh, MIDDLE, 2).unwrap();
        assert_eq!((neighborhood.triangles.len(), neighborhood.free_vertices().count()), (24, 7));
        let mut touched = untouched(&mesh);
        assert!(neighborhood.put_back(&mut mesh, &mut touched));
        let canonical = |triangles: &[[u32; 3]]| {
            let first = |&t: &[u32; 3]| [t, [t[1], t[2], t[0]], [t[2], t[0], t[1]]].into_iter().min();
            let mut all: Vec<Option<[u32; 3]>> = triangles.iter().map(first).collect();
            all.sort_unstable();
            all
        };
        let after = mesh.to_mesh();
        assert_eq!(after.positions, before.positions);
        assert_eq!(canonical(&after.triangles), canonical(&before.triangles));
        assert!(!neighborhood.put_back(&mut mesh, &mut touched), "it has been put back already");
    }

    #[test]
    fn moves_and_flips_in_a_neighborhood_are_put_back() {
        let mut mesh = square();
        let mut neighborhood = Neighborhood::around(&mesh, MIDDLE, 2).unwrap();
        neighborhood.mesh.samples[0].position.z = 0.5;
        let c = &neighborhood.mesh.connectivity;
        let inner = neighborhood.mesh.edges().find(|&h| c.origin(h) == 0 && c.can_flip(h)).unwrap();
        neighborhood.mesh.connectivity.flip(inner);
        let mut touched = untouched(&mesh);
        assert!(neighborhood.put_back(&mut mesh, &mut touched));
        assert_eq!((mesh.position(MIDDLE).z, mesh.connectivity.ring(MIDDLE).count()), (0.5, 5));
        let result = mesh.to_mesh();
        let kind = topology(result.positions.len(), &result.triangles);
        assert!(kind.is_manifold() && kind.is_oriented());
        assert_eq!((kind.euler, kind.boundary_loops), (1, 1));
    }

    #[test]
    fn a_neighborhood_ends_at_curves_and_is_refused_on_one() {
        let mut mesh = square();
        let row = |i: u32| i * (WIDTH + 1) + 5;
        let edges: Vec<([u32; 2], OnCurve)> = (0..WIDTH).map(|i| ([row(i), row(i + 1)], OnCurve::Curve(0))).collect();
        assert!(mesh.mark_curves(&edges, []));
        let neighborhood = Neighborhood::around(&mesh, MIDDLE, 3).unwrap();
        let beyond = neighborhood.vertices.iter().filter(|&&v| v % (WIDTH + 1) > 5).count();
        assert_eq!(beyond, 0);
        assert!(Neighborhood::around(&mesh, row(4), 3).is_none());
    }
}
