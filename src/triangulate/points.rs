//! A triangulation of the points of a cloud, all of them where they can be.
//!
//! The stars are those of samples of a mesh, with the neighbour graph in the place of the mesh: neighbours are points
//! nearby whose normals, and the way to them, are those of a surface that bends evenly. A triangle whose circumcircle is
//! large, measured by how far apart its corners are from their neighbours, spans a hole of the scan and is left out.
//!
//! Cost: as for stars of samples.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::base::rng::{Stage, units_at};
use crate::geom::aabb::Aabb;
use crate::spatial::kdtree::Neighbor;
use crate::triangulate::boundary_loops::{Filled, HoleCriteria, fill_boundary_loops};
use crate::triangulate::neighborhood::Neighborhood;
use crate::triangulate::surroundings::Surroundings;
use crate::triangulate::unfold::PlacedNeighbor;
use glam::DVec3;

/// The largest circumradius of a triangle in the star of a point, in spacings of its corners.
const LARGEST_CIRCUMRADIUS: f64 = 2.5;

/// How much a neighbourhood grows when it was too small.
const GROWTH: f64 = 1.5;

/// The triangles between the points, counter-clockwise seen from where normals point. Each point has one fan of them at
/// most. Holes whose loops have a bounding box with a diagonal of up to `close_up_to` are closed.
///
/// If lenient criteria find holes, the scan is open, and strict criteria are applied to find its smaller holes, too; in a
/// closed scan these would be places that are only sparse.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn triangulate_points(points: Surroundings<'_>, close_up_to: f64, monitor: &dyn Monitor) -> Result<Filled> {
    check(monitor)?;
    let stars = stars(points);
    check(monitor)?;
    let bounds = Aabb::of(points.positions.iter().copied()).unwrap_or_default();
    let smallest_diagonal = close_up_to.max(SMALL_HOLE * bounds.diagonal());
    let closed = fill_boundary_loops(points, &stars, HoleCriteria { smallest_diagonal, ..LENIENT });
    check(monitor)?;
    if closed.holes == 0 {
        return Ok(closed);
    }
    Ok(fill_boundary_loops(points, &stars, HoleCriteria { smallest_diagonal: close_up_to, ..STRICT }))
}

/// The same for the points of a part of a cloud: the triangles a few spacings from its border are the same whatever else there
/// is. Holes of a few sides are closed.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn triangulate_part(points: Surroundings<'_>, monitor: &dyn Monitor) -> Result<Vec<[u32; 3]>> {
    check(monitor)?;
    let stars = stars(points);
    check(monitor)?;
    Ok(fill_boundary_loops(points, &stars, HoleCriteria { flat_are_closed: false, ..STRICT }).triangles)
}

/// The triangles in the stars of all points, the centre of the star first in each.
fn stars(points: Surroundings<'_>) -> Vec<[u32; 3]> {
    let jittered = jittered(points);
    let moved = Surroundings { positions: &jittered, ..points };
    parallel::collect(0..points.positions.len() as u32, |block| {
        let mut maker = StarMaker::new(moved);
        block.flat_map(move |p| maker.star(p))
    })
}

/// Hole criteria for a closed scan, whose loops may lie where it is only sparse.
const LENIENT: HoleCriteria = HoleCriteria {
    largest_circumradius: LARGEST_CIRCUMRADIUS,
    most_sides: 16,
    noise: 0.17,
    smallest_diagonal: 0.0,
    flat_are_closed: true,
};

/// Loops whose bounding box has a diagonal below this fraction of the cloud's do not make a scan an open one.
const SMALL_HOLE: f64 = 0.08;

/// Hole criteria for a scan that has holes.
const STRICT: HoleCriteria = HoleCriteria { largest_circumradius: 1.2, most_sides: 7, noise: 0.0, ..LENIENT };

/// How far points are moved, in spacings, so that no four of them are on one circle: those of a grid are, and each would
/// see another two of them as neighbours.
const JITTER: f64 = 1e-4;

/// The positions, each a little aside.
fn jittered(points: Surroundings<'_>) -> Vec<DVec3> {
    let aside = |i: u32| {
        let ([x, y], [z, _]) = (units_at(0, Stage::Jitter, (i, 0)), units_at(0, Stage::Jitter, (i, 1)));
        2.0 * DVec3::new(x, y, z) - 1.0
    };
    let positions = points.positions.iter().zip(points.spacings).zip(0..);
    positions.map(|((p, spacing), i)| p + JITTER * spacing * aside(i)).collect()
}

/// Makes stars; keeps its memory from one to the next.
struct StarMaker<'a> {
    points: Surroundings<'a>,
    around: Neighborhood,
}

impl<'a> StarMaker<'a> {
    fn new(points: Surroundings<'a>) -> Self {
        StarMaker { points, around: Neighborhood::default() }
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
        let placed =
            nearest.iter().filter_map(|&n| Some(PlacedNeighbor { sample: n, place: points.place(centre, n)? }));
        self.around.found.clear();
        self.around.found.extend(placed);
        loop {
            self.around.sort();
            let reach = self.around.cut(largest);
            if 2.0 * reach <= radius || radius >= 2.0 * largest {
                break;
            }
            radius = (GROWTH * radius).min(2.0 * largest);
            let collect = |found: &mut Vec<Neighbor>| points.near.collect_within(here, radius, found);
            self.around.find(centre, collect, |n| points.place(centre, n.point));
        }
        self.around.cell.wedges().filter(|w| w.1.length() <= largest).map(|([a, b], _)| [centre, a, b]).collect()
    }
}
