//! Points of the surface at which its distance to the mesh is measured: its vertices, and points inside large triangles.

use crate::geom::triangle::closest_point;
use crate::manifold::faces::Faces;
use crate::optimize::quadrature::{POINTS, point};
use crate::surface::domain::Domain;
use glam::DVec3;

/// Longest side, in spacings, of a surface triangle that needs no probes inside.
const LONG_SIDE: f64 = 0.6;

/// A point of the surface at which the distance to the mesh is measured.
#[derive(Clone, Copy)]
pub(super) struct Probe {
    pub position: DVec3,
    pub normal: DVec3,
}

impl Probe {
    pub(super) fn at_vertex(domain: &Domain, v: u32) -> Probe {
        Probe { position: domain.mesh.positions[v as usize], normal: domain.vertex_normal(v) }
    }

    /// Returns the probes inside triangle `t` of the surface if it is so large that its corners do not suffice.
    pub(super) fn inside(domain: &Domain, t: u32, spacing: f64) -> impl Iterator<Item = Probe> + use<> {
        let corners = domain.mesh.corners(t as usize);
        let [a, b, c] = corners;
        let is_large = a.distance(b).max(b.distance(c)).max(c.distance(a)) > LONG_SIDE * spacing;
        let normal = domain.mesh.area_vector(t as usize);
        let probes = POINTS.map(|(at, _)| Probe { position: point(corners, at), normal });
        probes.into_iter().filter(move |_| is_large)
    }
}

/// The probes of a part of the surface.
pub(super) struct Probes {
    /// Vertices of the surface, in increasing order.
    pub vertices: Vec<u32>,
    /// Points inside large triangles.
    pub inside: Vec<Probe>,
}

impl Probes {
    /// Returns the probes closer to `p` than `reach`; `spacing` is the mean edge length of the mesh.
    pub(super) fn near(domain: &Domain, p: DVec3, reach: f64, spacing: f64) -> Probes {
        let triangles = domain.triangles_near(p, reach);
        let is_near = |q: DVec3| q.distance_squared(p) < reach * reach;
        let corners = triangles.iter().flat_map(|&t| domain.mesh.triangles[t as usize]);
        let mut vertices: Vec<u32> = corners.filter(|&v| is_near(domain.mesh.positions[v as usize])).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let inside = triangles.iter().flat_map(|&t| Probe::inside(domain, t, spacing));
        let inside = inside.filter(|probe| is_near(probe.position)).collect();
        Probes { vertices, inside }
    }

    /// Number of probes.
    pub(super) fn count(&self) -> usize {
        self.vertices.len() + self.inside.len()
    }

    /// Returns all probes, the vertices first.
    pub(super) fn all(&self, domain: &Domain) -> impl Iterator<Item = Probe> {
        let at_vertices = self.vertices.iter().map(|&v| Probe::at_vertex(domain, v));
        at_vertices.chain(self.inside.iter().copied())
    }
}

/// Returns the distance from `probe` to the closest face that faces the same way, and the number of that face, if the
/// distance is below `most`. Below `near`, any such face will do.
pub(super) fn distance(faces: &Faces, probe: &Probe, near: f64, most: f64) -> Option<(f64, u32)> {
    let hit = faces.closest_facing(probe.position, probe.normal, near * near..most * most)?;
    Some((hit.distance_squared.sqrt(), hit.triangle))
}

/// Returns whether face `t` faces the same way as `probe` and is closer to it than `distance`.
pub(super) fn is_nearer(faces: &Faces, t: u32, probe: &Probe, distance: f64) -> bool {
    faces.corners(t).is_some_and(|corners| {
        let [a, b, c] = corners;
        let looks_its_way = (b - a).cross(c - a).dot(probe.normal) > 0.0;
        looks_its_way && closest_point(probe.position, corners).distance(probe.position) < distance
    })
}
