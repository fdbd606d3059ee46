//! The domain of sampling: an oriented 2-manifold mesh with what it takes to place points on it, to walk over it and
//! to find back to it.

use crate::geom::triangle::barycentric;
use crate::surface::bvh::Bvh;
use crate::surface::connectivity::next;
use crate::surface::crossings::{crossing_pairs, faces_of};
use crate::surface::mesh::Mesh;
use crate::surface::topology::{NONE, components, twins};
use glam::DVec3;

/// A point on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub position: DVec3,
    /// Unit normal of the surface there, smooth across its triangles.
    pub normal: DVec3,
    /// The triangle of the domain that the point lies on.
    pub triangle: u32,
}

/// An oriented 2-manifold mesh and its derived data.
pub struct Domain {
    pub mesh: Mesh,
    /// The side across each side, as [`twins`] says; [`NONE`] at the boundary.
    pub twin: Vec<u32>,
    /// The connected piece of each vertex.
    pub piece: Vec<u32>,
    /// Unit normal at each vertex; zero where all its triangles are flat.
    vertex_normals: Vec<DVec3>,
    bvh: Bvh,
    boundary: BoundaryCurves,
}

/// The boundary sides of a domain as a mesh of triangles with two equal corners, to find closest points on.
#[derive(Default)]
struct BoundaryCurves {
    /// In increasing order.
    sides: Vec<u32>,
    /// The loop of each side.
    loops: Vec<u32>,
    segments: Mesh,
    bvh: Bvh,
}

impl Domain {
    /// The domain over `mesh`, which has to be an oriented 2-manifold.
    pub fn new(mesh: Mesh) -> Domain {
        let (vertex_normals, (twin, bvh)) =
            rayon::join(|| vertex_normals(&mesh), || rayon::join(|| twins(&mesh.triangles), || Bvh::new(&mesh)));
        let piece = components(mesh.positions.len(), &mesh.triangles);
        let mut domain = Domain { mesh, twin, piece, vertex_normals, bvh, boundary: BoundaryCurves::default() };
        domain.boundary = BoundaryCurves::new(&domain);
        domain
    }

    /// The piece that triangle `t` belongs to.
    #[inline]
    pub fn piece_of(&self, t: u32) -> u32 {
        self.piece[self.mesh.triangles[t as usize][0] as usize]
    }

    /// The point with barycentric coordinates `weights` (three, of sum 1) on triangle `t`.
    #[inline]
    pub fn sample(&self, t: u32, weights: [f64; 3]) -> Sample {
        let [a, b, c] = self.mesh.corners(t as usize);
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        Sample { position, normal: self.normal(t, weights), triangle: t }
    }

    /// The normal at a point of triangle `t`: that of the vertices, interpolated, where it stays within 60 degrees of
    /// the triangle's own; else the triangle's own (next to a sharp edge, or a spike).
    #[inline]
    fn normal(&self, t: u32, weights: [f64; 3]) -> DVec3 {
        let corners = self.mesh.triangles[t as usize];
        let smooth: DVec3 = (0..3).map(|k| weights[k] * self.vertex_normals[corners[k] as usize]).sum();
        let smooth = smooth.normalize_or_zero();
        let own = self.mesh.area_vector(t as usize);
        if smooth.dot(own) >= 0.5 * own.length() { smooth } else { own.normalize_or_zero() }
    }

    /// The point closest to `p` among those where the surface faces the way of `normal`, so that the other side of a
    /// thin place is not taken for this one. `near` is a triangle known to be close by, of the piece that is meant.
    pub fn project(&self, p: DVec3, normal: DVec3, near: u32) -> Sample {
        let piece = self.piece_of(near);
        let here = crate::geom::triangle::closest_point(p, self.mesh.corners(near as usize));
        let bound = p.distance_squared(here);
        let faces = |t: u32| self.piece_of(t) == piece && self.mesh.area_vector(t as usize).dot(normal) > 0.0;
        let hit = self.bvh.closest_where(&self.mesh, p, bound, faces);
        let (t, point) = hit.map_or((near, here), |h| (h.triangle, h.point));
        self.sample(t, barycentric(point, self.mesh.corners(t as usize)))
    }

    /// The point closest to `p` on the boundary loop that triangle `near` touches with a side.
    pub fn project_on_boundary(&self, p: DVec3, near: u32) -> Sample {
        let curves = &self.boundary;
        let own = (3 * near..3 * near + 3).find_map(|side| curves.sides.binary_search(&side).ok());
        let is_own = |i: u32| own.is_none_or(|own| curves.loops[i as usize] == curves.loops[own]);
        let Some(hit) = curves.bvh.closest_where(&curves.segments, p, f64::INFINITY, is_own) else {
            return self.project(p, DVec3::ZERO, near);
        };
        let t = curves.sides[hit.triangle as usize] / 3;
        self.sample(t, barycentric(hit.point, self.mesh.corners(t as usize)))
    }

    /// The triangles that cross or touch another one where they are not joined.
    pub fn crossing_faces(&self) -> Vec<u32> {
        faces_of(crossing_pairs(&self.mesh, &self.bvh))
    }

    /// The length of all boundary loops.
    pub fn boundary_length(&self) -> f64 {
        let length = |t: usize| self.boundary.segments.corners(t)[0].distance(self.boundary.segments.corners(t)[1]);
        (0..self.boundary.sides.len()).map(length).sum()
    }

    /// The boundary loops, each as the sides `3 t + k` along it with the surface on their left.
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

    /// The boundary side that begins where boundary side `side` ends: the last one of the fan around that vertex.
    fn next_boundary_side(&self, side: u32) -> u32 {
        let mut s = next(side);
        while self.twin[s as usize] != NONE {
            s = next(self.twin[s as usize]);
        }
        s
    }
}

impl BoundaryCurves {
    fn new(domain: &Domain) -> Self {
        let loops = domain.boundary_loops();
        let mut sides: Vec<(u32, u32)> =
            loops.iter().zip(0u32..).flat_map(|(sides, i)| sides.iter().map(move |&s| (s, i))).collect();
        sides.sort_unstable();
        let corner = |s: u32| domain.mesh.positions[domain.mesh.triangles[s as usize / 3][s as usize % 3] as usize];
        let positions = sides.iter().flat_map(|&(s, _)| [corner(s), corner(next(s))]).collect();
        let triangles = (0..sides.len() as u32).map(|i| [2 * i, 2 * i + 1, 2 * i + 1]).collect();
        let segments = Mesh { positions, triangles };
        let (sides, loops) = sides.into_iter().unzip();
        BoundaryCurves { bvh: Bvh::new(&segments), sides, loops, segments }
    }
}

/// Normals with the weights of N. Max, Weights for computing vertex normals from facet normals, 1999,
/// DOI 10.1080/10867651.1999.10487501: exact on a sphere, and slivers do not count for more than they are.
fn vertex_normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let p = mesh.corners(t);
        let area_vector = mesh.area_vector(t);
        for k in 0..3 {
            let (out, back) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
            let weight = out.length_squared() * back.length_squared();
            if weight > 0.0 {
                normals[corners[k] as usize] += area_vector / weight;
            }
        }
    }
    normals.iter_mut().for_each(|n| *n = n.normalize_or_zero());
    normals
}
