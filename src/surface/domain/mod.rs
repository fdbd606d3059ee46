//! The domain of sampling: an oriented 2-manifold mesh, with the data needed to place points on it, walk over it and project
//! onto it.
//!
//! It is cut along its sharp edges, so that walks, normals and projections stay within a smooth patch.

mod projection;
mod self_intersections;

use crate::geom::triangle::{barycentric, closest_point};
use crate::mesh::cut::{Cut, OfSides, cut};
use crate::mesh::half_edge::next;
use crate::mesh::normals::vertex_normals;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::{PointOnTriangle, Provenance};
use crate::mesh::topology::{NONE, component_count, components, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::bvh::Bvh;
use crate::spatial::groups::Groups;
use crate::spatial::passing_faces::PassingFaces;
use crate::surface::dihedral_angles::{folded_over, trusted_normal};
use crate::surface::feature_curves::Curves;
use crate::surface::features::{Features, sharp_sides};
use crate::surface::planes::Planes;
use crate::surface::spikes::spikes;
use glam::DVec3;
use std::sync::OnceLock;

/// A point on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Its position.
    pub position: DVec3,
    /// Smoothly interpolated unit normal of the surface there; zero on a sharp edge, which has none.
    pub normal: DVec3,
    /// The triangle of the domain that contains the point.
    pub triangle: u32,
    /// Target edge length there, relative to the mean spacing.
    pub size: f64,
}

/// An oriented 2-manifold mesh and its derived data.
pub struct Domain {
    /// The mesh, cut along sharp edges.
    pub mesh: Mesh,
    /// The opposite side of each side; [`NONE`] at the boundary and at sharp edges.
    pub twin: Vec<u32>,
    /// The opposite side of each side of a sharp edge; [`NONE`] elsewhere.
    pub across: OfSides,
    /// For each vertex, its index before the cut along sharp edges.
    pub original: Vec<u32>,
    /// Provenance of the mesh before the cut.
    provenance: Provenance,
    /// The smooth patch of each vertex: its connected component.
    pub patch: Vec<u32>,
    /// The triangles of each patch.
    patches: Groups,
    /// The boundary and the sharp edges.
    pub curves: Curves,
    /// Unit normal at each vertex; zero where all its triangles are flat.
    pub(super) vertex_normals: Vec<DVec3>,
    /// Target edge length at each vertex, relative to the mean spacing; empty if it is 1 everywhere.
    sizes: Vec<f64>,
    /// See [`Curves::new`].
    interface: Vec<[u32; 2]>,
    /// Spacing of the samples, in the units of the mesh; infinite if it was not given.
    spacing: f64,
    pub(super) bvh: Bvh,
    /// Whether each triangle lies in a plane that touches another; empty before these were searched.
    in_contact: Vec<bool>,
    /// A side that leaves the end of each spike; empty before these were searched.
    spikes: Vec<u32>,
    /// See [`Self::widths`].
    widths: OnceLock<Vec<f64>>,
    /// Triangles that pass through others.
    passing: PassingFaces,
}

impl Domain {
    /// Creates the domain over `mesh` without sharp edges.
    pub fn new(mesh: OrientedManifold) -> Domain {
        Domain::with_features(mesh, Features::Smooth, f64::INFINITY)
    }

    /// Creates the domain over `mesh` with sharp edges according to `features`. `spacing` is that of the samples, in the
    /// units of the mesh.
    pub fn with_features(mesh: OrientedManifold, features: Features, spacing: f64) -> Domain {
        Domain::with_interface(mesh, features, spacing, Vec::new())
    }

    /// [`Self::with_features`] over a part of a larger mesh. `interface` has the ends of the edges along which it was cut
    /// out, sorted, each directed with the part on its left.
    pub fn with_interface(
        mesh: OrientedManifold,
        features: Features,
        spacing: f64,
        interface: Vec<[u32; 2]>,
    ) -> Domain {
        let twin = twins(&mesh.triangles);
        let sharp = sharp_sides(&mesh, &twin, &features, spacing, 0.0, |_| false);
        Domain::with_sharp(mesh, twin, &sharp, spacing, interface)
    }

    /// [`Self::with_interface`] with given sharp edges: for each side of `mesh`, whether it is on one, and its opposite side
    /// as in the result of [`twins`].
    pub fn with_sharp(
        mesh: OrientedManifold,
        twin: Vec<u32>,
        sharp: &[bool],
        spacing: f64,
        interface: Vec<[u32; 2]>,
    ) -> Domain {
        let (mesh, provenance) = mesh.into_parts();
        let cut = cut(mesh, twin, sharp);
        let (curves, (vertex_normals, bvh)) = rayon::join(
            || Curves::new(&cut, spacing, &interface),
            || rayon::join(|| normals_of(&cut.mesh, &cut.twin, spacing), || Bvh::new(&cut.mesh)),
        );
        let Cut { mesh, twin, across, original } = cut;
        let patch = components(mesh.positions.len(), &mesh.triangles);
        let patches = Groups::new((&mesh, &bvh), component_count(&patch), |t| patch[mesh.origin(3 * t) as usize]);
        let (sizes, passing) = (Vec::new(), PassingFaces::new(&mesh, &bvh));
        Domain {
            mesh,
            twin,
            across,
            original,
            provenance,
            patch,
            patches,
            curves,
            vertex_normals,
            sizes,
            interface,
            spacing,
            bvh,
            in_contact: Vec::new(),
            spikes: Vec::new(),
            widths: OnceLock::new(),
            passing,
        }
    }

    /// Returns the values at its vertices of a function that is linear on each triangle of the source mesh, given at the
    /// vertices there.
    pub fn values(&self, of_source: &[f64]) -> Vec<f64> {
        let uncut = self.provenance.values(of_source);
        self.original.iter().map(|&v| uncut[v as usize]).collect()
    }

    /// Returns the triangle of the source mesh that triangle `t` is a part of.
    #[inline]
    pub fn source_triangle(&self, t: u32) -> u32 {
        self.provenance.triangle(t)
    }

    /// Returns the point of the source mesh closest to `off`, which lies at most `reach` off the surface. `source` has the
    /// triangles of that mesh.
    pub fn origin(&self, off: &Sample, reach: f64, source: &[[u32; 3]]) -> PointOnTriangle {
        let sample = self.project_by_walk(off, reach);
        let t = sample.triangle;
        let weights = barycentric(sample.position, self.mesh.corners(t as usize));
        let corners = self.mesh.triangles[t as usize].map(|v| self.original[v as usize]);
        self.provenance.origin(t, corners, weights, source)
    }

    /// Sets the target edge lengths at the vertices, relative to the mean spacing, instead of 1 everywhere. Copies of a
    /// vertex from the cut along sharp edges must have the same length.
    pub fn grade(&mut self, sizes: Vec<f64>) {
        self.sizes = sizes;
    }

    /// Target edge length at each vertex, relative to the mean spacing.
    pub fn sizes(&self) -> Vec<f64> {
        if self.sizes.is_empty() { vec![1.0; self.mesh.positions.len()] } else { self.sizes.clone() }
    }

    /// Smallest and largest target edge length, relative to the mean spacing.
    pub fn size_range(&self) -> [f64; 2] {
        let mut sizes = self.sizes.iter().copied();
        let first = sizes.next().unwrap_or(1.0);
        sizes.fold([first; 2], |[lo, hi], size| [lo.min(size), hi.max(size)])
    }

    /// Smooths over the sharp edges on curves whose index `is_left_out`.
    pub fn without_curves(self, is_left_out: impl Fn(u32) -> bool) -> Domain {
        let Domain { mut mesh, mut twin, original, provenance, interface, spacing, spikes, .. } = self;
        mesh.triangles.iter_mut().flatten().for_each(|v| *v = original[*v as usize]);
        // The first copy of a vertex keeps its index; further copies come after all others.
        let count = original.iter().zip(0..).take_while(|&(&v, i)| v == i).count();
        mesh.positions.truncate(count);
        let mut sharp = vec![false; twin.len()];
        for side in (0..twin.len() as u32).filter(|&side| self.across.get(side) != NONE) {
            twin[side as usize] = self.across.get(side);
            sharp[side as usize] = !is_left_out(self.curves.of_side(side));
        }
        let mesh = OrientedManifold::trusted(mesh, provenance);
        let made = Domain::with_sharp(mesh, twin, &sharp, spacing, interface);
        let of_copy = |&v: &u32| self.sizes[v as usize];
        let sizes = if self.sizes.is_empty() { Vec::new() } else { made.original.iter().map(of_copy).collect() };
        Domain { sizes, spikes, ..made }
    }

    /// Returns the indices of the curves along sharp edges.
    pub fn sharp_curves(&self) -> impl Iterator<Item = u32> {
        let curves = self.curves.list.iter().zip(0u32..);
        curves.filter(|(curve, _)| self.across.get(curve.sides[0]) != NONE).map(|(_, number)| number)
    }

    /// Returns whether it has sharp edges.
    pub fn is_sharp(&self) -> bool {
        self.sharp_curves().next().is_some()
    }

    /// Finds the planes that touch each other.
    pub fn find_contacts(&mut self) {
        let planes = Planes::new(&self.mesh, &self.twin, self.spacing, |t| self.source_triangle(t));
        self.in_contact = planes.in_contact(&self.mesh, &self.bvh);
    }

    /// Finds the spikes.
    pub fn find_spikes(&mut self) {
        self.spikes = spikes(&self.mesh, &self.twin, |v| self.spacing * self.size_at(v));
    }

    /// Returns a sample at the end of each spike, if spikes were searched.
    pub fn at_spikes(&self) -> impl Iterator<Item = Sample> {
        self.spikes.iter().map(|&side| self.sample_on_side(side, 0.0))
    }

    /// Returns whether triangle `t` lies in a plane that touches another one, if these were searched.
    pub fn is_in_contact(&self, t: u32) -> bool {
        self.in_contact.get(t as usize).is_some_and(|in_contact| *in_contact)
    }

    /// Returns the patch of triangle `t`.
    #[inline]
    pub fn patch_of(&self, t: u32) -> u32 {
        self.patch[self.mesh.triangles[t as usize][0] as usize]
    }

    /// Number of patches.
    pub fn patch_count(&self) -> usize {
        self.patches.count()
    }

    /// Width of each patch, by its index: twice its area over the length of its boundary, which is exact for a long strip;
    /// infinite for a closed one.
    pub fn widths(&self) -> &[f64] {
        self.widths.get_or_init(|| self.compute_widths())
    }

    fn compute_widths(&self) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.patch_count()];
        for t in 0..self.mesh.triangles.len() {
            let corners = self.mesh.corners(t);
            let (area, length) = &mut sums[self.patch_of(t as u32) as usize];
            *area += self.mesh.triangle_area(t);
            let open = (0..3).filter(|&k| self.twin[3 * t + k] == NONE);
            *length += open.map(|k| corners[k].distance(corners[(k + 1) % 3])).sum::<f64>();
        }
        sums.into_iter().map(|(area, length)| 2.0 * area / length).collect()
    }

    /// Returns the point with barycentric coordinates `weights` (three, of sum 1) on triangle `t`.
    #[inline]
    pub fn sample(&self, t: u32, weights: [f64; 3]) -> Sample {
        let [a, b, c] = self.mesh.corners(t as usize);
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        Sample { position, normal: self.normal(t, weights), triangle: t, size: self.size(t, weights) }
    }

    /// Target edge length at a point of triangle `t`, relative to the mean spacing, interpolated from its corners.
    #[inline]
    fn size(&self, t: u32, weights: [f64; 3]) -> f64 {
        if self.sizes.is_empty() {
            return 1.0;
        }
        let corners = self.mesh.triangles[t as usize];
        (0..3).map(|k| weights[k] * self.sizes[corners[k] as usize]).sum()
    }

    /// Target edge length at the point of triangle `t` closest to `p`, relative to the mean spacing.
    pub fn size_near(&self, p: DVec3, t: u32) -> f64 {
        let corners = self.mesh.corners(t as usize);
        self.size(t, barycentric(closest_point(p, corners), corners))
    }

    /// Target edge length at vertex `v`, relative to the mean spacing.
    #[inline]
    pub fn size_at(&self, v: u32) -> f64 {
        self.sizes.get(v as usize).copied().unwrap_or(1.0)
    }

    /// Normal at a point of triangle `t`: interpolated from its vertices if it is within 60 degrees of the triangle's own,
    /// or if that is a folded-over needle; otherwise the triangle's own (next to a sharp edge or a spike).
    #[inline]
    fn normal(&self, t: u32, weights: [f64; 3]) -> DVec3 {
        let corners = self.mesh.triangles[t as usize];
        let smooth: DVec3 = (0..3).map(|k| weights[k] * self.vertex_normals[corners[k] as usize]).sum();
        let smooth = smooth.normalize_or_zero();
        let own = self.mesh.area_vector(t as usize);
        let agreement = smooth.dot(own);
        if agreement >= 0.5 * own.length() || agreement < 0.0 && self.is_folded_over(t, smooth) {
            smooth
        } else {
            own.normalize_or_zero()
        }
    }

    /// Returns whether triangle `t`, with a normal opposed to `smooth`, is a needle folded onto an adjacent triangle that
    /// agrees with it.
    #[cold]
    fn is_folded_over(&self, t: u32, smooth: DVec3) -> bool {
        let trusted = trusted_normal(&self.mesh, &self.twin, self.spacing, t);
        smooth.dot(trusted) >= 0.5 * trusted.length()
    }

    /// Unit normal at vertex `v`; zero where all its triangles are flat.
    #[inline]
    pub fn vertex_normal(&self, v: u32) -> DVec3 {
        self.vertex_normals[v as usize]
    }

    /// Returns the point at share `along` of `side`, as part of the patch on its left.
    pub fn sample_on_side(&self, side: u32, along: f64) -> Sample {
        let mut weights = [0.0; 3];
        weights[side as usize % 3] = 1.0 - along;
        weights[next(side) as usize % 3] = along;
        self.sample(side / 3, weights)
    }

    /// Returns the loops of the boundary and of sharp edges, each as its sides `3 t + k` with the surface on their left.
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.twin.len()];
        let mut loops = Vec::new();
        for start in 0..self.twin.len() as u32 {
            if self.twin[start as usize] != NONE || seen[start as usize] {
                continue;
            }
            let mut chain = Vec::new();
            let mut side = start;
            while !seen[side as usize] {
                seen[side as usize] = true;
                chain.push(side);
                side = self.next_boundary_side(side);
            }
            loops.push(chain);
        }
        loops
    }

    /// Returns the boundary side that begins where boundary side `side` ends: the last one of the fan around that vertex.
    fn next_boundary_side(&self, side: u32) -> u32 {
        let mut s = next(side);
        while self.twin[s as usize] != NONE {
            s = next(self.twin[s as usize]);
        }
        s
    }
}

/// Unit normals at the vertices of a surface. Where needles are folded over, the normals of their surroundings.
fn normals_of(mesh: &Mesh, twin: &[u32], spacing: f64) -> Vec<DVec3> {
    let mut normals = vertex_normals(mesh);
    for (t, trusted) in folded_over(mesh, twin, spacing) {
        for v in mesh.triangles[t as usize] {
            if normals[v as usize].dot(trusted) < 0.0 {
                normals[v as usize] = trusted.normalize_or_zero();
            }
        }
    }
    normals
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;
    use glam::dvec3;

    #[test]
    fn without_a_curve_all_others_and_the_sizes_stay() {
        let (cube, features) = (testing::cube(), Features::Degrees(30.0));
        let mut domain = Domain::with_features(cube.clone().try_into().unwrap(), features, 0.5);
        let size = |p: DVec3| 1.0 + p.x + 2.0 * p.y + 4.0 * p.z;
        domain.grade(domain.mesh.positions.iter().map(|&p| size(p)).collect());
        let all: Vec<u32> = domain.sharp_curves().collect();
        assert_eq!((all.len(), domain.mesh.positions.len()), (12, 24));
        let domain = domain.without_curves(|curve| curve == all[3]);
        // The two faces beside the curve become one, with one corner less at each of its ends.
        assert_eq!((domain.sharp_curves().count(), domain.mesh.positions.len()), (11, 22));
        assert!(domain.mesh.positions.iter().zip(domain.sizes()).all(|(&p, s)| s == size(p)));
        let domain = domain.without_curves(|_| true);
        assert!(!domain.is_sharp() && domain.mesh.positions.len() == 8 && domain.twin.iter().all(|&t| t != NONE));
        assert_eq!(domain.mesh.triangles, cube.triangles);
    }

    #[test]
    fn a_needle_that_is_folded_over_faces_as_what_is_beside_it() {
        let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 1e-4]].map(|[x, y]| dvec3(x, y, 0.0));
        // The ear with the last corner should lie below the square, and lies on it.
        let mesh = |ear: DVec3| Mesh {
            positions: at[..4].iter().copied().chain([ear]).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [1, 0, 4]],
        };
        let normal = |ear: DVec3| Domain::new(mesh(ear).try_into().unwrap()).sample(2, [0.2, 0.2, 0.6]).normal;
        assert_eq!(normal(at[4]), DVec3::Z);
        assert_eq!(normal(dvec3(0.5, 0.5, 0.0)), -DVec3::Z, "a fold that is wide is one");
    }
}
