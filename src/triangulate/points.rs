//! Triangulates the points of a cloud, all of them if possible.
//!
//! The stars are like those of samples on a mesh, with the neighbour graph in place of the mesh: neighbours are nearby
//! points whose normals and offsets are those of an evenly curved surface. A triangle with a circumcircle that is large for
//! the spacing of its corners spans a hole of the scan, and is left out.
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

/// Largest circumradius of a triangle in the star of a point, in spacings of its corners.
const LARGEST_CIRCUMRADIUS: f64 = 2.5;

/// Growth factor of a neighbourhood that was too small.
const GROWTH: f64 = 1.5;

/// Returns the triangles between the points, counter-clockwise seen from the side that normals point to. Each point has at
/// most one fan of them. Holes are closed if the bounding box of their loop has a diagonal of up to `close_up_to`.
///
/// If lenient criteria find holes, the scan is open, and strict criteria are applied to find its smaller holes as well. In a
/// closed scan, those would merely be sparse places.
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

/// [`triangulate_points`] for a part of a cloud: the triangles more than a few spacings from its border do not depend on the
/// rest of the cloud. Holes with few sides are closed.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn triangulate_part(points: Surroundings<'_>, monitor: &dyn Monitor) -> Result<Vec<[u32; 3]>> {
    check(monitor)?;
    let stars = stars(points);
    check(monitor)?;
    Ok(fill_boundary_loops(points, &stars, HoleCriteria { flat_are_closed: false, ..STRICT }).triangles)
}

/// Returns the triangles in the stars of all points, each with the centre of its star first.
fn stars(points: Surroundings<'_>) -> Vec<[u32; 3]> {
    let jittered = jittered(points);
    let moved = Surroundings { positions: &jittered, ..points };
    parallel::collect(0..points.positions.len() as u32, |block| {
        let mut maker = StarMaker::new(moved);
        block.flat_map(move |p| maker.star(p))
    })
}

/// Hole criteria for a closed scan, with loops where it is merely sparse.
const LENIENT: HoleCriteria = HoleCriteria {
    largest_circumradius: LARGEST_CIRCUMRADIUS,
    most_sides: 16,
    noise: 0.17,
    smallest_diagonal: 0.0,
    flat_are_closed: true,
};

/// Loops do not make a scan an open one if the diagonal of their bounding box is below this share of the cloud's.
const SMALL_HOLE: f64 = 0.08;

/// Hole criteria for a scan with holes.
const STRICT: HoleCriteria = HoleCriteria { largest_circumradius: 1.2, most_sides: 7, noise: 0.0, ..LENIENT };

/// How far points are moved, in spacings, so that no four are cocircular: those of a grid are, and each would see a
/// different pair of them as neighbours.
const JITTER: f64 = 1e-4;

/// Returns the positions, each slightly displaced.
fn jittered(points: Surroundings<'_>) -> Vec<DVec3> {
    let aside = |i: u32| {
        let ([x, y], [z, _]) = (units_at(0, Stage::Jitter, (i, 0)), units_at(0, Stage::Jitter, (i, 1)));
        2.0 * DVec3::new(x, y, z) - 1.0
    };
    let positions = points.positions.iter().zip(points.spacings).zip(0..);
    positions.map(|((p, spacing), i)| p + JITTER * spacing * aside(i)).collect()
}

/// Makes stars, and reuses its memory for the next one.
struct StarMaker<'a> {
    points: Surroundings<'a>,
    around: Neighborhood,
}

impl<'a> StarMaker<'a> {
    fn new(points: Surroundings<'a>) -> Self {
        StarMaker { points, around: Neighborhood::default() }
    }

    /// Returns the triangles of the star of `centre`, which comes first in each.
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
