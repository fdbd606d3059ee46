//! A part of a manifold as one by itself, to be changed and put back.

use crate::surface::manifold::Manifold;
use crate::surface::topology::NONE;
use std::collections::BTreeMap;

/// The triangles around a vertex, with a border that stays.
#[derive(Debug, Clone)]
pub struct Patch {
    /// The triangles by themselves. Vertices on the border are corners of the boundary.
    pub mesh: Manifold,
    /// The numbers of its vertices and triangles in the whole, those of the latter by their size.
    vertices: Vec<u32>,
    triangles: Vec<u32>,
}

impl Patch {
    /// The triangles within `rings` rings around vertex `middle`, and no farther than to the next curves. `None` if
    /// `middle` is on a curve, or one ends among them.
    pub fn around(whole: &Manifold, middle: u32, rings: usize) -> Option<Patch> {
        let c = &whole.connectivity;
        let mut vertices = vec![middle];
        let mut number = BTreeMap::from([(middle, 0u32)]);
        let mut triangles = Vec::new();
        let mut begin = 0;
        for _ in 0..rings {
            let end = vertices.len();
            for i in begin..end {
                if c.curve_at(vertices[i]) != NONE || c.is_boundary(vertices[i]) {
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
        let inside = |h: u32| h != NONE && triangles.binary_search(&(h / 3)).is_ok();
        let sides = || triangles.iter().flat_map(|&t| 3 * t..3 * t + 3);
        if triangles.is_empty() || sides().any(|h| c.curve(h) != NONE && inside(c.twin(h))) {
            return None;
        }
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| c.triangle(3 * t).map(|v| number[&v])).collect();
        let samples = vertices.iter().map(|&v| whole.samples[v as usize]).collect();
        let mut mesh = Manifold::new(samples, &corners);
        mesh.hold_boundary();
        Some(Patch { mesh, vertices, triangles })
    }

    /// Whether the triangle with that number in the whole was taken.
    pub fn has_triangle(&self, t: u32) -> bool {
        self.triangles.binary_search(&t).is_ok()
    }

    /// The vertices that are not on the border or on curves.
    pub fn free_vertices(&self) -> impl Iterator<Item = u32> {
        (0..self.mesh.connectivity.vertex_bound()).filter(|&v| !self.mesh.is_held(v))
    }

    /// Puts the triangles back where they were taken from, and marks them in `touched`. As many vertices and triangles
    /// must be there as there were. Whether it could be: not if one of them is marked already, or an edge would be there
    /// twice.
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
