//! Initial vertices of a piece: the nodes of a base mesh, and samples where the base mesh is too coarse for the surface.

use crate::base::parallel;
use crate::mesh::topology::NONE;
use crate::pipeline::pieces::base_mesh::Node;
use crate::pipeline::pieces::outline::Outline;
use crate::pipeline::pieces::tile::{LocalCloud, TileOptions, TilePoint};
use crate::pipeline::scale::Scale;
use crate::spatial::kdtree::{Neighbor, Neighbors};
use crate::surface::domain::Sample;
use glam::DVec3;

/// Maximum distance of the surface from a node, in spacings of the target mesh.
const FAR: f64 = 2.0;

/// Number of points by which a node finds the surface nearby, and number of rounds.
const ASKED: usize = 12;
const ROUNDS: usize = 3;

/// Cosine of the angle between the normals of a node and of the surface above which both are on the same side.
const FACING: f64 = 0.3;

/// Distance between nodes, in spacings, below which one of them is left out: the base mesh is folded there.
const NEAR: f64 = 0.5;

/// Distance, in spacings, from all nodes above which a sample stays: in even triangles no point is farther than 0.58 from
/// the nearest corner.
const UNCOVERED: f64 = 0.75;

/// Returns the initial vertices for the mesh of a part of a cloud, all with unit normals: `nodes` moved onto the surface of
/// `points`, numbered [`NONE`], followed by those of the `samples` that are not near any node.
pub fn place_nodes(
    nodes: &[Node],
    points: Vec<TilePoint>,
    samples: &[TilePoint],
    options: &TileOptions,
    outline: &Outline,
) -> Vec<TilePoint> {
    let spacing = Scale::spacing_of_sigma(options.sigma);
    let cloud = LocalCloud::new(points, options, outline);
    let surface = cloud.surface();
    let place = |found: &mut Vec<Neighbor>, node: &Node| {
        let near = tangent_to(&cloud, node, FAR * spacing, found)?;
        surface.sample(near).filter(|sample| sample.normal.dot(node.normal) > FACING)
    };
    let placed: Vec<Option<Sample>> = parallel::map_with(nodes, Vec::new, place);
    let placed: Vec<Sample> = placed.into_iter().flatten().collect();
    let all = Crowd::new(placed, spacing);
    let is_first = |found: &mut Vec<Neighbor>, i: usize| {
        let sample = &all.samples[i];
        !all.has_before(i as u32, sample.position, sample.normal, NEAR, found)
    };
    let are_first: Vec<bool> = parallel::map_with(0..all.samples.len(), Vec::new, is_first);
    let kept = Crowd::new(all.samples.iter().zip(are_first).filter(|s| s.1).map(|s| *s.0).collect(), spacing);
    let is_covered =
        |found: &mut Vec<Neighbor>, s: &TilePoint| kept.has_before(NONE, s.position, s.normal, UNCOVERED, found);
    let are_covered: Vec<bool> = parallel::map_with(samples, Vec::new, is_covered);
    let uncovered = samples.iter().zip(are_covered).filter(|s| !s.1).map(|s| *s.0);
    let of_node = |s: &Sample| TilePoint { number: NONE, position: s.position, normal: s.normal };
    kept.samples.iter().map(of_node).chain(uncovered).collect()
}

/// Samples with a search for those near a position.
struct Crowd {
    samples: Vec<Sample>,
    near: Neighbors,
    spacing: f64,
}

impl Crowd {
    fn new(samples: Vec<Sample>, spacing: f64) -> Crowd {
        let near = Neighbors::new(&samples.iter().map(|s| s.position).collect::<Vec<_>>());
        Crowd { samples, near, spacing }
    }

    /// Returns whether a sample with a lower number is within so many spacings of a position, on the same side.
    fn has_before(&self, number: u32, p: DVec3, normal: DVec3, within: f64, found: &mut Vec<Neighbor>) -> bool {
        self.near.collect_within(p, within * self.spacing, found);
        let faces = |n: &Neighbor| self.samples[n.point as usize].normal.dot(normal) > FACING;
        found.iter().any(|n| n.point < number && faces(n))
    }
}

/// Returns where the tangent planes of nearby points with similar normals take a node, if there are such points within
/// `far`.
fn tangent_to(cloud: &LocalCloud, node: &Node, far: f64, found: &mut Vec<Neighbor>) -> Option<DVec3> {
    let mut position = node.position;
    for _ in 0..ROUNDS {
        cloud.near.collect_nearest_within(position, ASKED, far, found);
        let mut points = found.iter().map(|n| (cloud.positions[n.point as usize], cloud.normals[n.point as usize]));
        let (nearest, normal) = points.find(|(_, normal)| normal.dot(node.normal) > FACING)?;
        position -= normal * normal.dot(position - nearest);
    }
    Some(position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::points::Points;
    use crate::testing::grid;

    /// Places nodes of a lattice slightly above the plane from -1 to 1, where `is_there` holds, on a cloud of that plane.
    fn placed(is_there: impl Fn(DVec3) -> bool, more: &[Node], samples: &[TilePoint]) -> Vec<TilePoint> {
        let plane = |n: u32, z: f64| grid(n, n, move |u, v| DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, z)).positions;
        let points: Vec<TilePoint> = (0..)
            .zip(plane(80, 0.0))
            .map(|(number, position)| TilePoint { number, position, normal: DVec3::Z })
            .collect();
        let outline = Outline::new(Points::from_pairs(points.iter().map(|p| (p.position, p.normal))));
        let sigma = Scale::sigma_of_spacing(0.1);
        let options = TileOptions {
            sigma,
            cell: 2.0 * sigma,
            seed: 0,
            sweeps: None,
            smooth: None,
            is_sided: true,
            is_sharp: false,
        };
        let nodes = plane(20, 0.03).into_iter().filter(|&p| is_there(p));
        let nodes: Vec<Node> =
            nodes.map(|position| Node { position, normal: DVec3::Z }).chain(more.iter().copied()).collect();
        place_nodes(&nodes, points, samples, &options, &outline)
    }

    #[test]
    fn nodes_go_to_the_surface_and_samples_stay_where_there_are_none() {
        let at = |number: u32, x: f64| TilePoint { number, position: DVec3::new(x, 0.02, 0.0), normal: DVec3::Z };
        let vertices = placed(|p| p.x < 0.01, &[], &[at(3, -0.5), at(5, 0.04), at(7, 0.5), at(9, 0.6)]);
        let (nodes, samples): (Vec<TilePoint>, Vec<TilePoint>) = vertices.into_iter().partition(|v| v.number == NONE);
        assert_eq!(nodes.len(), 11 * 21);
        assert!(nodes.iter().all(|v| v.position.z.abs() < 1e-6 && v.normal.z > 0.99));
        assert_eq!(samples.iter().map(|s| s.number).collect::<Vec<_>>(), [7, 9]);
    }

    #[test]
    fn nodes_that_are_too_near_each_other_or_far_from_the_surface_are_left_out() {
        let node = |x: f64, z: f64, normal: DVec3| Node { position: DVec3::new(x, 0.0, z), normal };
        let more = [
            node(0.03, 0.01, DVec3::Z),
            node(0.0, 0.5, DVec3::Z),
            node(0.05, 0.02, -DVec3::Z),
            node(1.4, 0.0, DVec3::Z),
        ];
        assert_eq!(placed(|_| true, &more, &[]), placed(|_| true, &[], &[]));
        // A node on the other side of a thin wall is not too near.
        assert_eq!(placed(|p| p.x < -0.01 || p.x > 0.01, &more[..1], &[]).len(), 20 * 21 + 1);
    }
}
