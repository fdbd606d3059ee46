//! Open seams: boundaries that lie along each other because vertices that should be one differ by rounding.
//!
//! Exports of separate triangles or patches have them. Welding of exactly equal places leaves them open, and the result
//! gets boundaries along them. [`open_cracks`] tells how likely that is, [`close_cracks`] welds them.
//!
//! Two boundary vertices belong together if they are within a tolerance of each other and within half of the shortest
//! boundary edge at either. The second condition keeps a tolerance that is too large from eating a finely divided
//! boundary: vertices that follow each other on it are a whole edge apart.
//!
//! Cost: one sort of the edges, and a k-d tree over the boundary vertices with one query for each.
//!
//! Limits: vertices are welded to vertices. A vertex that lies on the middle of an edge across the seam stays.

use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::mesh::topology::sorted_sides;
use crate::mesh::triangle_mesh::Mesh;
use crate::mesh::weld::representatives;
use crate::spatial::kdtree::Neighbors;
use glam::DVec3;

/// How near boundary vertices are suspicious, in diagonals of the bounding box: a hundred times the rounding of single
/// precision, and far below any edge that is meant.
pub const SUSPICIOUS: f64 = 1e-5;

/// The number of boundary vertices that another one, not joined to it by an edge, comes suspiciously near to.
///
/// `mesh` is one whose vertices at exactly one place have been welded, or kept apart for a reason (as
/// [`repair`](crate::prepare::repair::repair) does): such pairs do not count.
pub fn open_cracks(mesh: &Mesh) -> usize {
    let boundary = OpenBoundary::new(&mesh.positions, &mesh.triangles);
    let pairs = boundary.pairs(SUSPICIOUS * mesh.diagonal());
    let mut near: Vec<u32> = pairs.iter().filter(|p| p.distance_squared > 0.0).flat_map(|p| p.ends).collect();
    near.sort_unstable();
    near.dedup();
    near.len()
}

/// For each vertex of `mesh` the one that it is welded to: boundary vertices within `tolerance` of each other, in units of
/// the mesh, are welded, the nearest pairs first, and so are all vertices at exactly one place. The one with the smallest
/// number stands for all.
///
/// No two ends of an edge are ever welded, so no triangle is lost. With a tolerance of zero, or one that is not a
/// number, only exact places are welded. The patches on both sides of a crack may differ in orientation, and more than
/// two faces may meet there now: [`repair_welded`](crate::prepare::repair::repair_welded) is meant to follow.
pub fn close_cracks(mesh: &Mesh, tolerance: f64) -> Vec<u32> {
    let exact = representatives(&mesh.positions);
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| exact[v as usize])).collect();
    let boundary = OpenBoundary::new(&mesh.positions, &triangles);
    let mut groups = Groups::new(boundary.vertices.len());
    for pair in boundary.pairs(tolerance.max(0.0)) {
        groups.join_unless(pair.ends, |a, b| boundary.are_joined(a, b));
    }
    let mut number: Vec<u32> = (0..exact.len() as u32).collect();
    for (i, &v) in boundary.vertices.iter().enumerate() {
        number[v as usize] = boundary.vertices[groups.sets.find(i as u32) as usize];
    }
    exact.into_iter().map(|v| number[v as usize]).collect()
}

/// The vertices at edges with one face.
struct OpenBoundary {
    /// In increasing order; everything else here counts by their place in it.
    vertices: Vec<u32>,
    positions: Vec<DVec3>,
    /// Half of the shortest boundary edge at each.
    reach: Vec<f64>,
    /// Edges of the mesh between two of them, the smaller end first, in increasing order.
    edges: Vec<[u32; 2]>,
}

/// Two boundary vertices that are near each other, the smaller one first.
struct Pair {
    ends: [u32; 2],
    distance_squared: f64,
}

impl OpenBoundary {
    fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let sides = sorted_sides(triangles);
        let edges = || sides.chunk_by(|a, b| a.ends == b.ends);
        let open = || edges().filter(|e| e.len() == 1).map(|e| e[0].ends);
        let mut vertices: Vec<u32> = open().flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let place = |v: u32| vertices.binary_search(&v).ok();
        let mut reach = vec![f64::INFINITY; vertices.len()];
        for ends in open() {
            let [a, b] = ends.map(|v| positions[v as usize]);
            for i in ends.into_iter().filter_map(place) {
                reach[i] = reach[i].min(0.5 * a.distance(b));
            }
        }
        let between = edges().filter_map(|e| Some([place(e[0].ends[0])? as u32, place(e[0].ends[1])? as u32]));
        let edges = between.collect();
        let positions = vertices.iter().map(|&v| positions[v as usize]).collect();
        OpenBoundary { vertices, positions, reach, edges }
    }

    fn are_joined(&self, a: u32, b: u32) -> bool {
        self.edges.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }

    /// All pairs that belong together, the nearest first, those that an edge joins left out.
    fn pairs(&self, tolerance: f64) -> Vec<Pair> {
        let set = Neighbors::new(&self.positions);
        let reach = |i: u32| self.reach[i as usize].min(tolerance);
        let mut pairs: Vec<Pair> = Vec::new();
        for (a, &p) in (0u32..).zip(&self.positions) {
            for found in set.within(p, reach(a)) {
                let (b, distance_squared) = (found.point, found.distance_squared);
                if a < b && distance_squared <= math::square(reach(b)) && !self.are_joined(a, b) {
                    pairs.push(Pair { ends: [a, b], distance_squared });
                }
            }
        }
        pairs.sort_unstable_by(|p, q| p.distance_squared.total_cmp(&q.distance_squared).then(p.ends.cmp(&q.ends)));
        pairs
    }
}

/// Disjoint sets that know their members.
struct Groups {
    sets: UnionFind,
    members: Vec<Vec<u32>>,
}

impl Groups {
    fn new(n: usize) -> Self {
        Groups { sets: UnionFind::new(n), members: (0..n as u32).map(|i| vec![i]).collect() }
    }

    /// Joins the sets of two numbers unless a member of one and a member of the other must stay `apart`.
    fn join_unless(&mut self, ends: [u32; 2], apart: impl Fn(u32, u32) -> bool) {
        let [a, b] = ends.map(|i| self.sets.find(i) as usize);
        let clash = || self.members[a].iter().any(|&i| self.members[b].iter().any(|&j| apart(i, j)));
        if a == b || clash() {
            return;
        }
        self.sets.join(a as u32, b as u32);
        let moved = std::mem::take(&mut self.members[a.max(b)]);
        self.members[a.min(b)].extend(moved);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::mesh::topology::topology;
    use crate::prepare::repair::{repair, repair_welded};
    use glam::dvec3;

    /// The mesh once its cracks are closed.
    fn closed(mesh: &Mesh, tolerance: f64) -> Mesh {
        repair_welded(mesh, close_cracks(mesh, tolerance)).0.into_mesh()
    }

    /// A sheet of n by n squares over the parallelogram of `x` and `y` at `origin`.
    fn sheet(n: u32, origin: DVec3, x: DVec3, y: DVec3) -> Mesh {
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
        let square = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        Mesh {
            positions: positions.map(|(i, j)| origin + (x * f64::from(i) + y * f64::from(j)) / f64::from(n)).collect(),
            triangles: (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).flat_map(square).collect(),
        }
    }

    /// The unit cube as six separate sheets, every vertex moved by up to `jitter` along each axis.
    fn cube_of_sheets(n: u32, jitter: f64) -> Mesh {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut cube = Mesh::default();
        for k in 0..3 {
            let (x, y, z) = (axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]);
            for face in [sheet(n, z, x, y), sheet(n, DVec3::ZERO, y, x)] {
                let base = cube.positions.len() as u32;
                cube.triangles.extend(face.triangles.iter().map(|t| t.map(|v| v + base)));
                cube.positions.extend(face.positions);
            }
        }
        let mut rng = stream(3, Stage::Scan);
        let mut shift = || jitter * (2.0 * unit(&mut rng) - 1.0);
        cube.positions.iter_mut().for_each(|p| *p += dvec3(shift(), shift(), shift()));
        cube
    }

    #[test]
    fn a_box_of_jittered_faces_has_seams_that_can_be_closed() {
        for n in [1, 4] {
            let apart = repair(&cube_of_sheets(n, 1e-7)).0;
            assert_eq!(topology(apart.positions.len(), &apart.triangles).boundary_loops, 6);
            assert_eq!(open_cracks(&apart), 6 * 4 * n as usize);
            let closed = closed(&apart, 1e-6);
            let t = topology(closed.positions.len(), &closed.triangles);
            assert_eq!((t.euler, t.components, t.boundary_loops), (2, 1, 0));
            assert!(t.is_manifold() && t.is_oriented() && t.vertices == closed.positions.len());
            assert_eq!((closed.triangles.len(), open_cracks(&closed)), (apart.triangles.len(), 0));
        }
    }

    #[test]
    fn an_open_sheet_has_none_however_fine_it_is() {
        let open = sheet(20, DVec3::ZERO, DVec3::X, DVec3::Y);
        assert_eq!(open_cracks(&open), 0);
        assert!(close_cracks(&open, 100.0).into_iter().eq(0..21 * 21));
        // A second one far off: the edges of the first are shorter than what is suspicious.
        let mut far = sheet(2, dvec3(1e7, 0.0, 0.0), DVec3::X, DVec3::Y);
        far.triangles.iter_mut().flatten().for_each(|v| *v += open.positions.len() as u32);
        let mut both = open;
        both.positions.extend(far.positions);
        both.triangles.extend(far.triangles);
        assert_eq!(open_cracks(&both), 0);
    }

    #[test]
    fn a_slit_is_closed_up_to_its_end() {
        // Twelve squares around a corner, the last ones not glued to the first.
        let fan = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / 12.0;
            dvec3(angle.cos(), angle.sin(), 0.0)
        };
        let ring = (0..=12).map(|k| fan(k) + if k == 12 { dvec3(0.0, 1e-8, 0.0) } else { DVec3::ZERO });
        let slit = Mesh {
            positions: [DVec3::ZERO].into_iter().chain(ring).collect(),
            triangles: (1..=12).map(|k| [0, k, k + 1]).collect(),
        };
        assert_eq!(open_cracks(&slit), 2);
        let closed = closed(&slit, 1e-6);
        assert_eq!((closed.positions.len(), closed.triangles.len()), (13, 12));
        assert_eq!(open_cracks(&closed), 0);
    }

    #[test]
    fn sheets_that_were_cut_apart_at_one_place_are_no_seam() {
        let fin = Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z],
            triangles: vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        };
        let (apart, repairs) = repair(&fin);
        assert_eq!(repairs.cut_edges, 1);
        assert_eq!(open_cracks(&apart), 0);
    }

    #[test]
    fn tolerances_that_are_none_change_nothing() {
        let apart = cube_of_sheets(1, 1e-7);
        for tolerance in [0.0, -1.0, f64::NAN] {
            assert!(close_cracks(&apart, tolerance).into_iter().eq(0..24));
        }
        assert_eq!(open_cracks(&Mesh::default()), 0);
        assert!(close_cracks(&Mesh::default(), 1.0).is_empty());
    }
}
