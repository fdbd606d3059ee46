//! Reduces irregular vertices by flips, glides and collapses.
//!
//! An inner vertex with a number of edges other than six is a defect; its excess e is the number of edges too many. A vertex
//! on a curve (boundary or sharp edge) has a fan of triangles on each side of the curve, ideally with as many triangles as
//! angles of 60 degrees fit into it: each fan has its own excess. The energy is the sum of e². Three kinds of moves lower
//! it:
//!
//! 1. *Flips* of an edge from a to b, with c and d opposite, change it by 4 + 2 (e_c + e_d - e_a - e_b).
//! 2. *Glides*: flips that keep the energy unchanged move a pair of a 5 and a 7 along its row. A bounded search follows them
//!    to where the pair meets another defect and a flip lowers the energy; if it finds none, everything is undone.
//! 3. *Collapses* of edges, while the number of vertices is not final. They do what no glide can: end a row.
//!
//! The rows along which a pair has moved are sheared and need room to straighten before they are Delaunay again. So
//! relaxation has to follow, with flips that add nothing to the energy (`Flips::KeepValence` in `relax.rs`).
//!
//! On a coarse mesh, only adjacent defects should meet: long glides there remove pairs that ease strain, and every triangle
//! around is the worse for it.
//!
//! Based on: Y. Li, E. Zhang, Y. Kobayashi, P. Wonka, Editing operations for irregular vertices in triangle meshes, 2010,
//! DOI 10.1145/1882261.1866179. Departure: edits made there by hand or along chosen paths are searched for here.
//!
//! Cost: linear in the edges per pass, and some hundred flips tried for each defect.
//!
//! Limits: defects required by curvature stay, and so do those next to locked vertices.

use crate::geom::triangle::angles;
use crate::manifold::Manifold;
use crate::manifold::facing::{FacingGuard, LEAST_MENDABLE};
use crate::manifold::vertex_set::VertexSet;
use crate::mesh::half_edge::{Connectivity, next, prev};
use crate::mesh::sides::lower_first;
use glam::DVec3;

/// Valence of a regular inner vertex.
const REGULAR: i32 = 6;

/// Maximum number of flips in a glide, and of flips that the search for one may try: a pair has one way to go, sometimes
/// two.
const LONGEST_GLIDE: usize = 12;
const MOST_TRIES: usize = 40;

/// Number of flips per edge after which flipping ends at the latest.
const FLIPS_PER_EDGE: usize = 20;

/// Minimum cosine of the angle between the normals at the ends of an edge that a pair glides over or at a removed vertex: 60
/// degrees. Glides around the end of a spike would shorten it.
const FLAT: f64 = 0.5;

/// Maximum distance, in spacings, of a removed vertex from the mesh.
const TOLERANCE: f64 = 0.25;

/// Lowers the energy of the fine mesh by flips, and by glides of up to a dozen flips that begin at vertices in `wide`.
/// Between nearby curves, glides would shear rows that have no room to straighten.
pub fn remove_defects(mesh: &mut Manifold, locked: &VertexSet, wide: &VertexSet) {
    let mut defects = Defects::new(mesh);
    defects.flip_down(mesh.edges().collect(), mesh);
    defects.glide_all(mesh, locked, wide);
}

/// Lowers the energy of a mesh whose number of vertices is not final: by flips, and by collapses of vertices that are not
/// `locked`.
pub fn remove_near_defects(mesh: &mut Manifold, locked: &VertexSet, spacing: f64) {
    let mut defects = Defects::new(mesh);
    defects.flip_down(mesh.edges().collect(), mesh);
    defects.collapse_down(mesh, locked, spacing);
}

/// The excess of each vertex that is not on a curve, kept up to date with the mesh.
pub(super) struct Defects {
    excess: Vec<i32>,
    /// Number of flips that may still be made to lower the energy. Each lowers it by at least two, so there can be no more
    /// than half of the initial energy. But the angles of a fan change with its triangles, and then a flip may raise what
    /// another lowers.
    flips_left: usize,
}

impl Defects {
    pub(super) fn new(mesh: &Manifold) -> Defects {
        let c = &mesh.connectivity;
        let excess = |v: u32| if c.has_vertex(v) { c.valence(v) as i32 - REGULAR } else { 0 };
        let excess: Vec<i32> = (0..c.vertex_bound()).map(excess).collect();
        let energy: usize = excess.iter().map(|&e| e.unsigned_abs() as usize).map(|e| e * e).sum();
        Defects { excess, flips_left: energy / 2 + c.half_edge_bound() as usize }
    }

    /// Returns the excess at the origin of `h`, on the side of the curve where the triangle of `h` is.
    #[inline]
    fn at(&self, mesh: &Manifold, h: u32) -> i32 {
        let v = mesh.connectivity.origin(h);
        if mesh.connectivity.is_on_curve(v) { excess_of_fan(mesh, h) } else { self.excess[v as usize] }
    }

    /// Returns the change in energy if the edge of `h`, which has two faces, is flipped.
    #[inline]
    fn rise(&self, mesh: &Manifold, h: u32) -> i32 {
        let g = mesh.connectivity.twin(h);
        let (ends, tops) = (self.at(mesh, h) + self.at(mesh, g), self.at(mesh, prev(h)) + self.at(mesh, prev(g)));
        4 + 2 * (tops - ends)
    }

    fn flip(&mut self, c: &mut Connectivity, h: u32) {
        let [a, b, top] = c.triangle(h);
        for (v, change) in [(a, -1), (b, -1), (top, 1), (c.apex(c.twin(h)), 1)] {
            self.excess[v as usize] += change;
        }
        c.flip(h);
    }

    /// Undoes the flip of `h`: with three more flips, even the numbers of the half-edges are the same as before.
    fn flip_back(&mut self, c: &mut Connectivity, h: u32) {
        (0..3).for_each(|_| self.flip(c, h));
    }

    /// Flips edges that lower the energy until there are none, beginning with those in `queue`.
    fn flip_down(&mut self, mut queue: Vec<u32>, mesh: &mut Manifold) {
        while let Some(h) = queue.pop().filter(|_| self.flips_left > 0) {
            let c = &mesh.connectivity;
            if c.has_half_edge(h)
                && c.has_twin(h)
                && self.rise(mesh, h) < 0
                && mesh.flip_leaves_mendable(h, FacingGuard::CAREFUL)
            {
                self.flips_left -= 1;
                self.flip(&mut mesh.connectivity, h);
                queue.extend(touched(&mesh.connectivity, h));
            }
        }
    }

    /// Flips edges that are not Delaunay, unless that raises the energy.
    pub(super) fn flip_level(&mut self, mesh: &mut Manifold) {
        let mut queue: Vec<u32> = mesh.edges().collect();
        let mut left = FLIPS_PER_EDGE * queue.len();
        while let Some(h) = queue.pop() {
            let c = &mesh.connectivity;
            if left > 0
                && c.has_twin(h)
                && mesh.breaks_delaunay(h)
                && self.rise(mesh, h) <= 0
                && mesh.flip_leaves_mendable(h, FacingGuard::CAREFUL)
            {
                let g = c.twin(h);
                self.flip(&mut mesh.connectivity, h);
                queue.extend([next(h), prev(h), next(g), prev(g)]);
                left -= 1;
            }
        }
    }

    fn glide_all(&mut self, mesh: &mut Manifold, locked: &VertexSet, wide: &VertexSet) {
        for h in 0..mesh.connectivity.half_edge_bound() {
            let c = &mesh.connectivity;
            if !c.has_half_edge(h) || !c.has_twin(h) || h > c.twin(h) || self.rise(mesh, h) != 0 {
                continue;
            }
            if !wide.contains(mesh.connectivity.origin(h)) || !may_glide(mesh, locked, h) {
                continue;
            }
            let mut glide = Glide { locked, flipped: Vec::new(), gone: Vec::new(), tries: MOST_TRIES };
            if self.glide(mesh, h, &mut glide) {
                let around = glide.flipped.iter().flat_map(|&h| touched(&mesh.connectivity, h)).collect();
                self.flip_down(around, mesh);
            }
        }
    }

    /// Flips `h` and further edges until the energy is lower; flips none if that cannot be reached.
    fn glide(&mut self, mesh: &mut Manifold, h: u32, glide: &mut Glide<'_>) -> bool {
        glide.tries -= 1;
        let lower = self.rise(mesh, h) < 0;
        glide.gone.push(ends(&mesh.connectivity, h));
        glide.flipped.push(h);
        self.flip(&mut mesh.connectivity, h);
        if lower || self.glide_on(mesh, h, glide) {
            return true;
        }
        self.flip_back(&mut mesh.connectivity, h);
        glide.flipped.pop();
        glide.gone.pop();
        false
    }

    fn glide_on(&mut self, mesh: &mut Manifold, h: u32, glide: &mut Glide<'_>) -> bool {
        if glide.flipped.len() >= LONGEST_GLIDE {
            return false;
        }
        let c = &mesh.connectivity;
        let mut ways: Vec<(i32, u32)> = touched(c, h)
            .filter(|&g| c.has_twin(g))
            .map(|g| (self.rise(mesh, g), g))
            .filter(|&(rise, g)| rise <= 0 && !glide.gone.contains(&ends_after(c, g)))
            .collect();
        ways.sort_unstable();
        ways.dedup_by_key(|way| way.1.min(c.twin(way.1)));
        ways.into_iter().any(|(_, g)| glide.tries > 0 && may_glide(mesh, glide.locked, g) && self.glide(mesh, g, glide))
    }

    /// Collapses edges that lower the energy, those that lower it most first.
    fn collapse_down(&mut self, mesh: &mut Manifold, locked: &VertexSet, spacing: f64) {
        let rise = |h| (self.rise_of_collapse(mesh, h), h);
        let mut falls: Vec<(i32, u32)> = mesh.half_edges().map(rise).filter(|(rise, _)| *rise < 0).collect();
        falls.sort_unstable();
        for (_, h) in falls {
            if mesh.connectivity.has_half_edge(h)
                && self.rise_of_collapse(mesh, h) < 0
                && may_collapse(mesh, locked, h, spacing)
            {
                self.collapse(mesh, h);
            }
        }
    }

    /// Returns the change in energy if the origin of `h` merges into its target.
    fn rise_of_collapse(&self, mesh: &Manifold, h: u32) -> i32 {
        let c = &mesh.connectivity;
        if !c.has_twin(h) {
            return 0;
        }
        let [a, b, top] = [h, next(h), prev(h)].map(|h| self.at(mesh, h));
        let bottom = self.at(mesh, prev(c.twin(h)));
        (a + b + 2).pow(2) - a * a - b * b + 2 - 2 * (top + bottom)
    }

    fn collapse(&mut self, mesh: &mut Manifold, h: u32) {
        let c = &mesh.connectivity;
        let [a, b, top] = c.triangle(h);
        let bottom = c.apex(c.twin(h));
        self.excess[b as usize] += self.excess[a as usize] + 2;
        self.excess[a as usize] = 0;
        [top, bottom].into_iter().for_each(|v| self.excess[v as usize] -= 1);
        mesh.connectivity.collapse(h);
        self.flip_down(mesh.connectivity.outgoing(b).flat_map(|h| [h, next(h)]).collect(), mesh);
    }
}

/// The flips of a glide so far, and the edges that they removed, which must not come back.
struct Glide<'a> {
    /// No glide goes past these vertices.
    locked: &'a VertexSet,
    flipped: Vec<u32>,
    gone: Vec<[u32; 2]>,
    tries: usize,
}

/// Returns how many triangles there are around the origin of `h`, between the curves on either side of the triangle of `h`,
/// in excess of the number of angles of 60 degrees that fit.
fn excess_of_fan(mesh: &Manifold, h: u32) -> i32 {
    let c = &mesh.connectivity;
    let ends = |h: u32| c.is_curve_edge(h) || !c.has_twin(h);
    let mut first = h;
    while !ends(first) {
        first = next(c.twin(first));
        if first == h {
            break;
        }
    }
    let (mut count, mut room, mut at) = (0, 0.0, first);
    loop {
        count += 1;
        room += angles(c.triangle(at).map(|v| mesh.position(v)))[0];
        if ends(prev(at)) {
            break;
        }
        at = c.twin(prev(at));
        if at == first {
            break;
        }
    }
    count - ((room / 60.0).round() as i32).max(1)
}

fn ends(c: &Connectivity, h: u32) -> [u32; 2] {
    lower_first([c.origin(h), c.target(h)])
}

/// Returns the ends of the edge of `h` after a flip.
fn ends_after(c: &Connectivity, h: u32) -> [u32; 2] {
    lower_first([c.apex(h), c.apex(c.twin(h))])
}

/// Returns the edges whose flip has another effect after that of `h`: those at and opposite its four vertices, or three if
/// later flips have put it on the boundary.
fn touched(c: &Connectivity, h: u32) -> impl Iterator<Item = u32> {
    let across = c.has_twin(h).then(|| c.apex(c.twin(h)));
    let corners = c.triangle(h).into_iter().chain(across);
    corners.flat_map(move |v| c.outgoing(v).flat_map(|h| [h, next(h)]))
}

/// Returns the cosine of the angle between the normals of two vertices; 1 if one is on a sharp edge and has no normal.
fn normal_cosine(mesh: &Manifold, v: u32, w: u32) -> f64 {
    let [n, m] = [v, w].map(|v| mesh.sample(v).normal);
    if n == DVec3::ZERO || m == DVec3::ZERO { 1.0 } else { n.dot(m) }
}

/// Returns whether a pair may glide over the edge of `h`: the surface is flat enough, and the vertices are free to move
/// afterwards.
fn may_glide(mesh: &Manifold, locked: &VertexSet, h: u32) -> bool {
    let c = &mesh.connectivity;
    let [a, b, top] = c.triangle(h);
    let bottom = c.apex(c.twin(h));
    let free = [a, b, top, bottom].into_iter().all(|v| !locked.contains(v));
    free && normal_cosine(mesh, a, b).min(normal_cosine(mesh, top, bottom)) >= FLAT
        && mesh.flip_leaves_mendable(h, FacingGuard::CAREFUL)
}

/// Returns whether the origin of `h` is free, and the surface does not miss it if it merges into the target.
fn may_collapse(mesh: &Manifold, locked: &VertexSet, h: u32, spacing: f64) -> bool {
    let c = &mesh.connectivity;
    let a = c.origin(h);
    if locked.contains(a)
        || c.is_on_curve(a)
        || !c.can_collapse(h)
        || c.ring(a).any(|w| normal_cosine(mesh, a, w) < FLAT)
    {
        return false;
    }
    let (facing, shape) = mesh.after_collapse(h);
    FacingGuard::CAREFUL.passes(facing)
        && shape >= LEAST_MENDABLE
        && mesh.distance_after_collapse(h) <= TOLERANCE * spacing * mesh.sample(a).size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;
    use crate::surface::domain::Sample;
    use glam::DVec3;

    const SIZE: u32 = 12;

    /// A flat sheet of equilateral triangles, `SIZE` by `SIZE` pairs of them.
    fn sheet() -> Manifold {
        let at = |i: u32, j: u32| i * (SIZE + 1) + j;
        let place = |i: u32, j: u32| DVec3::new(f64::from(j) + 0.5 * f64::from(i), 0.75f64.sqrt() * f64::from(i), 0.0);
        let pairs = (0..SIZE).flat_map(|i| (0..SIZE).map(move |j| (i, j)));
        let triangles: Vec<[u32; 3]> = pairs
            .flat_map(|(i, j)| [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]])
            .collect();
        let samples = (0..=SIZE).flat_map(|i| (0..=SIZE).map(move |j| (i, j)));
        let samples =
            samples.map(|(i, j)| Sample { position: place(i, j), normal: DVec3::Z, triangle: 0, size: 1.0 }).collect();
        let mut mesh = Manifold::new(samples, &triangles);
        mesh.lock_boundary();
        mesh
    }

    /// Sum of the squared excesses of all inner vertices.
    fn energy(mesh: &Manifold) -> i32 {
        let c = &mesh.connectivity;
        (0..c.vertex_bound())
            .filter(|&v| c.has_vertex(v) && !c.is_boundary(v))
            .map(|v| (c.valence(v) as i32 - REGULAR).pow(2))
            .sum()
    }

    /// Flips the edge between these two vertices.
    fn flip(mesh: &mut Manifold, v: u32, w: u32) {
        let h = mesh.connectivity.outgoing(v).find(|&h| mesh.connectivity.target(h) == w).unwrap();
        mesh.connectivity.flip(h);
    }

    /// Flipping adjacent edges along a row drives two pairs apart, and only a glide brings them together again.
    #[test]
    fn pairs_that_were_driven_apart_meet_again() {
        for length in 1..6 {
            let mut mesh = sheet();
            let row = |j: u32| [(6 * (SIZE + 1)) + j, 7 * (SIZE + 1) + j];
            for j in 3..3 + length {
                flip(&mut mesh, row(j)[0], row(j)[1]);
            }
            assert_eq!(energy(&mesh), 4, "{length}");
            let everywhere = VertexSet::all(&mesh);
            remove_defects(&mut mesh, &VertexSet::EMPTY, &everywhere);
            assert_eq!(energy(&mesh), 0, "{length}");
        }
    }

    #[test]
    fn a_locked_vertex_lets_no_pair_pass() {
        let mut mesh = sheet();
        (3..8).for_each(|j| flip(&mut mesh, 6 * (SIZE + 1) + j, 7 * (SIZE + 1) + j));
        let before = mesh.connectivity.clone();
        let all = VertexSet::all(&mesh);
        remove_defects(&mut mesh, &all, &all);
        assert_eq!(mesh.connectivity.compact(), before.compact());
    }

    /// A vertex inserted on an edge has four edges, and is removed again.
    #[test]
    fn an_inserted_vertex_is_collapsed() {
        let mut mesh = sheet();
        let h = mesh.edges().find(|&h| mesh.connectivity.origin(h) == 6 * (SIZE + 1) + 6).unwrap();
        let middle = 0.5 * (mesh.position(mesh.connectivity.origin(h)) + mesh.position(mesh.connectivity.target(h)));
        mesh.split_at(Sample { position: middle, normal: DVec3::Z, triangle: 0, size: 1.0 }, h);
        assert!(energy(&mesh) > 0);
        remove_near_defects(&mut mesh, &VertexSet::EMPTY, 1.0);
        assert_eq!(energy(&mesh), 0);
        let made = mesh.to_mesh();
        let t = topology(made.positions.len(), &made.triangles);
        assert!(t.is_manifold() && t.is_oriented() && t.euler == 1, "{t:?}");
    }

    /// Each flip of a failed glide is undone, down to the numbers of half-edges.
    #[test]
    fn a_flip_taken_back_leaves_no_trace() {
        let mut mesh = sheet();
        let mut defects = Defects::new(&mesh);
        let before = mesh.connectivity.compact();
        for h in mesh.edges().filter(|&h| mesh.connectivity.has_twin(h)).collect::<Vec<_>>() {
            if mesh.connectivity.can_flip(h) {
                defects.flip(&mut mesh.connectivity, h);
                defects.flip_back(&mut mesh.connectivity, h);
            }
        }
        assert_eq!(mesh.connectivity.compact(), before);
        assert_eq!(defects.excess, Defects::new(&mesh).excess);
    }
}
