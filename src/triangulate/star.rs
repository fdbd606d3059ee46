//! The star of a sample: its one-ring in the Delaunay triangulation of its neighbours, unrolled into its tangent plane.
//!
//! A Delaunay triangle has a circumcircle without samples. All triangles of the star are right once the neighbourhood
//! reaches twice as far as the largest of their circumradii, so it grows until it does. Boundaries are constraints: a
//! star ends at them.
//!
//! Cost: that of a walk, and a triangulation of some fifteen points.

use crate::triangulate::unfold::{Neighbour, Unfolding};
use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

/// First radius of a neighbourhood in mean spacings. Circumradii of samples that the scan leaves are mostly below one.
const FIRST_RADIUS: f64 = 2.0;

/// How much a neighbourhood grows when it was too small, and how often.
const GROWTH: f64 = 1.5;
const MOST_ATTEMPTS: usize = 3;

/// Marks a sample that is not on a boundary.
pub const INTERIOR: u32 = u32::MAX;

/// A sample as a point of the plane.
#[derive(Clone, Copy)]
struct Site {
    place: Point2<f64>,
    sample: u32,
}

impl HasPosition for Site {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// What a star is made from.
pub struct StarMaker<'a> {
    pub unfolding: Unfolding<'a>,
    /// Mean distance of neighbouring samples.
    pub spacing: f64,
    /// The next sample on the boundary, or [`INTERIOR`].
    pub successor: &'a [u32],
    found: Vec<Neighbour>,
}

impl<'a> StarMaker<'a> {
    pub fn new(unfolding: Unfolding<'a>, spacing: f64, successor: &'a [u32]) -> Self {
        StarMaker { unfolding, spacing, successor, found: Vec::new() }
    }

    /// Adds the triangles of the star of sample `centre` to `triangles`, counter-clockwise, the centre first.
    pub fn star(&mut self, centre: u32, triangles: &mut Vec<[u32; 3]>) {
        let mut radius = FIRST_RADIUS * self.spacing;
        let begin = triangles.len();
        for _ in 0..MOST_ATTEMPTS {
            triangles.truncate(begin);
            self.unfolding.neighbours(centre, radius, &mut self.found);
            let reach = self.delaunay_star(centre, triangles);
            if 2.0 * reach <= radius {
                break;
            }
            radius *= GROWTH;
        }
    }

    /// The star among the neighbours found; the largest circumradius, infinite if the star is open where no boundary is.
    fn delaunay_star(&mut self, centre: u32, triangles: &mut Vec<[u32; 3]>) -> f64 {
        let Some(plane) = self.triangulation(centre) else { return f64::INFINITY };
        let Some(hub) = plane.fixed_vertices().next().map(|v| plane.vertex(v)) else { return f64::INFINITY };
        let mut ring: Vec<Site> = hub.out_edges().map(|e| *e.to().data()).collect();
        let inner: Vec<bool> = hub.out_edges().map(|e| !e.face().is_outer()).collect();
        let next = self.successor[centre as usize];
        let mut wedges = ring.len();
        if next != INTERIOR {
            // From the next sample on the boundary counter-clockwise to the one before.
            let Some(first) = ring.iter().position(|s| s.sample == next) else { return f64::INFINITY };
            ring.rotate_left(first);
            let last = ring.iter().position(|s| self.successor[s.sample as usize] == centre);
            let Some(last) = last else { return f64::INFINITY };
            wedges = last;
        } else if inner.contains(&false) {
            return f64::INFINITY;
        }
        let mut reach: f64 = 0.0;
        for i in 0..wedges {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            triangles.push([centre, a.sample, b.sample]);
            reach = reach.max(circumradius(a.place, b.place));
        }
        reach * self.spacing
    }

    /// The neighbours in units of the spacing, triangulated; the centre is the first vertex.
    fn triangulation(&mut self, centre: u32) -> Option<ConstrainedDelaunayTriangulation<Site>> {
        let mut plane = ConstrainedDelaunayTriangulation::<Site>::new();
        let hub = plane.insert(Site { place: Point2::new(0.0, 0.0), sample: centre }).ok()?;
        self.found.sort_unstable_by(|a, b| {
            a.place.length_squared().total_cmp(&b.place.length_squared()).then(a.sample.cmp(&b.sample))
        });
        let mut on_boundary = vec![];
        if self.successor[centre as usize] != INTERIOR {
            on_boundary.push((centre, hub));
        }
        for n in &self.found {
            let DVec2 { x, y } = n.place / self.spacing;
            let before = plane.num_vertices();
            // Places too small to be told apart are taken by the sample that came first.
            let clean = |c: f64| if c.abs() < 1e-9 { 0.0 } else { c };
            let place = Point2::new(clean(x), clean(y));
            if plane.locate_vertex(place).is_some() {
                continue;
            }
            let vertex = plane.insert(Site { place, sample: n.sample }).ok()?;
            if plane.num_vertices() > before && self.successor[n.sample as usize] != INTERIOR {
                on_boundary.push((n.sample, vertex));
            }
        }
        for &(sample, from) in &on_boundary {
            let next = on_boundary.iter().find(|b| b.0 == self.successor[sample as usize]);
            if let Some(&(_, to)) = next {
                plane.try_add_constraint(from, to);
            }
        }
        Some(plane)
    }
}

/// Circumradius of the triangle of the origin, `a` and `b`.
fn circumradius(a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (a, b) = (DVec2::new(a.x, a.y), DVec2::new(b.x, b.y));
    a.length() * b.length() * (a - b).length() / (2.0 * a.perp_dot(b).abs()).max(f64::MIN_POSITIVE)
}
