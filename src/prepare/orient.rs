//! Orients the normals of a cloud consistently: neighbours vote, and the votes between two parts of the cloud are added up.
//!
//! Two points at an offset e lie on an evenly bent surface if the normal of one, mirrored in the plane perpendicular to e,
//! is that of the other: n' = n - 2 (n·e) e / e·e. So their normals agree if n' and the other normal do. This also holds
//! around a narrow rim and between the two sides of a thin sheet, where the normals themselves point apart. The vote of two
//! neighbours is the cube of the cosine, so that the clear votes decide.
//!
//! The thicker the neighbourhood of a point, the less its normal is trusted. Where neighbours lie on both sides of a thin
//! wall, or on no surface, the normal may point anywhere, and half a wall would turn over with it.
//!
//! At first, every point is a part of its own. In each round, every part joins the one with which it has the clearest votes,
//! oriented as these say, until nothing is left to join. Finally, points that all of their neighbours together outvote are
//! turned over.
//!
//! Based on: H. Hoppe et al., Surface reconstruction from unorganized points, 1992, DOI 10.1145/133994.134011 (a spanning
//! tree of the neighbour graph); O. Borůvka, O jistém problému minimálním, 1926 (the rounds); S. König, S. Gumhold,
//! Consistent propagation of normal orientations in point clouds, 2009, and H. Xie et al., Piecewise C1 continuous surface
//! reconstruction of noisy point clouds via local implicit quadric regression, 2003, DOI 10.1109/VISUAL.2003.1250359 (the
//! mirror).
//!
//! Departure: in a spanning tree, a single pair of neighbours decides for everything behind it, and in noisy regions a
//! single pair is clearly wrong now and then. The votes of all pairs between two parts together are not.
//!
//! Cost: sorting the edges of the graph, about twice.

use crate::base::math;
use crate::base::parallel;
use crate::base::union_find::UnionFind;
use crate::mesh::sides::lower_first;
use crate::prepare::cloud_normals::spread;
use crate::spatial::knn_graph::NeighborGraph;
use glam::DVec3;
use rayon::slice::ParallelSliceMut;

/// Votes of the neighbours between two parts (at first, two points) on their relative orientation.
#[derive(Clone, Copy)]
struct Vote {
    /// Lowest points of both parts, in increasing order.
    ends: [u32; 2],
    /// Positive if both have the same orientation; the larger its magnitude, the clearer.
    sum: f32,
}

/// Rounds of turning over outvoted points: hardly any are left after the first.
const ROUNDS: usize = 5;

/// Turns over some of `normals` so that they agree within each connected part of the graph. Returns the part of each point:
/// the number of the lowest point in it.
pub fn orient(points: &[DVec3], normals: &mut [DVec3], graph: &NeighborGraph) -> Vec<u32> {
    let trust = trust(points, graph);
    let parts = oriented_parts(votes_of_neighbors(points, normals, graph, &trust), points.len());
    normals.iter_mut().zip(&parts).filter(|(_, part)| **part % 2 == 1).for_each(|(n, _)| *n = -*n);
    turn_outvoted(points, normals, graph, &trust);
    parts.into_iter().map(|part| part / 2).collect()
}

/// Returns, for each of the points, twice the lowest point of its part, plus one if its orientation is opposite to that of
/// the lowest point.
fn oriented_parts(mut votes: Vec<Vote>, points: usize) -> Vec<u32> {
    // Two nodes for each point, one per orientation. The root of a set is its lowest node.
    let mut sets = UnionFind::new(2 * points);
    let mut parts: Vec<u32> = (0..points as u32).map(|p| 2 * p).collect();
    while !votes.is_empty() {
        for Vote { ends: [a, b], sum } in clearest(&votes, points) {
            let turned = u32::from(sum < 0.0);
            sets.join(2 * a, 2 * b + turned);
            sets.join(2 * a + 1, 2 * b + 1 - turned);
        }
        parts = (0..points as u32).map(|p| sets.find(2 * p)).collect();
        votes = between_parts(&votes, &parts);
    }
    parts
}

/// Returns the votes of all pairs of neighbours.
fn votes_of_neighbors(points: &[DVec3], normals: &[DVec3], graph: &NeighborGraph, trust: &[f64]) -> Vec<Vote> {
    let vote = |a: u32, b: u32| trust[a as usize] * trust[b as usize] * vote(points, normals, a, b);
    parallel::collect(0..points.len() as u32, |block| {
        block
            .flat_map(|a| graph.of(a).iter().map(move |&b| [a, b]))
            .filter(|&[a, b]| a < b || !graph.of(b).contains(&a))
            .map(|[a, b]| Vote { ends: lower_first([a, b]), sum: vote(a, b) as f32 })
    })
}

/// Returns the clearest vote of each part, the first of equally clear ones.
fn clearest(votes: &[Vote], points: usize) -> impl Iterator<Item = Vote> {
    let mut best: Vec<Option<Vote>> = vec![None; points];
    for vote in votes {
        for end in vote.ends {
            let best = &mut best[end as usize];
            if best.is_none_or(|b| b.sum.abs() < vote.sum.abs()) {
                *best = Some(*vote);
            }
        }
    }
    best.into_iter().flatten()
}

/// Returns the votes between the remaining parts, as [`oriented_parts`] numbers them; votes between the same two parts are
/// added up.
fn between_parts(votes: &[Vote], parts: &[u32]) -> Vec<Vote> {
    let renamed = |vote: &Vote| {
        let [a, b] = vote.ends.map(|end| parts[end as usize]);
        let sum = if a % 2 == b % 2 { vote.sum } else { -vote.sum };
        (a / 2 != b / 2).then_some(Vote { ends: [a.min(b) / 2, a.max(b) / 2], sum })
    };
    let mut left = parallel::collect(votes, |block| block.iter().filter_map(renamed));
    left.par_sort_unstable_by(|a, b| a.ends.cmp(&b.ends).then(a.sum.total_cmp(&b.sum)));
    let added = |same: &[Vote]| Vote { sum: same.iter().map(|v| v.sum).sum(), ..same[0] };
    left.chunk_by(|a, b| a.ends == b.ends).map(added).collect()
}

/// Turns over the points that their neighbours outvote.
fn turn_outvoted(points: &[DVec3], normals: &mut [DVec3], graph: &NeighborGraph, trust: &[f64]) {
    let is_outvoted = |normals: &[DVec3], p: u32| {
        graph.of(p).iter().map(|&n| trust[n as usize] * vote(points, normals, p, n)).sum::<f64>() < 0.0
    };
    for _ in 0..ROUNDS {
        let all = 0..points.len() as u32;
        let outvoted = parallel::collect(all, |block| block.filter(|&p| is_outvoted(normals, p)));
        // After one point is turned over, another may no longer need to be.
        for p in outvoted {
            if is_outvoted(normals, p) {
                normals[p as usize] = -normals[p as usize];
            }
        }
    }
}

/// Number of nearest neighbours that determine how far a normal is trusted.
const NEAREST: usize = 8;

/// Ratio of the spread of neighbours across their plane to that within it at which trust is halved: noise of an eighth of
/// the spacing has it.
const DOUBTFUL: f64 = 0.2;

/// Returns how far the normal of each point is to be trusted, from 0 to 1.
fn trust(points: &[DVec3], graph: &NeighborGraph) -> Vec<f64> {
    let of_point = |p: u32| {
        let ([least, middle, _], _) = spread(points, p, &graph.of(p)[..NEAREST.min(graph.degree())]);
        let thickness = least.max(0.0) / middle.max(f64::MIN_POSITIVE);
        1.0 / (1.0 + thickness / math::square(DOUBTFUL))
    };
    parallel::map(0..points.len() as u32, of_point)
}

/// Returns how clearly the normals of `a` and `b` have the same orientation: from -1 (opposite) to 1.
fn vote(points: &[DVec3], normals: &[DVec3], a: u32, b: u32) -> f64 {
    math::cube(agreement(points, normals, a, b))
}

/// Turns over the normals of each part that mostly disagrees with the `given` normals, which are zero where unknown. Returns
/// the number of points whose normal is then opposite to the given one.
pub fn side_with(given: &[DVec3], normals: &mut [DVec3], part: &[u32]) -> usize {
    let mut votes = vec![0i64; normals.len()];
    for ((n, g), part) in normals.iter().zip(given).zip(part) {
        votes[*part as usize] += i64::from(n.dot(*g) > 0.0) - i64::from(n.dot(*g) < 0.0);
    }
    normals.iter_mut().zip(part).filter(|(_, part)| votes[**part as usize] < 0).for_each(|(n, _)| *n = -*n);
    normals.iter().zip(given).filter(|(n, g)| n.dot(**g) < 0.0).count()
}

/// Returns the share of neighbours with opposite orientation, among those whose normals can be compared.
pub fn disagreement(points: &[DVec3], normals: &[DVec3], graph: &NeighborGraph) -> f64 {
    let add = |a: (usize, usize), b: (usize, usize)| (a.0 + b.0, a.1 + b.1);
    let of_blocks = parallel::collect(0..points.len() as u32, |block| {
        block
            .flat_map(|a| graph.of(a).iter().map(move |&b| agreement(points, normals, a, b)))
            .filter(|agreement| agreement.abs() > CLEAR)
            .map(|agreement| (1, usize::from(agreement < 0.0)))
            .reduce(add)
    });
    let (clear, turned) = of_blocks.into_iter().reduce(add).unwrap_or_default();
    turned as f64 / clear.max(1) as f64
}

/// Agreement above which there is no doubt.
const CLEAR: f64 = 0.8;

fn agreement(points: &[DVec3], normals: &[DVec3], a: u32, b: u32) -> f64 {
    let (a, b) = (a as usize, b as usize);
    agreement_across(points[b] - points[a], normals[a], normals[b])
}

/// Returns the cosine between the normal of one point, mirrored in the plane half-way to another one at `offset`, and the
/// normal of the other.
fn agreement_across(offset: DVec3, normal: DVec3, other: DVec3) -> f64 {
    let mirrored = normal - 2.0 * normal.project_onto(offset);
    if mirrored.is_finite() { mirrored.dot(other) } else { normal.dot(other) }
}

/// Returns the normal of a point at `position`, turned over if the consistently oriented normals of the points around it
/// require that.
pub fn sided(position: DVec3, normal: DVec3, around: impl Iterator<Item = (DVec3, DVec3)>) -> DVec3 {
    let votes = around.map(|(other, of_other)| math::cube(agreement_across(position - other, of_other, normal)));
    if votes.sum::<f64>() < 0.0 { -normal } else { normal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::rng::{Stage, stream, unit};
    use crate::prepare::cloud_normals::{Neighborhood, plane_normals};
    use crate::spatial::kdtree::Neighbors;

    fn oriented(points: &[DVec3]) -> Vec<DVec3> {
        let near = Neighbors::new(points);
        let graph = NeighborGraph::new(points, &near, 12);
        let mut normals = plane_normals(points, &near, &Neighborhood::Nearest(&graph, 12));
        orient(points, &mut normals, &graph);
        assert!(disagreement(points, &normals, &graph) < 0.01);
        normals
    }

    /// Points of a sphere around the origin, by the golden angle.
    fn sphere(count: u32, radius: f64) -> impl Iterator<Item = DVec3> {
        (0..count).map(move |i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sine, cosine) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            radius * DVec3::new((1.0 - z * z).sqrt() * cosine, (1.0 - z * z).sqrt() * sine, z)
        })
    }

    #[test]
    fn a_single_wrong_pair_is_outvoted_by_the_others_between_two_parts() {
        let vote = |a, b, sum| Vote { ends: [a, b], sum };
        // Two pairs, each with a common orientation; the clearest vote between them contradicts the sum of the others.
        let votes = vec![vote(0, 1, 1.0), vote(2, 3, 1.0), vote(0, 2, 0.9), vote(0, 3, -0.6), vote(1, 3, -0.6)];
        assert_eq!(oriented_parts(votes, 5), [0, 0, 1, 1, 8]);
    }

    #[test]
    fn two_nested_spheres_have_a_side_each() {
        let points: Vec<DVec3> = sphere(3000, 1.0).chain(sphere(1500, 0.7)).collect();
        let normals = oriented(&points);
        for part in [0..3000, 3000..4500] {
            let first = normals[part.start].dot(points[part.start]).signum();
            assert!(part.clone().all(|p| first * normals[p].dot(points[p]) > 0.0), "{part:?}");
        }
    }

    #[test]
    fn the_two_sides_of_a_thin_sheet_look_apart() {
        // A closed sheet a twentieth as thick as wide, points a fortieth of its width apart, with a round rim.
        let mut rng = stream(2, Stage::Scan);
        let (width, half) = (40.0, 1.0);
        let side = (0..1600).map(|i| DVec3::new(f64::from(i % 40) + 0.5, f64::from(i / 40) + 0.5, 0.0));
        let sheet = |z: f64| side.clone().map(move |p| p + z * DVec3::Z);
        let rim: Vec<DVec3> = (0..4 * 40 * 3)
            .map(|i| {
                let (along, turn) = (f64::from(i / 12) + unit(&mut rng), (f64::from(i / 4 % 3) - 1.0) * 0.9);
                let (out, up) = (half * f64::cos(turn), half * f64::sin(turn));
                match i % 4 {
                    0 => DVec3::new(along, -out, up),
                    1 => DVec3::new(along, width + out, up),
                    2 => DVec3::new(-out, along, up),
                    _ => DVec3::new(width + out, along, up),
                }
            })
            .collect();
        let points: Vec<DVec3> = sheet(half).chain(sheet(-half)).chain(rim).collect();
        let normals = oriented(&points);
        let up = normals[820].z.signum();
        let wrong = (0..3200).filter(|&p| normals[p].z * up * points[p].z < 0.0).count();
        assert_eq!(wrong, 0);
    }
}
