//! Restores parts of a refined mesh to what they were before coarsening.
//!
//! A coarse mesh may miss an ear, or pass through a wall that is thinner than its triangles, and the mesh refined from it is
//! wrong there. The vertices of the mesh that it was made from are right. Around such a place, they and their triangles
//! replace what is there, and a strip of triangles joins them to the rest.
//!
//! Based on: H. Fuchs, Z. M. Kedem, S. P. Uselton, Optimal surface reconstruction from planar contours, 1977,
//! DOI 10.1145/359842.359846 (the strip between two loops, by the shortest path).
//!
//! Cost: a test for self-intersections, and at each place the product of the lengths of the two loops.

use crate::base::union_find::UnionFind;
use crate::geom::aabb::Aabb;
use crate::manifold::Manifold;
use crate::manifold::neighborhood::Neighborhood;
use crate::manifold::vertex_set::VertexSet;
use crate::optimize::crossings::{Corners, Crossings, Surroundings};
use crate::spatial::kdtree::Neighbors;
use crate::spatial::self_intersections::faces_of;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

/// Distance, in spacings, from corners of crossing faces within which the mesh is replaced.
const REACH: f64 = 2.0;

/// Number of rings of vertices around the wrong ones that are replaced, too.
const RINGS: usize = 2;

/// Number of nearest vertices among which one that faces the same way is sought: more than both sides of a wall have nearby.
const NEAREST: usize = 12;

/// Maximum number of vertices around a hole of one part that is filled where the other part has none.
const MOST_OF_HOLE: usize = 16;

/// Maximum number of vertex pairs of two loops that are joined.
const MOST_PAIRS: usize = 1 << 22;

/// Replaces parts of `mesh`, which was refined from a coarsened `fine`, by those of `fine`: where faces cross avoidably, and
/// around the vertices of `fine` that were `missed`. `spacing` is the mean edge length. Returns the vertices that are new in
/// `mesh`.
pub fn graft(domain: &Domain, mesh: &mut Manifold, fine: &Manifold, missed: &VertexSet, spacing: f64) -> VertexSet {
    let crossings = Crossings::new(domain, mesh);
    if crossings.avoidable.is_empty() && missed.is_empty() {
        return VertexSet::EMPTY;
    }
    let first_new = mesh.connectivity.vertex_bound();
    let source = Source::new(fine, spacing, first_new);
    let crossing = faces_of(crossings.avoidable.clone()).into_iter().flat_map(|t| mesh.connectivity.triangle(3 * t));
    let places: Vec<Sample> = crossing.map(|v| *mesh.sample(v)).collect();
    let wrong = &source.near(&places) | missed;
    let mut touched = vec![false; mesh.connectivity.half_edge_bound() as usize / 3];
    for part in source.parts(&wrong) {
        if let Some(grafted) = source.grafted(mesh, &part)
            && crosses_no_more(&grafted, mesh, &crossings)
        {
            grafted.put_back(mesh, &mut touched);
        }
    }
    VertexSet::new(mesh, |v| v >= first_new)
}

/// Returns whether no more faces cross with `grafted` in place.
fn crosses_no_more(grafted: &Neighborhood, mesh: &Manifold, crossings: &Crossings) -> bool {
    let now = crossings.all.iter().filter(|(t, u)| grafted.has_triangle(*t) || grafted.has_triangle(*u)).count();
    let new: Vec<Corners> = grafted.mesh.triangles().map(|t| grafted.mesh.corners(t)).collect();
    let then = Surroundings::new(&crossings.faces).count(mesh, &new, grafted.triangles(), now);
    then <= now
}

/// The mesh that parts are taken from.
struct Source<'a> {
    fine: &'a Manifold,
    neighbors: Neighbors,
    spacing: f64,
    /// For each vertex of the mesh that receives the parts, the nearest vertex of `fine`, once it has been looked up.
    nearest: Vec<OnceLock<Option<u32>>>,
}

impl Source<'_> {
    /// Creates a source for a mesh with this number of `vertices`.
    fn new(fine: &Manifold, spacing: f64, vertices: u32) -> Source<'_> {
        let positions: Vec<DVec3> = fine.samples().iter().map(|s| s.position).collect();
        let nearest = (0..vertices).map(|_| OnceLock::new()).collect();
        Source { fine, neighbors: Neighbors::new(&positions), spacing, nearest }
    }

    /// Returns the vertices near `places` that face the same way.
    fn near(&self, places: &[Sample]) -> VertexSet {
        let mut found = Vec::new();
        let mut near = VertexSet::EMPTY;
        for place in places {
            self.neighbors.collect_within(place.position, REACH * self.spacing * place.size, &mut found);
            found.iter().filter(|n| self.faces(n.point, place)).for_each(|n| near.insert(n.point));
        }
        near
    }

    /// Returns whether vertex `v` exists and faces the same way as `place`.
    fn faces(&self, v: u32, place: &Sample) -> bool {
        self.fine.connectivity.has_vertex(v) && self.fine.sample(v).normal.dot(place.normal) > 0.0
    }

    /// Returns the vertex nearest to vertex `v` of `mesh` that faces the same way, if one of those nearby does.
    fn nearest(&self, mesh: &Manifold, v: u32) -> Option<u32> {
        let place = mesh.sample(v);
        let search = || {
            let mut found = Vec::new();
            self.neighbors.collect_nearest(place.position, NEAREST, &mut found);
            found.into_iter().map(|n| n.point).find(|&v| self.faces(v, place))
        };
        self.nearest.get(v as usize).map_or_else(search, |known| *known.get_or_init(search))
    }

    /// Returns the `wrong` vertices and some rings around them, in connected parts.
    fn parts(&self, wrong: &VertexSet) -> Vec<Vec<u32>> {
        connected_parts(self.fine, &wrong.clone().with_rings(self.fine, RINGS))
    }

    /// Returns the triangles around the vertices of `part`, with strips that join them to `mesh`, as a replacement for what
    /// is there. `None` if the two differ in topology, or one of them touches a curve.
    fn grafted(&self, mesh: &Manifold, part: &[u32]) -> Option<Neighborhood> {
        let patch = Patch::around(self.fine, part.iter().copied().collect())?;
        let is_of_patch: VertexSet = patch.vertices(self.fine).into_iter().collect();
        let bounds = Aabb::of(patch.vertices(self.fine).into_iter().map(|v| self.fine.position(v)))?;
        let margin = 2.0 * REACH * self.spacing;
        let gives_way = |v: u32| {
            bounds.distance_squared(mesh.position(v)) <= margin * margin
                && self.nearest(mesh, v).is_some_and(|near| is_of_patch.contains(near))
        };
        let replaced = Patch::around(mesh, largest_part(mesh, &VertexSet::new(mesh, gives_way)))?;
        let rims = patch.rims.len().min(replaced.rims.len());
        let (patch, replaced) = (patch.filled(self.fine, rims)?, replaced.filled(mesh, rims)?);
        (replaced.euler == patch.euler).then(|| self.joined(mesh, patch, replaced))?
    }

    /// Returns `patch` with strips that join it to the surroundings of `replaced` in `mesh`, as a replacement for
    /// `replaced`.
    fn joined(&self, mesh: &Manifold, patch: Patch, mut replaced: Patch) -> Option<Neighborhood> {
        let border = replaced.rims.concat();
        let vertices = patch.vertices(self.fine);
        let number: BTreeMap<u32, u32> = vertices.iter().copied().zip(border.len() as u32..).collect();
        let of_border: BTreeMap<u32, u32> = border.iter().copied().zip(0..).collect();
        let own = |t: &u32| self.fine.connectivity.triangle(3 * t).map(|v| number[&v]);
        let mut triangles: Vec<[u32; 3]> = patch.triangles.iter().map(own).collect();
        for inner in &patch.rims {
            let outer = replaced.take_rim_near(mesh, self.fine.position(inner[0]));
            let places = |mesh: &Manifold, rim: &[u32]| rim.iter().map(|&v| mesh.position(v)).collect::<Vec<DVec3>>();
            let [outside, inside] =
                [outer.iter().map(|v| of_border[v]).collect(), inner.iter().map(|v| number[v]).collect::<Vec<u32>>()];
            let steps = strip(&places(mesh, &outer), &places(self.fine, inner))?;
            triangles.extend(steps.into_iter().map(|step| step.triangle(&outside, &inside)));
        }
        let of_mesh = border.iter().map(|&v| *mesh.sample(v));
        let samples = of_mesh.chain(vertices.iter().map(|&v| *self.fine.sample(v))).collect();
        let mut grafted = Manifold::new(samples, &triangles);
        grafted.make_delaunay();
        let faces_surface = |t: u32| grafted.agreement(grafted.connectivity.triangle(3 * t)) > 0.0;
        let all_face_it = grafted.triangles().all(faces_surface);
        all_face_it.then(|| Neighborhood::in_place_of(replaced.triangles, border, grafted))
    }
}

/// A part of a mesh away from curves.
struct Patch {
    /// Its triangles, in increasing order.
    triangles: Vec<u32>,
    /// The boundary loops as vertices, in the direction of the half-edges of the patch. No loop touches itself or another
    /// one.
    rims: Vec<Vec<u32>>,
    /// Euler characteristic: vertices minus edges plus triangles.
    euler: i64,
}

impl Patch {
    /// Returns the triangles of `mesh` around these vertices, and around more where triangles would touch each other only at
    /// a vertex; `None` if they touch a curve.
    fn around(mesh: &Manifold, mut inner: BTreeSet<u32>) -> Option<Patch> {
        let c = &mesh.connectivity;
        loop {
            let mut triangles: Vec<u32> = inner.iter().flat_map(|&v| c.outgoing(v)).map(|h| h / 3).collect();
            triangles.sort_unstable();
            triangles.dedup();
            let sides = || triangles.iter().flat_map(|&t| 3 * t..3 * t + 3);
            if sides().any(|h| c.is_on_curve(c.origin(h)) || !c.has_twin(h)) {
                return None;
            }
            let is_outside = |h: u32| triangles.binary_search(&(c.twin(h) / 3)).is_err();
            let rim: Vec<[u32; 2]> = sides().filter(|&h| is_outside(h)).map(|h| [c.origin(h), c.target(h)]).collect();
            let following: BTreeMap<u32, u32> = rim.iter().map(|&[v, w]| (v, w)).collect();
            if following.len() < rim.len() {
                let mut seen = BTreeSet::new();
                inner.extend(rim.into_iter().map(|[v, _]| v).filter(|&v| !seen.insert(v)));
                continue;
            }
            let edges = (3 * triangles.len() + rim.len()) as i64 / 2;
            let mut patch = Patch { rims: loops(following), euler: triangles.len() as i64 - edges, triangles };
            patch.euler += patch.vertices(mesh).len() as i64;
            return Some(patch);
        }
    }

    /// Fills the smallest holes of the patch until it has no more than `rims` rims; `None` if one of these holes is not
    /// small.
    fn filled(mut self, mesh: &Manifold, rims: usize) -> Option<Patch> {
        while self.rims.len() > rims {
            let hole = self.rims.iter().min_by_key(|rim| rim.len()).filter(|rim| rim.len() <= MOST_OF_HOLE)?;
            let inner = self.inner(mesh).into_iter().chain(hole.iter().copied()).collect();
            self = Patch::around(mesh, inner)?;
        }
        Some(self)
    }

    /// Returns the vertices that are not on a rim.
    fn inner(&self, mesh: &Manifold) -> BTreeSet<u32> {
        let rims: BTreeSet<u32> = self.rims.iter().flatten().copied().collect();
        self.vertices(mesh).into_iter().filter(|v| !rims.contains(v)).collect()
    }

    /// Returns the vertices in increasing order.
    fn vertices(&self, mesh: &Manifold) -> Vec<u32> {
        let corners = |&t: &u32| mesh.connectivity.triangle(3 * t);
        let mut vertices: Vec<u32> = self.triangles.iter().flat_map(corners).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// Removes and returns the rim closest to `p`.
    fn take_rim_near(&mut self, mesh: &Manifold, p: DVec3) -> Vec<u32> {
        let distance =
            |rim: &Vec<u32>| rim.iter().map(|&v| mesh.position(v).distance_squared(p)).fold(f64::INFINITY, f64::min);
        let nearest = (0..self.rims.len()).min_by(|&i, &j| distance(&self.rims[i]).total_cmp(&distance(&self.rims[j])));
        self.rims.swap_remove(nearest.expect("as many rims as are joined"))
    }
}

/// Splits the map from each vertex to the following one into loops.
fn loops(mut following: BTreeMap<u32, u32>) -> Vec<Vec<u32>> {
    let mut loops = Vec::new();
    while let Some((first, mut v)) = following.pop_first() {
        let mut rim = vec![first];
        while let Some(next) = following.remove(&v) {
            rim.push(v);
            v = next;
        }
        loops.push(rim);
    }
    loops
}

/// Returns the parts of `set` that are connected by edges, each in increasing order.
fn connected_parts(mesh: &Manifold, set: &VertexSet) -> Vec<Vec<u32>> {
    let c = &mesh.connectivity;
    let all: Vec<u32> = (0..c.vertex_bound()).filter(|&v| set.contains(v)).collect();
    let mut joined = UnionFind::new(c.vertex_bound() as usize);
    for &v in &all {
        c.ring(v).filter(|&w| set.contains(w)).for_each(|w| _ = joined.join(v, w));
    }
    let mut parts: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    all.into_iter().for_each(|v| parts.entry(joined.find(v)).or_default().push(v));
    parts.into_values().collect()
}

/// Returns the largest part of `set` that is connected by edges.
fn largest_part(mesh: &Manifold, set: &VertexSet) -> BTreeSet<u32> {
    connected_parts(mesh, set).into_iter().max_by_key(Vec::len).unwrap_or_default().into_iter().collect()
}

/// A triangle of a strip between two loops: a side on one loop and a vertex of the other.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Outer([usize; 2], usize),
    Inner(usize, [usize; 2]),
}

impl Step {
    /// Returns the triangle, given the vertex numbers of the two loops.
    fn triangle(self, outer: &[u32], inner: &[u32]) -> [u32; 3] {
        match self {
            Step::Outer([i, after], j) => [outer[i], outer[after], inner[j]],
            Step::Inner(i, [j, after]) => [inner[after], inner[j], outer[i]],
        }
    }
}

/// Returns the triangles between two loops that run in the same direction, with the least sum of squared lengths of the
/// joining edges; `None` if the loops are too long.
fn strip(outer: &[DVec3], inner: &[DVec3]) -> Option<Vec<Step>> {
    let (n, m) = (outer.len(), inner.len());
    if n * m > MOST_PAIRS {
        return None;
    }
    // Start at the vertex of the outer loop that is nearest to the first one of the inner loop.
    let start =
        (0..n).min_by(|&i, &j| outer[i].distance_squared(inner[0]).total_cmp(&outer[j].distance_squared(inner[0])))?;
    let of_outer = |i: usize| (start + i) % n;
    let length = |i: usize, j: usize| outer[of_outer(i)].distance_squared(inner[j % m]);
    let at = |i: usize, j: usize| i * (m + 1) + j;
    let mut least = vec![f64::INFINITY; (n + 1) * (m + 1)];
    least[0] = 0.0;
    for i in 0..=n {
        for j in 0..=m {
            let after_outer = if i > 0 { least[at(i - 1, j)] } else { f64::INFINITY };
            let after_inner = if j > 0 { least[at(i, j - 1)] } else { f64::INFINITY };
            if i + j > 0 {
                least[at(i, j)] = after_outer.min(after_inner) + length(i, j);
            }
        }
    }
    let (mut i, mut j) = (n, m);
    let mut steps = Vec::with_capacity(n + m);
    while i + j > 0 {
        if j == 0 || i > 0 && least[at(i - 1, j)] <= least[at(i, j - 1)] {
            i -= 1;
            steps.push(Step::Outer([of_outer(i), of_outer(i + 1)], j % m));
        } else {
            j -= 1;
            steps.push(Step::Inner(of_outer(i), [j, (j + 1) % m]));
        }
    }
    Some(steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::half_edge::OnCurve;
    use crate::mesh::topology::topology;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::optimize::crossings::crossing_faces;
    use crate::testing::{grid, joined};
    use glam::dvec3;

    const WIDTH: f64 = 30.0;

    /// A square sheet of `squares` by `squares` cells, with edges of a length of about 1.
    fn sheet(squares: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
        grid(squares, squares, |u, v| dvec3(WIDTH * u, WIDTH * v, height(WIDTH * u, WIDTH * v)))
    }

    /// An ear in the middle of a sheet.
    fn ear(x: f64, y: f64) -> f64 {
        4.0 * (-((x - 15.0).powi(2) + (y - 15.0).powi(2)) / 4.0).exp()
    }

    fn manifold(domain: &Domain, mesh: &Mesh) -> Manifold {
        Manifold::new(mesh.positions.iter().map(|&p| domain.project_anywhere(p)).collect(), &mesh.triangles)
    }

    /// Euler characteristic, and the numbers of components, boundary loops and faulty edges.
    fn shape(mesh: &Manifold) -> (i64, usize, usize, usize) {
        let mesh = mesh.to_mesh();
        let t = topology(mesh.positions.len(), &mesh.triangles);
        (t.euler, t.components, t.boundary_loops, t.nonmanifold_edges + t.misoriented_edges)
    }

    #[test]
    fn an_ear_that_was_lost_is_there_again() {
        let domain = Domain::new(sheet(60, ear).try_into().unwrap());
        let fine = manifold(&domain, &sheet(30, ear));
        // Another mesh, without the ear.
        let mut mesh = manifold(&domain, &sheet(28, ear));
        mesh.change_samples(|_, sample| sample.position.z = 0.0);
        let before = shape(&mesh);
        let lost = VertexSet::new(&fine, |v| fine.position(v).z > 0.5);
        let new = graft(&domain, &mut mesh, &fine, &lost, 1.0);
        assert!(new.len() > lost.len() && new.len() < 120, "{} {}", new.len(), lost.len());
        let top = (0..mesh.samples().len()).filter(|&v| mesh.connectivity.has_vertex(v as u32));
        assert!(top.map(|v| mesh.samples()[v].position.z).fold(0.0, f64::max) > 3.9);
        assert_eq!(shape(&mesh), before);
        let longest = mesh.edges().map(|h| mesh.length_squared(h).sqrt()).fold(0.0, f64::max);
        assert!(longest < 3.0, "{longest}");
    }

    #[test]
    fn sides_of_a_wall_that_cross_come_apart() {
        // The two sides of a wall.
        let turned = |mut mesh: Mesh| {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            mesh
        };
        let pair = |squares: u32| joined([turned(sheet(squares, |_, _| 0.0)), sheet(squares, |_, _| 0.2)]);
        let domain = Domain::new(pair(60).try_into().unwrap());
        let fine = manifold(&domain, &pair(30));
        let mut mesh = manifold(&domain, &pair(28));
        let through = 14 * 29 + 14;
        mesh.raise(through, 0.5);
        let before = shape(&mesh);
        assert!(!crossing_faces(&domain, &mesh).is_empty());
        let new = graft(&domain, &mut mesh, &fine, &VertexSet::EMPTY, 1.0);
        assert!(!new.is_empty() && crossing_faces(&domain, &mesh).is_empty());
        assert_eq!(shape(&mesh), before);
    }

    #[test]
    fn what_is_right_stays_and_so_does_what_is_on_a_curve() {
        let domain = Domain::new(sheet(60, ear).try_into().unwrap());
        let fine = manifold(&domain, &sheet(30, ear));
        let mut mesh = manifold(&domain, &sheet(28, ear));
        assert!(graft(&domain, &mut mesh, &fine, &VertexSet::EMPTY, 1.0).is_empty());
        let beside_boundary = VertexSet::from_iter([31 * 2 + 2]);
        assert!(graft(&domain, &mut mesh, &fine, &beside_boundary, 1.0).is_empty());
        let mut marked = fine.clone();
        let middle = 15 * 31 + 15;
        marked.connectivity.put_on_curve(middle, OnCurve::Curve(0));
        assert!(graft(&domain, &mut mesh, &marked, &VertexSet::from_iter([middle]), 1.0).is_empty());
        assert!(!graft(&domain, &mut mesh, &fine, &VertexSet::from_iter([middle]), 1.0).is_empty());
    }

    #[test]
    fn a_patch_with_a_hole_has_two_rims_until_it_is_filled() {
        let mesh = sheet(30, |_, _| 0.0);
        let domain = Domain::new(mesh.clone().try_into().unwrap());
        let mesh = manifold(&domain, &mesh);
        let from_middle = |v: u32| mesh.position(v).distance(dvec3(15.0, 15.0, 0.0));
        let ring = (0..31 * 31).filter(|&v| (2.5..8.0).contains(&from_middle(v))).collect();
        let patch = Patch::around(&mesh, ring).unwrap();
        assert_eq!((patch.euler, patch.rims.len()), (0, 2));
        let filled = patch.filled(&mesh, 1).unwrap();
        assert_eq!((filled.euler, filled.rims.len()), (1, 1));
        assert!(
            filled.inner(&mesh).iter().all(|&v| from_middle(v) < 8.0) && filled.inner(&mesh).contains(&(15 * 31 + 15))
        );
    }

    #[test]
    fn a_strip_has_each_side_of_both_loops_once() {
        let circle = |n: usize, radius: f64, turn: f64| -> Vec<DVec3> {
            let angle = |i: usize| turn + std::f64::consts::TAU * i as f64 / n as f64;
            (0..n).map(|i| radius * dvec3(angle(i).cos(), angle(i).sin(), 0.0)).collect()
        };
        let (outer, inner) = (circle(17, 2.0, 0.3), circle(11, 1.0, 1.9));
        let steps = strip(&outer, &inner).unwrap();
        let place = |v: u32| if v < 17 { outer[v as usize] } else { inner[v as usize - 17] };
        let [of_outer, of_inner] = [0..17, 17..28].map(|numbers| numbers.collect::<Vec<u32>>());
        let triangles: Vec<[u32; 3]> = steps.iter().map(|step| step.triangle(&of_outer, &of_inner)).collect();
        let t = topology(28, &triangles);
        assert_eq!(
            (triangles.len(), t.euler, t.boundary_loops, t.nonmanifold_edges, t.misoriented_edges),
            (28, 0, 2, 0, 0)
        );
        for t in triangles {
            let [a, b, c] = t.map(place);
            assert!((b - a).cross(c - a).z > 0.0);
            assert!([a.distance(b), b.distance(c), c.distance(a)].into_iter().all(|length| length < 1.5));
        }
    }
}
