//! The origins of a mesh's vertices and triangles. Each preparation step records what it made from what, and the composition
//! of these records maps any point of the last mesh to a point of the first one, the source.
//!
//! A triangle is a part of one triangle of the source. A vertex is a vertex of the source, or lies on one of its triangles:
//! then it is a [`Blend`] of at most three vertices. Vertices of the source at the same position count as one, represented
//! by the first.
//!
//! When triangles of almost no height are removed, a vertex may end up in a triangle of the source of which it is not a
//! corner. Its position on that triangle is recorded, too.
//!
//! Cost: four bytes per vertex and per triangle, forty for each inserted vertex.

use crate::mesh::sides::lower_first;
use crate::mesh::topology::NONE;
use std::collections::{BTreeMap, HashSet};

/// A point of the source: the weighted mean of at most three vertices of one triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    vertices: [u32; 3],
    /// Non-negative, with sum 1; zero for missing vertices.
    weights: [f64; 3],
}

impl Blend {
    fn of(vertex: u32) -> Blend {
        Blend { vertices: [vertex, NONE, NONE], weights: [1.0, 0.0, 0.0] }
    }

    /// The vertices of the source with a positive weight.
    fn corners(self) -> impl Iterator<Item = u32> {
        self.vertices.into_iter().zip(self.weights).filter(|(v, weight)| *v != NONE && *weight > 0.0).map(|(v, _)| v)
    }

    /// The weight of a vertex of the source.
    fn weight_of(&self, vertex: u32) -> f64 {
        let places = self.vertices.iter().zip(self.weights);
        places.filter(|(v, _)| **v == vertex).map(|(_, weight)| weight).sum()
    }

    /// The weighted mean of points on the same triangle of the source.
    fn mean<const N: usize>(points: [Blend; N], weights: [f64; N]) -> Blend {
        let mut mean = Blend { vertices: [NONE; 3], weights: [0.0; 3] };
        for (point, share) in points.into_iter().zip(weights) {
            for (vertex, weight) in point.vertices.into_iter().zip(point.weights).filter(|(v, _)| *v != NONE) {
                // Points on the same triangle have no fourth vertex.
                if let Some(slot) = mean.vertices.iter().position(|&v| v == vertex || v == NONE) {
                    mean.vertices[slot] = vertex;
                    mean.weights[slot] += share * weight;
                }
            }
        }
        mean
    }

    /// Evaluates at this point a piecewise linear function, given by its values at the vertices of the source.
    fn value(&self, values: &[f64]) -> f64 {
        let known = self.vertices.iter().zip(self.weights).filter(|(v, _)| **v != NONE);
        known.map(|(&v, weight)| weight * values[v as usize]).sum()
    }
}

/// A point on a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointOnTriangle {
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates in the triangle, non-negative, with sum 1.
    pub weights: [f64; 3],
}

/// The positions of a mesh's vertices and triangles on a source.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Origins {
    /// For each vertex, the closest point of the source among those that face the same way.
    pub vertices: Vec<PointOnTriangle>,
    /// Likewise for the centre of each triangle.
    pub triangles: Vec<PointOnTriangle>,
}

/// The origins of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Provenance {
    /// For each vertex of the source, the vertex that represents its position.
    representatives: Vec<u32>,
    /// For each vertex, its number in the source; inserted vertices are numbered after those of the source.
    vertices: Vec<u32>,
    inserted: Vec<Blend>,
    /// For each triangle, the triangle of the source that it is a part of.
    triangles: Vec<u32>,
    /// The positions of vertices on source triangles of which they are not corners, by triangle and vertex.
    placed: BTreeMap<[u32; 2], Blend>,
}

impl Provenance {
    /// The provenance of a mesh that consists of some vertices and triangles of the source. For each vertex of the source,
    /// `representatives` has the vertex that represents its position; for each vertex of the mesh, `vertices` has one of
    /// these.
    pub fn new(representatives: Vec<u32>, vertices: Vec<u32>, triangles: Vec<u32>) -> Provenance {
        Provenance { representatives, vertices, inserted: Vec::new(), triangles, placed: BTreeMap::new() }
    }

    /// The provenance of the source itself.
    pub fn identity(vertices: usize, triangles: usize) -> Provenance {
        let all = |n: usize| (0..n as u32).collect();
        Provenance::new(all(vertices), all(vertices), all(triangles))
    }

    /// Adds a vertex between two vertices of the mesh, at the fraction `along` of the way from the first to the second.
    pub fn insert_on_edge(&mut self, [a, b]: [u32; 2], along: f64) {
        self.vertices.push((self.representatives.len() + self.inserted.len()) as u32);
        self.inserted.push(Blend::mean([self.blend(a), self.blend(b)], [1.0 - along, along]));
    }

    /// Adds a triangle that is a part of triangle `t` of the mesh.
    pub fn insert_part(&mut self, t: u32) {
        self.triangles.push(self.triangles[t as usize]);
    }

    /// Makes triangle `t` a part of the source triangle that `other` is a part of.
    pub fn take_source(&mut self, t: u32, other: u32) {
        self.triangles[t as usize] = self.triangles[other as usize];
    }

    /// Records that vertex `v`, a source vertex, is at the position of vertex `at` on the source triangle of `t`.
    pub fn put_at(&mut self, t: u32, v: u32, at: u32) {
        self.put_on_edge(t, v, [at, at], 0.0);
    }

    /// Records that vertex `v`, a source vertex, lies between vertices `a` and `b` of triangle `t`, at the fraction `along`
    /// of the way from `a` to `b`.
    pub fn put_on_edge(&mut self, t: u32, v: u32, [a, b]: [u32; 2], along: f64) {
        let source = self.triangle(t);
        let place = Blend::mean([a, b].map(|v| self.blend_on(source, v)), [1.0 - along, along]);
        self.placed.insert([source, self.vertices[v as usize]], place);
    }

    /// Returns the provenance of a mesh that consists of these vertices and triangles of this one, in the given order.
    #[must_use]
    pub fn select(mut self, vertices: &[u32], triangles: &[u32]) -> Provenance {
        self.vertices = vertices.iter().map(|&v| self.vertices[v as usize]).collect();
        self.triangles = triangles.iter().map(|&t| self.triangles[t as usize]).collect();
        self
    }

    /// Returns the source vertex that vertex `v` is; `None` for an inserted vertex.
    pub fn vertex(&self, v: u32) -> Option<u32> {
        let source = self.vertices[v as usize];
        ((source as usize) < self.representatives.len()).then_some(source)
    }

    /// Returns the source triangle that triangle `t` is a part of.
    pub fn triangle(&self, t: u32) -> u32 {
        self.triangles[t as usize]
    }

    fn blend(&self, v: u32) -> Blend {
        let source = self.vertices[v as usize];
        match (source as usize).checked_sub(self.representatives.len()) {
            Some(number) => self.inserted[number],
            None => Blend::of(source),
        }
    }

    /// The position of vertex `v` on triangle `source` of the source.
    fn blend_on(&self, source: u32, v: u32) -> Blend {
        let blend = self.blend(v);
        if self.placed.is_empty() {
            return blend;
        }
        let place = |vertex: u32| self.placed.get(&[source, vertex]).copied().unwrap_or(Blend::of(vertex));
        Blend::mean(blend.vertices.map(place), blend.weights)
    }

    /// Returns the values of a piecewise linear function at the vertices of the mesh, given those at the vertices of the
    /// source.
    pub fn values(&self, of_source: &[f64]) -> Vec<f64> {
        (0..self.vertices.len() as u32).map(|v| self.blend(v).value(of_source)).collect()
    }

    /// Returns for each vertex of the mesh whether any source vertex at its position is marked; false for inserted vertices.
    pub fn marks(&self, of_source: &[bool]) -> Vec<bool> {
        let mut at_place = vec![false; of_source.len()];
        let marked = self.representatives.iter().zip(of_source).filter(|(_, marked)| **marked);
        marked.for_each(|(&place, _)| at_place[place as usize] = true);
        (0..self.vertices.len() as u32).map(|v| self.vertex(v).is_some_and(|s| at_place[s as usize])).collect()
    }

    /// Returns for each side of `triangles`, which are those of the mesh, whether it lies along one of these `edges` of the
    /// source.
    pub fn sides_along(&self, triangles: &[[u32; 3]], edges: &[[u32; 2]]) -> Vec<bool> {
        let place = |v: u32| self.representatives[v as usize];
        let edges: HashSet<[u32; 2]> = edges.iter().map(|ends| lower_first(ends.map(place))).collect();
        // Two points of a triangle lie on one of its edges if only two corners have a weight in them.
        let is_along = |source: u32, ends: [u32; 2]| {
            let mut corners: Vec<u32> = ends.iter().flat_map(|&v| self.blend_on(source, v).corners()).collect();
            corners.sort_unstable();
            corners.dedup();
            <[u32; 2]>::try_from(corners).is_ok_and(|corners| edges.contains(&corners))
        };
        let sides = triangles.iter().zip(&self.triangles);
        sides.flat_map(|(&[a, b, c], &t)| [[a, b], [b, c], [c, a]].map(|ends| is_along(t, ends))).collect()
    }

    /// Returns the point of the source at a point of triangle `t` of the mesh. `corners` are the vertices of `t`, `weights`
    /// the barycentric coordinates of the point, `source` the triangles of the source.
    pub fn origin(&self, t: u32, corners: [u32; 3], weights: [f64; 3], source: &[[u32; 3]]) -> PointOnTriangle {
        let triangle = self.triangle(t);
        let blend = Blend::mean(corners.map(|v| self.blend_on(triangle, v)), weights.map(|weight| weight.max(0.0)));
        let of_corner = |v: u32| blend.weight_of(self.representatives[v as usize]);
        let weights = source[triangle as usize].map(of_corner);
        let sum: f64 = weights.iter().sum();
        PointOnTriangle { triangle, weights: if sum > 0.0 { weights.map(|w| w / sum) } else { [1.0, 0.0, 0.0] } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_part_of_a_part_are_points_of_the_source() {
        // Vertex 3 of the source is at the position of vertex 1.
        let source = [[0, 1, 2], [2, 3, 4]];
        let mut provenance = Provenance::new(vec![0, 1, 2, 1, 4], vec![0, 1, 2, 4], vec![0, 1]);
        provenance.insert_on_edge([1, 2], 0.5);
        provenance.insert_part(1);
        provenance.insert_on_edge([4, 3], 0.5);
        // The midpoint between vertex 4 of the source and the midpoint of its other two vertices.
        let origin = provenance.origin(2, [5, 5, 5], [0.2, 0.3, 0.5], &source);
        assert_eq!(origin, PointOnTriangle { triangle: 1, weights: [0.25, 0.25, 0.5] });
        assert_eq!(provenance.values(&[0.0, 4.0, 8.0, 4.0, 1.0]), [0.0, 4.0, 8.0, 1.0, 6.0, 3.5]);
        assert_eq!(provenance.vertex(4), None);
        let corner = provenance.origin(0, [0, 1, 2], [0.0, 1.0, 0.0], &source);
        assert_eq!(corner, PointOnTriangle { triangle: 0, weights: [0.0, 1.0, 0.0] });
    }

    #[test]
    fn a_mark_is_that_of_a_place() {
        let provenance = Provenance::new(vec![0, 1, 1], vec![1, 0], vec![0]);
        assert_eq!(provenance.marks(&[false, false, true]), [true, false]);
    }

    #[test]
    fn sides_along_an_edge_are_those_of_its_parts() {
        // Vertex 3 of the source is at the position of vertex 1; the edge from 0 to 1 is split.
        let mut provenance = Provenance::new(vec![0, 1, 2, 1], vec![0, 1, 2], vec![0]);
        provenance.insert_on_edge([0, 1], 0.5);
        provenance.insert_part(0);
        let sides = provenance.sides_along(&[[0, 3, 2], [3, 1, 2]], &[[3, 0]]);
        assert_eq!(sides, [true, false, false, true, false, false]);
        assert_eq!(provenance.sides_along(&[[0, 3, 2]], &[[2, 1]]), [false; 3]);
    }

    #[test]
    fn what_is_selected_keeps_where_it_came_from() {
        let mut provenance = Provenance::identity(3, 2);
        provenance.insert_on_edge([0, 2], 0.5);
        let some = provenance.select(&[3, 1], &[1]);
        assert_eq!((some.values(&[1.0, 2.0, 5.0]), some.triangle(0)), (vec![3.0, 2.0], 1));
    }
}
