//! A triangulation of the points of a cloud, all of them where they can be.
//!
//! The stars are those of samples of a mesh, with the neighbour graph in the place of the mesh: neighbours are points
//! nearby whose normals, and the way to them, are those of a surface that bends evenly. A triangle whose circumcircle is
//! large, measured by how far apart its corners are from their neighbours, spans a hole of the scan and is left out.
//!
//! Cost: as for stars of samples.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::rng::{Stage, stream, unit};
use crate::geom::aabb::Aabb;
use crate::spatial::kdtree::{Neighbor, Neighbors};
use crate::spatial::knn_graph::NeighborGraph;
use crate::triangulate::boundary_loops::{HoleCriteria, settle};
use crate::triangulate::cell::Cell;
use crate::triangulate::unfold::{Neighbour, along_bend};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The largest circumradius of a triangle in the star of a point, in spacings of its corners.
const LARGEST_CIRCUMRADIUS: f64 = 2.5;

/// Least cosine between the normals of two points of one sheet: sharp edges are part of it, the two sides of a thin wall
/// are not.
const LEAST_AGREEMENT: f64 = -0.2;

/// The largest sine between the way to a neighbour that faces the same way and the plane of both. On a sheet it is near
/// zero, towards another layer of a fold it is large; across an edge it may be anything up to the sine of half the angle.
const STEEPEST: f64 = 0.5;

/// How much a neighbourhood grows when it was too small.
const GROWTH: f64 = 1.5;

/// Points, with what is known of their neighbours.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// The points.
    pub positions: &'a [DVec3],
    /// Their unit normals.
    pub normals: &'a [DVec3],
    /// The points, to be asked for neighbours.
    pub near: &'a Neighbors,
    /// The nearest neighbours of each.
    pub graph: &'a NeighborGraph,
    /// How far apart the points are around each.
    pub spacings: &'a [f64],
}

/// The triangles between the points, counter-clockwise seen from where normals point. Each point has one fan of them at
/// most. Holes whose loops have a bounding box with a diagonal of up to `close_up_to` are closed.
///
/// Where even a lenient look finds holes the scan is an open one, and a stricter look finds the smaller ones, too: none
/// of them could be told from places that are only sparse otherwise.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn triangulate_points(points: Surroundings<'_>, close_up_to: f64, monitor: &dyn Monitor) -> Result<Vec<[u32; 3]>> {
    check(monitor)?;
    let jittered = jittered(points);
    let moved = Surroundings { positions: &jittered, ..points };
    let stars: Vec<[u32; 3]> = (0..points.positions.len() as u32)
        .into_par_iter()
        .map_init(|| StarMaker::new(moved), |maker, p| maker.star(p))
        .flatten_iter()
        .collect();
    check(monitor)?;
    let bounds = Aabb::of(points.positions.iter().copied()).unwrap_or_default();
    let smallest_diagonal = close_up_to.max(SMALL_HOLE * bounds.diagonal());
    let closed = settle(points, &stars, HoleCriteria { smallest_diagonal, ..LENIENT });
    check(monitor)?;
    if closed.holes == 0 {
        return Ok(closed.triangles);
    }
    Ok(settle(points, &stars, HoleCriteria { smallest_diagonal: close_up_to, ..STRICT }).triangles)
}

/// A look at a closed scan, whose gaps may be where it is only sparse.
const LENIENT: HoleCriteria =
    HoleCriteria { largest_circumradius: LARGEST_CIRCUMRADIUS, most_sides: 16, noise: 0.17, smallest_diagonal: 0.0 };

/// A scan whose holes have boxes with diagonals below this share of that of all points is taken for a closed one.
const SMALL_HOLE: f64 = 0.08;

/// A look at a scan that has holes.
const STRICT: HoleCriteria =
    HoleCriteria { largest_circumradius: 1.2, most_sides: 7, noise: 0.0, smallest_diagonal: 0.0 };

/// How far points are moved, in spacings, so that no four of them are on one circle: those of a grid are, and each would
/// see another two of them as neighbours.
const JITTER: f64 = 1e-4;

/// The positions, each a little aside.
fn jittered(points: Surroundings<'_>) -> Vec<DVec3> {
    let mut rng = stream(0, Stage::Jitter);
    let mut aside = || 2.0 * DVec3::new(unit(&mut rng), unit(&mut rng), unit(&mut rng)) - 1.0;
    points.positions.iter().zip(points.spacings).map(|(p, spacing)| p + JITTER * spacing * aside()).collect()
}

impl Surroundings<'_> {
    /// The circumradius of a triangle in spacings of its corners.
    pub(super) fn relative_circumradius(&self, triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|p| self.positions[p as usize]);
        let sides = (b - a).length() * (c - b).length() * (a - c).length();
        let spacing = triangle.iter().map(|&p| self.spacings[p as usize]).fold(0.0, f64::max);
        sides / (2.0 * (b - a).cross(c - a).length() * spacing)
    }

    /// Where point `b` lies in the tangent plane of `a`; `None` if they are not of one sheet.
    fn place(&self, a: u32, b: u32) -> Option<DVec2> {
        let (a, b) = (a as usize, b as usize);
        let offset = self.positions[b] - self.positions[a];
        let (here, there) = (self.normals[a], self.normals[b]);
        let cosine = here.dot(there);
        let half_sine = (0.5 - 0.5 * cosine).max(0.0).sqrt();
        let steepness = offset.dot((here + there).normalize_or_zero()).abs();
        let is_steep = steepness > (STEEPEST + (1.0 - STEEPEST) * half_sine) * offset.length();
        if cosine < LEAST_AGREEMENT || is_steep { None } else { Some(along_bend(here, there, offset)) }
    }
}

/// Makes stars; keeps its memory from one to the next.
struct StarMaker<'a> {
    points: Surroundings<'a>,
    ball: Vec<Neighbor>,
    found: Vec<Neighbour>,
    cell: Cell,
}

impl<'a> StarMaker<'a> {
    fn new(points: Surroundings<'a>) -> Self {
        StarMaker { points, ball: Vec::new(), found: Vec::new(), cell: Cell::default() }
    }

    /// The triangles of the star of `centre`, which comes first in each.
    fn star(&mut self, centre: u32) -> Vec<[u32; 3]> {
        let points = self.points;
        let nearest = points.graph.of(centre);
        let here = points.positions[centre as usize];
        let spacing =
            nearest.iter().map(|&n| points.spacings[n as usize]).fold(points.spacings[centre as usize], f64::max);
        let largest = LARGEST_CIRCUMRADIUS * spacing;
        let mut radius = nearest.last().map_or(0.0, |&n| here.distance(points.positions[n as usize]));
        self.found.clear();
        self.found
            .extend(nearest.iter().filter_map(|&n| Some(Neighbour { sample: n, place: points.place(centre, n)? })));
        loop {
            let reach = self.cut(largest);
            if 2.0 * reach <= radius || radius >= 2.0 * largest {
                break;
            }
            radius = (GROWTH * radius).min(2.0 * largest);
            self.find(centre, radius);
        }
        self.cell.wedges().filter(|w| w.1.length() <= largest).map(|([a, b], _)| [centre, a, b]).collect()
    }

    /// Finds the neighbours of `centre` within `radius`.
    fn find(&mut self, centre: u32, radius: f64) {
        let points = self.points;
        points.near.collect_within(points.positions[centre as usize], radius, &mut self.ball);
        self.found.clear();
        let others = self.ball.iter().map(|n| n.point).filter(|&n| n != centre);
        self.found.extend(others.filter_map(|n| Some(Neighbour { sample: n, place: points.place(centre, n)? })));
    }

    /// Cuts the cell among the neighbours found; the distance of its farthest corner.
    fn cut(&mut self, largest: f64) -> f64 {
        self.found.sort_unstable_by(|a, b| {
            a.place.length_squared().total_cmp(&b.place.length_squared()).then(a.sample.cmp(&b.sample))
        });
        self.cell.cut(&self.found, largest)
    }
}
