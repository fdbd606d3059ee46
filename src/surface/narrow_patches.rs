//! Leaves out sharp edges beside smooth patches that are too narrow for the samples: chamfers, engraved text, threads.
//!
//! The width of a patch is twice its area for the length of its rim, which is the width of a long strip. Without a curve
//! that bounds a strip of width w, and across which the surface turns by θ, it moves by about w sin(θ/2) / 2. The patch
//! where that is least is joined with the neighbour that it turns least towards, along all the edges between both, as long
//! as it is less than a share of the spacing. A chamfer's two curves become one, and what stays is whole. Where the vertices
//! do not suffice for the curves that are left, that share grows.
//!
//! Cost: n log n in the patches, linear in the sides; a few times over where the share grows.

use crate::base::heap::Ranked;
use crate::base::math;
use crate::base::union_find::UnionFind;
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::turns::{ends, turns};
use std::collections::{BTreeMap, BinaryHeap};

/// Deviations below which patches are joined with a neighbour, in spacings: the least is that of a chamfer whose width is a
/// tenth, or of a wall whose width is an eighteenth. The first of these that leaves no more samples on sharp edges than
/// `MOST_ON_EDGES` of all is taken, or the last.
const LEAST: [f64; 5] = [0.02, 0.05, 0.08, 0.12, 0.18];

/// Largest share of the vertices that may lie on sharp edges.
const MOST_ON_EDGES: f64 = 0.6;

/// What was left out.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LeftOut {
    /// Patches that were joined with a neighbour.
    pub patches: usize,
    /// About how far the surface moves by that at most, in the units of the mesh.
    pub deviation: f64,
}

impl LeftOut {
    /// The same of a mesh that is `size` times as large.
    pub fn times(self, size: f64) -> LeftOut {
        LeftOut { deviation: size * self.deviation, ..self }
    }
}

/// Takes from `sharp`, which says of each side of `mesh` whether it is on a sharp edge, those beside patches that are too
/// narrow for `wanted` vertices at distance `spacing`, but for patches with a triangle that `is_needed`. `twin` is as
/// [`twins`](crate::mesh::topology::twins) says.
pub fn leave_out_narrow(
    mesh: &Mesh,
    twin: &[u32],
    sharp: &mut [bool],
    spacing: f64,
    wanted: usize,
    is_needed: impl Fn(u32) -> bool,
) -> LeftOut {
    if !sharp.contains(&true) {
        return LeftOut::default();
    }
    let mut before = Patches::new(mesh, twin, sharp, spacing);
    before.need((0..mesh.triangles.len() as u32).filter(|&t| is_needed(t)));
    // A crease that fades within a patch parts nothing, and stays.
    let parts: Vec<bool> = (0..sharp.len()).map(|s| sharp[s] && before.differ(s as u32, twin)).collect();
    let mut left_out = LeftOut::default();
    for share in LEAST {
        let mut patches = before.clone();
        left_out = patches.join_below(share * spacing);
        let mut stays = |s: usize| sharp[s] && (!parts[s] || patches.differ(s as u32, twin));
        let kept: Vec<bool> = (0..sharp.len()).map(&mut stays).collect();
        if samples_on(mesh, twin, &kept, spacing) <= MOST_ON_EDGES * wanted as f64 || share == LEAST[LEAST.len() - 1] {
            sharp.copy_from_slice(&kept);
            break;
        }
    }
    left_out
}

/// About how many samples the edges of `mesh` that are `sharp` take at distance `spacing`: one for each corner and each
/// spacing.
pub fn samples_on(mesh: &Mesh, twin: &[u32], sharp: &[bool], spacing: f64) -> f64 {
    let mut edges_at = vec![0u32; mesh.positions.len()];
    let mut length = 0.0;
    for side in (0..sharp.len() as u32).filter(|&s| sharp[s as usize] && s < twin[s as usize]) {
        let [a, b] = ends(mesh, side);
        edges_at[a as usize] += 1;
        edges_at[b as usize] += 1;
        length += mesh.positions[a as usize].distance(mesh.positions[b as usize]);
    }
    let corners = edges_at.into_iter().filter(|&n| n != 0 && n != 2).count();
    corners as f64 + length / spacing
}

/// A smooth patch, or several that were joined.
#[derive(Debug, Clone, Default)]
struct Patch {
    area: f64,
    rim: f64,
    /// For each neighbour the length of the edges between both, and the same times the turn there.
    beside: BTreeMap<u32, [f64; 2]>,
    /// Whether it must not be joined with a neighbour for its own narrowness.
    needed: bool,
}

impl Patch {
    /// The neighbour that it turns least towards, itself being `own`, and by how much the surface moves without the edges
    /// between them; none for a patch that is needed.
    fn gentlest(&self, own: u32) -> Option<(u32, f64)> {
        let others = self.beside.iter().filter(|(q, _)| **q != own);
        let turns = others.map(|(&q, sums)| (q, sums[1] / sums[0].max(f64::MIN_POSITIVE)));
        let (q, turn) = turns.filter(|_| !self.needed).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))?;
        let width = 2.0 * self.area / self.rim;
        Some((q, 0.5 * width * math::sin_cos(0.5 * turn.to_radians()).0))
    }
}

/// The smooth patches of a mesh, known by one of their triangles.
#[derive(Clone)]
struct Patches {
    of_triangle: UnionFind,
    list: BTreeMap<u32, Patch>,
}

impl Patches {
    fn new(mesh: &Mesh, twin: &[u32], sharp: &[bool], spacing: f64) -> Patches {
        let mut of_triangle = UnionFind::new(mesh.triangles.len());
        for side in (0..twin.len() as u32).filter(|&s| !sharp[s as usize] && twin[s as usize] != NONE) {
            of_triangle.join(side / 3, twin[side as usize] / 3);
        }
        let turns = turns(mesh, twin, spacing, 0.0);
        let mut list: BTreeMap<u32, Patch> = BTreeMap::new();
        for t in 0..mesh.triangles.len() as u32 {
            let patch = list.entry(of_triangle.find(t)).or_default();
            patch.area += 0.5 * mesh.area_vector(t as usize).length();
            for side in (3 * t..3 * t + 3).filter(|&s| sharp[s as usize] || twin[s as usize] == NONE) {
                let [a, b] = ends(mesh, side).map(|v| mesh.positions[v as usize]);
                let length = a.distance(b);
                patch.rim += length;
                if twin[side as usize] != NONE {
                    let other = of_triangle.find(twin[side as usize] / 3);
                    let [sum, weighted] = patch.beside.entry(other).or_default();
                    *sum += length;
                    *weighted += length * turns[side as usize].abs();
                }
            }
        }
        Patches { of_triangle, list }
    }

    /// Marks the patches of `triangles` as needed.
    fn need(&mut self, triangles: impl Iterator<Item = u32>) {
        for t in triangles {
            let patch = self.of_triangle.find(t);
            self.list.get_mut(&patch).expect("a triangle is of a patch").needed = true;
        }
    }

    /// Whether the triangles on both sides of an edge are of different patches.
    fn differ(&mut self, side: u32, twin: &[u32]) -> bool {
        self.of_triangle.find(side / 3) != self.of_triangle.find(twin[side as usize] / 3)
    }

    /// Joins patches with a neighbour where that moves the surface by less than `deviation`, the least first.
    fn join_below(&mut self, deviation: f64) -> LeftOut {
        let mut left_out = LeftOut::default();
        let ranked = |p: u32, patch: &Patch| Some(Ranked::new(-patch.gentlest(p)?.1, p));
        let mut heap: BinaryHeap<Ranked> = self.list.iter().filter_map(|(&p, patch)| ranked(p, patch)).collect();
        while let Some(Ranked { rank, index: p, .. }) = heap.pop().filter(|least| -least.rank < deviation) {
            // What was joined since has another rank.
            let gentlest = self.list.get(&p).and_then(|patch| patch.gentlest(p));
            let Some((q, _)) = gentlest.filter(|found| found.1 == -rank) else { continue };
            left_out = LeftOut { patches: left_out.patches + 1, deviation: left_out.deviation.max(-rank) };
            let joined = self.join(p, q);
            heap.extend(ranked(joined, &self.list[&joined]));
        }
        left_out
    }

    /// Makes one patch of two; its name.
    fn join(&mut self, p: u32, q: u32) -> u32 {
        self.of_triangle.join(p, q);
        let name = self.of_triangle.find(p);
        let [Some(mut a), Some(mut b)] = [p, q].map(|p| self.list.remove(&p)) else { unreachable!("both are patches") };
        if a.beside.len() < b.beside.len() {
            std::mem::swap(&mut a, &mut b);
        }
        for (&other, sums) in &b.beside {
            let [sum, weighted] = a.beside.entry(other).or_default();
            *sum += sums[0];
            *weighted += sums[1];
        }
        let between: f64 = [p, q].iter().filter_map(|p| a.beside.remove(p)).map(|sums| sums[0]).sum();
        for other in a.beside.keys() {
            let beside = &mut self.list.get_mut(other).expect("a neighbour is a patch").beside;
            let sums = [p, q].map(|p| beside.remove(&p).unwrap_or_default());
            beside.insert(name, [sums[0][0] + sums[1][0], sums[0][1] + sums[1][1]]);
        }
        let rim = (a.rim + b.rim - between).max(f64::MIN_POSITIVE);
        self.list.insert(name, Patch { area: a.area + b.area, rim, beside: a.beside, needed: a.needed || b.needed });
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::topology::twins;
    use crate::testing::cube;
    use glam::{DVec3, dvec3};

    /// A roof of long strips that each turn by 45 degrees, of these widths.
    fn strips(widths: &[f64]) -> Mesh {
        let mut at = DVec3::ZERO;
        let mut profile = vec![at];
        for (i, &width) in widths.iter().enumerate() {
            let (sin, cos) = (45.0 * i as f64).to_radians().sin_cos();
            at += width * dvec3(cos, 0.0, -sin);
            profile.push(at);
        }
        let positions = profile.iter().flat_map(|&p| [p, p + 10.0 * DVec3::Y]).collect();
        let quads = (0..widths.len() as u32).map(|i| 2 * i);
        Mesh { positions, triangles: quads.flat_map(|v| [[v, v + 2, v + 1], [v + 1, v + 2, v + 3]]).collect() }
    }

    fn kept(widths: &[f64], wanted: usize) -> (usize, LeftOut) {
        let mesh = strips(widths);
        let twin = twins(&mesh.triangles);
        let mut sharp: Vec<bool> = turns(&mesh, &twin, 1.0, 30.0).into_iter().map(|turn| turn.abs() > 30.0).collect();
        let left_out = leave_out_narrow(&mesh, &twin, &mut sharp, 1.0, wanted, |_| false);
        (sharp.iter().filter(|s| **s).count() / 2, left_out)
    }

    #[test]
    fn of_a_narrow_chamfer_one_edge_stays() {
        let (edges, left_out) = kept(&[5.0, 0.05, 5.0], 1000);
        assert_eq!((edges, left_out.patches), (1, 1));
        assert!((0.005..0.05).contains(&left_out.deviation));
        assert_eq!(kept(&[5.0, 2.0, 5.0], 1000), (2, LeftOut::default()));
    }

    #[test]
    fn a_patch_that_is_needed_stays() {
        let mesh = strips(&[5.0, 0.05, 5.0]);
        let twin = twins(&mesh.triangles);
        let found: Vec<bool> = turns(&mesh, &twin, 1.0, 30.0).into_iter().map(|turn| turn.abs() > 30.0).collect();
        let mut sharp = found.clone();
        assert_eq!(leave_out_narrow(&mesh, &twin, &mut sharp, 1.0, 1000, |t| t == 2), LeftOut::default());
        assert_eq!(sharp, found);
    }

    #[test]
    fn each_edge_and_each_corner_takes_samples_once() {
        let mesh = cube();
        let twin = twins(&mesh.triangles);
        let sharp: Vec<bool> = turns(&mesh, &twin, 0.1, 30.0).into_iter().map(|turn| turn.abs() > 30.0).collect();
        assert!((samples_on(&mesh, &twin, &sharp, 0.1) - (8.0 + 12.0 / 0.1)).abs() < 1e-9);
    }

    #[test]
    fn a_crease_that_parts_nothing_stays() {
        let positions = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1], [-0.1, 0.0], [0.0, -0.1]];
        let positions = positions.map(|[x, y]| dvec3(x, y, 0.0)).to_vec();
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]] };
        let twin = twins(&mesh.triangles);
        let mut sharp = vec![false; twin.len()];
        (sharp[0], sharp[twin[0] as usize]) = (true, true);
        let before = sharp.clone();
        assert_eq!(leave_out_narrow(&mesh, &twin, &mut sharp, 1.0, 1000, |_| false), LeftOut::default());
        assert_eq!(sharp, before);
    }

    #[test]
    fn more_is_left_out_where_there_are_fewer_vertices() {
        let widths = [3.0, 0.5, 3.0, 0.5, 3.0];
        assert_eq!(kept(&widths, 1000).0, 4);
        assert_eq!(kept(&widths, 50).0, 2);
    }
}
