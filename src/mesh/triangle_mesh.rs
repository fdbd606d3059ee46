//! A triangle mesh as plain data.

use crate::base::parallel;
use crate::geom::aabb::Aabb;
use crate::mesh::topology::component_count;
use glam::DVec3;

/// Number of triangles that one task processes.
const CHUNK: usize = 1 << 14;

/// An indexed triangle mesh. The corners of a triangle are in counter-clockwise order seen from outside.
///
/// Nothing is guaranteed about the topology: a mesh from a reader may be anything whose indices are in range and whose
/// coordinates are finite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, in the units of the file.
    pub positions: Vec<DVec3>,
    /// Corner indices into `positions`, three per triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Makes a mesh of triangles that share no vertices, even if corners are at the same position.
    pub fn soup(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Mesh {
        let positions: Vec<DVec3> = triangles.into_iter().flatten().collect();
        let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh { positions, triangles }
    }

    /// The corner positions of triangle `t`.
    #[inline]
    pub fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }

    /// The vertex at which `side` begins: side `3 t + k` runs from corner `k` of triangle `t` to the next one.
    #[inline]
    pub(crate) fn origin(&self, side: u32) -> u32 {
        self.triangles[side as usize / 3][side as usize % 3]
    }

    /// The vertices at which `side` begins and ends.
    #[inline]
    pub(crate) fn ends(&self, side: u32) -> [u32; 2] {
        let [t, k] = [side as usize / 3, side as usize % 3];
        [k, (k + 1) % 3].map(|k| self.triangles[t][k])
    }

    /// The positions of the ends of `side`.
    #[inline]
    pub(crate) fn segment(&self, side: u32) -> [DVec3; 2] {
        self.ends(side).map(|v| self.positions[v as usize])
    }

    /// The centroid of triangle `t`.
    pub fn centroid(&self, t: usize) -> DVec3 {
        self.corners(t).into_iter().sum::<DVec3>() / 3.0
    }

    /// The unit normal of triangle `t` times twice its area.
    #[inline]
    pub fn area_vector(&self, t: usize) -> DVec3 {
        let [a, b, c] = self.corners(t);
        (b - a).cross(c - a)
    }

    /// The area of triangle `t`.
    pub fn triangle_area(&self, t: usize) -> f64 {
        0.5 * self.area_vector(t).length()
    }

    /// Returns for each vertex the sum of the area vectors of its triangles: a normal that is not of unit length.
    pub fn vertex_area_vectors(&self) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for (t, corners) in self.triangles.iter().enumerate() {
            corners.iter().for_each(|&v| sums[v as usize] += self.area_vector(t));
        }
        sums
    }

    /// The total area of all triangles.
    pub fn area(&self) -> f64 {
        self.sum_over_triangles(|t| self.triangle_area(t))
    }

    /// Returns the area of each component; `component` holds the component of each vertex.
    pub fn component_areas(&self, component: &[u32]) -> Vec<f64> {
        let mut areas = vec![0.0; component_count(component)];
        for (t, corners) in self.triangles.iter().enumerate() {
            areas[component[corners[0] as usize] as usize] += self.triangle_area(t);
        }
        areas
    }

    /// Returns the sum of `of` over all triangles, which is the same with any number of threads.
    pub fn sum_over_triangles(&self, of: impl Fn(usize) -> f64 + Sync) -> f64 {
        let sums: Vec<f64> = parallel::blocks(0..self.triangles.len(), CHUNK, |chunk| chunk.map(&of).sum());
        sums.into_iter().sum()
    }

    /// The bounding box of the vertices that triangles use; `None` without triangles.
    pub fn bounds(&self) -> Option<Aabb> {
        let of_chunk = |chunk: &[[u32; 3]]| Aabb::of(chunk.iter().flatten().map(|&v| self.positions[v as usize]));
        let boxes = parallel::blocks(&self.triangles[..], CHUNK, of_chunk);
        boxes.into_iter().flatten().reduce(|one, other| one.join(&other))
    }

    /// The length of the bounding box's diagonal; zero without triangles.
    pub fn diagonal(&self) -> f64 {
        self.bounds().map_or(0.0, |bounds| bounds.diagonal())
    }

    /// Marks the vertices in so many rings around the `marked` ones, too.
    pub fn grow(&self, marked: &mut [bool], rings: usize) {
        for _ in 0..rings {
            let touches = |t: &&[u32; 3]| t.iter().any(|&v| marked[v as usize]);
            let around: Vec<[u32; 3]> = self.triangles.iter().filter(touches).copied().collect();
            around.as_flattened().iter().for_each(|&v| marked[v as usize] = true);
        }
    }

    /// Returns, for each vertex, whether a triangle uses it.
    pub fn used_vertices(&self) -> Vec<bool> {
        used_vertices(&self.triangles, self.positions.len())
    }

    /// Removes the vertices that no triangle uses; the others keep their order.
    pub fn drop_unused(&mut self) {
        let mut number = vec![u32::MAX; self.positions.len()];
        self.triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
        let mut kept = 0;
        for (v, n) in number.iter_mut().enumerate().filter(|(_, n)| **n == 0) {
            *n = kept;
            self.positions[kept as usize] = self.positions[v];
            kept += 1;
        }
        self.positions.truncate(kept as usize);
        self.triangles.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
    }
}

/// Returns, for each of `count` vertices, whether a triangle uses it.
pub fn used_vertices(triangles: &[[u32; 3]], count: usize) -> Vec<bool> {
    let mut used = vec![false; count];
    triangles.as_flattened().iter().for_each(|&v| used[v as usize] = true);
    used
}
