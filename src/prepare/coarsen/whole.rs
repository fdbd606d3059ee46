//! Coarsens a whole manifold, together with its sharp edges.

use crate::base::parallel;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::provenance::Provenance;
use crate::mesh::topology::{NONE, twins};
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::coarsen::block::{BLOCK, Block, Coarseness, MARGIN, numbered_apart, order_of_triangles};
use std::borrow::Cow;

/// A mesh with longer edges.
pub struct Coarsened {
    /// Its vertices are some of those of the fine mesh, which is its source; a triangle is only near the one that it came
    /// from.
    pub mesh: OrientedManifold,
    /// The ends of each sharp edge, as vertices of the fine mesh.
    pub sharp: Vec<[u32; 2]>,
}

/// Sorts the triangles and vertices of `mesh` along a space-filling curve, so that those close in space are mostly close in
/// memory.
pub fn in_spatial_order(mesh: OrientedManifold) -> OrientedManifold {
    let order = mesh.bounds().map_or(Vec::new(), |bounds| order_of_triangles(&mesh, bounds));
    let (triangles, vertices) = numbered(order.iter().map(|&t| mesh.triangles[t as usize]), mesh.positions.len());
    let positions = vertices.iter().map(|&v| mesh.positions[v as usize]).collect();
    let provenance = mesh.into_parts().1.select(&vertices, &order);
    OrientedManifold::trusted(Mesh { positions, triangles }, provenance)
}

/// Renumbers `count` vertices in the order in which `triangles` use them. Returns the triangles and the used vertices in that
/// order.
fn numbered(triangles: impl Iterator<Item = [u32; 3]>, count: usize) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut number = vec![NONE; count];
    let mut vertices = Vec::new();
    let mut numbered = |v: u32| {
        if number[v as usize] == NONE {
            number[v as usize] = vertices.len() as u32;
            vertices.push(v);
        }
        number[v as usize]
    };
    let triangles = triangles.map(|corners| corners.map(&mut numbered)).collect();
    (triangles, vertices)
}

/// Returns `fine` with longer edges. `sharp` says for each side of its triangles whether it is on a sharp edge. Triangles
/// that are close in memory should be close in space, as [`in_spatial_order`] arranges them.
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

/// Returns the share of the edges of `mesh` that are shorter than `length`.
pub fn share_of_edges_below(mesh: &Mesh, length: f64) -> f64 {
    let is_short =
        |[a, b]: [u32; 2]| mesh.positions[a as usize].distance_squared(mesh.positions[b as usize]) < length * length;
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].into_iter().filter(|&side| is_short(side)).count();
    let of_blocks = parallel::collect(&mesh.triangles[..], |block| [block.iter().map(sides).sum::<usize>()]);
    let short: usize = of_blocks.into_iter().sum();
    short as f64 / (3 * mesh.triangles.len()).max(1) as f64
}

/// A mesh that is being coarsened.
struct Coarse<'a> {
    mesh: Cow<'a, Mesh>,
    /// For each triangle, which of its sides are on sharp edges.
    sharp: Cow<'a, [[bool; 3]]>,
    /// For each vertex and triangle, the one of the fine mesh that it comes from.
    of_vertex: Vec<u32>,
    of_triangle: Vec<u32>,
    /// For each vertex, how far the vertices merged into it may be from the surface.
    strayed: Vec<f64>,
}

impl Coarse<'_> {
    /// Coarsens blocks of the triangles, which are taken in this order.
    fn turn(&self, order: &[u32], coarseness: Coarseness) -> Coarse<'static> {
        let blocks = parallel::blocks(order, BLOCK, |triangles| self.left_of(triangles, coarseness));
        self.joined(&blocks)
    }

    /// Returns the remains of a block of these triangles.
    fn left_of(&self, triangles: &[u32], coarseness: Coarseness) -> Left {
        let (corners, vertices) = numbered_apart(triangles.iter().map(|&t| self.mesh.triangles[t as usize]));
        let positions = vertices.iter().map(|&v| self.mesh.positions[v as usize]).collect();
        let strayed = vertices.iter().map(|&v| self.strayed[v as usize]).collect();
        let twin = twins(&corners);
        let mut block = Block::new(Mesh { positions, triangles: corners }, twin, strayed);
        block.mark_sharp(triangles.iter().map(|&t| self.sharp[t as usize]));
        block.coarsen(coarseness);
        let left: Vec<u32> = block.triangles().collect();
        Left {
            triangles: left.iter().map(|&t| block.corners(t).map(|v| vertices[v as usize])).collect(),
            sharp: left.iter().map(|&t| block.sharp_sides(t)).collect(),
            sources: left.iter().map(|&t| triangles[t as usize]).collect(),
            strayed: block.inside().map(|v| (vertices[v as usize], block.strayed(v))).collect(),
        }
    }

    /// Returns the triangles in spatial order within wider bounds.
    fn in_other_order(&self) -> Vec<u32> {
        let Some(mut bounds) = self.mesh.bounds() else { return Vec::new() };
        bounds.lo -= MARGIN * bounds.size();
        order_of_triangles(&self.mesh, bounds)
    }

    /// Returns the ends of each sharp edge, as vertices of the fine mesh.
    fn sharp_edges(&self) -> Vec<[u32; 2]> {
        let sides = self.mesh.triangles.iter().zip(&*self.sharp).flat_map(|(t, sharp)| {
            let ends = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
            ends.into_iter().zip(*sharp).filter(|(_, sharp)| *sharp).map(|(ends, _)| ends)
        });
        // The triangle across has the same edge in the other direction.
        sides.filter(|[a, b]| a < b).map(|ends| ends.map(|v| self.of_vertex[v as usize])).collect()
    }

    /// Joins the remains of all blocks, and renumbers vertices without gaps.
    fn joined(&self, blocks: &[Left]) -> Coarse<'static> {
        let of_blocks = blocks.iter().flat_map(|block| &block.triangles).copied();
        let (triangles, old) = numbered(of_blocks, self.mesh.positions.len());
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

/// Remains of a block, in terms of the vertices and triangles of the mesh before.
struct Left {
    triangles: Vec<[u32; 3]>,
    sharp: Vec<[bool; 3]>,
    sources: Vec<u32>,
    strayed: Vec<(u32, f64)>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::{topology, twins};
    use crate::spatial::bvh::Bvh;
    use crate::surface::features::{Features, sharp_sides};
    use crate::testing::{cube, revolved};
    use glam::{DVec3, dvec3};

    /// A torus of radii 1 and 0.4 with enough triangles for several blocks.
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
        // Remove the lid: the triangles at the upper pole.
        cup.triangles.retain(|t| !t.contains(&1));
        cup.drop_unused();
        let sharp = sharp_sides(
            &cup.clone().try_into().unwrap(),
            &twins(&cup.triangles),
            &Features::Degrees(60.0),
            0.2,
            0.0,
            |_| false,
        );
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
