//! A point cloud as plain data, and which of its points say nothing of a surface.

use crate::surface::graph::NeighborGraph;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

/// Points of a surface, with or without normals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    /// Where they are, in the units of the file.
    pub positions: Vec<DVec3>,
    /// A normal for each point, of any length, or none at all: then this is empty.
    pub normals: Vec<DVec3>,
}

impl Points {
    /// Keeps the points that are `wanted`, in their order.
    pub fn retain(&mut self, wanted: &[bool]) {
        keep(&mut self.positions, wanted);
        keep(&mut self.normals, wanted);
    }
}

/// Keeps the entries of a list that are `wanted`, in their order.
pub fn keep<T>(list: &mut Vec<T>, wanted: &[bool]) {
    let mut wanted = wanted.iter();
    list.retain(|_| wanted.next() == Some(&true));
}

/// For each position whether it is the first one there.
pub fn distinct(positions: &[DVec3]) -> Vec<bool> {
    // Adding zero makes -0.0 and 0.0 the same bits.
    let key = |p: u32| (positions[p as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&p| (key(p), p));
    let mut first = vec![false; positions.len()];
    order.chunk_by(|&a, &b| key(a) == key(b)).for_each(|place| first[place[0] as usize] = true);
    first
}

/// For each point whether it is a neighbour of its neighbours, or of any other point: strays are not.
pub fn wanted_by_others(graph: &NeighborGraph, points: usize) -> Vec<bool> {
    let mut wanted = vec![false; points];
    (0..points as u32).flat_map(|p| graph.of(p)).for_each(|&n| wanted[n as usize] = true);
    wanted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::neighbors::Neighbors;

    #[test]
    fn the_first_at_each_place_stays() {
        let mut points = Points {
            positions: vec![DVec3::X, DVec3::ZERO, DVec3::X, DVec3::new(-0.0, 0.0, 0.0), DVec3::Y],
            normals: vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y],
        };
        points.retain(&distinct(&points.positions));
        assert_eq!(points.positions, [DVec3::X, DVec3::ZERO, DVec3::Y]);
        assert_eq!(points.normals, [DVec3::X, DVec3::Y, DVec3::NEG_Y]);
    }

    #[test]
    fn a_stray_is_nobodys_neighbour() {
        let mut positions: Vec<DVec3> =
            (0..400).map(|i| DVec3::new(f64::from(i % 20), f64::from(i / 20), 0.0)).collect();
        positions.push(DVec3::new(10.0, 10.0, 4.0));
        let graph = NeighborGraph::new(&positions, &Neighbors::new(&positions), 8);
        let wanted = wanted_by_others(&graph, positions.len());
        assert_eq!(wanted.iter().position(|w| !w), Some(400));
    }
}
