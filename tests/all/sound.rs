//! Tests whether a mesh is sound, independently of the library.

use glam::DVec3;
use spectral_remesh::Mesh;
use std::collections::{BTreeMap, BTreeSet};

/// The topology of a surface, which remeshing keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    pub euler: i64,
    pub components: usize,
    pub boundary_loops: usize,
}

/// Returns the topology of an oriented manifold; for any other mesh, returns what is wrong with it.
pub fn kind(mesh: &Mesh) -> Result<Kind, String> {
    let Mesh { positions, triangles } = mesh;
    if let Some(v) = positions.iter().position(|p| !p.is_finite()) {
        return Err(format!("vertex {v} is not finite"));
    }
    // For each vertex, the next neighbour around it within each face: a fan is a chain of these.
    let mut around: Vec<BTreeMap<u32, u32>> = vec![BTreeMap::new(); positions.len()];
    for &[a, b, c] in triangles {
        if [a, b, c].iter().any(|&v| v as usize >= positions.len()) || a == b || b == c || c == a {
            return Err(format!("a triangle has the corners {a}, {b}, {c}"));
        }
        for [v, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
            if around[v as usize].insert(from, to).is_some() {
                return Err(format!("two triangles have the edge from {v} to {from}"));
            }
        }
    }
    let mut ends = BTreeMap::new();
    for (v, links) in around.iter().enumerate() {
        let targets: BTreeSet<u32> = links.values().copied().collect();
        let begin = links.keys().find(|from| !targets.contains(from)).or(links.keys().next());
        let Some(&begin) = begin else { return Err(format!("no triangle has vertex {v}")) };
        let (mut at, mut length) = (begin, 0);
        while let Some(&next) = links.get(&at) {
            (at, length) = (next, length + 1);
            if at == begin {
                break;
            }
        }
        if length < links.len() || targets.len() < links.len() {
            return Err(format!("the triangles around vertex {v} are no single fan"));
        }
        if at != begin {
            ends.insert(v as u32, at);
        }
    }
    let edges = (3 * triangles.len() + ends.len()) / 2;
    let inner = positions.len() - ends.len();
    Ok(Kind {
        euler: positions.len() as i64 - edges as i64 + triangles.len() as i64,
        components: sets(positions.len(), triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]])),
        boundary_loops: sets(positions.len(), ends.iter().map(|(&v, &w)| [v, w])) - inner,
    })
}

/// Returns the number of sets into which `count` items fall when some are joined.
fn sets(count: usize, joined: impl Iterator<Item = [u32; 2]>) -> usize {
    let mut parent: Vec<u32> = (0..count as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    let mut sets = count;
    for [v, w] in joined {
        let [v, w] = [v, w].map(|v| root(&mut parent, v));
        if v != w {
            parent[v as usize] = w;
            sets -= 1;
        }
    }
    sets
}

/// Depth up to which intersecting faces count as touching, relative to the diagonal of the mesh, as the program documents it.
const CONTACT: f64 = 1e-6;

/// Returns two faces, an edge of one of which passes through the inside of the other by more than contact, if any exist.
pub fn crossing(mesh: &Mesh) -> Option<[u32; 2]> {
    let bounds =
        mesh.positions.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], &p| [low.min(p), high.max(p)]);
    let contact = CONTACT * bounds[0].distance(bounds[1]);
    let faces: Vec<[DVec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
    let low = |t: u32| faces[t as usize].iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
    let high = |t: u32| faces[t as usize].iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
    let mut order: Vec<u32> = (0..faces.len() as u32).collect();
    order.sort_by(|&s, &t| low(s).x.total_cmp(&low(t).x));
    for (i, &s) in order.iter().enumerate() {
        let [s_low, s_high] = [low(s), high(s)];
        for &t in order[i + 1..].iter().take_while(|&&t| low(t).x <= s_high.x) {
            let apart = low(t).cmpgt(s_high).any() || high(t).cmplt(s_low).any();
            let crosses = || goes_through(mesh, s, t) || goes_through(mesh, t, s);
            let [one, other] = [s, t].map(|face| faces[face as usize]);
            let passes = || is_on_both_sides(one, other, contact) && is_on_both_sides(other, one, contact);
            if !apart && crosses() && passes() && length_in_common(one, other) > contact {
                return Some([s, t]);
            }
        }
    }
    None
}

/// Returns whether `face` has corners farther than `depth` from the plane of `other` on both sides of it.
fn is_on_both_sides(face: [DVec3; 3], other: [DVec3; 3], depth: f64) -> bool {
    let normal = (other[1] - other[0]).cross(other[2] - other[0]).normalize_or_zero();
    let heights = face.map(|p| (p - other[0]).dot(normal));
    heights.iter().any(|&height| height > depth) && heights.iter().any(|&height| height < -depth)
}

/// Returns the length of the part of `face` in the plane of `other` that lies within `other`.
fn length_in_common(face: [DVec3; 3], other: [DVec3; 3]) -> f64 {
    let normal = (other[1] - other[0]).cross(other[2] - other[0]).normalize_or_zero();
    let height = |p: DVec3| (p - other[0]).dot(normal);
    let ends: Vec<DVec3> = [[0, 1], [1, 2], [2, 0]]
        .into_iter()
        .map(|side| side.map(|k| face[k]))
        .filter(|&[p, q]| height(p) * height(q) <= 0.0 && height(p) != height(q))
        .map(|[p, q]| p.lerp(q, height(p) / (height(p) - height(q))))
        .collect();
    let pairs = ends.iter().flat_map(|&p| ends.iter().map(move |&q| [p, q]));
    let Some([p, q]) = pairs.max_by(|a, b| a[0].distance(a[1]).total_cmp(&b[0].distance(b[1]))) else { return 0.0 };
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for k in 0..3 {
        let inwards = normal.cross(other[(k + 1) % 3] - other[k]);
        let [at_p, at_q] = [p, q].map(|r| (r - other[k]).dot(inwards));
        let crossing = at_p / (at_p - at_q);
        match (at_p < 0.0, at_q < 0.0) {
            (true, true) => return 0.0,
            (true, false) => from = from.max(crossing),
            (false, true) => to = to.min(crossing),
            (false, false) => {}
        }
    }
    (to - from).max(0.0) * p.distance(q)
}

/// Returns whether an edge of face `s` that shares no corner with face `t` passes through the inside of `t`, decided exactly.
fn goes_through(mesh: &Mesh, s: u32, t: u32) -> bool {
    let face = mesh.triangles[t as usize];
    let corners = mesh.triangles[s as usize];
    let edges = [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]]);
    let side = |corners: [u32; 4]| {
        let [a, b, c, d] = corners.map(|v| {
            let [x, y, z] = mesh.positions[v as usize].to_array();
            robust::Coord3D { x, y, z }
        });
        let side = robust::orient3d(a, b, c, d);
        if side == 0.0 { 0 } else { side.signum() as i32 }
    };
    edges.iter().any(|&[p, q]| {
        let [a, b, c] = face;
        let is_apart = !face.contains(&p) && !face.contains(&q);
        let ends = || side([a, b, c, p]) * side([a, b, c, q]);
        let turns = || [[a, b], [b, c], [c, a]].map(|[v, w]| side([p, q, v, w]));
        is_apart && ends() == -1 && [[1; 3], [-1; 3]].contains(&turns())
    })
}
