//! The neighbourhood of a vertex or of triangles as a separate manifold, to be changed and put back.

use crate::base::union_find::UnionFind;
use crate::geom::aabb::Aabb;
use crate::geom::intersection::cross_deeper_than;
use crate::manifold::Manifold;
use crate::manifold::faces::Faces;
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::OnCurve;
use crate::mesh::topology::NONE;
use glam::DVec3;
use std::collections::BTreeMap;

/// The triangles around a vertex or some triangles. Their border to the rest stays.
#[derive(Debug, Clone)]
pub struct Neighborhood {
    /// The triangles. Vertices on the border to the rest are corners; the middle, if it is a vertex, is vertex 0.
    pub mesh: Manifold,
    /// The number of each vertex in the whole.
    vertices: Vec<u32>,
    /// The number of each triangle in the whole, in increasing order.
    triangles: Vec<u32>,
}

impl Neighborhood {
    /// Returns the triangles within `rings` rings around vertex `middle`, up to the next feature curves. `None` if `middle`
    /// is on a curve, or a curve ends among the triangles.
    pub fn around(whole: &Manifold, middle: u32, rings: usize) -> Option<Neighborhood> {
        let c = &whole.connectivity;
        let ends = |v: u32| c.is_on_curve(v) || c.is_boundary(v);
        let found = Rings::around(whole, &[middle], rings, ends);
        let is_curve_inside = |h: u32| c.is_curve_edge(h) && c.has_twin(h) && found.has_half_edge(c.twin(h));
        if found.triangles.is_empty() || found.half_edges().any(is_curve_inside) {
            return None;
        }
        let mut neighborhood = Neighborhood::of(whole, found);
        neighborhood.mesh.lock_boundary();
        Some(neighborhood)
    }

    /// Returns the triangles within `rings` rings around triangle `middle`, across feature curves, and more where they would
    /// touch each other only at a vertex. `None` if one of them is `taken`, or they reach an interface.
    pub fn across_curves(
        whole: &Manifold,
        middle: u32,
        rings: usize,
        taken: impl Fn(u32) -> bool,
    ) -> Option<Neighborhood> {
        let c = &whole.connectivity;
        // Quick check, since mostly some are.
        if c.triangle(3 * middle).into_iter().any(|v| has_around(whole, v, rings, &taken)) {
            return None;
        }
        let mut found = Rings::around(whole, &c.triangle(3 * middle), rings, |_| false);
        found.fill_up(whole);
        let is_taken = found.triangles.iter().any(|&t| taken(t));
        if is_taken || found.vertices.iter().any(|&v| c.is_on_interface(v)) {
            return None;
        }
        let border = found.half_edges().filter(|&h| c.has_twin(h) && !found.has_half_edge(c.twin(h)));
        let locked: Vec<u32> = border.flat_map(|h| [c.origin(h), c.target(h)]).map(|v| found.number[&v]).collect();
        let mut neighborhood = Neighborhood::of(whole, found);
        locked.into_iter().for_each(|v| neighborhood.mesh.connectivity.put_on_curve(v, OnCurve::Corner));
        Some(neighborhood)
    }

    /// Returns the triangles within `rings` rings, at least one, around those of `groups`, across feature curves: one
    /// neighborhood for each group, or for several groups whose triangles meet. The border to the rest is an interface.
    pub fn around_groups(whole: &Manifold, groups: &[[u32; 2]], rings: usize) -> Vec<Neighborhood> {
        let c = &whole.connectivity;
        let middle: VertexSet = groups.iter().flatten().flat_map(|&t| c.triangle(3 * t)).collect();
        let mut inner = middle.with_rings(whole, rings - 1);
        loop {
            let touching = VertexSet::new(whole, |v| !inner.contains(v) && touches_itself(whole, v, &inner));
            if touching.is_empty() {
                break;
            }
            inner = &inner | &touching;
        }
        let found: Vec<u32> = whole.triangles().filter(|&t| has_corner_in(whole, t, &inner)).collect();
        let mut parts = UnionFind::new(c.vertex_bound() as usize);
        let joined = found.iter().map(|&t| c.triangle(3 * t).to_vec());
        let grouped = groups.iter().map(|group| group.map(|t| c.triangle(3 * t)[0]).to_vec());
        for vertices in joined.chain(grouped) {
            vertices[1..].iter().for_each(|&v| _ = parts.join(vertices[0], v));
        }
        let mut apart: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for t in found {
            apart.entry(parts.find(c.triangle(3 * t)[0])).or_default().push(t);
        }
        apart.into_values().map(|triangles| Neighborhood::with_interface(whole, triangles)).collect()
    }

    /// Creates a replacement for these `triangles` of the whole, given in increasing order. The first vertices of `mesh` are
    /// those on the `border` to the rest, with these numbers in the whole; its others are new.
    pub fn in_place_of(triangles: Vec<u32>, border: Vec<u32>, mesh: Manifold) -> Neighborhood {
        Neighborhood { mesh, vertices: border, triangles }
    }

    /// Returns these triangles of the whole, given in increasing order, with an interface to the rest.
    fn with_interface(whole: &Manifold, triangles: Vec<u32>) -> Neighborhood {
        let c = &whole.connectivity;
        let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| c.triangle(3 * t)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = vertices.iter().copied().zip(0..).collect();
        let found = Rings { vertices, number, triangles };
        let is_border = |h: u32| c.has_twin(h) && !found.has_half_edge(c.twin(h));
        let border: Vec<u32> =
            (0..).zip(found.half_edges()).filter(|(_, h)| is_border(*h)).map(|(own, _)| own).collect();
        let mut neighborhood = Neighborhood::of(whole, found);
        let c = &mut neighborhood.mesh.connectivity;
        for h in border {
            c.put_half_edge_on_curve(h, OnCurve::Interface);
            [c.origin(h), c.target(h)].into_iter().for_each(|v| c.put_on_curve(v, OnCurve::Corner));
        }
        neighborhood
    }

    /// Returns these triangles of the whole, with no vertex locked yet.
    fn of(whole: &Manifold, Rings { vertices, number, triangles }: Rings) -> Neighborhood {
        let c = &whole.connectivity;
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| c.triangle(3 * t).map(|v| number[&v])).collect();
        let samples = vertices.iter().map(|&v| whole.samples[v as usize]).collect();
        let mut mesh = Manifold::new(samples, &corners);
        let sides = triangles.iter().flat_map(|&t| 3 * t..3 * t + 3);
        for (own, h) in (0..).zip(sides) {
            mesh.connectivity.put_half_edge_on_curve(own, c.curve(h));
        }
        for (own, &v) in (0..).zip(&vertices) {
            mesh.connectivity.put_on_curve(own, c.curve_at(v));
        }
        Neighborhood { mesh, vertices, triangles }
    }

    /// Returns whether it has the triangle with number `t` in the whole.
    pub fn has_triangle(&self, t: u32) -> bool {
        self.triangles.binary_search(&t).is_ok()
    }

    /// Returns the vertices that can move.
    pub fn free_vertices(&self) -> impl Iterator<Item = u32> {
        (0..self.mesh.connectivity.vertex_bound()).filter(|&v| self.mesh.can_move(v, &VertexSet::EMPTY))
    }

    /// Returns the number that half-edge `h` of the whole has here while nothing has changed; `None` if it is not here.
    pub fn own_half_edge(&self, h: u32) -> Option<u32> {
        self.triangles.binary_search(&(h / 3)).ok().map(|own| 3 * own as u32 + h % 3)
    }

    /// Returns the numbers of its triangles in the whole, in increasing order.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Returns whether the whole, with these `faces`, would have more self-intersections if this were put back.
    pub fn adds_self_intersections(&self, faces: &Faces) -> bool {
        let [now, then] = self.self_intersections(faces).map(|crossing| crossing.len());
        then > now
    }

    /// Returns the corners of its faces that intersect others, and of those others: first as they are now, then as they
    /// would be if it were put back in the whole, which has these `faces`.
    pub fn self_intersections(&self, faces: &Faces) -> [Vec<[DVec3; 3]>; 2] {
        let new = self.mesh.to_mesh();
        let Some(bounds) = new.bounds() else { return [Vec::new(), Vec::new()] };
        let (mut now, mut around) = (Vec::new(), Vec::new());
        faces.in_box(&bounds, |t, corners| if self.has_triangle(t) { now.push(corners) } else { around.push(corners) });
        let then = (0..new.triangles.len()).map(|t| new.corners(t)).collect();
        [now, then].map(|own| crossing(&own, &around, faces.depth_of_contact()))
    }

    /// Replaces its triangles in the whole, and marks them, and any added ones, in `touched`. Returns `false`, and does
    /// nothing, if one of the triangles is already marked or an edge would occur twice.
    pub fn put_back(&self, whole: &mut Manifold, touched: &mut Vec<bool>) -> bool {
        if self.triangles.iter().any(|&t| touched[t as usize]) {
            return false;
        }
        let c = &self.mesh.connectivity;
        let mut next = whole.connectivity.vertex_bound();
        let mut added = Vec::new();
        let number: Vec<u32> = (0..c.vertex_bound())
            .map(|v| match self.vertices.get(v as usize) {
                Some(&old) => old,
                None if c.has_vertex(v) => {
                    added.push(v);
                    next += 1;
                    next - 1
                }
                None => NONE,
            })
            .collect();
        let triangle =
            |t: u32| (c.triangle(3 * t).map(|v| number[v as usize]), [0, 1, 2].map(|side| c.curve(3 * t + side)));
        let triangles: Vec<([u32; 3], [OnCurve; 3])> = self.mesh.triangles().map(triangle).collect();
        let curves: Vec<OnCurve> = added.iter().map(|&v| c.curve_at(v)).collect();
        if !whole.connectivity.replace(&self.triangles, &triangles, &curves) {
            return false;
        }
        whole.samples.extend(added.iter().map(|&v| self.mesh.samples[v as usize]));
        for (&v, sample) in self.vertices.iter().zip(&self.mesh.samples) {
            whole.samples[v as usize] = *sample;
        }
        // Vertices on the border keep the curves that they have in the whole.
        for (&v, own) in self.vertices.iter().zip(0..) {
            if c.has_vertex(own) && !c.is_boundary(own) {
                whole.connectivity.put_on_curve(v, c.curve_at(own));
            }
        }
        self.triangles.iter().for_each(|&t| touched[t as usize] = true);
        touched.resize(whole.connectivity.half_edge_bound() as usize / 3, true);
        true
    }
}

/// Returns whether `which` holds for a triangle within `rings` rings around vertex `v`.
fn has_around(mesh: &Manifold, v: u32, rings: usize, which: &impl Fn(u32) -> bool) -> bool {
    let c = &mesh.connectivity;
    c.outgoing(v).any(|h| which(h / 3)) || rings > 1 && c.ring(v).any(|w| has_around(mesh, w, rings - 1, which))
}

fn has_corner_in(mesh: &Manifold, t: u32, set: &VertexSet) -> bool {
    mesh.connectivity.triangle(3 * t).into_iter().any(|v| set.contains(v))
}

/// Returns whether the triangles with a corner in `inner` form more than one fan around `v`, which is not in `inner`, or an
/// edge from `v` to another of their vertices is outside: a new edge inside could duplicate it.
fn touches_itself(mesh: &Manifold, v: u32, inner: &VertexSet) -> bool {
    let c = &mesh.connectivity;
    let is_in = |h: u32| has_corner_in(mesh, h / 3, inner);
    if !c.outgoing(v).any(is_in) {
        return false;
    }
    let across_is_in = |h: u32| c.has_twin(h) && is_in(c.twin(h));
    let fans = c.outgoing(v).filter(|&h| is_in(h) && !across_is_in(h)).count();
    let is_outside = |h: u32| !is_in(h) && !across_is_in(h);
    fans > 1 || c.outgoing(v).any(|h| is_outside(h) && c.outgoing(c.target(h)).any(is_in))
}

/// The triangles around some vertices of a manifold.
struct Rings {
    /// Their vertices, those in the middle first.
    vertices: Vec<u32>,
    /// The index of each in `vertices`.
    number: BTreeMap<u32, u32>,
    /// Their numbers, in increasing order.
    triangles: Vec<u32>,
}

impl Rings {
    /// Returns `rings` rings around the vertices `middle`. They do not continue at a vertex for which `ends` holds.
    fn around(whole: &Manifold, middle: &[u32], rings: usize, ends: impl Fn(u32) -> bool) -> Rings {
        let c = &whole.connectivity;
        let mut vertices = middle.to_vec();
        let mut number: BTreeMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
        let mut triangles = Vec::new();
        let mut begin = 0;
        for _ in 0..rings {
            let end = vertices.len();
            for i in begin..end {
                if ends(vertices[i]) {
                    continue;
                }
                for h in c.outgoing(vertices[i]) {
                    triangles.push(h / 3);
                    for v in c.triangle(h) {
                        number.entry(v).or_insert_with(|| {
                            vertices.push(v);
                            vertices.len() as u32 - 1
                        });
                    }
                }
            }
            begin = end;
        }
        triangles.sort_unstable();
        triangles.dedup();
        Rings { vertices, number, triangles }
    }

    /// Adds what is around vertices at which the triangles form more than one fan, until there are none.
    fn fill_up(&mut self, whole: &Manifold) {
        let c = &whole.connectivity;
        let begins_fan =
            |rings: &Rings, h: u32| rings.has_half_edge(h) && !(c.has_twin(h) && rings.has_half_edge(c.twin(h)));
        loop {
            let fans = |v: u32| c.outgoing(v).filter(|&h| begins_fan(self, h)).count();
            let touching: Vec<u32> = self.vertices.iter().copied().filter(|&v| fans(v) > 1).collect();
            if touching.is_empty() {
                break;
            }
            for h in touching.into_iter().flat_map(|v| c.outgoing(v)) {
                self.triangles.push(h / 3);
                for v in c.triangle(h) {
                    self.number.entry(v).or_insert_with(|| {
                        self.vertices.push(v);
                        self.vertices.len() as u32 - 1
                    });
                }
            }
            self.triangles.sort_unstable();
            self.triangles.dedup();
        }
    }

    fn half_edges(&self) -> impl Iterator<Item = u32> {
        self.triangles.iter().flat_map(|&t| 3 * t..3 * t + 3)
    }

    fn has_half_edge(&self, h: u32) -> bool {
        self.triangles.binary_search(&(h / 3)).is_ok()
    }
}

/// Returns the corners of those faces of `own` that intersect others, in `own` or `around`, deeper than `depth`, and of the
/// faces in `around` that they intersect.
fn crossing(own: &[[DVec3; 3]], around: &[[DVec3; 3]], depth: f64) -> Vec<[DVec3; 3]> {
    let all: Vec<([DVec3; 3], Aabb)> =
        own.iter().chain(around).map(|&corners| (corners, Aabb::of_triangle(corners))).collect();
    let mut crosses = vec![false; all.len()];
    for (i, (a, bounds)) in all[..own.len()].iter().enumerate() {
        for (j, (b, other)) in all.iter().enumerate().skip(i + 1) {
            if !(crosses[i] && crosses[j]) && other.meets(bounds) && cross_deeper_than(depth, *a, *b) {
                (crosses[i], crosses[j]) = (true, true);
            }
        }
    }
    all.into_iter().zip(crosses).filter(|(_, crosses)| *crosses).map(|((corners, _), _)| corners).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::mesh::triangle_mesh::Mesh;
    use crate::surface::domain::Sample;
    use crate::testing::{joined, sheet};

    const WIDTH: u32 = 8;

    /// A flat square of `WIDTH` by `WIDTH` squares, each two triangles.
    fn square() -> Manifold {
        let at = |i: u32, j: u32| i * (WIDTH + 1) + j;
        let all = |n: u32| (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)));
        let sample = |(i, j)| Sample {
            position: DVec3::new(f64::from(i), f64::from(j), 0.0),
            normal: DVec3::Z,
            triangle: 0,
            size: 1.0,
        };
        let halves = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        let triangles: Vec<[u32; 3]> = all(WIDTH).flat_map(halves).collect();
        Manifold::new(all(WIDTH + 1).map(sample).collect(), &triangles)
    }

    /// A tube of `around` times 12 squares, each two triangles.
    fn tube(around: u32) -> Manifold {
        let at = |i: u32, j: u32| j * around + i % around;
        let all = |n: u32| (0..n).flat_map(move |j| (0..around).map(move |i| (i, j)));
        let sample = |(i, j)| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(around)).sin_cos();
            let normal = DVec3::new(cos, sin, 0.0);
            Sample { position: normal + f64::from(j) * DVec3::Z, normal, triangle: 0, size: 1.0 }
        };
        let halves = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        let triangles: Vec<[u32; 3]> = all(12).flat_map(halves).collect();
        Manifold::new(all(13).map(sample).collect(), &triangles)
    }

    const MIDDLE: u32 = 4 * (WIDTH + 1) + 4;

    fn untouched(mesh: &Manifold) -> Vec<bool> {
        vec![false; mesh.connectivity.half_edge_bound() as usize / 3]
    }

    #[test]
    fn around_a_narrow_tube_it_is_filled_up_where_it_would_touch_itself() {
        for around in 3..=9 {
            let mesh = tube(around);
            let place = Neighborhood::across_curves(&mesh, 12 * around, 2, |_| false).unwrap();
            let c = &place.mesh.connectivity;
            let mut corners = vec![0; place.vertices.len()];
            place
                .triangles()
                .iter()
                .zip(0..)
                .for_each(|(_, t)| c.triangle(3 * t).iter().for_each(|&v| corners[v as usize] += 1));
            let is_one_fan = corners.iter().zip(0..).all(|(&count, v)| c.outgoing(v).count() == count);
            assert!(is_one_fan && place.triangles().len() < 24 * around as usize, "{around}");
            assert!(Neighborhood::across_curves(&mesh, 12 * around, 2, |t| t == 12 * around + 1).is_none());
        }
    }

    #[test]
    fn a_vertex_that_becomes_a_corner_of_curves_is_one_when_it_is_put_back() {
        let mut mesh = square();
        let row = |i: u32, j: u32| i * (WIDTH + 1) + j;
        let curve = [(0, 3), (1, 5)]
            .map(|(number, j)| (0..WIDTH).map(move |i| ([row(i, j), row(i + 1, j)], OnCurve::Curve(number))));
        let edges: Vec<_> = curve.into_iter().flatten().collect();
        mesh.mark_curves(&edges, []);
        let h = mesh.connectivity.outgoing(row(4, 3)).find(|&h| mesh.connectivity.target(h) == row(5, 3)).unwrap();
        let mut place = Neighborhood::across_curves(&mesh, h / 3, 3, |_| false).unwrap();
        let own = place.own_half_edge(h).unwrap();
        let top = place.mesh.connectivity.apex(own);
        assert!(place.mesh.connectivity.can_bend(own) && !place.mesh.connectivity.is_boundary(top));
        place.mesh.connectivity.bend(own);
        let top = place.vertices[top as usize];
        assert!(!mesh.connectivity.is_corner(top));
        let mut touched = untouched(&mesh);
        assert!(place.put_back(&mut mesh, &mut touched) && mesh.connectivity.is_corner(top));
    }

    #[test]
    fn an_unchanged_neighborhood_put_back_changes_nothing() {
        let mut mesh = square();
        let before = mesh.to_mesh();
        let neighborhood = Neighborhood::around(&mesh, MIDDLE, 2).unwrap();
        assert_eq!((neighborhood.triangles.len(), neighborhood.free_vertices().count()), (24, 7));
        let mut touched = untouched(&mesh);
        assert!(neighborhood.put_back(&mut mesh, &mut touched));
        let canonical = |triangles: &[[u32; 3]]| {
            let first = |&t: &[u32; 3]| [t, [t[1], t[2], t[0]], [t[2], t[0], t[1]]].into_iter().min();
            let mut all: Vec<Option<[u32; 3]>> = triangles.iter().map(first).collect();
            all.sort_unstable();
            all
        };
        let after = mesh.to_mesh();
        assert_eq!(after.positions, before.positions);
        assert_eq!(canonical(&after.triangles), canonical(&before.triangles));
        assert!(!neighborhood.put_back(&mut mesh, &mut touched), "it has been put back already");
    }

    #[test]
    fn moves_and_flips_in_a_neighborhood_are_put_back() {
        let mut mesh = square();
        let mut neighborhood = Neighborhood::around(&mesh, MIDDLE, 2).unwrap();
        neighborhood.mesh.samples[0].position.z = 0.5;
        let c = &neighborhood.mesh.connectivity;
        let inner = neighborhood.mesh.edges().find(|&h| c.origin(h) == 0 && c.can_flip(h)).unwrap();
        neighborhood.mesh.connectivity.flip(inner);
        let mut touched = untouched(&mesh);
        assert!(neighborhood.put_back(&mut mesh, &mut touched));
        assert_eq!((mesh.position(MIDDLE).z, mesh.connectivity.ring(MIDDLE).count()), (0.5, 5));
        let result = mesh.to_mesh();
        let kind = topology(result.positions.len(), &result.triangles);
        assert!(kind.is_manifold() && kind.is_oriented());
        assert_eq!((kind.euler, kind.boundary_loops), (1, 1));
    }

    #[test]
    fn a_neighborhood_ends_at_curves_and_is_refused_on_one() {
        let mut mesh = square();
        let row = |i: u32| i * (WIDTH + 1) + 5;
        let edges: Vec<([u32; 2], OnCurve)> = (0..WIDTH).map(|i| ([row(i), row(i + 1)], OnCurve::Curve(0))).collect();
        assert!(mesh.mark_curves(&edges, []));
        let neighborhood = Neighborhood::around(&mesh, MIDDLE, 3).unwrap();
        let beyond = neighborhood.vertices.iter().filter(|&&v| v % (WIDTH + 1) > 5).count();
        assert_eq!(beyond, 0);
        assert!(Neighborhood::around(&mesh, row(4), 3).is_none());
    }

    #[test]
    fn a_neighborhood_across_a_curve_is_put_back_with_another_number_of_vertices() {
        let mut mesh = square();
        let row = |i: u32| i * (WIDTH + 1) + 4;
        let edges: Vec<([u32; 2], OnCurve)> = (0..WIDTH).map(|i| ([row(i), row(i + 1)], OnCurve::Curve(0))).collect();
        assert!(mesh.mark_curves(&edges, []));
        let on_curve = |mesh: &Manifold| mesh.edges().filter(|&h| mesh.connectivity.is_curve_edge(h)).count();
        let count = mesh.connectivity.vertex_count();
        let along = |mesh: &Manifold| {
            mesh.connectivity.outgoing(row(4)).find(|&h| mesh.connectivity.target(h) == row(5)).unwrap()
        };
        let side = along(&mesh);
        let mut finer = Neighborhood::across_curves(&mesh, side / 3, 2, |_| false).unwrap();
        let own = finer.own_half_edge(side).unwrap();
        finer.mesh.samples.push(finer.mesh.samples[0]);
        finer.mesh.connectivity.split_edge(own);
        let mut touched = untouched(&mesh);
        assert!(finer.put_back(&mut mesh, &mut touched));
        assert_eq!((mesh.connectivity.vertex_count(), on_curve(&mesh)), (count + 1, edges.len() + 1));
        assert_eq!(touched.len(), untouched(&mesh).len());
        let new = mesh.connectivity.vertex_bound() - 1;
        assert_eq!(mesh.connectivity.curve_at(new), OnCurve::Curve(0));
        let side = mesh.connectivity.outgoing(new).find(|&h| mesh.connectivity.is_curve_edge(h)).unwrap();
        let mut coarser = Neighborhood::across_curves(&mesh, side / 3, 2, |_| false).unwrap();
        let own = coarser.own_half_edge(side).unwrap();
        coarser.mesh.collapse(own);
        let mut touched = untouched(&mesh);
        assert!(coarser.put_back(&mut mesh, &mut touched));
        assert_eq!((mesh.connectivity.vertex_count(), on_curve(&mesh)), (count, edges.len()));
        let result = mesh.to_mesh();
        let kind = topology(result.positions.len(), &result.triangles);
        assert!(kind.is_manifold() && kind.is_oriented() && (kind.euler, kind.boundary_loops) == (1, 1));
    }

    #[test]
    fn neighborhoods_of_groups_have_a_border_that_stays_and_are_put_back() {
        let mut mesh = square();
        let at = |i: u32, j: u32| mesh.connectivity.outgoing(i * (WIDTH + 1) + j).next().unwrap() / 3;
        let [left, right, middle] = [at(1, 1), at(6, 6), at(4, 4)];
        let sizes = |groups: &[[u32; 2]], rings: usize| -> Vec<usize> {
            Neighborhood::around_groups(&mesh, groups, rings).iter().map(|place| place.triangles.len()).collect()
        };
        assert_eq!(sizes(&[[left, left], [right, right]], 1).len(), 2);
        assert_eq!(sizes(&[[left, right]], 1).len(), 1, "a group is one neighborhood");
        assert_eq!(sizes(&[[left, left], [middle, middle], [right, right]], 3).len(), 1, "they meet");
        let mut places = Neighborhood::around_groups(&mesh, &[[middle, middle]], 2);
        let place = &mut places[0];
        let c = &place.mesh.connectivity;
        let inside: Vec<u32> = place.free_vertices().collect();
        assert!((0..c.vertex_bound()).all(|v| c.is_on_interface(v) != inside.contains(&v)) && inside.len() > 6);
        let h = c.outgoing(inside[0]).find(|&h| c.can_collapse(h)).unwrap();
        place.mesh.collapse(h);
        let (count, mut touched) = (mesh.connectivity.vertex_count(), untouched(&mesh));
        assert!(places[0].put_back(&mut mesh, &mut touched));
        assert_eq!(mesh.connectivity.vertex_count(), count - 1);
        let result = mesh.to_mesh();
        let kind = topology(result.positions.len(), &result.triangles);
        assert!(kind.is_manifold() && kind.is_oriented() && (kind.euler, kind.boundary_loops) == (1, 1));
        let on_interface = |v| mesh.connectivity.has_vertex(v) && mesh.connectivity.is_on_interface(v);
        assert!(!(0..mesh.connectivity.vertex_bound()).any(on_interface), "only the part had one");
    }

    #[test]
    fn a_boundary_of_the_whole_may_have_another_number_of_vertices() {
        let mut mesh = square();
        let count = mesh.connectivity.vertex_count();
        let is_middle = |mesh: &Manifold, h: u32| !mesh.connectivity.has_twin(h) && mesh.connectivity.origin(h) == 4;
        let side = mesh.half_edges().find(|&h| is_middle(&mesh, h)).unwrap();
        let mut finer = Neighborhood::across_curves(&mesh, side / 3, 2, |_| false).unwrap();
        let own = finer.own_half_edge(side).unwrap();
        assert!(finer.mesh.can_move(finer.mesh.connectivity.origin(own), &VertexSet::EMPTY));
        finer.mesh.samples.push(finer.mesh.samples[0]);
        finer.mesh.connectivity.split_edge(own);
        let mut touched = untouched(&mesh);
        assert!(finer.put_back(&mut mesh, &mut touched));
        let new = mesh.connectivity.vertex_bound() - 1;
        assert!(mesh.connectivity.is_boundary(new) && mesh.connectivity.vertex_count() == count + 1);
        let side = mesh.half_edges().find(|&h| is_middle(&mesh, h)).unwrap();
        let mut coarser = Neighborhood::across_curves(&mesh, side / 3, 2, |_| false).unwrap();
        let own = coarser.own_half_edge(side).unwrap();
        assert!(coarser.mesh.connectivity.can_collapse(own));
        coarser.mesh.collapse(own);
        let mut touched = untouched(&mesh);
        assert!(coarser.put_back(&mut mesh, &mut touched));
        let result = mesh.to_mesh();
        let kind = topology(result.positions.len(), &result.triangles);
        assert!(kind.is_manifold() && kind.is_oriented() && kind.vertices == count);
        assert_eq!((kind.euler, kind.boundary_loops), (1, 1));
    }

    #[test]
    fn a_vertex_put_through_another_sheet_would_cross_it() {
        const CELLS: u32 = 8;
        let Mesh { positions, triangles } = joined([0.0, 0.01].map(|height| sheet(CELLS, |_, _| height)));
        let first = positions.len() as u32 / 2;
        let samples =
            positions.into_iter().map(|position| Sample { position, normal: DVec3::Z, triangle: 0, size: 1.0 });
        let mesh = Manifold::new(samples.collect(), &triangles);
        let mut neighborhood = Neighborhood::around(&mesh, first / 2, 2).unwrap();
        let faces = Faces::new(&mesh);
        for (height, crosses) in [(0.0, false), (0.009, false), (0.02, true)] {
            neighborhood.mesh.samples[0].position.z = height;
            assert_eq!(neighborhood.adds_self_intersections(&faces), crosses, "{height}");
        }
    }
}
