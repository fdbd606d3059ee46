//! Triangulates points in a plane as one sheet: their Delaunay triangulation without the long triangles at its outline.
//!
//! The convex hull spans bays with long triangles. Triangles whose edge on the outline is too long are removed, the longest
//! edge first, unless their third corner is already on the outline. So the sheet stays in one piece, without a hole, and
//! contains all points.
//!
//! Based on: M. Duckham, L. Kulik, M. Worboys, A. Galton, Efficient generation of simple polygons for characterizing the
//! shape of a set of points in the plane, 2008, DOI 10.1016/j.patcog.2008.03.023 (the χ-shape).
//!
//! Cost: the triangulation, n log n for n points, and a heap of the edges on the outline.

use glam::DVec2;
use spade::handles::{DirectedEdgeHandle, FixedDirectedEdgeHandle};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Maximum length of an edge on the outline, relative to the median edge.
const LONG: f64 = 5.0;

/// A point of the plane and its index.
struct Site(Point2<f64>, u32);

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.0
    }
}

type Edge<'a> = DirectedEdgeHandle<'a, Site, (), (), ()>;

/// An edge on the outline, with the sheet to its left. Ordered by length; of equally long ones, the lowest is the greatest.
#[derive(PartialEq)]
struct OnOutline {
    length: f64,
    edge: FixedDirectedEdgeHandle,
}

impl Eq for OnOutline {}

impl PartialOrd for OnOutline {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OnOutline {
    fn cmp(&self, other: &Self) -> Ordering {
        self.length.total_cmp(&other.length).then(other.edge.cmp(&self.edge))
    }
}

/// Returns counter-clockwise triangles between `points` at different places; none if these are collinear, or so many orders
/// of magnitude apart that floating point cannot distinguish them.
pub fn triangulate_plan(points: &[DVec2]) -> Vec<[u32; 3]> {
    let sites = points.iter().enumerate().map(|(i, p)| Site(Point2::new(p.x, p.y), i as u32)).collect();
    let Ok(sheet) = DelaunayTriangulation::<Site>::bulk_load_stable(sites) else { return Vec::new() };
    let longest = LONG * median_edge(&sheet);
    let mut is_on_outline = vec![false; sheet.num_vertices()];
    let mut is_gone = vec![false; sheet.num_all_faces()];
    let mut outline = BinaryHeap::new();
    for edge in sheet.convex_hull().map(|outside| outside.rev()) {
        is_on_outline[edge.from().index()] = true;
        push(&mut outline, edge);
    }
    while let Some(OnOutline { length, edge }) = outline.pop() {
        if length <= longest {
            break;
        }
        let edge = sheet.directed_edge(edge);
        let apex = edge.next().to().index();
        if is_on_outline[apex] || is_gone[edge.face().index()] {
            continue;
        }
        is_gone[edge.face().index()] = true;
        is_on_outline[apex] = true;
        for inner in [edge.next().rev(), edge.prev().rev()] {
            if !inner.is_outer_edge() && !is_gone[inner.face().index()] {
                push(&mut outline, inner);
            }
        }
    }
    let kept = sheet.inner_faces().filter(|face| !is_gone[face.index()]);
    kept.map(|face| face.vertices().map(|v| v.data().1)).collect()
}

fn push(outline: &mut BinaryHeap<OnOutline>, edge: Edge) {
    outline.push(OnOutline { length: edge.length_2().sqrt(), edge: edge.fix() });
}

fn median_edge(sheet: &DelaunayTriangulation<Site>) -> f64 {
    let mut lengths: Vec<f64> = sheet.undirected_edges().map(|edge| edge.length_2()).collect();
    if lengths.is_empty() {
        return 0.0;
    }
    let middle = lengths.len() / 2;
    lengths.select_nth_unstable_by(middle, f64::total_cmp).1.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::topology;

    fn area(points: &[DVec2], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| t.map(|v| points[v as usize])).map(|[a, b, c]| (b - a).perp_dot(c - a) / 2.0).sum()
    }

    #[test]
    fn a_bay_is_not_spanned_and_the_sheet_stays_in_one_piece() {
        // A horseshoe of 30 by 30 with a bay of 20 by 10, and a single point far away.
        let grid = (0..900).map(|i| DVec2::new(f64::from(i % 30), f64::from(i / 30)));
        let mut points: Vec<DVec2> = grid.filter(|p| !(p.x >= 10.0 && (10.0..20.0).contains(&p.y))).collect();
        points.push(DVec2::new(60.0, 0.3));
        let triangles = triangulate_plan(&points);
        let kind = topology(points.len(), &triangles);
        assert_eq!((kind.vertices, kind.euler, kind.components, kind.boundary_loops), (points.len(), 1, 1, 1));
        assert!(kind.is_manifold() && kind.is_oriented());
        let area = area(&points, &triangles);
        assert!((29.0 * 29.0 - 20.0 * 11.0..29.0 * 29.0 - 20.0 * 11.0 + 40.0).contains(&area), "{area}");
    }

    #[test]
    fn points_on_a_line_have_no_triangles() {
        assert!(triangulate_plan(&[0.0, 1.0, 2.0, 5.0].map(|x| DVec2::new(x, 2.0 * x))).is_empty());
        assert!(triangulate_plan(&[]).is_empty());
    }
}
