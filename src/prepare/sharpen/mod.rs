//! Restores the sharp edges of a surface in a mesh through points of it.
//!
//! Hardly any point of a scan lies on a sharp edge, so triangles between points on both sides cut it off. Here each vertex
//! near it gets the tangent plane of its own side (see `planes`). Where the planes at the ends of an edge of the mesh differ,
//! the edge runs from one side to the other. It is split where it would cross the sharp edge if the sides were unfolded onto
//! one plane, and the new vertex is put where the planes meet. If an end is close to there, it moves there instead.
//!
//! Crossed edges form chains along the sharp edges. Chains that are short or nowhere clear are noise or details. If most are,
//! as on scans of what has no sharp edges, the others hardly mean more, and all stay as they are.
//!
//! Based on: M. Attene, B. Falcidieno, J. Rossignac, M. Spagnuolo, Sharpen&Bend: recovering curved sharp edges in triangle
//! meshes produced by feature-insensitive sampling, 2005, DOI 10.1109/TVCG.2005.34; L. Kobbelt, M. Botsch, U. Schwanecke,
//! H.-P. Seidel, Feature sensitive surface extraction from volume data, 2001, DOI 10.1145/383259.383265 (vertices where
//! tangent planes meet). Departure: planes instead of dihedral angles decide what is sharp, since noise bends all edges.
//!
//! Cost: linear. Limits: sides narrower than a few edges have no planes of their own.

mod net;
mod planes;
mod split;

use crate::base::csr::Csr;
use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::geom::symmetric::Symmetric;
use crate::mesh::sides::lower_first;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::sharpen::net::tidied;
use crate::prepare::sharpen::planes::{BETTER, Plane, Tangent, tangents};
use crate::prepare::sharpen::split::split;
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;

/// What is restored.
#[derive(Debug, Clone, Copy)]
pub struct SharpEdges {
    /// Minimum angle between the planes of both sides, in degrees.
    pub angle: f64,
    /// Minimum length of a chain, in the units of the mesh.
    pub shortest: f64,
    /// About how many rings of neighbours a plane passes through.
    pub rings: usize,
}

/// Mesh with restored sharp edges.
#[derive(Debug, Clone)]
pub struct Sharpened {
    /// The mesh: its first vertices are those of the original one, some of them moved.
    pub mesh: Mesh,
    /// For each new vertex, an original one beside it.
    pub beside: Vec<u32>,
    /// The sharp edges, by their ends.
    pub edges: Vec<[u32; 2]>,
}

/// Maximum angle between the planes of both sides, in degrees: the edge of a blade cannot be told from a thin wall.
const MOST: f64 = 165.0;

/// How many times better one-sided planes fit than others along a clear chain.
const CLEAR: f64 = 3.5;

/// Minimum share of the crossed edges that are in clear chains. Of clouds of 200,000 points, parts have 0.57 to 1, and scans
/// and sculpts up to 0.47.
const MOSTLY: f64 = 0.5;

/// An end of a crossed edge moves onto the sharp edge if its share of the edge is less.
const CLOSE: f64 = 0.2;

/// Angle between the triangles on both sides of a restored edge, relative to the minimum of its chain.
const SURE: f64 = 2.0 / 3.0;

/// Weight that keeps a vertex where it is, relative to that of a plane, and the number of steps to where planes meet. Planes
/// that hardly differ thus do not move it far along them.
const STAY: f64 = 0.03;
const STEPS: usize = 3;

/// Edge of the mesh that crosses a sharp edge.
struct Crossing {
    ends: [u32; 2],
    /// Share of the edge before the crossing.
    share: f64,
}

/// Restores the sharp edges of an oriented manifold; `None` if it has none.
pub fn sharpened(mesh: &Mesh, wanted: &SharpEdges) -> Option<Sharpened> {
    let sides = || mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let neighbors = Csr::new(mesh.positions.len(), sides);
    let tangents = tangents(mesh, &neighbors, wanted.rings);
    let crossed = Crossed::new(mesh, &tangents, wanted);
    if crossed.crossings.is_empty() {
        return None;
    }
    let mut restored = Restored::new(mesh, &tangents, &crossed.crossings);
    let triangles = restored.split(mesh, &tangents, &crossed);
    let Restored { positions, is_sharp, beside, .. } = restored;
    let mut mesh = Mesh { positions, triangles };
    let twin = twins(&mesh.triangles);
    let edges = edges_between_sides(&mesh, &twin, &is_sharp, &tangents, SURE * wanted.angle);
    let edges = tidied(edges, &mesh, &twin, wanted.shortest);
    place_corners(&mut mesh, &edges, &is_sharp, &tangents);
    Some(Sharpened { mesh, beside, edges })
}

/// The edges that cross sharp edges.
struct Crossed {
    crossings: Vec<Crossing>,
    /// For each side of the mesh, its crossing; [`NONE`] if there is none.
    of_side: Vec<u32>,
}

impl Crossed {
    fn new(mesh: &Mesh, tangents: &[Tangent], wanted: &SharpEdges) -> Crossed {
        let twin = twins(&mesh.triangles);
        let mut crossed = Crossed { crossings: Vec::new(), of_side: vec![NONE; twin.len()] };
        for side in (0..twin.len() as u32).filter(|&side| side < twin[side as usize]) {
            let Some(crossing) = crossing(mesh, tangents, side, wanted.angle) else { continue };
            let number = crossed.crossings.len() as u32;
            [side, twin[side as usize]]
                .iter()
                .filter(|&&s| s != NONE)
                .for_each(|&s| crossed.of_side[s as usize] = number);
            crossed.crossings.push(crossing);
        }
        crossed.keep_chains(mesh, tangents, wanted.shortest);
        crossed
    }

    /// Keeps the chains that are clear over the length `shortest`.
    fn keep_chains(&mut self, mesh: &Mesh, tangents: &[Tangent], shortest: f64) {
        let at = |c: u32| {
            let Crossing { ends: [a, b], share } = self.crossings[c as usize];
            mesh.positions[a as usize].lerp(mesh.positions[b as usize], share)
        };
        let is_clear = |c: u32| self.crossings[c as usize].ends.iter().all(|&v| tangents[v as usize].better > CLEAR);
        let mut chains = UnionFind::new(self.crossings.len());
        let mut links = Vec::new();
        for crossings in self.of_side.as_chunks::<3>().0 {
            let mut found = crossings.iter().copied().filter(|&c| c != NONE);
            let Some(first) = found.next() else { continue };
            for next in found {
                chains.join(first, next);
                links.push([first, next]);
            }
        }
        let mut lengths = vec![0.0; self.crossings.len()];
        for [a, b] in links.into_iter().filter(|link| link.iter().all(|&c| is_clear(c))) {
            lengths[chains.find(a) as usize] += at(a).distance(at(b));
        }
        let (all, mut kept) = (self.crossings.len(), Vec::new());
        let mut number = vec![NONE; all];
        for (c, crossing) in (0..).zip(self.crossings.drain(..)) {
            if lengths[chains.find(c) as usize] >= shortest {
                number[c as usize] = kept.len() as u32;
                kept.push(crossing);
            }
        }
        if (kept.len() as f64) < MOSTLY * all as f64 {
            kept.clear();
        }
        self.crossings = kept;
        self.of_side.iter_mut().filter(|c| **c != NONE).for_each(|c| *c = number[*c as usize]);
    }
}

/// Returns where an edge crosses a sharp edge of at least `angle` degrees, if it does.
fn crossing(mesh: &Mesh, tangents: &[Tangent], side: u32, angle: f64) -> Option<Crossing> {
    let ends = lower_first(mesh.ends(side));
    if ends.iter().any(|&v| tangents[v as usize].better < BETTER) {
        return None;
    }
    let [a, b] = ends.map(|v| tangents[v as usize].plane);
    // Both sides are below each other's plane at a ridge, and above at a valley.
    let is_edge =
        (angle..=MOST).contains(&angle_between(a.normal, b.normal)) && a.height(b.mean) * b.height(a.mean) > 0.0;
    if !is_edge {
        return None;
    }
    let [p, q] = ends.map(|v| mesh.positions[v as usize]);
    let on_edge = meeting([a, b].into_iter(), 0.5 * (p + q));
    let along = a.normal.cross(b.normal).normalize();
    let [from_p, from_q] = [p, q].map(|p| (p - on_edge).reject_from_normalized(along).length());
    // The planes meet near the edge.
    (from_p + from_q <= 2.0 * p.distance(q)).then(|| Crossing { ends, share: from_p / (from_p + from_q) })
}

/// Returns the point where `planes` meet, nearest to `start`.
fn meeting(planes: impl Iterator<Item = Plane> + Clone, start: DVec3) -> DVec3 {
    let mut squares = Symmetric::default();
    planes.clone().for_each(|plane| squares += Symmetric::outer(plane.normal));
    let stay = DMat3::from_diagonal(DVec3::splat(STAY * planes.clone().count() as f64));
    let step = (squares.matrix() + stay).inverse();
    (0..STEPS).fold(start, |p, _| p - step * planes.clone().map(|plane| plane.height(p) * plane.normal).sum::<DVec3>())
}

fn angle_between(a: DVec3, b: DVec3) -> f64 {
    math::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
}

/// Vertices of the mesh, with those on the restored edges.
struct Restored {
    positions: Vec<DVec3>,
    /// For each vertex, whether it is on a sharp edge.
    is_sharp: Vec<bool>,
    /// The new vertex at each crossing, unless an end moved there.
    at_crossing: Vec<Option<u32>>,
    beside: Vec<u32>,
}

impl Restored {
    fn new(mesh: &Mesh, tangents: &[Tangent], crossings: &[Crossing]) -> Restored {
        let (positions, is_sharp) = (mesh.positions.clone(), vec![false; mesh.positions.len()]);
        let mut restored = Restored { positions, is_sharp, at_crossing: Vec::new(), beside: Vec::new() };
        restored.move_close_ends(mesh, tangents, crossings);
        for &Crossing { ends, share } in crossings {
            let [p, q] = ends.map(|v| mesh.positions[v as usize]);
            let is_new = !ends.iter().any(|&v| restored.is_sharp[v as usize]);
            let at = is_new.then(|| restored.add(meeting(planes(tangents, &ends), p.lerp(q, share)), ends[0]));
            restored.at_crossing.push(at);
        }
        restored
    }

    /// Moves ends of crossed edges that are close to the sharp edge onto it.
    fn move_close_ends(&mut self, mesh: &Mesh, tangents: &[Tangent], crossings: &[Crossing]) {
        for &Crossing { ends: [a, b], share } in crossings {
            self.is_sharp[a as usize] |= share < CLOSE;
            self.is_sharp[b as usize] |= share > 1.0 - CLOSE;
        }
        let ends = || crossings.iter().flat_map(|&Crossing { ends: [a, b], .. }| [(a, b), (b, a)]);
        let across = Csr::new(mesh.positions.len(), ends);
        for v in (0..mesh.positions.len() as u32).filter(|&v| self.is_sharp[v as usize]) {
            let start = mesh.positions[v as usize];
            let all: Vec<u32> = across.row(v).iter().copied().chain([v]).collect();
            let at = meeting(planes(tangents, &all), start);
            if across.row(v).iter().all(|&w| mesh.positions[w as usize].distance(start) > at.distance(start)) {
                self.positions[v as usize] = at;
            }
        }
    }

    /// Adds a vertex on a sharp edge, beside an original one.
    fn add(&mut self, position: DVec3, beside: u32) -> u32 {
        self.positions.push(position);
        self.is_sharp.push(true);
        self.beside.push(beside);
        self.positions.len() as u32 - 1
    }

    /// Returns the triangles, split at the new vertices. Where three sides meet in one, a vertex at their corner is added.
    fn split(&mut self, mesh: &Mesh, tangents: &[Tangent], crossed: &Crossed) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(mesh.triangles.len() + 2 * self.beside.len());
        for (&corners, sides) in mesh.triangles.iter().zip(crossed.of_side.as_chunks::<3>().0) {
            let at = sides.map(|c| if c == NONE { None } else { self.at_crossing[c as usize] });
            if let [Some(p), Some(q), Some(r)] = at {
                let around = [corners[0], p, corners[1], q, corners[2], r];
                let middle = [p, q, r].iter().map(|&v| self.positions[v as usize]).sum::<DVec3>() / 3.0;
                let corner = meeting(planes(tangents, &corners), middle);
                let is_near =
                    around.iter().any(|&v| self.positions[v as usize].distance(middle) > corner.distance(middle));
                let centre = self.add(if is_near { corner } else { middle }, corners[0]);
                triangles.extend((0..6).map(|k| [around[k], around[(k + 1) % 6], centre]));
            } else {
                split(corners, at, &self.positions, &mut triangles);
            }
        }
        triangles
    }
}

/// Returns the tangent planes at `vertices`.
fn planes<'a>(tangents: &'a [Tangent], vertices: &'a [u32]) -> impl Iterator<Item = Plane> + Clone + 'a {
    vertices.iter().map(|&v| tangents[v as usize].plane)
}

/// Returns the edges between vertices on sharp edges that separate two sides, whose planes differ by at least `angle`
/// degrees.
fn edges_between_sides(
    mesh: &Mesh,
    twin: &[u32],
    is_sharp: &[bool],
    tangents: &[Tangent],
    angle: f64,
) -> Vec<[u32; 2]> {
    let normal = |t: u32| {
        // Vertices on sharp edges belong to all sides.
        let own = mesh.triangles[t as usize].iter().find(|&&v| !is_sharp[v as usize]);
        own.map_or_else(|| mesh.area_vector(t as usize), |&v| tangents[v as usize].plane.normal)
    };
    let inner = (0..twin.len() as u32).filter(|&side| twin[side as usize] != NONE && side < twin[side as usize]);
    let sharp = inner.filter(|&side| {
        let is_between = mesh.ends(side).iter().all(|&v| is_sharp[v as usize]);
        is_between && angle_between(normal(side / 3), normal(twin[side as usize] / 3)) >= angle
    });
    sharp.map(|side| mesh.ends(side)).collect()
}

/// Moves each vertex where three or more sharp edges end to where the planes around it meet.
fn place_corners(mesh: &mut Mesh, edges: &[[u32; 2]], is_sharp: &[bool], tangents: &[Tangent]) {
    let mut ends = vec![0u8; mesh.positions.len()];
    edges.as_flattened().iter().for_each(|&v| ends[v as usize] = ends[v as usize].saturating_add(1));
    let mut around: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for corners in &mesh.triangles {
        for &v in corners.iter().filter(|&&v| ends[v as usize] >= 3) {
            around.entry(v).or_default().extend(corners.iter().filter(|&&w| !is_sharp[w as usize]));
        }
    }
    for (v, own) in around {
        let position = mesh.positions[v as usize];
        let corner = meeting(planes(tangents, &own), position);
        if own.iter().any(|&w| mesh.positions[w as usize].distance(position) > corner.distance(position)) {
            mesh.positions[v as usize] = corner;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream};
    use crate::mesh::topology::topology;
    use crate::testing::{grid, random_point};

    /// Number of squares of a side of a sheet.
    const SQUARES: u32 = 40;

    /// A square sheet of the given height, whose points are moved at random along it by a third of their spacing, and off it
    /// by `noise` times their spacing. No row of points is in the middle.
    fn scan(noise: f64, height: impl Fn(f64, f64) -> f64) -> Mesh {
        let mut rng = stream(3, Stage::Candidates);
        let spacing = 1.0 / f64::from(SQUARES);
        let mut mesh = grid(SQUARES, SQUARES, |x, y| DVec3::new(x + 0.4 * spacing, y + 0.4 * spacing, 0.0));
        for p in &mut mesh.positions {
            let random = (2.0 * random_point(&mut rng) - 1.0) * spacing;
            *p += DVec3::new(random.x / 3.0, random.y / 3.0, 0.0);
            p.z = height(p.x, p.y) + noise * random.z;
        }
        mesh
    }

    fn sharpen(mesh: &Mesh) -> Option<Sharpened> {
        sharpened(mesh, &SharpEdges { angle: 30.0, shortest: 0.2, rings: 2 })
    }

    fn roof(x: f64, _: f64) -> f64 {
        -(x - 0.5).abs()
    }

    #[test]
    fn a_ridge_between_rows_of_points_becomes_straight() {
        let flat = scan(0.0, roof);
        let Sharpened { mesh, edges, beside } = sharpen(&flat).unwrap();
        let on_ridge =
            |v: &u32| (mesh.positions[*v as usize] - DVec3::X / 2.0).reject_from_normalized(DVec3::Y).length();
        assert!(edges.as_flattened().iter().map(on_ridge).all(|distance| distance < 1e-4));
        let length: f64 =
            edges.iter().map(|e| (mesh.positions[e[0] as usize].y - mesh.positions[e[1] as usize].y).abs()).sum();
        assert!((length - 1.0).abs() < 0.05, "{length}");
        assert_eq!(mesh.positions.len(), flat.positions.len() + beside.len());
        // Still one sheet, whose boundary has no loops but its rim.
        let topology = topology(mesh.positions.len(), &mesh.triangles);
        assert!(topology.is_manifold() && topology.is_oriented());
        assert_eq!([topology.euler, topology.boundary_loops as i64], [1, 1]);
        // What was cut off is back: as much as both sides have, and no triangle lies upside down.
        let flat_area = flat.area();
        assert!(mesh.area() > flat_area && (0..mesh.triangles.len()).all(|t| mesh.area_vector(t).z > -1e-9));
    }

    #[test]
    fn a_ridge_is_found_in_noise_and_sides_keep_it() {
        let Sharpened { mesh, edges, .. } = sharpen(&scan(0.1, roof)).unwrap();
        let far = edges.as_flattened().iter().map(|&v| (mesh.positions[v as usize].x - 0.5).abs());
        assert!(far.fold(0.0, f64::max) < 0.3 / f64::from(SQUARES));
        assert!(edges.len() > SQUARES as usize / 2);
    }

    #[test]
    fn the_sides_of_a_pyramid_meet_at_its_top() {
        let pyramid = |x: f64, y: f64| -(x - 0.5).max(0.5 - x).max(y - 0.5).max(0.5 - y);
        let Sharpened { mesh, .. } = sharpen(&scan(0.0, pyramid)).unwrap();
        let top = mesh.positions.iter().map(|p| p.distance(DVec3::new(0.5, 0.5, 0.0)));
        assert!(top.fold(f64::INFINITY, f64::min) < 2e-3);
    }

    #[test]
    fn what_bends_smoothly_or_is_only_noise_has_no_sharp_edges() {
        assert!(sharpen(&scan(0.0, |x, y| 0.5 * (6.0 * x).sin() * (5.0 * y).cos())).is_none());
        assert!(sharpen(&scan(0.3, |_, _| 0.0)).is_none());
        assert!(sharpen(&scan(0.0, |x, _| 0.2 * roof(x, 0.0))).is_none());
    }
}
