//! A coarser mesh of the same surface, where its edges are far shorter than those that the result is to have.
//!
//! What takes time with the sampled surface (samples, walks, projections) does so triangle by triangle; those far smaller than
//! the spacing tell nothing that the result could follow. Here edges collapse into one of their ends, the shortest ones first,
//! until those left are long enough, as long as the vertex that goes stays near to the surface that is left.
//!
//! The triangles are treated in blocks that are near in space, beside each other. Vertices that blocks share stay. So there are
//! two turns, with blocks of other bounds.
//!
//! Vertices that are left stay where they are. The link condition keeps the topology. Those on the boundary stay, and those on
//! sharp edges go along these only: where the fine mesh turns is told better than where the coarse one does.
//!
//! Based on: P. Lindstrom, G. Turk, Fast and memory efficient polygonal simplification, 1998, DOI 10.1109/VISUAL.1998.745314,
//! in that the error is that of the mesh so far. Departure: an end instead of the best place, so that no noise is invented and
//! each vertex is one of the input.
//!
//! Cost: sorting the triangles, and about a microsecond for each vertex that goes; linear.

use crate::base::math;
use crate::geom::aabb::Aabb;
use crate::geom::triangle::{closest_point, mean_ratio};
use crate::mesh::half_edge::{Connectivity, OnCurve, next};
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::Provenance;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::spatial::order::spatial_order_in;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::borrow::Cow;

/// How coarse a mesh may become, in its units.
#[derive(Debug, Clone, Copy)]
pub struct Coarseness {
    /// The length that edges are to have at least.
    pub shortest: f64,
    /// About how far vertices that go may be from the surface that is left: what strays in one step counts in the next, but
    /// not how triangles of vertices that stay move away later.
    pub tolerance: f64,
}

/// Triangles of a block: its data fit into the caches of a core.
const BLOCK: usize = 1 << 15;

/// How far the bounds that blocks of the second turn are cut from reach beyond those of the mesh, in extents: planes between
/// blocks of the first turn are none of this one.
const MARGIN: f64 = 1.0 / 3.0;

/// The shares of the shortest length that edges are held against one after the other, so that the shortest ones go first.
const LENGTHS: [f64; 3] = [0.25, 0.5, 1.0];

/// Longest edge that a collapse may leave, in shortest lengths.
const LONGEST: f64 = 2.0;

/// How much a triangle may turn: the cosine.
const MOST_TURN: f64 = 0.5;

/// Least mean ratio of a triangle that a collapse leaves, unless one there is worse.
const LEAST_SHAPE: f64 = 0.3;

/// A mesh with longer edges.
pub struct Coarsened {
    /// Some of the vertices of the fine mesh, which is its source; a triangle is only near to the one that it came from.
    pub mesh: OrientedManifold,
    /// The ends of each sharp edge, as vertices of the fine mesh.
    pub sharp: Vec<[u32; 2]>,
}

/// The triangles and vertices of `mesh` along a curve through space: what is near in it is mostly near in memory.
pub fn in_spatial_order(mesh: OrientedManifold) -> OrientedManifold {
    let order = mesh.bounds().map_or(Vec::new(), |bounds| order_of_triangles(&mesh, bounds));
    let mut number = vec![NONE; mesh.positions.len()];
    let mut vertices = Vec::with_capacity(mesh.positions.len());
    let mut numbered = |v: u32| {
        if number[v as usize] == NONE {
            number[v as usize] = vertices.len() as u32;
            vertices.push(v);
        }
        number[v as usize]
    };
    let triangles = order.iter().map(|&t| mesh.triangles[t as usize].map(&mut numbered)).collect();
    let positions = vertices.iter().map(|&v| mesh.positions[v as usize]).collect();
    let provenance = mesh.into_parts().1.select(&vertices, &order);
    OrientedManifold::trusted(Mesh { positions, triangles }, provenance)
}

/// `fine` with longer edges. `sharp` tells for each side of its triangles whether it is on a sharp edge. Triangles that are near
/// in memory should be near in space, as [`in_spatial_order`] has them.
pub fn coarsened(fine: &Mesh, sharp: &[bool], coarseness: Coarseness) -> Coarsened {
    let all = |n: usize| (0..n as u32).collect::<Vec<u32>>();
    let (vertices, triangles) = (fine.positions.len(), fine.triangles.len());
    let whole = Coarse {
        mesh: Cow::Borrowed(fine),
        sharp: Cow::Borrowed(sharp.as_chunks().0),
        of_vertex: all(vertices),
        of_triangle: all(triangles),
        strayed: vec![0.0; vertices],
    };
    let once = whole.turn(&whole.of_triangle, coarseness);
    drop(whole);
    let coarse = once.turn(&once.in_other_order(), coarseness);
    let sharp = coarse.sharp_edges();
    let Coarse { mesh, of_vertex, of_triangle, .. } = coarse;
    let provenance = Provenance::new(all(vertices), of_vertex, of_triangle);
    Coarsened { mesh: OrientedManifold::trusted(mesh.into_owned(), provenance), sharp }
}

/// The triangles of `mesh` in the order of where they are within `bounds`.
fn order_of_triangles(mesh: &Mesh, bounds: Aabb) -> Vec<u32> {
    let first = |t: usize| mesh.positions[mesh.triangles[t][0] as usize];
    spatial_order_in(bounds, mesh.triangles.len(), first)
}

/// Puts the sides that are `sharp`, triangle by triangle, on curves, which end at vertices with more or less than two of them.
fn mark_sharp(connectivity: &mut Connectivity, sharp: impl Iterator<Item = [bool; 3]>) {
    let mut at = vec![0u32; connectivity.vertex_bound() as usize];
    for (h, _) in (0u32..).zip(sharp.flatten()).filter(|side| side.1) {
        at[connectivity.origin(h) as usize] += 1;
        connectivity.put_half_edge_on_curve(h, OnCurve::Curve(0));
    }
    for v in (0..connectivity.vertex_bound()).filter(|&v| at[v as usize] > 0) {
        let curve = if at[v as usize] == 2 { OnCurve::Curve(0) } else { OnCurve::Corner };
        connectivity.put_on_curve(v, curve);
    }
}

/// How many of the edges of `mesh` are shorter than `length`, as a share.
pub fn share_of_edges_below(mesh: &Mesh, length: f64) -> f64 {
    let is_short =
        |[a, b]: [u32; 2]| mesh.positions[a as usize].distance_squared(mesh.positions[b as usize]) < length * length;
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].into_iter().filter(|&side| is_short(side)).count();
    let short: usize = mesh.triangles.par_iter().map(sides).sum();
    short as f64 / (3 * mesh.triangles.len()).max(1) as f64
}

/// A mesh on its way.
struct Coarse<'a> {
    mesh: Cow<'a, Mesh>,
    /// For each triangle which of its sides are on sharp edges.
    sharp: Cow<'a, [[bool; 3]]>,
    /// For each vertex and triangle that of the fine mesh.
    of_vertex: Vec<u32>,
    of_triangle: Vec<u32>,
    /// For each vertex how far those that went into it may be from the surface.
    strayed: Vec<f64>,
}

impl Coarse<'_> {
    /// Treats blocks of the triangles, which come in this order.
    fn turn(&self, order: &[u32], coarseness: Coarseness) -> Coarse<'static> {
        let treat = |triangles: &[u32]| {
            let mut block = Block::new(self, triangles);
            block.coarsen(coarseness);
            block.left(triangles)
        };
        let blocks: Vec<Left> = order.par_chunks(BLOCK).map(treat).collect();
        self.joined(&blocks)
    }

    /// The triangles in the order of where they are within wider bounds.
    fn in_other_order(&self) -> Vec<u32> {
        let Some(mut bounds) = self.mesh.bounds() else { return Vec::new() };
        bounds.lo -= MARGIN * bounds.size();
        order_of_triangles(&self.mesh, bounds)
    }

    /// The ends of each sharp edge, as vertices of the fine mesh.
    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        let sides = self.mesh.triangles.iter().zip(&*self.sharp).flat_map(|(t, sharp)| {
            let ends = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
            ends.into_iter().zip(*sharp).filter(|(_, sharp)| *sharp).map(|(ends, _)| ends)
        });
        // The triangle across has the same edge the other way.
        sides.filter(|[a, b]| a < b).map(|ends| ends.map(|v| self.of_vertex[v as usize])).collect()
    }

    /// What is left of all blocks, without gaps.
    fn joined(&self, blocks: &[Left]) -> Coarse<'static> {
        let mut number = vec![NONE; self.mesh.positions.len()];
        let mut old = Vec::new();
        let mut triangles = Vec::with_capacity(blocks.iter().map(|block| block.triangles.len()).sum());
        for corners in blocks.iter().flat_map(|block| &block.triangles) {
            triangles.push(corners.map(|v| {
                if number[v as usize] == NONE {
                    number[v as usize] = old.len() as u32;
                    old.push(v);
                }
                number[v as usize]
            }));
        }
        let mut strayed = self.strayed.clone();
        blocks.iter().flat_map(|block| &block.strayed).for_each(|&(v, far)| strayed[v as usize] = far);
        let of_triangle = blocks.iter().flat_map(|block| &block.sources).map(|&t| self.of_triangle[t as usize]);
        Coarse {
            sharp: blocks.iter().flat_map(|block| &block.sharp).copied().collect(),
            of_triangle: of_triangle.collect(),
            of_vertex: old.iter().map(|&v| self.of_vertex[v as usize]).collect(),
            strayed: old.iter().map(|&v| strayed[v as usize]).collect(),
            mesh: Cow::Owned(Mesh {
                positions: old.iter().map(|&v| self.mesh.positions[v as usize]).collect(),
                triangles,
            }),
        }
    }
}

/// What is left of a block, with the vertices and triangles of the mesh before.
struct Left {
    triangles: Vec<[u32; 3]>,
    sharp: Vec<[bool; 3]>,
    sources: Vec<u32>,
    strayed: Vec<(u32, f64)>,
}

/// Some triangles of a mesh, with vertices of their own. The boundary is that of the mesh, and where other blocks begin.
struct Block {
    connectivity: Connectivity,
    positions: Vec<DVec3>,
    strayed: Vec<f64>,
    /// For each vertex that of the mesh.
    vertices: Vec<u32>,
}

impl Block {
    /// That of `triangles` of `whole`.
    fn new(whole: &Coarse, triangles: &[u32]) -> Block {
        let mut number: FxHashMap<u32, u32> = FxHashMap::default();
        number.reserve(triangles.len());
        let mut vertices = Vec::new();
        let mut local = |v: u32| {
            *number.entry(v).or_insert_with(|| {
                vertices.push(v);
                vertices.len() as u32 - 1
            })
        };
        let corners: Vec<[u32; 3]> =
            triangles.iter().map(|&t| whole.mesh.triangles[t as usize].map(&mut local)).collect();
        let mut connectivity = Connectivity::new(vertices.len(), &corners);
        mark_sharp(&mut connectivity, triangles.iter().map(|&t| whole.sharp[t as usize]));
        Block {
            connectivity,
            positions: vertices.iter().map(|&v| whole.mesh.positions[v as usize]).collect(),
            strayed: vertices.iter().map(|&v| whole.strayed[v as usize]).collect(),
            vertices,
        }
    }

    fn coarsen(&mut self, coarseness: Coarseness) {
        for share in LENGTHS {
            let square = math::square(share * coarseness.shortest);
            for h in 0..self.connectivity.half_edge_bound() {
                if self.connectivity.has_half_edge(h) && self.length_squared(h) < square {
                    self.collapse_if_near(h, coarseness);
                }
            }
        }
    }

    fn position(&self, v: u32) -> DVec3 {
        self.positions[v as usize]
    }

    fn length_squared(&self, h: u32) -> f64 {
        self.position(self.connectivity.origin(h)).distance_squared(self.position(self.connectivity.target(h)))
    }

    /// Collapses the edge of `h` into its target, if the origin is near enough to what is left then.
    fn collapse_if_near(&mut self, h: u32, coarseness: Coarseness) {
        let c = &self.connectivity;
        let (from, to) = (c.origin(h), c.target(h));
        if c.is_boundary(from) || c.is_boundary(to) {
            return;
        }
        let Some(distance) = self.distance_after(h, LONGEST * coarseness.shortest) else { return };
        let strayed = self.strayed[from as usize] + distance;
        if strayed <= coarseness.tolerance && self.keeps_topology(h) {
            self.connectivity.collapse(h);
            self.strayed[to as usize] = self.strayed[to as usize].max(strayed);
        }
    }

    /// Whether a collapse keeps the topology of the whole, of which vertices on the boundary may have edges that are not here.
    fn keeps_topology(&self, h: u32) -> bool {
        let c = &self.connectivity;
        c.both_sides(h).all(|side| c.valence(c.apex(side)) > 3) && c.can_collapse(h)
    }

    /// How far the origin of `h` is from the triangles that are left around it once it went into the target; `None` if one of
    /// these turns, is too long or badly shaped.
    fn distance_after(&self, h: u32, longest: f64) -> Option<f64> {
        let c = &self.connectivity;
        let (from, to) = (self.position(c.origin(h)), self.position(c.target(h)));
        let fan = || c.outgoing(c.origin(h)).map(|out| (out, [c.target(out), c.apex(out)].map(|v| self.position(v))));
        let left = || fan().filter(|&(out, _)| out != h && next(c.twin(h)) != out).map(|(_, ends)| ends);
        let mut least = f64::INFINITY;
        for [a, b] in left() {
            let [before, after] = [from, to].map(|p| (a - p).cross(b - p));
            let is_too_long = a.distance_squared(to) > longest * longest;
            if is_too_long || before.dot(after) < MOST_TURN * before.length() * after.length() {
                return None;
            }
            least = least.min(mean_ratio([to, a, b]));
        }
        let least_before = || fan().map(|(_, [a, b])| mean_ratio([from, a, b])).fold(f64::INFINITY, f64::min);
        if least < LEAST_SHAPE && least < least_before() {
            return None;
        }
        let squares = left().map(|[a, b]| closest_point(from, [to, a, b]).distance_squared(from));
        Some(squares.fold(f64::INFINITY, f64::min).sqrt())
    }

    /// What is left of `triangles`, which it was made of.
    fn left(self, triangles: &[u32]) -> Left {
        let c = &self.connectivity;
        let live: Vec<u32> = (0..triangles.len() as u32).filter(|&t| c.has_half_edge(3 * t)).collect();
        let corners = |&t: &u32| c.triangle(3 * t).map(|v| self.vertices[v as usize]);
        let inside = (0..c.vertex_bound()).filter(|&v| c.has_vertex(v) && !c.is_boundary(v));
        Left {
            triangles: live.iter().map(corners).collect(),
            sharp: live.iter().map(|t| [0, 1, 2].map(|k| c.is_curve_edge(3 * t + k))).collect(),
            sources: live.iter().map(|&t| triangles[t as usize]).collect(),
            strayed: inside.map(|v| (self.vertices[v as usize], self.strayed[v as usize])).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::{topology, twins};
    use crate::spatial::bvh::Bvh;
    use crate::surface::features::{Features, sharp_sides};
    use crate::testing::{cube, revolved};
    use glam::dvec3;

    /// A torus of radii 1 and .4 with so many triangles that there are several blocks.
    fn torus() -> Mesh {
        let (n, m) = (400u32, 200u32);
        let angle = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i % n) / f64::from(n);
        let place = |i: u32, j: u32| {
            let (u, v) = (angle(i, n), angle(j, m));
            let radius = 1.0 + 0.4 * v.cos();
            dvec3(radius * u.cos(), radius * u.sin(), 0.4 * v.sin())
        };
        let number = |i: u32, j: u32| (i % n) * m + j % m;
        let cells = || (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
        let triangles = cells().flat_map(|(i, j)| {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| number(i, j));
            [[a, b, c], [a, c, d]]
        });
        Mesh { positions: cells().map(|(i, j)| place(i, j)).collect(), triangles: triangles.collect() }
    }

    fn farthest(from: &[DVec3], mesh: &Mesh) -> f64 {
        let bvh = Bvh::new(mesh);
        let square = |&p: &DVec3| bvh.closest(mesh, p).map_or(f64::INFINITY, |hit| hit.distance_squared);
        from.iter().map(square).fold(0.0, f64::max).sqrt()
    }

    fn is_manifold_of(mesh: &Mesh, fine: &Mesh) -> bool {
        let kind = |mesh: &Mesh| {
            let t = topology(mesh.positions.len(), &mesh.triangles);
            (t.is_manifold() && t.is_oriented(), t.euler, t.components, t.boundary_loops)
        };
        kind(mesh).0 && kind(mesh) == kind(fine)
    }

    #[test]
    fn a_fine_torus_becomes_a_coarse_one_near_to_it() {
        let fine = torus();
        let coarseness = Coarseness { shortest: 0.1, tolerance: 0.01 };
        let Coarsened { mesh, sharp } = coarsened(&fine, &vec![false; 3 * fine.triangles.len()], coarseness);
        assert!(is_manifold_of(&mesh, &fine) && sharp.is_empty());
        assert!(10 * mesh.positions.len() < fine.positions.len(), "{} vertices", mesh.positions.len());
        let far = farthest(&fine.positions, &mesh);
        assert!(far < 0.015, "{far}");
        let source = |v: usize| fine.positions[mesh.provenance().vertex(v as u32).unwrap() as usize];
        assert!((0..mesh.positions.len()).all(|v| mesh.positions[v] == source(v)));
    }

    #[test]
    fn sharp_edges_and_the_boundary_keep_their_course() {
        // A cup: a disk of radius 1 with a wall, open above.
        let wall = (0..=100).map(|k| (1.0, f64::from(k) / 100.0));
        let floor = (1..100).map(|k| (f64::from(k) / 100.0, 0.0));
        let profile: Vec<(f64, f64)> = floor.chain(wall).collect();
        let mut cup = revolved([0.0, 1.0], &profile, 200);
        // Without the lid, the triangles at the upper pole.
        cup.triangles.retain(|t| !t.contains(&1));
        cup.drop_unused();
        let sharp =
            sharp_sides(&cup.clone().try_into().unwrap(), &twins(&cup.triangles), &Features::Degrees(60.0), 0.2, 0.0);
        let coarseness = Coarseness { shortest: 0.1, tolerance: 0.01 };
        let Coarsened { mesh, sharp } = coarsened(&cup, &sharp, coarseness);
        assert!(is_manifold_of(&mesh, &cup));
        assert!(10 * mesh.positions.len() < cup.positions.len(), "{} vertices", mesh.positions.len());
        let radius = |v: u32| cup.positions[v as usize].truncate().length();
        let on_rim = |v: u32| cup.positions[v as usize].z == 0.0 && (radius(v) - 1.0).abs() < 1e-9;
        assert!(sharp.iter().flatten().all(|&v| on_rim(v)));
        let around: f64 =
            sharp.iter().map(|e| cup.positions[e[0] as usize].distance(cup.positions[e[1] as usize])).sum();
        assert!((6.2..6.284).contains(&around), "{around}");
        assert!(sharp.len() < 100, "{} edges", sharp.len());
    }

    #[test]
    fn what_is_coarse_enough_stays() {
        let cube = cube();
        let coarse = coarsened(&cube, &[false; 36], Coarseness { shortest: 0.5, tolerance: 1.0 });
        assert_eq!(coarse.mesh.positions.len(), 8);
        assert_eq!(share_of_edges_below(&cube, 1.1), 2.0 / 3.0);
        assert_eq!(share_of_edges_below(&cube, 0.9), 0.0);
    }
}
