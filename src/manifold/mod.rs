//! The mesh on its way to the result: a 2-manifold whose vertices are samples of a domain. Local operations change it, keep
//! its topology and never turn a triangle against the surface.

mod collapse;
mod colours;
mod curves;
mod delaunay;
pub mod faces;
pub mod facing;
pub mod motion;
pub mod neighborhood;
pub mod small_angles;
mod split;
pub mod vertex_set;

use crate::mesh::half_edge::Connectivity;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::order::spatial_order;
use crate::surface::domain::Sample;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

/// A 2-manifold over samples.
#[derive(Debug, Clone)]
pub struct Manifold {
    /// The connectivity of the vertices.
    pub connectivity: Connectivity,
    /// A sample for each vertex number, including those of removed vertices.
    samples: Vec<Sample>,
    /// Cache of the colours, from 0 to 63, of the last call of [`Self::colour_classes`], from which the next one starts.
    /// Vertices created since then have none yet.
    colours: Vec<u8>,
}

impl Manifold {
    /// Creates the manifold of `triangles`, which have to be an oriented 2-manifold that uses all of `samples`.
    pub fn new(samples: Vec<Sample>, triangles: &[[u32; 3]]) -> Self {
        Manifold { connectivity: Connectivity::new(samples.len(), triangles), samples, colours: Vec::new() }
    }

    /// Returns the sample of vertex `v`.
    #[inline]
    pub fn sample(&self, v: u32) -> &Sample {
        &self.samples[v as usize]
    }

    /// Returns the samples by vertex number, including those of removed vertices.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Moves vertex `v` without checking the triangles around it. The caller checks them, before or afterwards, or accepts any.
    /// The functions of [`motion`] check by themselves.
    pub fn place(&mut self, v: u32, sample: Sample) {
        self.samples[v as usize] = sample;
    }

    /// Moves vertex `v` to `position`, like [`Self::place`], with the normal, triangle and size that it has.
    pub fn place_at(&mut self, v: u32, position: DVec3) {
        self.samples[v as usize].position = position;
    }

    /// Changes all samples, like [`Self::place`]: `change` gets each vertex, including removed ones, and its sample.
    pub fn change_samples(&mut self, mut change: impl FnMut(u32, &mut Sample)) {
        self.samples.iter_mut().zip(0..).for_each(|(sample, v)| change(v, sample));
    }

    /// Returns the samples by vertex number, including those of removed vertices.
    pub fn into_samples(self) -> Vec<Sample> {
        self.samples
    }

    /// Moves all vertices, like [`Self::place`]; `samples` is what [`Self::samples`] returned before, changed.
    pub fn place_all(&mut self, samples: Vec<Sample>) {
        debug_assert_eq!(samples.len(), self.samples.len());
        self.samples = samples;
    }

    /// The position of vertex `v`.
    #[inline]
    pub fn position(&self, v: u32) -> DVec3 {
        self.samples[v as usize].position
    }

    /// The positions of the corners of triangle `t`, whose first half-edge is `3 t`.
    #[inline]
    pub fn corners(&self, t: u32) -> [DVec3; 3] {
        self.connectivity.triangle(3 * t).map(|v| self.position(v))
    }

    /// The numbers of all triangles, in increasing order.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        (0..self.connectivity.half_edge_bound() / 3).filter(|t| self.connectivity.has_half_edge(3 * t))
    }

    /// All half-edges, in increasing order.
    pub fn half_edges(&self) -> impl Iterator<Item = u32> {
        (0..self.connectivity.half_edge_bound()).filter(|&h| self.connectivity.has_half_edge(h))
    }

    /// One half-edge of each edge, in increasing order.
    pub fn edges(&self) -> impl Iterator<Item = u32> {
        self.half_edges().filter(|&h| !self.connectivity.has_twin(h) || h < self.connectivity.twin(h))
    }

    /// The squared length of the edge of `h`.
    #[inline]
    pub fn length_squared(&self, h: u32) -> f64 {
        self.position(self.connectivity.origin(h)).distance_squared(self.position(self.connectivity.target(h)))
    }

    /// Returns the squared length of the edge of `h` relative to the sizes at its ends, in squared mean spacings.
    #[inline]
    pub fn relative_length_squared(&self, h: u32) -> f64 {
        let c = &self.connectivity;
        let [a, b] = [c.origin(h), c.target(h)].map(|v| &self.samples[v as usize]);
        a.position.distance_squared(b.position) / (a.size * b.size)
    }

    /// Returns the mesh without gaps in the numbering.
    pub fn to_mesh(&self) -> Mesh {
        let (triangles, old) = self.connectivity.compact();
        Mesh { positions: old.iter().map(|&v| self.position(v)).collect(), triangles }
    }

    /// Returns the manifold without the numbering gaps that collapses leave, and the old number of each vertex. Loops over
    /// the whole result are faster.
    pub fn without_gaps(&self) -> (Manifold, Vec<u32>) {
        let (triangles, old) = self.connectivity.compact();
        (self.renumbered(&old, &triangles), old)
    }

    /// Returns the manifold without gaps and with neighbouring vertices and triangles close in memory, and the old number of
    /// each vertex. On large meshes, loops over the whole result are faster.
    pub fn in_spatial_order(&self) -> (Manifold, Vec<u32>) {
        let (_, old) = self.connectivity.compact();
        let positions: Vec<DVec3> = old.iter().map(|&v| self.position(v)).collect();
        let old: Vec<u32> = spatial_order(&positions).into_iter().map(|i| old[i as usize]).collect();
        let number = self.new_numbers(&old);
        let corners = |t: u32| self.connectivity.triangle(3 * t).map(|v| number[v as usize]);
        let mut triangles: Vec<[u32; 3]> = self.triangles().map(corners).collect();
        for t in &mut triangles {
            let first = (0..3).min_by_key(|&k| t[k]).expect("a triangle has corners");
            t.rotate_left(first);
        }
        triangles.par_sort_unstable();
        (self.renumbered(&old, &triangles), old)
    }

    /// Returns the manifold of `triangles`, which are its own with the vertices `old` renumbered as 0, 1, 2...
    fn renumbered(&self, old: &[u32], triangles: &[[u32; 3]]) -> Manifold {
        let mut mesh = Manifold::new(old.iter().map(|&v| self.samples[v as usize]).collect(), triangles);
        let unsplit = vec![NONE; self.connectivity.half_edge_bound() as usize];
        self.copy_curves(&mut mesh, &self.new_numbers(old), &unsplit);
        mesh
    }

    /// Returns, for each vertex, its new number if only those of `old` are kept, in that order.
    fn new_numbers(&self, old: &[u32]) -> Vec<u32> {
        let mut number = vec![NONE; self.samples.len()];
        old.iter().zip(0..).for_each(|(&v, n)| number[v as usize] = n);
        number
    }
}

#[cfg(test)]
impl Manifold {
    /// Moves vertex `v` to height `z`, wherever the surface is.
    pub fn raise(&mut self, v: usize, z: f64) {
        self.samples[v].position.z = z;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of two rows of `n` vertices; the more the second row is shifted, the longer the triangles are.
    pub(super) fn strip(n: u32, shift: f64) -> Manifold {
        let sample =
            |x: f64, y: f64| Sample { position: DVec3::new(x, y, 0.0), normal: DVec3::Z, triangle: 0, size: 1.0 };
        let lower = (0..n).map(|i| sample(f64::from(i), 0.0));
        let upper = (0..n).map(|i| sample(f64::from(i) + shift, 1.0));
        let triangles = (0..n - 1).flat_map(|i| [[i, i + 1, n + i + 1], [i, n + i + 1, n + i]]);
        Manifold::new(lower.chain(upper).collect(), &triangles.collect::<Vec<_>>())
    }
}
