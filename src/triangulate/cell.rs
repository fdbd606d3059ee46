//! The Delaunay neighbours of a point among others in the plane: those that share a side with its Voronoi cell.
//!
//! The cell begins as a square and is cut by the bisector towards each neighbour, the nearest first. A neighbour more than
//! twice as far as the farthest corner of the cell cannot cut it any more, and neither can those after it. The corners of
//! the cell are the circumcentres of the point's Delaunay triangles.
//!
//! Based on: B. Lévy, N. Bonneel, Variational anisotropic surface meshing with Voronoi parallel linear enumeration, 2013,
//! DOI 10.1007/978-3-642-33573-0_21 (the radius of security).
//!
//! Cost: tests of about six corners for each of about fifteen neighbours; no memory.
//!
//! Limits: rounding decides which of four cocircular neighbours are adjacent, and each of them may see it differently.

use crate::triangulate::unfold::PlacedNeighbor;
use glam::DVec2;

/// A side of the initial square.
const WALL: u32 = u32::MAX;

/// How far a corner must lie beyond the bisector to be cut off, as a share of the neighbour's squared distance.
const TOUCH: f64 = 1e-10;

/// A corner of the cell, and the neighbour across the side that begins there, counter-clockwise.
#[derive(Clone, Copy)]
struct Corner {
    place: DVec2,
    across: u32,
}

/// The Voronoi cell of the origin. Reuses its memory for the next cell.
#[derive(Default)]
pub struct Cell {
    corners: Vec<Corner>,
    before: Vec<Corner>,
}

impl Cell {
    /// Cuts the cell from the square of half width `extent`. `found` is sorted by distance. Returns the distance of the
    /// farthest corner, infinite if the neighbours do not bound the cell.
    pub fn cut(&mut self, found: &[PlacedNeighbor], extent: f64) -> f64 {
        let square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        self.corners.clear();
        self.corners.extend(square.map(|(x, y)| Corner { place: extent * DVec2::new(x, y), across: WALL }));
        let mut reach_squared = 2.0 * extent * extent;
        for n in found {
            let distance_squared = n.place.length_squared();
            if distance_squared > 4.0 * reach_squared {
                break;
            }
            if distance_squared > 0.0 && self.cut_by(n.place, n.sample) {
                reach_squared = self.corners.iter().map(|c| c.place.length_squared()).fold(0.0, f64::max);
            }
        }
        let bounded = self.corners.iter().all(|c| c.across != WALL);
        if bounded { reach_squared.sqrt() } else { f64::INFINITY }
    }

    /// Returns the neighbours across the sides, counter-clockwise.
    pub fn ring(&self) -> impl ExactSizeIterator<Item = u32> + Clone {
        self.corners.iter().map(|c| c.across)
    }

    /// Returns the neighbours across each two adjacent sides, counter-clockwise, and the corner between these: the
    /// circumcentre of their triangle with the origin. Corners of the square are left out.
    pub fn wedges(&self) -> impl Iterator<Item = ([u32; 2], DVec2)> {
        let before = self.corners.iter().cycle().skip(self.corners.len().saturating_sub(1));
        let wedges = before.zip(&self.corners).map(|(from, to)| ([from.across, to.across], to.place));
        wedges.filter(|(sides, _)| !sides.contains(&WALL))
    }

    /// Cuts off the part closer to the neighbour at `place` than to the origin; returns whether there is any.
    fn cut_by(&mut self, place: DVec2, sample: u32) -> bool {
        let middle = 0.5 * place.length_squared();
        let beyond = |c: &Corner| c.place.dot(place) - middle;
        let least = TOUCH * middle;
        if self.corners.iter().all(|c| beyond(c) <= least) {
            return false;
        }
        std::mem::swap(&mut self.corners, &mut self.before);
        self.corners.clear();
        for (i, from) in self.before.iter().enumerate() {
            let to = &self.before[if i + 1 < self.before.len() { i + 1 } else { 0 }];
            let (a, b) = (beyond(from), beyond(to));
            let crossing = || from.place + (to.place - from.place) * (a / (a - b));
            if a <= least {
                self.corners.push(*from);
                if b > least {
                    self.corners.push(Corner { place: crossing(), across: sample });
                }
            } else if b <= least {
                self.corners.push(Corner { place: crossing(), across: from.across });
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use spade::{DelaunayTriangulation, Point2, Triangulation};

    fn neighbours(places: &[DVec2]) -> Vec<PlacedNeighbor> {
        let mut found: Vec<PlacedNeighbor> =
            places.iter().zip(0u32..).map(|(&place, sample)| PlacedNeighbor { sample, place }).collect();
        found.sort_by(|a, b| a.place.length_squared().total_cmp(&b.place.length_squared()));
        found
    }

    /// The ring, starting from its lowest index.
    fn from_lowest(mut ring: Vec<u32>) -> Vec<u32> {
        let lowest = (0..ring.len()).min_by_key(|&i| ring[i]).unwrap();
        ring.rotate_left(lowest);
        ring
    }

    #[test]
    fn the_neighbours_are_those_of_a_triangulation_of_all_points() {
        let mut rng = stream(5, Stage::Scan);
        for count in 8..60 {
            let places: Vec<DVec2> =
                (0..count).map(|_| 4.0 * DVec2::new(unit(&mut rng), unit(&mut rng)) - 2.0).collect();
            let mut cell = Cell::default();
            if cell.cut(&neighbours(&places), 100.0).is_infinite() {
                continue;
            }
            let mut plane = DelaunayTriangulation::<Point2<f64>>::new();
            let hub = plane.insert(Point2::new(0.0, 0.0)).unwrap();
            for p in &places {
                plane.insert(Point2::new(p.x, p.y)).unwrap();
            }
            let expected = plane.vertex(hub).out_edges().map(|e| e.to().index() as u32 - 1).collect();
            assert_eq!(from_lowest(cell.ring().collect()), from_lowest(expected));
        }
    }

    #[test]
    fn the_reach_is_the_largest_circumradius_and_infinite_where_a_side_is_open() {
        let hexagon: Vec<DVec2> = (0..6).map(|k| DVec2::from_angle(f64::from(k).to_radians() * 60.0)).collect();
        let mut cell = Cell::default();
        assert!((cell.cut(&neighbours(&hexagon), 10.0) - 1.0 / 3f64.sqrt()).abs() < 1e-12);
        assert_eq!(cell.ring().len(), 6);
        assert_eq!(cell.cut(&neighbours(&hexagon[..3]), 10.0), f64::INFINITY);
    }
}
