//! A part of a manifold as one by itself, to be changed and put back.

use crate::surface::manifold::Manifold;
use crate::surface::topology::NONE;
use std::collections::BTreeMap;

/// The triangles around a vertex, with a border that stays.
#[derive(Debug, Clone)]
pub struct Patch {
    /// The triangles by themselves. Vertices on the border are corners of the boundary.
    pub mesh: Manifold,
    /// The numbers in the whole of its first vertices and of its first triangles.
    vertices: Vec<u32>,
    pub triangles: Vec<u32>,
}

impl Patch {
    /// The triangles within `rings` rings around vertex `middle`. `None` if a curve or the boundary of the whole is
    /// among them: what is there has to stay.
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
                    return None;
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
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| c.triangle(3 * t).map(|v| number[&v])).collect();
        let samples = vertices.iter().map(|&v| whole.samples[v as usize]).collect();
        let mut mesh = Manifold::new(samples, &corners);
        mesh.hold_boundary();
        Some(Patch { mesh, vertices, triangles })
    }

    /// Puts the triangles back where they were taken from. As many vertices and triangles must be there as there were,
    /// and new vertices take the numbers of those that are gone. Whether it could be: not if an edge would be there
    /// twice.
    pub fn put_back(&self, whole: &mut Manifold) -> bool {
        let c = &self.mesh.connectivity;
        let first = self.vertices.len() as u32;
        let mut free = (0..first).filter(|&v| !c.has_vertex(v)).map(|v| self.vertices[v as usize]);
        let mut number = self.vertices.clone();
        number.extend((first..c.vertex_bound()).map(|_| free.next().expect("a vertex is gone for each new one")));
        let corners: Vec<[u32; 3]> = (0..c.half_edge_bound() / 3)
            .filter(|t| c.has_half_edge(3 * t))
            .map(|t| c.triangle(3 * t).map(|v| number[v as usize]))
            .collect();
        if !whole.connectivity.replace(&self.triangles, &corners) {
            return false;
        }
        for v in (0..c.vertex_bound()).filter(|&v| c.has_vertex(v)) {
            whole.samples[number[v as usize] as usize] = self.mesh.samples[v as usize];
        }
        true
    }
}
