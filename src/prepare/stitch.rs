//! Closes open seams: boundaries that run along each other because vertices that should be one differ by rounding.
//!
//! Exports of separate triangles or patches have them. Welding exactly equal places leaves them open, and the result gets
//! boundaries along them. [`stitch`] closes what rounding opened and reports wider cracks; [`close_cracks`] closes cracks
//! within a tolerance.
//!
//! Two boundary vertices may belong together if their distance is within a tolerance and within a share of the shortest
//! boundary edge at either. The second condition keeps too large a tolerance from consuming a finely divided boundary, on
//! which consecutive vertices are a whole edge apart. A seam is where exactly two boundary edges, and no other edge, become
//! one in this way. Where more would meet, or where two sheets lie on each other, there is no seam. A whole boundary loop
//! that is a single place but for rounding is closed, too.
//!
//! Based on: A. Guéziec, G. Taubin, F. Lazarus, W. Horn, Cutting and stitching: converting sets of polygons to manifold
//! surfaces, 2001, DOI 10.1109/2945.928166. Departure: edges are matched by the places of their ends.
//!
//! Cost: one sort of the edges, two where a seam is closed, and a k-d tree over the boundary vertices with one query for
//! each.
//!
//! Limits: vertices are welded only to vertices. A vertex that lies in the middle of an edge across the seam stays.

use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::mesh::sides::{edges, lower_first};
use crate::mesh::triangle_mesh::Mesh;
use crate::prepare::welded::Welded;
use crate::spatial::kdtree::Neighbors;
use glam::DVec3;

/// Maximum distance of two boundary vertices that belong together: `distance`, in units of the mesh, and `of_edge` times the
/// shortest boundary edge at either.
#[derive(Clone, Copy)]
struct Reach {
    distance: f64,
    of_edge: f64,
}

/// Gaps that rounding opens, in diagonals of the bounding box: a few units in the last place of single precision.
const ROUNDING: Reach = Reach { distance: 1e-6, of_edge: 0.1 };

/// Boundary vertices this close are suspicious: far below any intended edge length. Along a seam, a larger distance is
/// suspicious, too.
const SUSPICIOUS: Reach = Reach { distance: 1e-5, of_edge: 0.5 };
const SUSPICIOUS_SEAM: Reach = Reach { distance: 2e-3, of_edge: 0.25 };

/// Cosine of the angle between two faces at an edge above which they lie on each other: one degree.
const FOLDED: f64 = 0.9998;

impl Reach {
    /// Returns the reach in units of a mesh with this diagonal.
    fn of(self, diagonal: f64) -> Reach {
        Reach { distance: diagonal * self.distance, ..self }
    }
}

/// A mesh without the seams that rounding opened.
pub struct Stitched {
    /// Its triangles over the remaining vertices.
    pub welded: Welded,
    /// Suspected cracks, wider than what rounding opens.
    pub cracks: Option<Cracks>,
}

/// Boundary vertices across a gap from others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cracks {
    /// Number of these vertices.
    pub vertices: usize,
    /// Widest gap between two of them, in units of the mesh: a tolerance that closes all gaps.
    pub width: f64,
}

/// Welds the vertices of `mesh` at exactly the same place, and those along seams and around pinholes that rounding opened:
/// boundary vertices within a millionth of the mesh's diagonal and a tenth of the edges there.
///
/// A seam is closed only where each of its boundary edges finds a partner, so that no edge gets a third face and no face is
/// folded onto another. A pinhole is closed together with the faces around it that have two corners there: all faces around
/// the pole of a globe sampled by angles are such needles. [`repair_welded`](crate::prepare::repair::repair_welded) is meant
/// to follow.
pub fn stitch(mesh: &Mesh) -> Stitched {
    let mut welded = Welded::at_places(mesh);
    let mut boundary = OpenBoundary::new(&mesh.positions, &welded);
    let diagonal = mesh.diagonal();
    // A seam may end in pinholes.
    for opened in [OpenBoundary::seams, OpenBoundary::pinholes] {
        let pairs = opened(&boundary, ROUNDING.of(diagonal));
        if pairs.is_empty() {
            continue;
        }
        let mut joined = UnionFind::new(boundary.vertices.len());
        pairs.iter().for_each(|&[a, b]| {
            joined.join(a, b);
        });
        welded = Welded::new(mesh, boundary.welded(welded.representatives, &mut joined));
        boundary = OpenBoundary::new(&mesh.positions, &welded);
    }
    Stitched { welded, cracks: boundary.cracks(diagonal) }
}

/// Closes the cracks of `mesh`: welds boundary vertices within `tolerance` of each other, in units of the mesh, nearest
/// pairs first, and all vertices at exactly the same place. The vertex with the smallest number represents all.
///
/// The two ends of an edge are never welded, so no triangle is lost. With a tolerance of zero or NaN, only exactly equal
/// places are welded. The patches on both sides of a crack may differ in orientation, and more than two faces may now meet
/// there: [`repair_welded`](crate::prepare::repair::repair_welded) is meant to follow.
pub fn close_cracks(mesh: &Mesh, tolerance: f64) -> Welded {
    let exact = Welded::at_places(mesh);
    let boundary = OpenBoundary::new(&mesh.positions, &exact);
    let mut groups = boundary.groups(Reach { distance: tolerance.max(0.0), of_edge: 0.5 });
    Welded::new(mesh, boundary.welded(exact.representatives, &mut groups))
}

/// Vertices of edges with only one face.
struct OpenBoundary {
    /// In increasing order; all other fields use indices into this list.
    vertices: Vec<u32>,
    positions: Vec<DVec3>,
    /// Length of the shortest boundary edge at each vertex.
    shortest: Vec<f64>,
    /// Edges of the mesh between two of these vertices, in increasing order.
    edges: Vec<Edge>,
}

/// An edge between two boundary vertices.
struct Edge {
    /// The lower one first.
    ends: [u32; 2],
    /// Position of the third corner of its face, if it has exactly one face.
    apex: Option<DVec3>,
}

/// Two boundary vertices that are close to each other, the lower one first.
struct Pair {
    ends: [u32; 2],
    distance_squared: f64,
}

impl OpenBoundary {
    /// Finds the open boundary of welded triangles over vertices at `positions`.
    fn new(positions: &[DVec3], welded: &Welded) -> Self {
        let Welded { triangles, sides, .. } = welded;
        let edges = || edges(sides);
        let open = || edges().filter(|e| e.len() == 1).map(|e| e[0].ends());
        let mut vertices: Vec<u32> = open().flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let place = |v: u32| vertices.binary_search(&v).ok();
        let mut shortest = vec![f64::INFINITY; vertices.len()];
        for ends in open() {
            let [a, b] = ends.map(|v| positions[v as usize]);
            for i in ends.into_iter().filter_map(place) {
                shortest[i] = shortest[i].min(a.distance(b));
            }
        }
        let apex = |side: u32| positions[triangles[side as usize / 3][(side as usize + 2) % 3] as usize];
        let any = if vertices.is_empty() { 0 } else { usize::MAX };
        let between = edges().take(any).filter_map(|e| {
            let ends = [place(e[0].ends()[0])? as u32, place(e[0].ends()[1])? as u32];
            Some(Edge { ends, apex: (e.len() == 1).then(|| apex(e[0].side)) })
        });
        let edges = between.collect();
        let positions = vertices.iter().map(|&v| positions[v as usize]).collect();
        OpenBoundary { vertices, positions, shortest, edges }
    }

    fn are_joined(&self, a: u32, b: u32) -> bool {
        self.edges.binary_search_by_key(&lower_first([a, b]), |edge| edge.ends).is_ok()
    }

    /// Returns all pairs that may belong together, nearest first, without those that an edge connects.
    fn pairs(&self, reach: Reach) -> Vec<Pair> {
        let set = Neighbors::new(&self.positions);
        let radius = |i: u32| (reach.of_edge * self.shortest[i as usize]).min(reach.distance);
        let mut pairs: Vec<Pair> = Vec::new();
        for (a, &p) in (0u32..).zip(&self.positions) {
            for found in set.within(p, radius(a)) {
                let (b, distance_squared) = (found.point, found.distance_squared);
                if a < b && distance_squared <= math::square(radius(b)) && !self.are_joined(a, b) {
                    pairs.push(Pair { ends: [a, b], distance_squared });
                }
            }
        }
        pairs.sort_unstable_by(|p, q| p.distance_squared.total_cmp(&q.distance_squared).then(p.ends.cmp(&q.ends)));
        pairs
    }

    /// Groups the vertices of all pairs, except where an edge connects two members.
    fn groups(&self, reach: Reach) -> UnionFind {
        let mut groups = Groups::new(self.vertices.len());
        for pair in self.pairs(reach) {
            groups.join_unless(pair.ends, |a, b| self.are_joined(a, b));
        }
        groups.sets
    }

    /// Returns pairs of vertices across a seam: the ends of two boundary edges that become one edge, without any other edge.
    fn seams(&self, reach: Reach) -> Vec<[u32; 2]> {
        let mut groups = self.groups(reach);
        let mut edges: Vec<([u32; 2], &Edge)> = Vec::with_capacity(self.edges.len());
        for edge in &self.edges {
            edges.push((lower_first(edge.ends.map(|v| groups.find(v))), edge));
        }
        edges.sort_by_key(|(ends, _)| *ends);
        let mut is_crowded = vec![false; self.vertices.len()];
        let mut seams: Vec<([u32; 2], [u32; 2])> = Vec::new();
        for same in edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            let ends = same[0].0;
            match same {
                [(_, one), (_, other)] if self.are_halves(one, other) => {
                    let is_along = groups.find(one.ends[0]) == groups.find(other.ends[0]);
                    let [c, d] = if is_along { other.ends } else { [other.ends[1], other.ends[0]] };
                    seams.extend([[one.ends[0], c], [one.ends[1], d]].map(|pair| (ends, pair)));
                }
                _ => ends.into_iter().for_each(|end| is_crowded[end as usize] = true),
            }
        }
        seams.retain(|(ends, [a, b])| a != b && !ends.iter().any(|&end| is_crowded[end as usize]));
        seams.into_iter().map(|(_, pair)| pair).collect()
    }

    /// Returns the ends of the boundary edges around pinholes. A pinhole is a whole connected part of the boundary within
    /// the distance, at which all faces are needles.
    fn pinholes(&self, reach: Reach) -> Vec<[u32; 2]> {
        let open = || self.edges.iter().filter_map(|edge| Some((edge.ends, edge.apex?)));
        let mut parts = UnionFind::new(self.vertices.len());
        open().for_each(|([a, b], _)| {
            parts.join(a, b);
        });
        let mut is_wide = vec![false; self.vertices.len()];
        for (ends, apex) in open() {
            let part = parts.find(ends[0]);
            let [origin, a, b] = [part, ends[0], ends[1]].map(|v| self.positions[v as usize]);
            let is_needle = a.distance(b) <= reach.of_edge * a.distance(apex).min(b.distance(apex));
            let is_near = origin.distance(a).max(origin.distance(b)) <= reach.distance;
            is_wide[part as usize] |= !(is_needle && is_near);
        }
        open().map(|(ends, _)| ends).filter(|ends| !is_wide[parts.find(ends[0]) as usize]).collect()
    }

    /// Returns whether two edges at one place have one face each, and these do not lie on each other.
    fn are_halves(&self, one: &Edge, other: &Edge) -> bool {
        let [Some(p), Some(q)] = [one.apex, other.apex] else { return false };
        let [a, b] = one.ends.map(|v| self.positions[v as usize]);
        let along = (b - a).normalize_or_zero();
        let [p, q] = [p, q].map(|apex| (apex - a).reject_from_normalized(along).normalize_or_zero());
        p.dot(q) < FOLDED
    }

    /// Returns the representative of each vertex: the one so far, or the first vertex of the set that contains it.
    fn welded(&self, representatives: Vec<u32>, sets: &mut UnionFind) -> Vec<u32> {
        let mut number: Vec<u32> = (0..representatives.len() as u32).collect();
        for (i, &v) in (0..).zip(&self.vertices) {
            number[v as usize] = self.vertices[sets.find(i) as usize];
        }
        representatives.into_iter().map(|v| number[v as usize]).collect()
    }

    /// Returns the cracks: the vertices that are suspiciously close to others.
    fn cracks(&self, diagonal: f64) -> Option<Cracks> {
        let near = self.pairs(SUSPICIOUS.of(diagonal)).into_iter().map(|pair| pair.ends);
        let pairs: Vec<[u32; 2]> = near.chain(self.seams(SUSPICIOUS_SEAM.of(diagonal))).collect();
        let gap = |[a, b]: &[u32; 2]| self.positions[*a as usize].distance(self.positions[*b as usize]);
        let width = pairs.iter().map(gap).reduce(f64::max)?;
        let mut vertices: Vec<u32> = pairs.into_iter().flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        Some(Cracks { vertices: vertices.len(), width })
    }
}

/// Disjoint sets with lists of their members.
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
    use crate::prepare::repair::{Repaired, repair, repair_welded};
    use crate::testing::{grid, joined};
    use glam::dvec3;
    use std::f64::consts::{PI, TAU};

    /// Closes the cracks of a mesh and repairs it.
    fn closed(mesh: &Mesh, tolerance: f64) -> Mesh {
        repair_welded(mesh.positions.clone(), close_cracks(mesh, tolerance)).mesh.into_mesh()
    }

    /// Closes what rounding opened in a mesh and repairs it.
    fn stitched(mesh: &Mesh) -> Mesh {
        repair_welded(mesh.positions.clone(), stitch(mesh).welded).mesh.into_mesh()
    }

    fn boundary_loops(mesh: &Mesh) -> usize {
        topology(mesh.positions.len(), &mesh.triangles).boundary_loops
    }

    /// A sphere of radius 1 with poles that all meridians share, cut along one meridian, with the vertices on one side of
    /// the cut offset by `gap`.
    fn cut_sphere(gap: f64) -> Mesh {
        let (rows, columns) = (24u32, 48u32);
        let place = |i: u32, j: u32| {
            let (polar, round) = (PI * f64::from(i) / f64::from(rows), TAU * f64::from(j) / f64::from(columns));
            dvec3(polar.sin() * round.cos(), polar.sin() * round.sin(), polar.cos())
        };
        let off = |j: u32| if j == columns { dvec3(0.0, gap, 0.0) } else { DVec3::ZERO };
        let rings = (1..rows).flat_map(|i| (0..=columns).map(move |j| (i, j)));
        let poles = [DVec3::Z, DVec3::NEG_Z];
        let positions: Vec<DVec3> = rings.map(|(i, j)| place(i, j % columns) + off(j)).chain(poles).collect();
        let [top, bottom] = [2, 1].map(|k| positions.len() as u32 - k);
        let at = |i: u32, j: u32| match i {
            0 => top,
            i if i == rows => bottom,
            i => (i - 1) * (columns + 1) + j,
        };
        let squares =
            (0..rows).flat_map(|i| (0..columns).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
        let halves = squares.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let triangles = halves.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        Mesh { positions, triangles }
    }

    #[test]
    fn what_rounding_opened_is_closed_and_wider_cracks_are_told() {
        for gap in [3e-16, 1e-12, 1e-7, 1e-6] {
            let cut = cut_sphere(gap);
            assert_eq!(boundary_loops(&repair(&cut).0), 1);
            let Repaired { mesh: whole, repairs, .. } = repair_welded(cut.positions.clone(), stitch(&cut).welded);
            assert_eq!((boundary_loops(&whole), repairs.cut_edges), (0, 0), "{gap}");
            assert_eq!((repairs.seam_vertices, repairs.welded_vertices), (23, 23), "{gap}");
            assert_eq!(stitch(&cut).cracks, None);
        }
        for gap in [1e-5, 2e-3] {
            let cut = cut_sphere(gap);
            assert_eq!(boundary_loops(&stitched(&cut)), 1);
            let cracks = stitch(&cut).cracks.unwrap();
            assert_eq!(cracks.vertices, 46);
            assert!((cracks.width - gap).abs() < 1e-9);
            assert_eq!(boundary_loops(&closed(&cut, 1.01 * cracks.width)), 0);
        }
    }

    /// A globe of radius 1, sampled by angles: each row has as many vertices as the equator, those at the poles at a
    /// distance of `off` from them, and each meridian but the first has one vertex for both sides.
    fn globe(off: f64) -> Mesh {
        let (rows, columns) = (12u32, 36u32);
        let polar = |i: u32| PI * f64::from(i) / f64::from(rows);
        let place = |i: u32, j: u32| {
            let round = TAU * f64::from(j) / f64::from(columns);
            let radius = if i.is_multiple_of(rows) { off } else { polar(i).sin() };
            dvec3(radius * round.cos(), radius * round.sin(), polar(i).cos())
        };
        let at = |i: u32, j: u32| i * (columns + 1) + j;
        let halves = |i, j| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        Mesh {
            positions: (0..=rows).flat_map(|i| (0..=columns).map(move |j| place(i, j))).collect(),
            triangles: (0..rows).flat_map(|i| (0..columns).flat_map(move |j| halves(i, j))).collect(),
        }
    }

    #[test]
    fn poles_of_which_rounding_made_rings_are_closed() {
        for off in [1e-17, 1e-8] {
            let whole = stitched(&globe(off));
            let t = topology(whole.positions.len(), &whole.triangles);
            assert_eq!((t.euler, t.components, t.boundary_loops), (2, 1, 0), "{off}");
            assert_eq!(whole.positions.len(), 11 * 36 + 2);
        }
        assert_eq!(boundary_loops(&stitched(&globe(1e-4))), 2);
        // A mesh that is small all over is no pinhole.
        let mut far = globe(1e-17);
        far.triangles.push([0, 1, 2].map(|k| k + far.positions.len() as u32));
        far.positions.extend([DVec3::X, DVec3::Y, DVec3::ZERO].map(|p| 1e-7 * p + 9.0 * DVec3::X));
        assert_eq!(stitched(&far).triangles.len(), 2 * 11 * 36 + 1);
    }

    #[test]
    fn slits_and_sheets_that_are_meant_stay() {
        let slit = cut_sphere(0.03);
        assert!(stitch(&slit).cracks.is_none() && boundary_loops(&stitched(&slit)) == 1);
        // Sheets lying on each other, in either orientation, and three sheets that meet along a line.
        let sheet_at = |z: f64, y: DVec3| sheet(4, dvec3(0.0, 0.0, z), DVec3::X, y);
        let mut behind = sheet_at(1e-8, DVec3::Y);
        for _ in 0..2 {
            assert_eq!(boundary_loops(&stitched(&joined([sheet_at(0.0, DVec3::Y), behind.clone()]))), 2);
            behind.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        let fan = [sheet_at(0.0, DVec3::Y), sheet_at(1e-8, DVec3::NEG_Y), sheet_at(2e-8, DVec3::Z)];
        let three = joined(fan.clone());
        assert_eq!(boundary_loops(&stitched(&three)), 3);
        assert!(stitch(&three).cracks.is_some());
        let [a, b, _] = fan;
        assert_eq!(boundary_loops(&stitched(&joined([a, b]))), 1);
    }

    /// A sheet of n by n squares over the parallelogram that `x` and `y` span at `origin`.
    fn sheet(n: u32, origin: DVec3, x: DVec3, y: DVec3) -> Mesh {
        grid(n, n, |u, v| origin + u * x + v * y)
    }

    /// The unit cube as six separate sheets, every vertex moved by up to `jitter` along each axis.
    fn cube_of_sheets(n: u32, jitter: f64) -> Mesh {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let faces = |k: usize| {
            let (x, y, z) = (axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]);
            [sheet(n, z, x, y), sheet(n, DVec3::ZERO, y, x)]
        };
        let mut cube = joined((0..3).flat_map(faces));
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
            assert_eq!(stitched(&apart), stitched(&cube_of_sheets(n, 1e-7)));
            let closed = closed(&apart, 1e-6);
            assert_eq!(boundary_loops(&stitched(&apart)), 0);
            let t = topology(closed.positions.len(), &closed.triangles);
            assert_eq!((t.euler, t.components, t.boundary_loops), (2, 1, 0));
            assert!(t.is_manifold() && t.is_oriented() && t.vertices == closed.positions.len());
            assert_eq!((closed.triangles.len(), stitch(&closed).cracks), (apart.triangles.len(), None));
        }
    }

    #[test]
    fn an_open_sheet_has_none_however_fine_it_is() {
        let open = sheet(20, DVec3::ZERO, DVec3::X, DVec3::Y);
        assert_eq!(stitch(&open).cracks, None);
        assert!(stitch(&open).welded.representatives.into_iter().eq(0..21 * 21));
        assert!(close_cracks(&open, 100.0).representatives.into_iter().eq(0..21 * 21));
        // A second sheet far away: the edges of the first are shorter than the suspicious distance.
        let far = sheet(2, 1e7 * DVec3::X, DVec3::X, DVec3::Y);
        assert_eq!(stitch(&joined([open, far])).cracks, None);
    }

    #[test]
    fn a_slit_is_closed_up_to_its_end() {
        // Twelve triangles around a corner, the last one not glued to the first.
        let fan = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / 12.0;
            dvec3(angle.cos(), angle.sin(), 0.0)
        };
        let ring = (0..=12).map(|k| fan(k) + if k == 12 { dvec3(0.0, 1e-8, 0.0) } else { DVec3::ZERO });
        let slit = Mesh {
            positions: [DVec3::ZERO].into_iter().chain(ring).collect(),
            triangles: (1..=12).map(|k| [0, k, k + 1]).collect(),
        };
        for closed in [closed(&slit, 1e-6), stitched(&slit)] {
            assert_eq!((closed.positions.len(), closed.triangles.len()), (13, 12));
            assert_eq!(stitch(&closed).cracks, None);
        }
    }

    #[test]
    fn a_fin_at_one_place_is_no_seam() {
        let fin = Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z],
            triangles: vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
        };
        let (apart, repairs) = repair(&fin);
        assert_eq!(repairs.cut_edges, 1);
        assert_eq!(stitch(&apart).cracks, None);
    }

    #[test]
    fn tolerances_that_are_none_change_nothing() {
        let apart = cube_of_sheets(1, 1e-7);
        for tolerance in [0.0, -1.0, f64::NAN] {
            assert!(close_cracks(&apart, tolerance).representatives.into_iter().eq(0..24));
        }
        assert_eq!(stitch(&Mesh::default()).cracks, None);
        assert!(close_cracks(&Mesh::default(), 1.0).representatives.is_empty());
    }
}
